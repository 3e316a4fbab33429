"""Lists of trials: the rows, and what of them is left after a kill. The device here is a stand-in with the calls that a list uses."""

import json
import os
import random
import signal
from types import SimpleNamespace

import numpy as np
import pytest

import slipline
from slipline import trials
from slipline.staircase import Staircase

RATE_HZ = 400_000.0


class Device:
    """The calls of a device that a list of trials uses; each drive begins a tenth of a second after the last call."""

    def __init__(self):
        self.now = 1_000
        self.calls = []

    def status(self):
        return SimpleNamespace(sample_rate_hz=RATE_HZ)

    def drive(self, *, level, **place):
        self.calls.append(("drive", place, level))
        self.now += 40_000
        tone = {"felt_edge_m": 0.2, "turning_point_m": 0.16, "frequency_hz": 126.5, "level": level}
        crc = SimpleNamespace(crc="0badcafe")
        tones = [SimpleNamespace(**tone)]
        return SimpleNamespace(at_samples=self.now, tones=tones, plate="membrane", table=crc, superseded=False)

    def wait(self, at):
        self.calls.append(("wait",))
        self.now = at if isinstance(at, int) else at.at_samples
        return self.now

    def stop(self, *, at=None):
        self.calls.append(("stop",) if at is None else ("end",))
        return self.now if at is None else at


LIST = [
    {"turning_point_m": 0.12, "level": 0.5, "duration_s": 0.25, "trial_type": "near"},
    {"felt_edge_m": 0.21, "duration_s": 0.5, "trial_type": "far"},
    {"frequency_hz": 130.0},
]


def test_a_row_has_the_columns_of_bids_and_what_was_asked_and_played(tmp_path):
    def respond(trial):
        if trial["trial_type"] == "far":
            trial["measured_place_m"], trial["measured_level"] = 0.2075, 0.49
        return {"near": True, "far": "a tab\tand\na line", "trial": 3}[trial["trial_type"]]

    rows = trials.run(Device(), LIST, respond, folder=tmp_path)
    lines = (tmp_path / "events.tsv").read_text().splitlines()
    assert lines[0].split("\t")[:5] == ["onset", "duration", "trial_type", "response", "response_time"]
    assert [line.split("\t") for line in lines[1:]] == [list(row.values()) for row in rows]
    assert list(json.loads((tmp_path / "events.json").read_text())) == lines[0].split("\t") == list(rows[0])
    first, second, third = rows
    assert float(first["onset"]) == int(first["at_samples"]) / RATE_HZ == 41_000 / RATE_HZ
    assert [row["duration"] for row in rows] == ["0.25", "0.5", "0.0"]
    assert [row["response"] for row in rows] == ["yes", "a tab and a line", "3"]
    assert [row["level"] for row in rows] == ["0.5", "0.8", "0.8"]
    # The requested place as it was given, the others by the plate.
    assert (first["turning_point_m"], first["felt_edge_m"], first["frequency_hz"]) == ("0.12", "0.2", "126.5")
    assert (second["turning_point_m"], second["felt_edge_m"]) == ("0.16", "0.21")
    assert third["frequency_hz"] == "130.0"
    assert (second["measured_place_m"], second["measured_level"]) == ("0.2075", "0.49")
    assert first["measured_place_m"] == first["seed"] == "n/a"
    assert {row["plate"] for row in rows} == {"membrane"} and {row["table_crc"] for row in rows} == {"0badcafe"}
    assert float(first["response_time"]) >= 0


def test_a_tone_without_a_duration_sounds_until_it_is_answered(tmp_path):
    device = Device()
    trials.run(device, LIST, lambda trial: device.calls.append(("answer",)), folder=tmp_path)
    names = [call[0] for call in device.calls]
    assert names == ["drive", "end", "wait", "wait", "answer"] * 2 + ["drive", "wait", "answer", "stop"]


