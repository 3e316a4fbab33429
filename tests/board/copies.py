"""Runs cases on copies of a rig, so that a state that takes long to reach is reached once.

A copy is a fork of the process: memory, processor and peripherals of the board are as they are in that moment, and what
happens to them in the copy stays there.
"""
import os
import pickle
import sys
import traceback

import pytest


def in_copy(case):
    """Calls `case()` in a copy and returns its result; what it raises is raised here, as an AssertionError."""
    sys.stdout.flush()
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(read)
        try:
            answer = "result", case()
        except pytest.skip.Exception as reason:
            answer = "skipped", str(reason)
        except BaseException:
            answer = "failed", traceback.format_exc()
        with os.fdopen(write, "wb") as pipe:
            pickle.dump(answer, pipe)
        sys.stdout.flush()
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        answer = pipe.read()
    os.waitpid(child, 0)
    assert answer, "the copy's process has died"
    kind, result = pickle.loads(answer)
    if kind == "skipped":
        pytest.skip(result)
    assert kind == "result", f"in a copy of the rig:\n{result}"
    return result


def on_copy(rig, case):
    """As `in_copy`, for a case that takes the rig."""
    return in_copy(lambda: case(rig))
