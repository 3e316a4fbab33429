"""Trials on the simulated device: their samples, a break, and an answer that took too long."""

import os
import time

import numpy as np
import pytest
import slipline

#: A break that is longer than the unattended time of its device; the night takes one of 70 s.
BREAK_S = float(os.environ.get("SLIPLINE_BREAK_S", "2.4"))


@pytest.fixture(params=[60.0])
def device(request):
    with slipline.connect("sim", unattended_s=request.param) as device:
        device.use(slipline.Plate("membrane"))
        device.arm()
        yield device


short_of_attention = pytest.mark.parametrize("device", [BREAK_S * 5 / 6], indirect=True)


def run(device, listed, respond, folder, **more):
    return slipline.trials.run(device, listed, respond, folder=folder, subject="01", task="edge", **more)


def test_a_list_runs_on_the_simulated_device(device, tmp_path):
    plate = slipline.Plate("membrane")
    listed = [
        {"turning_point_m": 0.12, "duration_s": 0.05},
        {"felt_edge_m": 0.21, "level": 0, "duration_s": 0.05, "trial_type": "catch"},
        {"texture": plate.texture(solid_m=0.25), "duration_s": 0.2},
        {"tones": [{"turning_point_m": 0.12, "level": 0.2}, {"turning_point_m": 0.2, "level": 0.2}], "duration_s": 0.05},
        {"intervals": [{"turning_point_m": place_m, "duration_s": 0.05} for place_m in (0.12, 0.2)], "gap_s": 0.1},
        {"turning_point_m": 0.2, "timeout_s": 0.1},
    ]
    seen = []

    def respond(trial):
        seen.append(trial)
        return device.wait(seconds=0.15) if trial["number"] == 5 else "here"

    rows = run(device, listed, respond, tmp_path)
    status = device.status()
    rate_hz = status.sample_rate_hz
    assert [row["response"] for row in rows[:5]] == ["here"] * 5 and rows[5]["timed_out"] == "yes"
    for row, trial in zip(rows, seen):
        at_samples = int(row["at_samples"])
        assert at_samples == trial["at_samples"]
        assert float(row["onset"]) == pytest.approx((at_samples - int(rows[0]["at_samples"])) / rate_hz, abs=1e-9)
        assert row["unit"] == status.unit and row["table_crc"] == status.table.crc and row["plate"] == "membrane"
    lengths = [round(float(row["duration"]) * rate_hz) for row in rows]
    # 20 000 samples, rounded up to a block: those of a catch trial, too.
    assert lengths[0] == lengths[1] == lengths[3] == 20_096 and lengths[5] == 40_064
    assert rows[1]["level"] == "0.0" and seen[1]["felt_edge_m"] == 0.21
    indices = [int(row["at_samples"]) for row in rows]
    assert all(index + length <= later for index, length, later in zip(indices, lengths, [*indices[1:], status.now_samples]))


@short_of_attention
def test_a_break_longer_than_the_unattended_time_is_one_without_a_fault(device, tmp_path):
    listed = [{"turning_point_m": 0.12, "duration_s": 0.05, "block": block} for block in (1, 1, 2)]
    states = []

    def take_break(trial):
        states.append(trial["number"])
        time.sleep(BREAK_S)
        # A call, which does not arm it.
        states.append(device.status().state)

    rows = run(device, listed, lambda trial: np.True_, tmp_path, take_break=take_break)
    assert states == [2, "Idle"] and [row["break_s"] == "n/a" for row in rows] == [True, True, False]
    # Until the last tone has faded, within 20 ms.
    device.wait(seconds=0.05)
    assert float(rows[2]["break_s"]) >= BREAK_S and device.status().state == "Armed"


def test_the_result_of_rest_says_how_to_go_on(device):
    rest = device.rest()
    assert device.status().state == "Idle" and repr(rest) == "Rest(the device is disarmed: go_on() arms it again)"
    with pytest.raises(slipline.Refused):
        device.drive(turning_point_m=0.16)
    rest.go_on()
    assert device.status().state == "Armed" and repr(rest) == "Rest(over)"
    with pytest.raises(KeyError), device.rest():
        raise KeyError
    assert device.status().state == "Idle", "what was left by an error is not armed"


@short_of_attention
def test_an_answer_after_more_than_the_unattended_time_is_written_and_the_call_goes_on(device, tmp_path):
    listed = [{"turning_point_m": 0.12}] * 2
    slow = [BREAK_S, 0.0]

    def respond(trial):
        time.sleep(slow.pop(0))
        return trial["number"]

    with pytest.raises(slipline.Unattended, match="the same call goes on"):
        run(device, listed, respond, tmp_path)
    device.arm()
    rows = run(device, listed, respond, tmp_path)
    assert [row["response"] for row in rows] == ["0", "1"] and float(rows[0]["response_time"]) >= BREAK_S
    assert [row["part"] for row in rows] == ["1", "2"] and float(rows[1]["onset"]) > BREAK_S


def test_a_list_is_checked_on_the_plate_in_use(device, tmp_path):
    assert device.plate == slipline.Plate("membrane")
    with pytest.raises(slipline.OutOfRange, match="trial 2: felt_edge_m = 0.9 m: must be"):
        run(device, [{"felt_edge_m": 0.21}, {"felt_edge_m": 0.9}], lambda trial: True, tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("trial", [{"timeout_s": 600.0}, {"duration_s": 90.0, "response_time_from": "onset"}])
def test_an_answer_is_asked_for_at_the_onset_however_far_the_end_is(device, tmp_path, trial):
    """The device takes an end up to a minute ahead; a longer tone has its end sent while the answer may come."""

    class Leaves(Exception):
        pass

    def leave(trial):
        # A wait for the end takes far longer than this limit.
        assert device.status().now_samples - trial["at_samples"] < 30 * device.sample_rate_hz
        raise Leaves

    place = {"turning_point_m": 0.16}
    with pytest.raises(Leaves):
        run(device, [{**place, **trial}], leave, tmp_path)
    # The end that was to come does not end what sounds later.
    device.wait(seconds=0.1)
    assert device.status().state == "Armed"
    if "duration_s" not in trial:
        row, = run(device, [{**place, **trial}], lambda trial: True, tmp_path)
        assert 0 < float(row["duration"]) < 30 and row["timed_out"] == "no"
