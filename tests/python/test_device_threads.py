"""Several threads at one device: each has its own answer, and a stop ends what the others wait for."""

from __future__ import annotations

import os
import random
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest
import slipline
from line import Line, Program


@pytest.fixture(scope="module")
def plate() -> slipline.Plate:
    return slipline.Plate("membrane")


@pytest.fixture
def device(plate: slipline.Plate) -> Iterator[slipline.Device]:
    with slipline.connect() as device:
        device.use(plate)
        device.arm()
        yield device


def beside(call: Callable[[], Any], repeats: Callable[[], Any], threads: int = 3) -> Any:
    """The result of a call while threads repeat another."""
    ended = threading.Event()

    def repeat() -> None:
        while not ended.is_set():
            repeats()

    with ThreadPoolExecutor(threads) as pool:
        polls = [pool.submit(repeat) for _ in range(threads)]
        try:
            return call()
        finally:
            ended.set()
            for poll in polls:
                poll.result()


def test_a_drive_has_its_answer_however_often_others_ask_for_the_status(device: slipline.Device) -> None:
    def drive() -> int:
        return sum(device.drive(turning_point_m=0.12 + 0.01 * (i % 8)).superseded for i in range(60))

    assert beside(drive, device.status) == 0


def test_a_measurement_ends_while_others_ask_for_the_status(plate: slipline.Plate) -> None:
    with slipline.connect(actual_plate=plate, sensor_m=0.03) as device:
        device.use(plate)
        measured = beside(lambda: device.measure(0.03, points=8), device.status)
        assert len(measured.frequency_hz) == 8


def test_of_drives_of_several_threads_the_newest_supersedes_without_an_error(device: slipline.Device) -> None:
    def drive(place_m: float) -> list[slipline.Result]:
        return [device.drive(turning_point_m=place_m) for _ in range(60)]

    with ThreadPoolExecutor(4) as pool:
        results = [one for of_one in pool.map(drive, (0.12, 0.14, 0.16, 0.18)) for one in of_one]
    for result in results:
        assert result.superseded == (result.at_samples is None)
    begun = [result.at_samples for result in results if not result.superseded]
    assert len(begun) == len(set(begun)) > 0
    superseded = [result for result in results if result.superseded]
    if superseded:
        with pytest.raises(slipline.Refused, match="never began"):
            device.wait(superseded[0])
    assert device.status().state == "Driving"


def after(delay_s: float, call: Callable[[], Any]) -> threading.Timer:
    timer = threading.Timer(delay_s, call)
    timer.start()
    return timer


@pytest.mark.parametrize("ends", ["stop", "disarm", "emergency_stop"])
def test_a_wait_ends_when_another_thread_stops(device: slipline.Device, ends: str) -> None:
    drive = device.drive(turning_point_m=0.16)
    end = drive.at_samples + 400 * 400_000
    timer = after(0.2, getattr(device, ends))
    try:
        at = device.wait(end, timeout=30.0)
    except slipline.Fault as fault:
        assert ends == "emergency_stop" and fault.faults == ["EmergencyStop"]
    else:
        assert drive.at_samples < at < end
    timer.join()


def test_a_stop_before_the_wait_does_not_end_it(device: slipline.Device) -> None:
    device.drive(turning_point_m=0.16)
    at = device.stop()
    assert device.wait(at + 40_000) == at + 40_000


@pytest.mark.parametrize("ends", ["stop", "emergency_stop", "disarm"])
def test_a_measurement_that_another_thread_stops_disarms(plate: slipline.Plate, ends: str) -> None:
    with slipline.connect(actual_plate=plate, sensor_m=0.03) as device:
        device.use(plate)
        timer = after(0.5, getattr(device, ends))
        with pytest.raises(slipline.Refused):
            device.measure(0.03, points=64)
        timer.join()
        assert device.status().state in ("Idle", "Fault")
        if ends == "emergency_stop":
            device.clear_faults()
        assert device.status().state == "Idle"


def test_a_measurement_that_fails_disarms(device: slipline.Device) -> None:
    with pytest.raises(slipline.Refused, match="no input"):
        device.measure(0.05)
    assert device.status().state == "Idle"


def test_a_drive_plays_the_plate_that_another_thread_has_put_in_use(device: slipline.Device) -> None:
    other = slipline.Plate("al-bending")
    with ThreadPoolExecutor(1) as pool:
        pool.submit(device.use, other).result()
    low_m, high_m = other.span_m
    assert device.drive(turning_point_m=(low_m + high_m) / 2).plate == "al-bending"


