"""Drives and their ends at sample indices, and waits by time: blocking, in asyncio, and as an iterator."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import slipline
from line import Line

BLOCK = 128


@pytest.fixture(scope="module")
def plate() -> slipline.Plate:
    return slipline.Plate("membrane")


@pytest.fixture
def device(plate: slipline.Plate) -> Iterator[slipline.Device]:
    with slipline.connect() as device:
        device.use(plate)
        device.arm()
        yield device


def test_a_stop_at_an_index_begins_at_the_first_block_there(device: slipline.Device) -> None:
    # Two seconds ahead: a machine that is busy elsewhere does not let them pass before the stop is sent.
    for samples in (750 * BLOCK, 750 * BLOCK + 1):
        drive = device.drive(turning_point_m=0.16)
        stopped = device.stop(at=drive.at_samples + samples)
        assert stopped - drive.at_samples == -(-samples // BLOCK) * BLOCK
        assert device.status().state == "Driving"
        assert device.wait(stopped) == stopped
    device.wait(seconds=0.05)
    assert device.status().state == "Armed"


def test_a_stop_at_an_index_that_has_passed_is_a_stop_now(device: slipline.Device) -> None:
    drive = device.drive(turning_point_m=0.16)
    now = device.wait(seconds=0.05)
    assert drive.at_samples + 10 < now <= device.stop(at=drive.at_samples + 10)
    device.wait(seconds=0.05)
    assert device.status().state == "Armed"


def test_the_next_drive_waits_for_the_change_that_is_ahead_and_a_stop_drops_it(device: slipline.Device) -> None:
    first = device.drive(turning_point_m=0.16)
    # Longer than the link repeats a refused drive.
    stopped = device.stop(at=first.at_samples + 200_000)
    second = device.drive(turning_point_m=0.18)
    assert second.at_samples > stopped
    third = device.drive(turning_point_m=0.2, at=second.at_samples + 4_000_000)
    assert third.at_samples >= second.at_samples + 4_000_000
    device.stop()
    fourth = device.drive(turning_point_m=0.2)
    assert fourth.at_samples < third.at_samples


def test_a_stop_from_another_thread_supersedes_a_drive_that_waits_for_an_earlier_one(device: slipline.Device) -> None:
    first = device.drive(turning_point_m=0.16)
    device.drive(turning_point_m=0.18, at=first.at_samples + 8_000_000)
    threading.Timer(0.2, device.stop).start()
    assert device.drive(turning_point_m=0.2, at=first.at_samples + 9_000_000).superseded


def test_a_list_of_drives_begins_at_its_indices(plate: slipline.Plate) -> None:
    with Line() as line, slipline.connect(line.port) as device:
        device.use(plate)
        device.arm()
        begin = device.status().now_samples + 80_000
        begin -= begin % BLOCK
        indices = [begin + 40_000 * i for i in range(6)]
        steps = [{"at": at, "turning_point_m": 0.12 + 0.01 * i, "level": 0.4} for i, at in enumerate(indices[:-1])]
        results = device.sequence([*steps, {"at": indices[-1], "glide_s": 0.01}])
        assert [result.at_samples for result in results] == [-(-at // BLOCK) * BLOCK for at in indices]
        assert [len(result.tones) for result in results] == [1] * 5 + [0]
        assert not any(result.superseded for result in results)
        sent = line.bodies("Drive")
        assert [len(drive.tones) for drive in sent] == [1] * 5 + [0]
        device.wait(results[-1].at_samples + 20_000)
        assert device.status().state == "Armed"
        for steps, kind in (
            ([{"turning_point_m": 0.16}], TypeError),
            ([{"at": 1.5, "turning_point_m": 0.16}], TypeError),
            ([{"at": -1, "turning_point_m": 0.16}], slipline.OutOfRange),
            ([{"at": 0, "turning_point_m": 0.16}], slipline.OutOfRange),
            ([{"at": 0, "turning_point": 0.16}], TypeError),
            ([{"at": 0, "glide_s": 99.0}], slipline.OutOfRange),
            (5, TypeError),
        ):
            with pytest.raises(kind):
                device.sequence(steps)


def test_a_wait_lasts_by_the_devices_clock_and_ends_at_its_timeout(device: slipline.Device) -> None:
    before = device.status().now_samples
    assert before + 40_000 <= device.wait(seconds=0.1) <= device.status().now_samples
    for call in (
        lambda: device.wait(1 << 60, timeout=0.1),
        lambda: device.wait(seconds=60.0, timeout=0.1),
        lambda: device.wait(device.drive(turning_point_m=0.16, at=device.status().now_samples + 1_000_000), timeout=0.1),
    ):
        with pytest.raises(TimeoutError, match="timeout = 0.1 s"):
            call()
    for arguments, kind in (
        ({}, TypeError),
        ({"at_samples": 5, "seconds": 1.0}, TypeError),
        ({"at_samples": "soon"}, TypeError),
        ({"at_samples": 0.5}, TypeError),
        ({"at_samples": -1}, slipline.OutOfRange),
        ({"seconds": -1.0}, slipline.OutOfRange),
        ({"seconds": float("nan")}, slipline.OutOfRange),
        ({"seconds": 1.0, "timeout": float("inf")}, slipline.OutOfRange),
    ):
        with pytest.raises(kind):
            device.wait(**arguments)


def test_other_tasks_run_during_a_wait_of_asyncio_and_it_can_be_cancelled(device: slipline.Device) -> None:
    async def run() -> None:
        drive = device.drive(turning_point_m=0.16)
        turns = 0

        async def turn() -> None:
            nonlocal turns
            while True:
                turns += 1
                await asyncio.sleep(0.005)

        turning = asyncio.create_task(turn())
        assert await device.wait_async(drive.at_samples + 80_000) == drive.at_samples + 80_000
        assert turns > 3
        with pytest.raises(TimeoutError):
            await device.wait_async(seconds=60.0, timeout=0.1)
        waiting = asyncio.create_task(device.wait_async(1 << 60, timeout=60.0))
        await asyncio.sleep(0.1)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(device.wait_async(1 << 60, timeout=60.0), 0.1)
        turning.cancel()

    began = time.monotonic()
    asyncio.run(run())
    # The threads of the cancelled waits have ended.
    assert time.monotonic() - began < 20.0


def test_waits_of_asyncio_neither_wait_for_each_other_nor_keep_a_thread_of_the_event_loop(device: slipline.Device) -> None:
    async def run() -> None:
        # More than the threads of the loop's executor.
        waits = [asyncio.create_task(device.wait_async(1 << 60, timeout=60.0)) for _ in range((os.cpu_count() or 1) + 5)]
        await asyncio.sleep(0.2)
        stopped = await asyncio.wait_for(asyncio.to_thread(device.stop), 20.0)
        ends = await asyncio.wait_for(asyncio.gather(*waits), 20.0)
        assert all(stopped - 40_000 < end for end in ends)

    device.drive(turning_point_m=0.16)
    asyncio.run(run())


def test_an_iterator_watches_the_device_until_it_is_closed(plate: slipline.Plate) -> None:
    seen = []
    with slipline.connect() as device:
        device.use(plate)
        device.arm()
        for status in device.watch(0.02):
            seen.append(status)
            if len(seen) == 3:
                device.drive(turning_point_m=0.16)
            if len(seen) == 6:
                device.close()
        with pytest.raises(slipline.OutOfRange):
            device.watch(0.0)
    assert [status.state for status in seen] == ["Armed"] * 3 + ["Driving"] * 3
    assert [one.now_samples < other.now_samples for one, other in zip(seen, seen[1:])] == [True] * 5


def test_closing_ends_the_iterator_of_another_thread_within_its_period(plate: slipline.Plate) -> None:
    seen: list[object] = []
    with slipline.connect() as device:
        watching = threading.Thread(target=lambda: seen.extend(device.watch(60.0)), daemon=True)
        watching.start()
        device.wait(seconds=0.2)
    watching.join(20.0)
    assert not watching.is_alive() and len(seen) == 1


#: Number of trials, and of programs that compute beside them; the night takes 200 at load 8.
TRIALS = int(os.environ.get("SLIPLINE_TRIALS", "8"))
LOAD = int(os.environ.get("SLIPLINE_LOAD", "0"))


@pytest.fixture
def load() -> Iterator[None]:
    """Programs that compute all the time."""
    running = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(LOAD)]
    try:
        yield
    finally:
        for program in running:
            program.kill()
            program.wait()


def test_each_trial_of_a_tenth_of_a_second_fades_from_the_same_sample_on(plate: slipline.Plate, tmp_path: Path, load: None) -> None:
    listed = [{"turning_point_m": 0.12 + 0.001 * (i % 80), "level": 0.5, "duration_s": 0.1} for i in range(TRIALS)]
    with Line() as line, slipline.connect(line.port) as device:
        device.use(plate)
        device.arm()
        rows = slipline.trials.run(device, listed, lambda trial: True, folder=tmp_path, subject="01", task="edge")
        ends = [drive for drive in line.bodies("Drive") if not drive.tones]
    assert [row["duration"] for row in rows] == [str(40_064 / 400_000)] * TRIALS
    assert len(ends) == TRIALS
    # What the device was asked, by the tap on its line: it rounds up to a block.
    begins = [int(row["at_samples"]) for row in rows]
    fades = [-(-end.apply.value // BLOCK) * BLOCK for end in ends]
    assert [fade - begin for begin, fade in zip(begins, fades)] == [40_064] * TRIALS
