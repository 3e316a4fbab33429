"""From each state in which a device refuses to be driven there is a way out by calls of the package."""

from __future__ import annotations

import contextlib
import signal
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import slipline
from line import Line, Program, drives


@pytest.fixture(scope="module")
def plate() -> slipline.Plate:
    return slipline.Plate("membrane")


def test_an_emergency_stop_latches_a_fault_that_names_itself_and_the_call_that_clears_it(plate: slipline.Plate) -> None:
    with slipline.connect() as device:
        device.use(plate)
        device.arm()
        drive = device.drive(turning_point_m=0.16)
        assert device.emergency_stop() >= drive.at_samples
        for call in (device.arm, lambda: device.wait(seconds=0.01), lambda: device.drive(turning_point_m=0.16)):
            with pytest.raises(slipline.Fault) as caught:
                call()
            assert caught.value.faults == ["EmergencyStop"]
            assert "emergency stop" in str(caught.value) and "clear_faults()" in str(caught.value)
            assert "clear_faults(), and arm()" in caught.value.remedy
            assert isinstance(caught.value, slipline.Refused)
        device.clear_faults()
        assert device.status().state == "Idle"
        device.arm()
        assert device.drive(turning_point_m=0.16).at_samples > drive.at_samples
        # Also before the ramp of the stop has ended.
        for _ in range(20):
            device.emergency_stop()
            device.clear_faults()
            device.arm()
            device.drive(turning_point_m=0.16)


#: The line that the page names after a dead-man trip.
AGAIN = """
import sys
import slipline

plate = slipline.Plate("membrane")
with slipline.connect(sys.argv[1]) as device:
    try:
        device.clear_faults()
        device.use(plate)
        device.arm()
        drive = device.drive(turning_point_m=0.16)
        print("drives", device.status().state)
    except slipline.Fault as fault:
        print("refused", *fault.faults)
"""


def test_after_a_dead_man_trip_one_line_makes_the_next_block_work() -> None:
    with Line() as line:
        with drives(line, "input()") as program:
            assert program.line() == "drives"
            program.signal(signal.SIGSTOP)
            time.sleep(2.0)
            program.signal(signal.SIGKILL)
            program.end()
        assert line.status() == ("Fault", ["HostLost"])
        with Program(AGAIN.replace("device.clear_faults()", "pass"), line.port) as program:
            assert program.line() == "refused HostLost"
            assert program.end() == (0, "")
        with Program(AGAIN, line.port) as program:
            assert program.line() == "drives Driving"
            assert program.end() == (0, "")


#: A profile whose device has a stop input.
STOP_FITTED = 'name = "rig"\nmax_sum = 0.5\nstop_input = true\n[travel]\nresonance_hz = 60.0\nquality = 2.0\nstatic_travel = 0.5\n'


def test_a_profile_is_stored_with_the_button_and_a_cause_that_stands_is_refused_by_its_name(command: Any) -> None:
    with Line() as line:
        with slipline.connect(line.port) as device:
            assert device.profile().profile is None
            with pytest.raises(slipline.BadFile, match="max_sum = 1.2: must be 0.001 to 1"):
                device.store_profile('name = "x"\nmax_sum = 1.2')
            with pytest.raises(slipline.Refused, match="button"):
                device.store_profile(STOP_FITTED)
            line.server.type("press")
            _until(lambda: device.store_profile(STOP_FITTED).profile is not None)
            line.server.type("release")
            kept = device.profile()
            assert (kept.profile.name, kept.profile.max_sum, kept.profile.travel.quality) == ("rig", 0.5, 2.0)
            device.use(slipline.Plate("membrane"))
            device.arm()
            device.drive(turning_point_m=0.16, level=0.3)
            line.server.type("open")
            _until(lambda: device.status().state == "Fault")
            for call in (device.clear_faults, device.arm):
                with pytest.raises(slipline.Fault, match="stop") as caught:
                    call()
                assert caught.value.faults == ["DeskStop"] and "close its stop input" in caught.value.remedy
        shown = command("profile", "--port", line.port).answer()
        assert kept.to_dict() == {name: value for name, value in shown.items() if name != "schema"}
        # A fresh process with the line of the page, while the cause stands.
        with Program(AGAIN, line.port) as program:
            assert program.line() == "refused DeskStop"
            assert program.end() == (0, "")
        line.server.type("close")
        with slipline.connect(line.port) as device:
            # It must rest closed for 2 s.
            _until(lambda: not _refused(device.clear_faults))
            line.server.type("press")
            _until(lambda: device.erase_profile().profile is None)