def test_closing_ends_the_waits_of_other_threads(plate: slipline.Plate) -> None:
    device = slipline.connect().open()
    device.use(plate)
    device.arm()
    device.drive(turning_point_m=0.16)
    with ThreadPoolExecutor(1) as pool:
        waits: Future[int] = pool.submit(device.wait, 1 << 60, timeout=30.0)
        time.sleep(0.2)
        device.close()
        with pytest.raises(slipline.Refused, match="closed"):
            waits.result()


def test_ctrl_c_reaches_the_main_thread_while_others_ask_for_the_status() -> None:
    body = """
    import sys, threading
    import slipline

    with slipline.connect(sys.argv[1]) as device:
        def poll():
            try:
                while True:
                    device.status()
            except slipline.Error:
                pass

        device.use(slipline.Plate("membrane"))
        device.arm()
        device.drive(turning_point_m=0.16)
        threads = [threading.Thread(target=poll) for _ in range(3)]
        for thread in threads:
            thread.start()
        print("drives")
        try:
            device.wait(1 << 60)
        except KeyboardInterrupt:
            print("interrupted")
    for thread in threads:
        thread.join()
    """
    for _ in range(3):
        with Line() as line, Program(body, line.port) as program:
            assert program.line() == "drives"
            time.sleep(0.2)
            program.signal(signal.SIGINT)
            assert program.line() == "interrupted"
            assert program.end() == (0, "")
            assert line.status() == ("Idle", [])


#: Number of random calls; the night takes 1 000.
CALLS = int(os.environ.get("SLIPLINE_CALLS", "100"))

#: Random calls from four threads until the main one has made its share. The arguments: port, seed, calls.
RANDOM = """
import random, sys, threading, time
import slipline

port, seed, calls = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
plate = slipline.Plate("membrane")
# A call may take this long: that of its own timeout, and a second.
TIMEOUT_S = 0.3
slow = []

def act(device, random):
    turn = random.randrange(12)
    if turn < 3:
        device.drive(turning_point_m=random.uniform(0.1, 0.2))
    elif turn == 3:
        device.drive(turning_point_m=0.16, at=device.status().now_samples + random.randrange(40_000))
    elif turn == 4:
        device.stop(at=device.status().now_samples + random.randrange(40_000))
    elif turn == 5:
        device.stop()
    elif turn == 6:
        device.wait(seconds=0.2, timeout=TIMEOUT_S)
    elif turn == 7:
        device.wait(1 << 60, timeout=TIMEOUT_S)
    elif turn == 8:
        device.emergency_stop()
        device.clear_faults()
        device.arm()
    elif turn == 9:
        device.disarm()
        device.arm()
    else:
        device.status()

def run(device, seed, count):
    drawn = random.Random(seed)
    for _ in range(count):
        began = time.monotonic()
        try:
            act(device, drawn)
        except (slipline.Error, TimeoutError):
            pass
        if time.monotonic() - began > TIMEOUT_S + 1.0:
            slow.append(time.monotonic() - began)

try:
    with slipline.connect(port) as device:
        device.use(plate)
        device.arm()
        print("runs")
        threads = [threading.Thread(target=run, args=(device, seed + i, calls // 4)) for i in range(3)]
        for thread in threads:
            thread.start()
        run(device, seed + 3, calls // 4)
        for thread in threads:
            thread.join()
except KeyboardInterrupt:
    pass
except slipline.LinkLost:
    pass
for thread in threads:
    thread.join(10)
    assert not thread.is_alive()
print("slow", *slow)
"""


@pytest.mark.parametrize("disturbance", ["none", "ctrl-c", "kill of the device's program"])
def test_random_calls_of_four_threads_neither_hang_nor_abort(disturbance: str) -> None:
    seed = random.randrange(1 << 20)
    with Line() as line, Program(RANDOM, line.port, str(seed), str(CALLS)) as program:
        assert program.line() == "runs"
        time.sleep(random.uniform(0.05, 0.5))
        if disturbance == "ctrl-c":
            program.signal(signal.SIGINT)
        elif disturbance != "none":
            line.server.kill()
        assert program.line() == "slow", seed
        code, errors = program.end()
        assert (code, errors) == (0, ""), (seed, errors)
        if disturbance in ("none", "ctrl-c"):
            state, faults = line.status()
            assert state in ("Idle", "Fault") and set(faults) <= {"EmergencyStop"}, seed
