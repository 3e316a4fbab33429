"""An armed device that its program leaves alone is stopped and disarmed after `unattended_s`."""

from __future__ import annotations

import os
import sys

from line import Line, Program, drives

#: Length of the sleep that drives on; a shorter one is for a quick look, the gate takes this.
SLEEP_S = float(os.environ.get("SLIPLINE_SLEEP_S", "30"))


def test_a_sleep_of_half_a_minute_drives_on() -> None:
    with Line() as line, drives(line, f"time.sleep({SLEEP_S})\nprint(device.status().state)\ninput()") as program:
        assert program.line() == "drives"
        assert program.line() == "Driving"
        assert line.count("Stop") == line.count("Disarm") == 0
        program.write("")
        assert program.end() == (0, "")


def unattended(then: str, unattended_s: float) -> tuple[float, str]:
    """Seconds from the drive to the disarm of a program that does this, and its error stream."""
    with Line() as line, drives(line, then, f"{{'unattended_s': {unattended_s}}}") as program:
        assert program.line() == "drives"
        code, errors = program.end()
        assert code == 1
        assert line.status() == ("Idle", [])
        return line.time_of("Disarm") - line.time_of("Drive"), errors


def test_a_sleep_of_five_seconds_ends_after_the_three_that_are_allowed() -> None:
    took_s, errors = unattended("time.sleep(5)\ndevice.status()", 3.0)
    assert 2.5 < took_s < 3.5
    assert "slipline.Unattended: no call came for 3 s, so the device was stopped and disarmed" in errors


def test_the_prompt_of_a_debugger_is_unattended() -> None:
    body = "import pdb; pdb.set_trace()\ndevice.status()"
    with Line() as line, drives(line, body, "{'unattended_s': 1.0}") as program:
        assert program.line() == "drives"
        assert 0.5 < line.time_of("Disarm") - line.time_of("Drive") < 1.5
        program.write("continue")
        code, errors = program.end()
        assert code == 1 and "slipline.Unattended" in errors


def test_any_call_renews_the_time_and_a_wait_is_a_call() -> None:
    then = """
    for _ in range(4):
        time.sleep(0.7)
        device.status()
    device.wait(device.status().now_samples + 1_000_000)
    print(device.status().state)
    """
    with Line() as line, drives(line, then, "{'unattended_s': 2.0}") as program:
        assert program.line() == "drives"
        assert program.line() == "Driving"
        assert program.end() == (0, "")


def test_after_it_was_unattended_the_device_can_be_armed_again() -> None:
    then = """
    time.sleep(1.5)
    try:
        device.drive(turning_point_m=0.16)
    except slipline.Unattended as unattended:
        print(isinstance(unattended, slipline.Error), device.status().state)
    device.arm()
    device.drive(turning_point_m=0.16)
    print(device.status().state)
    """
    with Line() as line, drives(line, then, "{'unattended_s': 1.0}") as program:
        assert program.line() == "drives"
        assert program.line() == "True Idle"
        assert program.line() == "Driving"
        assert program.end() == (0, "")


def test_an_interactive_program_that_has_armed_nothing_counts_as_attended() -> None:
    body = """
    import sys, time
    import slipline

    with slipline.connect(sys.argv[1], unattended_s=1.0) as device:
        time.sleep(1.5)
        print(device.status().state)
    """
    with Line() as line, Program(body, line.port) as program:
        assert program.line() == "Idle"
        assert program.end() == (0, "")




def test_a_slow_or_failing_log_handler_delays_no_keep_alive() -> None:
    then = """
    import logging

    class Slow(logging.Handler):
        def emit(self, record):
            time.sleep(2.5)                       # as one that sends mails
            raise RuntimeError("its window is gone")

    logging.getLogger("slipline").addHandler(Slow())
    logging.getLogger("slipline").setLevel(logging.DEBUG)
    device.disarm()
    device.arm()
    device.drive(turning_point_m=0.16)
    time.sleep(6.0)
    print(device.status().state)
    """
    with Line() as line, drives(line, then) as program:
        assert program.line() == "drives"
        assert program.line() == "Driving"
        code, errors = program.end()
        assert code == 0 and errors.count("RuntimeError: its window is gone") >= 2, errors
