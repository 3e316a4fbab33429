"""The device in Python: what a program that drives, waits and measures gets back."""

from __future__ import annotations

import json
import subprocess
import threading
from collections.abc import Iterator

import numpy
import pytest
import slipline
from line import Line, binary


@pytest.fixture(scope="module")
def plate() -> slipline.Plate:
    return slipline.Plate("membrane")


@pytest.fixture
def device(plate: slipline.Plate) -> Iterator[slipline.Device]:
    with slipline.connect() as device:
        device.use(plate)
        device.arm()
        yield device


def test_a_devices_status_has_the_fields_of_the_command_lines_info() -> None:
    command = [str(binary()), "info", "--port", "sim", "--json"]
    info = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    status = slipline.connect("sim").status().to_dict()
    # The command's own: the settings of the command line, and the form of its line.
    assert set(info) - {"defaults", "schema"} == set(status)
    for name in ("board", "sample_rate_hz", "max_tones", "inputs", "faults", "compatibility", "port"):
        assert status[name] == info[name], name
    assert status["state"] == "Idle", "nothing is armed by connecting"
    assert set(status["counters"]) == set(info["counters"])


def test_a_device_is_armed_and_driven_inside_the_block_only(plate: slipline.Plate) -> None:
    device = slipline.connect()
    device.use(plate)
    for call in (device.arm, device.verify, device.selftest, lambda: device.measure(0.03)):
        with pytest.raises(slipline.Refused, match="outside the block"):
            call()
    assert not device.closed
    with device:
        device.arm()
        with pytest.raises(slipline.Refused, match="in a block already"):
            device.__enter__()
    assert device.closed
    for call in (device.arm, device.status, device.__enter__):
        with pytest.raises(slipline.Refused, match="closed"):
            call()


def test_a_drive_begins_now_or_at_a_sample_index_and_reports_its_tones(device: slipline.Device) -> None:
    first = device.drive(felt_edge_m=0.21, level=0.5)
    assert device.status().state == "Driving"
    assert [tone.level for tone in first.tones] == [0.5]
    assert abs(first.tones[0].felt_edge_m - 0.21) < 1e-5
    assert first.plate == "membrane" and first.table.crc == device.status().table.crc

    at = device.status().now_samples + 100_000
    later = device.drive(
        turning_point_m=0.16,
        tones=[{"frequency_hz": 130.0, "level": 0.2}, {"turning_point_m": 0.2}],
        level=0.3,
        at=at,
    )
    assert at <= later.at_samples < at + 128
    assert [tone.level for tone in later.tones] == [0.3, 0.2, 0.3]
    assert later.tones[0].turning_point_m == 0.16
    assert abs(later.tones[1].frequency_hz - 130.0) < 0.01
    assert device.wait(later) == later.at_samples <= device.status().now_samples
    assert device.wait(at) == at


def test_a_drive_that_is_not_possible_names_its_field_and_range(device: slipline.Device) -> None:
    def refused(**arguments: object) -> slipline.OutOfRange:
        with pytest.raises(slipline.OutOfRange) as caught:
            device.drive(**arguments)
        return caught.value

    span = refused(turning_point_m=0.5)
    assert (span.field, span.value) == ("turning_point_m", 0.5) and span.low < span.high < 0.5
    edge = refused(felt_edge_m=210.0)
    assert edge.field == "felt_edge_m" and 0.0 < edge.low < edge.high < 0.4
    assert str(edge).endswith("did you mean 0.21 m?")
    assert refused(frequency_hz=1e6).field == "frequency_hz"
    assert refused(turning_point_m=0.16, level=1.5).high == 1.0
    assert refused(turning_point_m=0.16, glide_s=0.001).low == 0.005
    assert refused(turning_point_m=0.16, tones=[{"turning_point_m": 0.2, "level": -1.0}]).field == "level"
    for arguments, words in (
        ({"turning_point_m": 0.16, "tones": [{"turning_point_m": 0.2}]}, "per mille|full scale|sum"),
        ({}, "0 tones: must be 1 to 16"),
    ):
        with pytest.raises(slipline.Refused, match=words):
            device.drive(**arguments)
    for arguments in (
        {"turning_point_m": 0.16, "frequency_hz": 100.0},
        {"turning_point_m": 0.16, "at": "soon"},
        {"turning_point_m": 0.16, "tones": [{"place": 0.2}]},
        {"tones": [{"level": 0.2}]},
        {"tones": [0.2]},
    ):
        with pytest.raises(TypeError):
            device.drive(**arguments)
    assert device.status().state == "Armed"


def test_a_drive_that_waits_for_the_trigger_begins_with_it(plate: slipline.Plate) -> None:
    with Line() as line, slipline.connect(line.port) as device:
        device.use(plate)
        device.arm()
        for place_m in (0.16, 0.2):
            drive = device.drive(turning_point_m=place_m, at="trigger")
            assert drive.at_samples is None
            assert device.status().state == "Waiting"
            threading.Timer(0.2, line.server.raise_trigger).start()
            at = device.wait(drive)
            assert drive.at_samples == at <= device.status().now_samples
            assert device.status().state == "Driving"
        drive = device.drive(turning_point_m=0.16, at="trigger")
        threading.Timer(0.2, device.stop).start()
        with pytest.raises(slipline.Refused, match="dropped the drive before the trigger"):
            device.wait(drive)


