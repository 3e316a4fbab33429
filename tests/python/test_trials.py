"""Rows of trials: what they have, what is on the disk when, and how a later call goes on. The device is a stand-in."""

import json
import os
import random
import signal
from datetime import datetime
from types import SimpleNamespace

import numpy as np
import pytest

import slipline
from slipline import trials
from slipline.staircase import Staircase
from trial_device import RATE_HZ, Device, device, events, run  # noqa: F401

LIST = [
    {"turning_point_m": 0.12, "level": 0.5, "duration_s": 0.25, "trial_type": "near"},
    {"felt_edge_m": 0.21, "duration_s": 0.5, "trial_type": "far"},
    {"frequency_hz": 130.0},
]


def test_a_row_has_the_columns_of_bids_and_what_was_asked_and_played(device, tmp_path):
    def respond(trial):
        if trial["trial_type"] == "far":
            return {"response": "a tab\tand\na line", "measured_place_m": 0.2075}
        return {"near": True, "trial": 3}[trial["trial_type"]]

    display = device()
    rows = run(display, LIST, respond, tmp_path)
    lines = events(tmp_path).read_text().splitlines()
    assert lines[0].split("\t")[:5] == ["onset", "duration", "trial_type", "response", "response_time"]
    assert [line.split("\t") for line in lines[1:]] == [list(row.values()) for row in rows]
    described = json.loads(events(tmp_path).with_suffix(".json").read_text())
    assert [name for name in described if name not in ("TaskName", "StimulusPresentation")] == lines[0].split("\t") == list(rows[0])
    first, second, third = rows
    indices = [int(row["at_samples"]) for row in rows]
    assert [float(row["onset"]) for row in rows] == [(index - indices[0]) / RATE_HZ for index in indices]
    assert indices[0] == 41_000
    assert [row["duration"] for row in rows] == ["0.25", "0.5", "0.0"]
    assert [row["response"] for row in rows] == ["yes", "a tab and a line", "3"]
    assert [row["level"] for row in rows] == ["0.5", "0.8", "0.8"]
    # The requested place as it was given, the others by the plate.
    assert (first["turning_point_m"], first["felt_edge_m"], first["frequency_hz"]) == ("0.12", "0.2", "126.5")
    assert (second["turning_point_m"], second["felt_edge_m"]) == ("0.16", "0.21")
    assert third["frequency_hz"] == "130.0"
    assert [row["measured_place_m"] for row in rows] == ["n/a", "0.2075", "n/a"]
    same = {"plate": "membrane", "table_crc": "0badcafe", "unit": "unit-1", "session": "01", "part": "1", "seed": "n/a"}
    for column, value in same.items():
        assert {row[column] for row in rows} == {value}
    for row, index in zip(rows, indices):
        assert datetime.fromisoformat(row["date"]).timestamp() == pytest.approx(1_800_000_000 + index / RATE_HZ, abs=2e-6)
        assert float(row["host_clock_s"]) == pytest.approx(index / RATE_HZ)


def test_rows_become_a_table_of_numbers_and_labels(device, tmp_path):
    answers = iter(['a "quoted', None, "NA"])
    table = run(device(), LIST, lambda trial: next(answers), tmp_path).to_pandas()
    assert list(table.columns) == events(tmp_path).read_text().splitlines()[0].split("\t") and len(table) == 3
    assert table.response.fillna("missing").tolist() == ['a "quoted', "missing", "NA"]
    assert table.level.tolist() == [0.5, 0.8, 0.8] and table.at_samples.iloc[0] == 41_000
    assert table.session.tolist() == ["01"] * 3 and table.table_crc.tolist() == ["0badcafe"] * 3
    assert list(trials.Rows().to_pandas().columns) == list(trials.COLUMNS)


def test_a_tone_without_a_duration_sounds_until_it_is_answered(device, tmp_path):
    display = device()
    run(display, LIST, lambda trial: display.calls.append(("answer",)), tmp_path)
    assert display.names() == ["drive", "end", "wait", "wait", "answer"] * 2 + ["drive", "wait", "answer", "stop"]


def test_a_row_is_on_the_disk_before_the_next_trial_begins(device, tmp_path, monkeypatch):
    display, real = device(), os.fsync
    on_disk = []

    def fsync(descriptor):
        real(descriptor)
        on_disk.append(events(tmp_path).read_bytes().count(b"\n") - 1 if display.calls else 0)

    monkeypatch.setattr(os, "fsync", fsync)
    begun = []

    def respond(trial):
        begun.append(on_disk[-1])
        return True

    run(display, LIST, respond, tmp_path)
    assert begun == [0, 1, 2] and on_disk[-1] == 3


