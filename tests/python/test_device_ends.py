"""The drive ends with whatever ends the block or the program, by commands of the program or by the device's dead-man."""

from __future__ import annotations

import signal
import time

from line import Line, Program, drives

#: Of the device and the machine, beside the time that is stated.
SLACK_S = 0.15


def assert_stopped(line: Line) -> None:
    """The program itself has stopped and disarmed the device: no fault is latched."""
    assert line.status() == ("Idle", [])
    assert line.time_of("Disarm") > line.time_of("Drive")


def ends(then: str) -> tuple[int, str]:
    """Exit code and error stream of a program that drives and then does this, after which the device must be disarmed."""
    with Line() as line, drives(line, then) as program:
        assert program.line() == "drives"
        ended = program.end()
        assert_stopped(line)
        return ended


def test_the_end_of_the_block_stops_and_disarms() -> None:
    assert ends("pass") == (0, "")


def test_an_exception_in_the_block_stops_and_disarms() -> None:
    code, errors = ends("raise RuntimeError('of the experiment')")
    assert code == 1 and "RuntimeError: of the experiment" in errors


def test_an_exception_of_the_device_stops_and_disarms() -> None:
    code, errors = ends("device.drive(turning_point_m=0.9)")
    assert code == 1 and "slipline.OutOfRange: turning_point_m = 0.9 m: must be" in errors


def test_an_exit_of_the_interpreter_stops_and_disarms() -> None:
    assert ends("sys.exit(3)") == (3, "")


def interrupted(then: str) -> float:
    """Seconds from Ctrl-C to the disarm of a program that drives and then does this."""
    with Line() as line, drives(line, then) as program:
        assert program.line() == "drives"
        # It is in the middle of it.
        time.sleep(0.3)
        pressed = program.signal(signal.SIGINT)
        code, errors = program.end()
        assert code in (1, -signal.SIGINT) and "KeyboardInterrupt" in errors, errors
        assert_stopped(line)
        return line.time_of("Stop") - pressed


def test_ctrl_c_stops_within_a_fifth_of_a_second_wherever_the_program_is() -> None:
    for then in (
        "time.sleep(60)",
        "device.wait(1 << 60)",
        "while True: device.status()",
        "device.verify(window_s=2.0)",
    ):
        took_s = interrupted(then)
        assert took_s < 0.2, (then, took_s)


def test_a_device_that_is_collected_is_stopped_while_the_program_runs_on() -> None:
    body = """
    import gc, sys
    import slipline

    def leave_alone():
        device = slipline.connect(sys.argv[1]).__enter__()
        device.use(slipline.Plate("membrane"))
        device.arm()
        device.drive(turning_point_m=0.16)

    leave_alone()
    gc.collect()
    print("collected")
    input()
    """
    with Line() as line, Program(body, line.port) as program:
        assert program.line() == "collected"
        assert_stopped(line)
        program.write("")
        assert program.end() == (0, "")


def test_the_end_of_the_interpreter_stops_a_block_that_was_never_left() -> None:
    body = """
    import sys
    import slipline

    device = slipline.connect(sys.argv[1]).__enter__()
    device.use(slipline.Plate("membrane"))
    device.arm()
    device.drive(turning_point_m=0.16)
    sys.kept = device
    """
    with Line() as line, Program(body, line.port) as program:
        assert program.end() == (0, "")
        assert_stopped(line)


def test_the_end_of_the_interpreter_stops_the_block_of_a_thread_that_it_abandons() -> None:
    body = """
    import sys, threading
    import slipline

    begun = threading.Event()

    def drive():
        with slipline.connect(sys.argv[1]) as device:
            device.use(slipline.Plate("membrane"))
            device.arm()
            device.drive(turning_point_m=0.16)
            begun.set()
            threading.Event().wait()

    threading.Thread(target=drive, daemon=True).start()
    begun.wait()
    """
    with Line() as line, Program(body, line.port) as program:
        assert program.end() == (0, "")
        assert_stopped(line)


def test_a_thread_that_is_abandoned_while_the_program_runs_on_is_unattended() -> None:
    then = """
    threading.Thread(target=threading.Event().wait, daemon=True).start()
    input()
    device.status()
    """
    with Line() as line, drives(line, then, "{'unattended_s': 1.0}") as program:
        assert program.line() == "drives"
        assert 0.5 < line.time_of("Disarm") - line.time_of("Drive") < 1.5
        program.write("")
        code, errors = program.end()
        assert code == 1 and "slipline.Unattended: no call came for 1 s" in errors
        assert line.status() == ("Idle", [])


def test_a_c_call_that_keeps_the_interpreter_ends_the_drive_within_a_second() -> None:
    then = """
    import ctypes
    # Calls of this library keep the interpreter's lock.
    ctypes.PyDLL(None).sleep(3)
    print(device.status().state)
    device.drive(turning_point_m=0.16)
    """
    with Line() as line, drives(line, then) as program:
        assert program.line() == "drives"
        began = time.monotonic()
        assert line.time_of("Disarm") - began < 1.0 + SLACK_S
        assert program.line() == "Idle"
        code, errors = program.end()
        assert code == 1 and "slipline.Unattended: this program was held up" in errors
        assert line.status() == ("Idle", [])


def test_a_program_that_is_stopped_for_two_seconds_finds_the_device_stopped_by_its_dead_man() -> None:
    then = """
    input()
    status = device.status()
    print(status.state, *status.faults)
    """
    with Line() as line, drives(line, then) as program:
        assert program.line() == "drives"
        program.signal(signal.SIGSTOP)
        time.sleep(2.0)
        program.signal(signal.SIGCONT)
        program.write("")
        assert program.line() == "Fault the host fell silent while driving"
        program.end()
        assert line.count("Disarm") >= 1


def test_a_program_that_is_killed_leaves_a_device_that_its_dead_man_stops() -> None:
    with Line() as line, drives(line, "input()") as program:
        assert program.line() == "drives"
        program.signal(signal.SIGKILL)
        program.end()
        time.sleep(1.0 + 2 * SLACK_S)
        assert line.status() == ("Fault", ["HostLost"])
        assert line.count("Stop") == line.count("Disarm") == 0