def test_a_row_is_on_the_disk_before_the_next_trial_begins(tmp_path, monkeypatch):
    device, real = Device(), os.fsync
    on_disk = []

    def fsync(descriptor):
        real(descriptor)
        on_disk.append((tmp_path / "events.tsv").read_bytes().count(b"\n") - 1 if device.calls else 0)

    monkeypatch.setattr(os, "fsync", fsync)
    begun = []

    def respond(trial):
        begun.append(on_disk[-1])
        return True

    trials.run(device, LIST, respond, folder=tmp_path)
    assert begun == [0, 1, 2] and on_disk[-1] == 3


def test_the_same_call_goes_on_and_other_trials_are_refused(tmp_path):
    seen = []

    def until(count):
        def respond(trial):
            if len(seen) == count:
                raise KeyboardInterrupt
            seen.append(trial["trial_type"])
            return "x"

        return respond

    with pytest.raises(KeyboardInterrupt):
        trials.run(Device(), LIST, until(2), folder=tmp_path)
    # Half of a row, as a kill leaves it.
    with (tmp_path / "events.tsv").open("ab") as file:
        file.write(b"0.1\t0.2\ttri")
    before = (tmp_path / "events.tsv").read_bytes()
    for other in [LIST[:1], [LIST[1], LIST[0], LIST[2]], [{**LIST[0], "level": 0.6}, *LIST[1:]]]:
        with pytest.raises(slipline.BadFile, match="events.tsv"):
            trials.run(Device(), other, until(3), folder=tmp_path)
    with pytest.raises(slipline.BadFile, match="its seed is n/a, not 3"):
        trials.run(Device(), LIST * 2, until(3), folder=tmp_path, seed=3)
    device = Device()
    rows = trials.run(device, LIST, until(3), folder=tmp_path)
    assert seen == ["near", "far", "trial"] and len(rows) == 3
    assert sum(call[0] == "drive" for call in device.calls) == 1
    assert (tmp_path / "events.tsv").read_bytes().startswith(before[: before.rfind(b"\n") + 1])
    # All done: nothing is driven.
    device = Device()
    assert trials.run(device, LIST, until(3), folder=tmp_path) == rows and not device.calls


def test_a_seed_orders_the_trials_and_stands_in_every_row(tmp_path):
    listed = [{"turning_point_m": 0.1 + 0.01 * i, "trial_type": str(i)} for i in range(10)]
    orders = []
    for name, seed in [("a", 5), ("b", 5), ("c", 6)]:
        rows = trials.run(Device(), listed, lambda trial: True, folder=tmp_path / name, seed=seed)
        orders.append([row["trial_type"] for row in rows])
        assert {row["seed"] for row in rows} == {str(seed)}
    assert orders[0] == orders[1] != orders[2]
    assert sorted(orders[0]) == sorted(orders[2]) == [str(i) for i in range(10)]


def answers(stop_after=None):
    """An observer whose place is 143.1 mm, who leaves after this number of answers."""
    count = 0

    def respond(trial):
        nonlocal count
        if count == stop_after:
            raise KeyboardInterrupt
        count += 1
        return np.bool_(trial["turning_point_m"] > 0.1431)

    return respond


def test_a_staircase_goes_on_where_it_was(tmp_path):
    def staircase(high=0.2):
        return Staircase(0.1, high, place="turning_point_m", trials=20, points=51, level=0.6)

    whole = staircase()
    rows = trials.run(Device(), whole, answers(), folder=tmp_path / "whole")
    assert whole.done and len(rows) == 20 and abs(whole.threshold - 0.1431) < 1.5e-3
    with pytest.raises(KeyboardInterrupt):
        trials.run(Device(), staircase(), answers(7), folder=tmp_path / "parts")
    second = staircase()
    again = trials.run(Device(), second, answers(13), folder=tmp_path / "parts")
    assert [row["turning_point_m"] for row in again] == [row["turning_point_m"] for row in rows]
    assert second.threshold == whole.threshold
    for other in [staircase(0.21), Staircase(0.1, 0.2, place="turning_point_m", trials=3, points=51, level=0.6)]:
        with pytest.raises(slipline.BadFile, match="another list of trials|more rows than"):
            trials.run(Device(), other, answers(), folder=tmp_path / "parts")
    with pytest.raises(slipline.BadFile, match="takes true or false"):
        trials.run(Device(), staircase(), lambda trial: 3, folder=tmp_path / "three")
    assert (tmp_path / "three" / "events.tsv").read_bytes().count(b"\n") == 1, "no row that cannot be read again"
    with pytest.raises(slipline.OutOfRange, match="seed"):
        trials.run(Device(), staircase(), answers(), folder=tmp_path / "seed", seed=1)


