"""What a trial may be: its sounds, its intervals, its answer and its times. The device is a stand-in."""

import itertools
import json

import numpy as np
import pytest

import slipline
from trial_device import RATE_HZ, device, events, run  # noqa: F401

PLACE = {"turning_point_m": 0.12}
PLATE = slipline.Plate("membrane")


@pytest.mark.parametrize(
    ("trial", "message"),
    [
        ({"level": 0.5}, "a trial has one of felt_edge_m, turning_point_m, frequency_hz, tones, texture, or intervals"),
        ({"felt_edge_m": 0.2, "frequency_hz": 120.0}, "this one has 2"),
        ({"felt_edge_m": 0.2, "duration": 1.0}, "duration: the run writes this column itself; a trial has .*duration_s"),
        ({"felt_edge": 0.2}, "felt_edge: did you mean felt_edge_m?"),
        ({**PLACE, "frequency": 120.0}, "frequency: did you mean frequency_hz?"),
        ({**PLACE, "timeout_ms": 120.0}, "timeout_ms: did you mean timeout_s?"),
        ({**PLACE, "response": 1}, "response: the run writes this column itself"),
        ({**PLACE, "number": 7}, "number: the run writes this column itself"),
        ({**PLACE, "my column": 1}, "has letters, digits and _"),
        ({**PLACE, "list": [1]}, "one number, text or truth value"),
        ({**PLACE, "duration_s": 0.0}, "duration_s = 0.0: must be above 0, up to 600 s"),
        ({**PLACE, "duration_s": "1"}, "duration_s = '1': must be a number"),
        ({**PLACE, "level": 1.5}, "level = 1.5: must be 0 to 1"),
        ({**PLACE, "level": True}, "level = True: must be a number"),
        ({"felt_edge_m": float("inf")}, "felt_edge_m = inf"),
        ({"felt_edge_m": 10**400}, "felt_edge_m = 10*: must be 0 or above, and finite"),
        ({**PLACE, "duration_s": 10**400}, "duration_s = 10*: must be"),
        ({**PLACE, "trial_type": "a\tb"}, "one line without tabs"),
        ({**PLACE, "iti_s": (2, 1)}, "must not be above the second"),
        ({**PLACE, "iti_s": (1, 2)}, "a range needs a seed"),
        ({**PLACE, "response_time_from": "start"}, "must be one of call, onset, last_onset, end"),
        ({**PLACE, "response_time_from": "end"}, "needs duration_s"),
        ({**PLACE, "gap_s": 1}, "only a trial with intervals has a gap"),
        ({**PLACE, "tones": [{"felt_edge_m": 0.2, "phase": 1}]}, "phase: a tone has"),
        ({**PLACE, "tones": {"felt_edge_m": 0.2}}, "tones: must be a list"),
        ({"texture": "stripes"}, "must be the result of plate.texture"),
        ({"intervals": []}, "must be a list of dictionaries"),
        ({"intervals": [PLACE]}, "duration_s: each interval needs it"),
        ({"intervals": [{**PLACE, "duration_s": 1, "hand": "left"}]}, "hand: an interval has"),
        ({**PLACE, "intervals": [{**PLACE, "duration_s": 1}]}, "turning_point_m: a trial with intervals has it in each"),
        ("felt_edge_m", "a trial is a dictionary"),
        # By the plate.
        ({"felt_edge_m": 0.9}, "felt_edge_m = 0.9 m: must be"),
        ({"turning_point_m": 0.3}, "turning_point_m = 0.3 m: must be"),
        ({"frequency_hz": 9e3}, "frequency_hz = 9000 Hz: must be"),
        ({"intervals": [{"frequency_hz": 9e3, "duration_s": 1}]}, "frequency_hz = 9000 Hz: must be"),
    ],
)
def test_a_trial_that_is_not_allowed_is_refused_by_its_number_before_any_is_run(device, tmp_path, trial, message):
    display = device()
    display.plate = PLATE
    with pytest.raises(slipline.OutOfRange, match=f"trial 2: .*{message}|{message}"):
        run(display, [PLACE, trial], lambda trial: True, tmp_path)
    with pytest.raises(slipline.OutOfRange, match=message):
        run(display, [PLACE], lambda trial: True, tmp_path, practice=[trial])
    assert not display.calls and not events(tmp_path).exists()


def test_the_trials_of_an_iterator_are_taken_one_at_a_time(device, tmp_path):
    display = device()
    taken = []

    def endless():
        for number in itertools.count():
            taken.append(number)
            yield PLACE if number < 3 else {"level": 1}

    with pytest.raises(slipline.OutOfRange, match="a trial has one of"):
        run(display, (trial for trial in endless()), lambda trial: taken[-1] == trial["number"], tmp_path)
    assert [row.split("\t")[3] for row in events(tmp_path).read_text().splitlines()[1:]] == ["yes"] * 3