def _refused(call: Callable[[], object]) -> bool:
    try:
        call()
    except slipline.Refused:
        return True
    return False


def _until(holds: Callable[[], bool]) -> None:
    """Waits until it holds; what the device still refuses does not."""
    until = time.monotonic() + 30.0
    while time.monotonic() < until:
        with contextlib.suppress(slipline.Refused):
            if holds():
                return
        time.sleep(0.02)
    raise TimeoutError("it never held")


def test_the_program_that_was_held_up_itself_goes_on_with_the_same_line() -> None:
    then = """
    input()
    try:
        device.drive(turning_point_m=0.16)
    except slipline.Error as error:
        print(type(error).__name__)
    device.clear_faults()
    device.arm()
    device.drive(turning_point_m=0.16)
    print(device.status().state)
    """
    with Line() as line, drives(line, then) as program:
        assert program.line() == "drives"
        program.signal(signal.SIGSTOP)
        time.sleep(2.0)
        program.signal(signal.SIGCONT)
        program.write("")
        assert program.line() in ("Fault", "Unattended")
        assert program.line() == "Driving"
        assert program.end() == (0, "")


def test_a_lost_link_is_logged_and_connected_again_and_drives_the_plate_in_use(
    plate: slipline.Plate, caplog: pytest.LogCaptureFixture
) -> None:
    with Line() as line, slipline.connect(line.port) as device:
        device.use(plate)
        device.arm()
        device.drive(turning_point_m=0.16)
        line.cut()
        with pytest.raises(slipline.LinkLost):
            for _ in range(100):
                device.status()
                time.sleep(0.05)
        # The dead-man has stopped the device meanwhile.
        time.sleep(1.0)
        logged = [(record.name, record.levelname) for record in caplog.records if "Connection lost" in record.message]
        assert logged == [("slipline", "ERROR")]
        device.reconnect()
        with pytest.raises(slipline.Fault) as caught:
            device.arm()
        assert caught.value.faults == ["HostLost"]
        device.clear_faults()
        device.arm()
        device.drive(turning_point_m=0.16)
        assert device.status().state == "Driving"


def test_threads_that_connect_again_at_the_same_time_take_turns(plate: slipline.Plate) -> None:
    with slipline.connect() as device, ThreadPoolExecutor(4) as pool:
        device.use(plate)
        for again in [pool.submit(device.reconnect) for _ in range(12)]:
            again.result()
        device.arm()
        assert device.drive(turning_point_m=0.16).plate == "membrane"


@pytest.mark.parametrize("call", ["verify", "sweep"])
def test_a_link_lost_in_a_procedure_is_a_lost_link(plate: slipline.Plate, tmp_path: Path, call: str) -> None:
    with Line() as line, slipline.connect(line.port) as device, ThreadPoolExecutor(1) as pool:
        device.use(plate)
        calls = {"verify": lambda: device.verify(window_s=2.0), "sweep": lambda: device.sweep(tmp_path / "sweep.toml")}
        running = pool.submit(calls[call])
        while not running.done() and device.status().state != "Driving":
            pass
        line.cut()
        with pytest.raises(slipline.LinkLost):
            running.result(30.0)


def test_a_fault_ends_a_hold_as_a_fault(plate: slipline.Plate) -> None:
    with slipline.connect("sim", actual_plate=plate, sensor_m=0.1) as device, ThreadPoolExecutor(1) as pool:
        device.use(plate)
        device.arm()
        device.drive(turning_point_m=0.16)
        running = pool.submit(device.hold, timeout=30.0)
        device.wait(seconds=0.1)
        device.emergency_stop()
        with pytest.raises(slipline.Fault) as raised:
            running.result(30.0)
        assert raised.value.faults == ["EmergencyStop"]


def test_a_block_is_opened_and_closed_without_with(plate: slipline.Plate) -> None:
    device = slipline.connect().open()
    device.use(plate)
    device.arm()
    assert device.sample_rate_hz == device.status().sample_rate_hz == 400_000
    device.close()
    device.close()
    assert device.closed
    with pytest.raises(slipline.Refused, match="closed"):
        device.status()


def test_the_ports_of_this_computer_are_those_of_the_command_line() -> None:
    simulated = slipline.ports()[0]
    assert (simulated.port, simulated.is_ours, simulated.usb_serial) == ("sim", True, None)