@pytest.mark.parametrize(
    ("trial", "message"),
    [
        ({"level": 0.5}, "this one has 0"),
        ({"felt_edge_m": 0.2, "frequency_hz": 120.0}, "this one has 2"),
        ({"felt_edge_m": 0.2, "duration": 1.0}, "duration: a trial has duration_s, "),
        ({"felt_edge_m": 0.2, "duration_s": 0.0}, "duration_s = 0.0: must be above 0, up to 600 s"),
        ({"felt_edge_m": 0.2, "trial_type": "a\tb"}, "one line without tabs"),
    ],
)
def test_a_trial_that_is_not_allowed_is_refused_before_any_is_run(tmp_path, trial, message):
    device = Device()
    with pytest.raises(slipline.OutOfRange, match=message):
        trials.run(device, [LIST[0], trial], lambda trial: True, folder=tmp_path)
    assert not device.calls


def test_a_file_of_something_else_is_not_touched(tmp_path):
    for text in ["onset\tduration\n1\t2\n", "", "\t".join(trials.COLUMNS) + "\n1\t2\n"]:
        (tmp_path / "events.tsv").write_text(text)
        with pytest.raises(slipline.BadFile, match="events.tsv"):
            trials.run(Device(), LIST, lambda trial: True, folder=tmp_path)
        assert (tmp_path / "events.tsv").read_text() == text


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_kill_at_a_random_moment_loses_at_most_the_trial_in_progress(tmp_path):
    choose = random.Random(7)
    listed = [{"turning_point_m": 0.12, "trial_type": str(i)} for i in range(400)]
    done = 0
    for _ in range(50):
        ours, theirs = os.pipe()
        child = os.fork()
        if child == 0:

            def say(trial):
                os.write(theirs, trial["trial_type"].encode() + b"\n")
                return True

            # Whatever happens here, the tests go on in the parent alone.
            try:
                trials.run(Device(), listed, say, folder=tmp_path)
            finally:
                os._exit(1)
        os.close(theirs)
        with os.fdopen(ours) as said:
            # The kill comes some trials, and a part of one, later.
            begun = [int(said.readline()) for _ in range(choose.randrange(1, 6))]
            for _ in range(choose.randrange(20_000)):
                pass
            os.kill(child, signal.SIGKILL)
            begun += [int(line) for line in said]
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL, "killed before its end"
        # It began with the first trial that had no row.
        assert begun == list(range(done, done + len(begun)))
        done = (tmp_path / "events.tsv").read_bytes().count(b"\n") - 1
        assert done in (begun[-1], begun[-1] + 1), "the trial in progress may have its row"
    rows = trials.run(Device(), listed, lambda trial: True, folder=tmp_path)
    assert [row["trial_type"] for row in rows] == [str(i) for i in range(400)]


def test_a_list_runs_on_the_simulated_device(tmp_path):
    asked = [{"turning_point_m": place_m, "duration_s": 0.05} for place_m in (0.12, 0.2)]
    heard = []
    with slipline.connect("sim") as device:
        device.use(slipline.Plate("membrane"))
        device.arm()
        rows = slipline.trials.run(device, asked, lambda trial: heard.append(trial) or "here", folder=tmp_path)
        status = device.status()
    assert [row["response"] for row in rows] == ["here", "here"]
    for row, trial in zip(rows, heard):
        at_samples = int(row["at_samples"])
        assert at_samples == trial["at_samples"] and float(row["onset"]) == at_samples / status.sample_rate_hz
        # 20 000 samples, rounded up to a block.
        assert float(row["duration"]) * status.sample_rate_hz == 20_096 and float(row["frequency_hz"]) == trial["frequency_hz"]
    assert int(rows[0]["at_samples"]) + 0.05 * status.sample_rate_hz <= int(rows[1]["at_samples"]) < status.now_samples