def test_a_generator_gets_each_answer_and_the_same_ones_when_it_goes_on(device, tmp_path):
    given = [True, False, 3, 2.5, "left", None, {"response": "right", "sure": 1}, "7", "1_0", "\u0667"]
    sent = []

    def generator():
        for _ in given:
            sent.append((yield PLACE))

    def respond(trial):
        if trial["number"] == leaves:
            raise KeyboardInterrupt
        return given[trial["number"]]

    leaves = 5
    with pytest.raises(KeyboardInterrupt):
        run(device(), generator(), respond, tmp_path)
    assert sent == given[:5]
    sent.clear()
    leaves = None
    rows = run(device(), generator(), respond, tmp_path)
    assert sent == [True, False, 3, 2.5, "left", None, "right", 7, "1_0", "\u0667"]
    assert [row["sure"] for row in rows] == ["n/a"] * 6 + ["1"] + ["n/a"] * 3


@pytest.mark.parametrize(
    "trial",
    [
        {"felt_edge_m": 0.21, "level": 0},
        {"felt_edge_m": None},
        {"frequency_hz": float("nan"), "level": 0.5},
        {"tones": []},
        {"texture": None},
    ],
)
def test_a_catch_trial_is_a_tone_of_level_0_with_the_times_of_any_other(device, tmp_path, trial):
    display, other = device(), device()
    row, = run(display, [{**trial, "duration_s": 0.5, "trial_type": "catch"}], lambda trial: trial["level"] > 0, tmp_path)
    loud, = run(other, [{**PLACE, "duration_s": 0.5}], lambda trial: True, tmp_path, task="other")
    assert [call for call in display.calls if call[0] == "drive"] == [("drive", {"turning_point_m": pytest.approx(0.18)}, 0.0)]
    assert display.names() == other.names()
    assert (row["level"], row["response"], row["frequency_hz"]) == ("0.0", "no", "n/a")
    assert row["felt_edge_m"] == ("0.21" if trial.get("felt_edge_m") else "n/a")
    assert (row["duration"], row["at_samples"]) == (loud["duration"], loud["at_samples"])


def test_an_empty_cell_of_a_table_is_a_field_that_is_not_given(device, tmp_path):
    empty = dict.fromkeys(("tones", "texture", "intervals", "gap_s", "timeout_s", "iti_s", "trial_type", "response_time_from"), float("nan"))
    rows = run(device(), [{**empty, **PLACE, "duration_s": 0.5}], lambda trial: True, tmp_path)
    wanted = run(device(), [{**PLACE, "duration_s": 0.5}], lambda trial: True, tmp_path, task="wanted")
    assert rows == wanted and rows[0]["trial_type"] == "trial"


def test_tones_and_textures_have_their_parts_in_the_column_played(device, tmp_path):
    texture = PLATE.texture(solid_m=0.25)
    listed = [
        {**PLACE, "tones": [{"felt_edge_m": 0.22, "level": 0.1}], "level": 0.3, "duration_s": 1},
        {"tones": [{"frequency_hz": 120.0}], "duration_s": 1},
        {"texture": texture, "duration_s": 1},
        {"texture": texture, "level": 0, "duration_s": 1},
    ]
    display = device()
    rows = run(display, listed, lambda trial: True, tmp_path)
    first, second, third, fourth = (json.loads(row["played"]) if row["played"] != "n/a" else None for row in rows)
    assert [tone["level"] for tone in first[0]["tones"]] == [0.3, 0.1] and first[0]["tones"][1]["felt_edge_m"] == 0.22
    assert first[0]["duration_s"] == 1 and second is None and rows[1]["frequency_hz"] == "120.0" and rows[1]["level"] == "0.8"
    assert [tone["level"] for tone in third[0]["tones"]] == [tone.level for tone in texture.tones]
    assert fourth is None and rows[3]["level"] == "0.0" and display.names().count("play") == 1
    # It is this texture that a later call must have.
    listed[2] = {**listed[2], "texture": PLATE.texture(solid_m=0.26)}
    with pytest.raises(slipline.BadFile, match="line 4: .* its texture is"):
        run(device(), listed, lambda trial: True, tmp_path)


