"""A session of practice, interleaved staircases, catch trials and breaks, killed in each of its phases, on a stand-in."""

import os
import signal

import numpy as np
import pytest

import slipline
from slipline import trials
from slipline.staircase import Staircase
from trial_device import device, events, run  # noqa: F401

SEED = 7
BREAK_S = 70.0
FIELDS = {"duration_s": 0.5, "iti_s": (0.5, 1.5), "level": 0.6}
PRACTICE = [{"felt_edge_m": 0.2, "trial_type": "practice", **FIELDS}] * 2


def experiment():
    """Two staircases, interleaved, and catch trials by felt edge among them."""
    rng = np.random.default_rng(SEED)
    low = Staircase(0.19, 0.22, trials=15, points=31, staircase="low", **FIELDS)
    high = Staircase(0.22, 0.25, trials=15, points=31, staircase="high", **FIELDS)
    staircases = iter(trials.interleaved(low, high, seed=SEED))
    trial = next(staircases)
    while True:
        if rng.random() < 0.25:
            yield {**FIELDS, "felt_edge_m": trial["felt_edge_m"], "level": 0, "trial_type": "catch"}
        answer = yield trial
        try:
            trial = staircases.send(answer)
        except StopIteration:
            return


def session(display, folder, answer=lambda: None):
    def respond(trial):
        answer()
        display.pass_s(0.3)
        return trial["level"] > 0 and trial["felt_edge_m"] > (0.203 if trial.get("staircase") == "low" else 0.241)

    return run(
        display,
        experiment(),
        respond,
        folder,
        seed=SEED,
        practice=PRACTICE,
        break_every=10,
        take_break=lambda trial: display.pass_s(BREAK_S),
    )


#: The calls at which the program is killed: each in a process of its own, at this occurrence.
PHASES = [
    *(("answer", 1), ("pause", 3), ("drive", 3), ("end", 3), ("wait", 4), ("wait", 5), ("status", 4), ("answer", 3)),
    *(("row", 1), ("row", 4), ("rest", 1), ("arm", 1)),
]


def killed_at(phase, occurrence, display, folder):
    """In a process that is killed at this call."""
    count = 0

    def at(name):
        nonlocal count
        count += name == phase
        if count == occurrence:
            os.kill(os.getpid(), signal.SIGKILL)

    real = os.fsync

    def fsync(descriptor):
        at("row" if display.calls else "")
        real(descriptor)

    os.fsync = fsync
    display.before = at
    session(display, folder, lambda: at("answer"))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_session_killed_in_each_phase_has_the_rows_of_one_that_was_not(device, tmp_path):
    whole = session(device(), tmp_path / "whole")
    counts = []
    for number, (phase, occurrence) in enumerate(PHASES):
        child = os.fork()
        if child == 0:
            # Whatever happens here, the tests go on in the parent alone.
            try:
                # The device and the program are started again, an hour later.
                killed_at(phase, occurrence, device(now=1_000 + number, started_s=3600.0 * number), tmp_path / "parts")
            finally:
                os._exit(1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL, (phase, "killed before its end")
        counts.append(events(tmp_path / "parts").read_bytes().count(b"\n") - 1)
    assert counts == sorted(counts) and counts[0] == 0 and counts[-1] < len(whole), counts
    rows = session(device(started_s=3600.0 * len(PHASES)), tmp_path / "parts")
    assert 2 + 30 + 3 < len(rows) == len(whole)
    same = ("trial_type", "practice", "staircase", "felt_edge_m", "level", "iti_s", "response", "duration", "asked", "seed")
    for row, other in zip(rows, whole):
        assert {name: row[name] for name in same} == {name: other[name] for name in same}
    catches = [row for row in rows if row["trial_type"] == "catch"]
    assert len(catches) > 3 and {(row["level"], row["response"]) for row in catches} == {("0.0", "no")}
    assert all(0.19 <= float(row["felt_edge_m"]) <= 0.25 and row["frequency_hz"] == "n/a" for row in catches)
    assert [row["practice"] for row in rows] == ["yes"] * 2 + ["no"] * (len(rows) - 2)
    # After the practice, and after each ten trials: before the same trials, whatever was killed.
    due = [2, *range(12, len(rows), 10)]
    for listed in (rows, whole):
        assert [number for number, row in enumerate(listed) if row["break_s"] != "n/a"] == due
        assert {float(listed[number]["break_s"]) for number in due} == {BREAK_S}
    parts = [int(row["part"]) for row in rows]
    assert parts == sorted(parts) and len(set(parts)) > 6
    onsets = [float(row["onset"]) for row in rows]
    assert onsets == sorted(onsets) and onsets[-1] > 3600.0 * (len(PHASES) - 1)
    assert [row["date"] for row in rows] == sorted(row["date"] for row in rows)


def test_a_break_disarms_the_device_and_arms_it_then(device, tmp_path):
    display = device()
    session(display, tmp_path)
    calls = [name for name in display.names() if name in ("rest", "arm", "drive")]
    assert calls[:5] == ["drive", "drive", "rest", "arm", "drive"]
    assert calls.count("rest") == calls.count("arm") == 4
    with pytest.raises(slipline.OutOfRange, match="break_every: needs take_break"):
        run(device(), [], lambda trial: True, tmp_path / "x", break_every=10)

    class Leaves(Exception):
        pass

    def leave(_trial):
        raise Leaves

    display = device()
    with pytest.raises(Leaves):
        run(display, [PRACTICE[0]], lambda trial: True, tmp_path / "x", practice=PRACTICE, take_break=leave, seed=1)
    assert "arm" not in display.names(), "one that was left is not armed"


@pytest.mark.parametrize("duration", [{}, {"duration_s": 0.5}])
def test_an_answer_after_more_than_the_unattended_time_is_written(device, tmp_path, duration):
    display = device()
    listed = [{"turning_point_m": 0.12, **duration}] * 3

    def respond(trial):
        display.pass_s(70.0 if trial["number"] == 1 else 1.0)
        return trial["number"]

    with pytest.raises(slipline.Unattended, match=r"no call came for 60 s.*written: device.arm\(\), and the same call goes on"):
        run(display, listed, respond, tmp_path)
    assert [line.split("\t")[3] for line in events(tmp_path).read_text().splitlines()[1:]] == ["0", "1"]
    display.arm()
    rows = run(display, listed, respond, tmp_path)
    assert [row["response"] for row in rows] == ["0", "1", "2"] and float(rows[1]["response_time"]) == pytest.approx(70.0)
    assert rows[1]["duration"] == ("0.5" if duration else "n/a")


@pytest.mark.parametrize("raised", [slipline.LinkLost("lost"), KeyboardInterrupt()])
def test_an_answer_is_written_before_what_the_device_raises_then(device, tmp_path, raised):
    display = device()

    def fails(name):
        if name == "stop":
            raise raised

    display.before = fails
    with pytest.raises(type(raised)):
        run(display, [{"turning_point_m": 0.12}], lambda trial: "kept", tmp_path)
    assert events(tmp_path).read_text().splitlines()[1].split("\t")[1:4] == ["n/a", "trial", "kept"]