def test_the_same_call_goes_on_and_refuses_by_name_what_differs(device, tmp_path):
    seen = []

    def until(count):
        def respond(trial):
            if len(seen) == count:
                raise KeyboardInterrupt
            seen.append(trial["trial_type"])
            return "x"

        return respond

    with pytest.raises(KeyboardInterrupt):
        run(device(), LIST, until(2), tmp_path)
    # Half of a row, as a kill leaves it.
    with events(tmp_path).open("ab") as file:
        file.write(b"0.1\t0.2\ttri")
    before = events(tmp_path).read_bytes()
    others = {
        "it has 2 rows, and there are 1 trials": LIST[:1],
        "line 2: .* its trial_type is near, not far": [LIST[1], LIST[0], LIST[2]],
        "line 2: .* its level is 0.5, not 0.6": [{**LIST[0], "level": 0.6}, *LIST[1:]],
        "line 3: .* its duration_s is 0.5, not 0.4": [LIST[0], {**LIST[1], "duration_s": 0.4}, LIST[2]],
        "line 3: .* its timeout_s is n/a, not 2.0": [LIST[0], {**LIST[1], "timeout_s": 2}, LIST[2]],
        "line 2: .* its trial_type is near, not x": [{**LIST[0], "trial_type": "x"}, *LIST[1:]],
        "line 2: .* its iti_s is 0.0, not 1.0": [{**LIST[0], "iti_s": 1.0}, *LIST[1:]],
        "line 3: .* its hand is n/a, not left": [LIST[0], {**LIST[1], "hand": "left"}, LIST[2]],
    }
    for message, other in others.items():
        with pytest.raises(slipline.BadFile, match=f"task-edge_events.tsv.*{message}"):
            run(device(), other, until(3), tmp_path)
    with pytest.raises(slipline.BadFile, match="its seed is n/a, not 3"):
        run(device(), LIST * 2, until(3), tmp_path, seed=3)
    with pytest.raises(slipline.BadFile, match="its practice is no, not yes"):
        run(device(), LIST[1:], until(3), tmp_path, practice=LIST[:1])
    with pytest.raises(slipline.BadFile, match="its table_crc is 0badcafe, and the device's is 12345678"):
        run(device(crc="12345678"), LIST, until(3), tmp_path)
    other = device()
    other.plate = SimpleNamespace(name="another", respond=lambda **_: None, frequency_hz=float, turning_point_m=float)
    with pytest.raises(slipline.BadFile, match="its plate is membrane, and the device's is another"):
        run(other, LIST, until(3), tmp_path)
    assert len(seen) == 2, "nothing of these was run"
    display = device()
    rows = run(display, LIST, until(3), tmp_path)
    assert seen == ["near", "far", "trial"] and [row["part"] for row in rows] == ["1", "1", "2"]
    assert display.names().count("drive") == 1
    assert events(tmp_path).read_bytes().startswith(before[: before.rfind(b"\n") + 1])
    # All done: nothing is driven.
    display = device()
    assert run(display, LIST, until(3), tmp_path) == rows and not display.calls


def test_onsets_go_on_on_one_axis_whether_the_device_was_reset_or_not(device, tmp_path):
    listed = [{"turning_point_m": 0.12, "duration_s": 1.0, "trial_type": str(i)} for i in range(6)]

    def two():
        for trial in listed[: len(rows) + 2]:
            yield trial

    rows = []
    # On, after half an hour, as the same device, and then after its reset.
    for arguments in ({"now": 7_000_000}, {"now": 720_000_000}, {"now": 900, "started_s": 2000.0}):
        display = device(**arguments)
        rows = run(display, two(), lambda trial: True, tmp_path)
    indices = [int(row["at_samples"]) for row in rows]
    onsets = [float(row["onset"]) for row in rows]
    assert onsets[0] == 0.0 and indices[4] < indices[3], "the reset shows as an index that went back"
    assert onsets[1:4] == pytest.approx([(index - indices[0]) / RATE_HZ for index in indices[1:4]], abs=1e-9)
    assert onsets[4] == pytest.approx(2000.0 + (indices[4] - indices[0]) / RATE_HZ, abs=1e-4)
    assert onsets[5] - onsets[4] == pytest.approx((indices[5] - indices[4]) / RATE_HZ, abs=1e-9)
    assert [row["part"] for row in rows] == ["1", "1", "2", "2", "3", "3"]


def test_a_person_may_write_into_the_description(device, tmp_path):
    columns = {"hand": {"Description": "The hand that touches", "Levels": {"left": "Left", "right": "Right"}}}
    hands = [{"turning_point_m": 0.12, "hand": hand} for hand in ("left", "right", "both")]
    run(device(), hands[:1], lambda trial: 1, tmp_path, columns=columns)
    path = events(tmp_path).with_suffix(".json")
    described = json.loads(path.read_text())
    described["Instructions"] = "Say where it ends."
    described["trial_type"]["Levels"]["trial"] = "A line"
    path.write_text(json.dumps(described))
    run(device(), hands, lambda trial: trial["hand"] == "left", tmp_path, columns=columns)
    described = json.loads(path.read_text())
    assert described["Instructions"] == "Say where it ends." and described["TaskName"] == "edge"
    assert described["trial_type"]["Levels"] == {"trial": "A line"}
    levels = columns["hand"]["Levels"]
    assert described["hand"] == {"Description": "The hand that touches", "Levels": {**levels, "both": "both"}}
    # A number among the answers, too: each value of a column with levels is one of them.
    assert set(described["response"]["Levels"]) == {"1", "no"}
    path.write_text("[")
    with pytest.raises(slipline.BadFile, match="task-edge_events.json: it is no JSON"):
        run(device(), hands, lambda trial: 1, tmp_path)