def test_a_device_is_stopped_from_another_thread_and_armed_and_driven_again(device: slipline.Device) -> None:
    device.drive(turning_point_m=0.16)
    stopped = []
    thread = threading.Timer(0.2, lambda: stopped.append(device.stop()))
    thread.start()
    device.wait(device.status().now_samples + 200_000)
    thread.join()
    device.disarm()
    assert stopped and device.status().state == "Idle"
    with pytest.raises(slipline.Refused, match="arm"):
        device.drive(turning_point_m=0.16)
    device.arm()
    device.drive(turning_point_m=0.16)
    assert device.status().state == "Driving"


def test_a_texture_is_played_by_its_tones(device: slipline.Device, plate: slipline.Plate) -> None:
    texture = plate.texture(solid_m=0.24, tones=4)
    drive = device.play(texture)
    assert device.status().state == "Driving"
    # The tones of the texture, the outermost one first.
    assert [tone.turning_point_m for tone in drive.tones] == [
        tone.turning_point_m for tone in reversed(texture.tones)
    ]
    other = slipline.Plate("al-bending")
    device.use(other)
    with pytest.raises(slipline.Refused, match="'?\"?membrane"):
        device.play(texture)


def test_a_sensor_on_the_simulated_plate_measures_and_holds(plate: slipline.Plate) -> None:
    with slipline.connect(actual_plate=plate, sensor_m=0.03) as device:
        device.use(plate)
        measured = device.measure(0.05, points=16, level=0.4)
        assert measured.place_m == 0.05 and len(measured.frequency_hz) == 16
        assert numpy.all(numpy.abs(measured.response) > 0.0)
        assert device.status().state == "Idle"
        current = device.measure(input="current", points=16, sweep=False)
        assert len(current.frequency_hz) == 16
        device.arm()
        device.drive(turning_point_m=0.2, level=0.4)
        device.hold(max_rise_db=6)
        assert device.status().state == "Driving"
        for call, words in (
            (lambda: device.measure(0.05, kind="velocity"), "measures displacement"),
            (lambda: device.measure(0.05, kind="heat"), "must be one of displacement"),
            (lambda: device.measure(0.05, input="light"), "must be \"sensor\" or \"current\""),
            (lambda: device.measure(0.05, points=4), "points"),
            (lambda: device.measure(1.0), "place_m"),
            (lambda: device.hold(max_rise_db=21), "max_rise_db"),
        ):
            with pytest.raises(slipline.Error, match=words):
                call()
        for call in (
            lambda: device.measure(),
            lambda: device.measure(0.05, amplifier_v=2.0),
            lambda: device.measure(0.05, pints=16),
        ):
            with pytest.raises(TypeError):
                call()


def test_a_device_without_inputs_neither_measures_nor_holds(device: slipline.Device) -> None:
    with pytest.raises(slipline.Refused, match="no input"):
        device.measure(0.05)
    device.arm()
    device.drive(turning_point_m=0.16)
    with pytest.raises(slipline.Refused, match="no inputs"):
        device.hold()


def test_a_devices_codes_match_the_mirror(device: slipline.Device) -> None:
    verified = device.verify(tones=3, window_s=0.05)
    assert verified.equal and [window.equal for window in verified.windows] == [True] * 4
    assert device.status().state == "Idle"
    with pytest.raises(slipline.OutOfRange):
        device.verify(window_s=1e-4)


def test_a_device_tests_itself_and_skips_the_steps_that_lack_a_wire(device: slipline.Device) -> None:
    report = device.selftest(short=True)
    verdicts = {step.name: step.verdict for step in report.steps}
    assert (verdicts["codes"], verdicts["supply"], verdicts["mute"]) == ("green",) * 3
    assert verdicts["delay"] == verdicts["mute time"] == "skipped"
    assert "dac=sensor" in next(step.sentence for step in report.steps if step.name == "delay")
    assert device.status().state == "Idle"


def test_two_devices_are_driven_at_once(plate: slipline.Plate) -> None:
    with slipline.connect() as one, slipline.connect() as other:
        for device in (one, other):
            device.use(plate)
            device.arm()
            device.drive(turning_point_m=0.16)
        one.stop()
        one.disarm()
        assert (one.status().state, other.status().state) == ("Idle", "Driving")


def test_what_cannot_be_connected_is_named() -> None:
    plate = slipline.Plate("membrane")
    with pytest.raises(slipline.LinkLost, match="there is no port unix:/nowhere"):
        slipline.connect("unix:/nowhere")
    with pytest.raises(slipline.OutOfRange) as caught:
        slipline.connect(unattended_s=601)
    assert (caught.value.field, caught.value.low, caught.value.high) == ("unattended_s", 1.0, 600.0)
    with pytest.raises(slipline.Refused):
        slipline.connect("")
    for arguments in ({"sensor_m": 0.03}, {"port": "/dev/ttyACM0", "actual_plate": plate}):
        with pytest.raises(TypeError):
            slipline.connect(**arguments)
    with pytest.raises(slipline.Error):
        slipline.connect(actual_plate=plate, sensor_m=9.0)


def test_a_lost_line_is_a_lost_link(plate: slipline.Plate) -> None:
    with Line() as line:
        device = slipline.connect(line.port).__enter__()
        device.use(plate)
    with pytest.raises(slipline.LinkLost):
        while True:
            device.status()