def test_two_intervals_of_a_trial_are_a_gap_apart(device, tmp_path):
    display = device()
    intervals = [{"felt_edge_m": 0.2, "duration_s": 0.5}, {"felt_edge_m": 0.21, "level": 0.4, "duration_s": 0.3}]
    listed = [{"intervals": intervals, "gap_s": 0.7, "standard_first": True}]
    row, = run(display, listed, lambda trial: display.pass_s(0.25) or "second", tmp_path)
    played = json.loads(row["played"])
    starts = [interval["at_samples"] for interval in played]
    assert [interval["duration_s"] for interval in played] == [0.5, 0.3]
    # The stand-in begins a drive a tenth of a second after its call.
    assert starts[1] - starts[0] == round((0.5 + 0.7 + 0.1) * RATE_HZ)
    assert float(row["duration"]) == pytest.approx(0.5 + 0.7 + 0.1 + 0.3)
    assert float(row["response_time"]) == pytest.approx(0.25)
    assert (row["felt_edge_m"], row["standard_first"], row["response"]) == ("0.2", "yes", "second")


@pytest.mark.parametrize(
    ("named", "seconds"),
    # The tones last for 0.5 s; the answer comes 0.2 s after the call, which is at the onset of the last where that is named.
    [("call", 0.2), ("end", 0.2), ("onset", 0.5 + 0.5 + 0.1 + 0.2), ("last_onset", 0.2)],
)
def test_a_response_time_counts_from_the_onset_that_is_named(device, tmp_path, named, seconds):
    display = device()
    trial = {"intervals": [{**PLACE, "duration_s": 0.5}] * 2, "response_time_from": named}
    row, = run(display, [trial], lambda trial: display.pass_s(0.2), tmp_path)
    assert float(row["response_time"]) == pytest.approx(seconds, abs=1e-6)
    assert float(row["duration"]) == pytest.approx(0.5 + 0.5 + 0.1 + 0.5)
    # As a keyboard has measured it.
    row, = run(device(), [trial], lambda trial: {"response": "k", "response_time": 0.123}, tmp_path, task="key")
    assert row["response_time"] == "0.123"


def test_an_answer_that_comes_too_late_is_written_and_does_not_count(device, tmp_path):
    display = device()
    sent = []

    def generator():
        for _ in range(3):
            sent.append((yield {**PLACE, "timeout_s": 2.0}))

    def respond(trial):
        display.pass_s((1.0, 2.5, 2.0)[trial["number"]])
        return (True, True, None)[trial["number"]]

    rows = run(display, generator(), respond, tmp_path)
    assert [row["timed_out"] for row in rows] == ["no", "yes", "yes"] and [row["response"] for row in rows] == ["yes", "yes", "n/a"]
    assert sent == [True, None, None]
    # The tone ends with the time.
    assert [float(row["duration"]) for row in rows] == [1.0, 2.0, 2.0]


def test_no_answer_of_a_dictionary_is_lost(device, tmp_path):
    answer = {"response": 1, "onset": 2, "hand": "left", "how sure": 3, "texts": ["a", "b"]}
    row, = run(device(), [{**PLACE, "hand": "right"}], lambda trial: answer, tmp_path)
    names = ("response", "answer_onset", "hand", "answer_hand", "answer_how_sure")
    assert [row[name] for name in names] == ["1", "2", "right", "left", "3"]
    assert json.loads(row["texts"]) == ["a", "b"] and row["onset"] == "0.0"
    # A long array, of which NumPy's own text leaves most out.
    samples = np.arange(2000.0)
    row, = run(device(), [PLACE], lambda trial: {"track": samples, "both": {"x": samples}}, tmp_path, task="long")
    assert json.loads(row["track"]) == json.loads(row["both"])["x"] == samples.tolist()
    # Names that become the same one.
    answer = {"a-b": 1, "a b": 2, "answer_onset": 3, "onset": 4, "hand": 5}
    row, = run(device(), [{**PLACE, "hand": 6, "answer_hand": 7}], lambda trial: answer, tmp_path, task="same")
    names = ("answer_a_b", "answer_a_b_2", "answer_onset", "answer_onset_2", "hand", "answer_hand", "answer_hand_2")
    assert [row[name] for name in names] == ["1", "2", "3", "4", "6", "7", "5"]


def test_a_column_that_is_new_is_na_in_the_rows_before(device, tmp_path):
    listed = [PLACE, {**PLACE, "hand": "left"}, PLACE]
    rows = run(device(), listed, lambda trial: {"response": 1, **({"sure": 2} if trial["number"] == 2 else {})}, tmp_path)
    assert [row["hand"] for row in rows] == ["n/a", "left", "n/a"] and [row["sure"] for row in rows] == ["n/a", "n/a", "2"]
    lines = [line.split("\t") for line in events(tmp_path).read_text().splitlines()]
    assert lines[0][-2:] == ["hand", "sure"] and [dict(zip(lines[0], line)) for line in lines[1:]] == rows
    assert run(device(), listed, lambda trial: 1, tmp_path) == rows