def test_subjects_sessions_tasks_and_runs_have_files_of_their_own(device, tmp_path):
    for more in ({}, {"subject": "02"}, {"session": "b"}, {"task": "other"}, {"run": 2}):
        assert len(run(device(), LIST[:1], lambda trial: True, tmp_path, **more)) == 1
    names = sorted(path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.tsv"))
    assert names == [
        "sub-01/ses-01/beh/sub-01_ses-01_task-edge_events.tsv",
        "sub-01/ses-01/beh/sub-01_ses-01_task-edge_run-2_events.tsv",
        "sub-01/ses-01/beh/sub-01_ses-01_task-other_events.tsv",
        "sub-01/ses-b/beh/sub-01_ses-b_task-edge_events.tsv",
        "sub-02/ses-01/beh/sub-02_ses-01_task-edge_events.tsv",
    ]
    for more in ({"subject": "a_b"}, {"session": ""}, {"task": "../x"}, {"run": 0}, {"subject": 1}):
        with pytest.raises(slipline.OutOfRange, match=next(iter(more))):
            run(device(), LIST[:1], lambda trial: True, tmp_path, **more)


def test_a_file_of_something_else_is_not_touched(device, tmp_path):
    path = events(tmp_path)
    path.parent.mkdir(parents=True)
    header, row = ("\t".join(cells) for cells in (trials.COLUMNS, ["n/a"] * len(trials.COLUMNS)))
    for text in ["onset\tduration\n1\t2\n", "", f"{header}\n1\t2\n", f"{header}\n{row}"]:
        path.write_text(text)
        with pytest.raises(slipline.BadFile, match="events.tsv"):
            run(device(), LIST, lambda trial: True, tmp_path)
        assert path.read_text() == text


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


def test_a_staircase_goes_on_where_it_was(device, tmp_path):
    def staircase(high=0.2):
        return Staircase(0.1, high, place="turning_point_m", trials=20, points=51, level=0.6)

    whole = staircase()
    rows = run(device(), whole, answers(), tmp_path / "whole")
    assert whole.done and len(rows) == 20 and abs(whole.threshold - 0.1431) < 1.5e-3
    with pytest.raises(KeyboardInterrupt):
        run(device(), staircase(), answers(7), tmp_path / "parts")
    second = staircase()
    again = run(device(), second, answers(13), tmp_path / "parts")
    assert [row["turning_point_m"] for row in again] == [row["turning_point_m"] for row in rows]
    assert second.threshold == whole.threshold
    for other in [staircase(0.21), Staircase(0.1, 0.2, place="turning_point_m", trials=3, points=51, level=0.6)]:
        with pytest.raises(slipline.BadFile, match="another list of trials|20 rows, and there are 3 trials"):
            run(device(), other, answers(), tmp_path / "parts")
    for answer in (3, "no", float("nan")):
        with pytest.raises(slipline.OutOfRange, match="takes true or false"):
            run(device(), staircase(), lambda trial: answer, tmp_path / "three")
    assert events(tmp_path / "three").read_bytes().count(b"\n") == 1, "no row that cannot be read again"


def test_a_staircase_repeats_a_trial_without_an_answer(device, tmp_path):
    calls = []

    def respond(trial):
        calls.append(trial["turning_point_m"])
        return None if len(calls) == 2 else trial["turning_point_m"] > 0.15

    staircase = Staircase(0.1, 0.2, place="turning_point_m", trials=3)
    rows = run(device(), staircase, respond, tmp_path)
    assert staircase.done and len(rows) == 4 and calls[1] == calls[2] and rows[1]["response"] == "n/a"
    again = Staircase(0.1, 0.2, place="turning_point_m", trials=3)
    run(device(), again, respond, tmp_path)
    assert again.threshold == staircase.threshold and len(calls) == 4


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
                run(Device(), listed, say, tmp_path)
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
        done = events(tmp_path).read_bytes().count(b"\n") - 1
        assert done in (begun[-1], begun[-1] + 1), "the trial in progress may have its row"
    rows = run(Device(), listed, lambda trial: True, tmp_path)
    assert [row["trial_type"] for row in rows] == [str(i) for i in range(400)]
    assert not list(tmp_path.rglob("*.part"))
