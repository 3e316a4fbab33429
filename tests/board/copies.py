"""Runs cases on copies of a rig, so that a state that takes long to reach is reached once.

A copy is a fork of the process: memory, processor and peripherals of the board are as they are in that moment, and what
happens to them in the copy stays there.
"""
import os
import pickle
import traceback


def on_copy(rig, case):
    """Calls `case(rig)` in a copy and returns its result; what it raises is raised here, as an AssertionError."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(read)
        try:
            result = True, case(rig)
        except BaseException:
            result = False, traceback.format_exc()
        with os.fdopen(write, "wb") as pipe:
            pickle.dump(result, pipe)
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        answer = pipe.read()
    os.waitpid(child, 0)
    is_well, result = pickle.loads(answer)
    assert is_well, f"in a copy of the rig:\n{result}"
    return result
