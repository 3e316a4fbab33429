"""What a lab does with a device besides driving it and measuring: trims, and sweeps for a separate recorder."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
import slipline

PLACE_M = 0.034
CALIBRATION = "\n[calibration]\nchi2_per_n = 1.0\nhalf_width_tolerance = 0.002\ntaper_tolerance = 0.002\n"


def test_a_trim_finds_the_speed_that_has_changed_as_the_command_line_does(tmp_path: Path, command: Any) -> None:
    plate = slipline.Plate.from_toml(slipline.Plate("al-bending").to_toml() + CALIBRATION)
    # The speed in bending is that of the fourth root of the modulus.
    actual = plate.replace(**{"model.youngs_modulus_pa": 70e9 * 1.01**4})
    for name, one in (("plate", plate), ("actual", actual)):
        (tmp_path / f"{name}.toml").write_text(one.to_toml())
    files = ("--plate", tmp_path / "plate.toml", "--actual-plate", tmp_path / "actual.toml")
    shown = command("trim", "--port", "sim", *files, "--sensor", "34mm", "--for", "0.1s").answer()
    with slipline.connect("sim", actual_plate=actual, sensor_m=PLACE_M) as device:
        device.use(plate)
        found = device.trim(PLACE_M, duration_s=0.1)
        assert device.status().state == "Idle"
        assert set(found.to_dict()) == set(shown) - {"schema", "files"}
        for one in (found.begin, found.later[0]):
            assert one.low < 1.01 < one.high and one.high - one.low < 4e-3 and one.chi2_per_n < 3.0
        assert found.place_m == PLACE_M and "from its mark" in (found.caution or "")
        # The plate of the latest speed can be trimmed again.
        device.use(found.plate)
        again = device.trim(PLACE_M)
        assert abs(again.begin.wave_speed_share - 1.0) < 4e-3 and again.later == []
        with pytest.raises(slipline.OutOfRange, match="place_m = 9"):
            device.trim(9.0)
        with pytest.raises(slipline.OutOfRange, match="duration_s = -1"):
            device.trim(PLACE_M, duration_s=-1)
        device.use(slipline.Plate("al-bending"))
        with pytest.raises(slipline.Refused, match="holds no calibration"):
            device.trim(PLACE_M)


def test_a_sweep_is_played_and_described_as_by_the_command_line(tmp_path: Path, command: Any) -> None:
    path = tmp_path / "shown.toml"
    shown = command("sweep", "--port", "sim", "--plate", "al-bending", "--for", "150ms", "--level", "0.4", "--out", path).answer()
    plate = slipline.Plate("al-bending")
    with slipline.connect() as device:
        device.use(plate)
        played = device.sweep(tmp_path / "sweep.toml", duration_s=0.15, level=0.4)
        assert device.status().state == "Idle"
        assert played.to_dict() == {name: value for name, value in shown.items() if name not in ("schema", "files")}
        assert (tmp_path / "sweep.toml").read_text() == path.read_text()
        for wrong, words in (({"duration_s": 60.0}, "duration_s = 60"), ({"level": 2.0}, "level = 2")):
            with pytest.raises(slipline.OutOfRange, match=words):
                device.sweep(tmp_path / "no.toml", **wrong)
        with pytest.raises(slipline.BadFile, match="none"):
            device.sweep(tmp_path / "none" / "sweep.toml", duration_s=0.15)
    assert not (tmp_path / "no.toml").exists()
    # The description is the one that a recording is read with: silence is no recording of it.
    import wave

    with wave.open(str(tmp_path / "silence.wav"), "wb") as file:
        file.setparams((1, 2, 96_000, 0, "NONE", ""))
        file.writeframes(bytes(2 * 96_000 * 5))
    with pytest.raises(slipline.BadFile, match="shorter than the sweep, or silent"):
        slipline.Measurement.read(
            tmp_path / "silence.wav", plate=plate, place_m=PLACE_M, kind="velocity", played=tmp_path / "sweep.toml"
        )


def test_harmonics_are_measured_as_by_the_command_line_and_cancelled(command: Any) -> None:
    options = ("--sensor", "32mm", "--harmonics", "2", "--level", "0.8")
    shown = command("measure", "--port", "sim", "--plate", "membrane", *options).answer()
    membrane = slipline.Plate("membrane")
    with slipline.connect("sim", actual_plate=membrane, sensor_m=0.032) as device:
        device.use(membrane)
        device.arm()
        with pytest.raises(slipline.Refused, match="states no harmonics"):
            device.drive(turning_point_m=0.12, cancel_harmonics=True)
        found = device.measure_harmonics(0.032, points=2, level=0.8)
        assert device.status().state == "Idle"
        assert set(found.to_dict()) == set(shown) - {"schema", "files"}
        assert [harmonic.order for harmonic in found.harmonics] == [2, 3] and found.harmonic_level == 0.8
        for harmonic, other in zip(found.harmonics, shown["harmonics"], strict=True):
            assert list(harmonic.frequency_hz) == other["frequency_hz"]
            assert harmonic.unclear == 0 and max(harmonic.ratio_db) < -60.0
        assert found.toml == found.plate.to_toml() and "harmonic_2_points" in found.toml and found.warnings == []
        device.use(found.plate)
        device.arm()
        drive = device.drive(turning_point_m=0.12, level=0.5, cancel_harmonics=True)
        assert device.status().state == "Driving"
        assert drive.tones[0].second_boundary_m is None
        for wrong, words in (({"points": 1}, "points = 1"), ({"level": 2.0}, "level = 2"), ({"place_m": 9.0}, "place_m = 9")):
            with pytest.raises(slipline.OutOfRange, match=words):
                device.measure_harmonics(**{"place_m": 0.032, **wrong})


def test_the_amplifier_of_the_simulated_device_is_tested() -> None:
    membrane = slipline.Plate("membrane")
    with slipline.connect("sim", actual_plate=membrane, sensor_m=0.032) as device:
        verdicts = {step.name: step.verdict for step in device.selftest(amplifier=True).steps}
        assert (verdicts["amplifier"], verdicts["mute"], verdicts["codes"]) == ("green", "green", "skipped")
        assert device.status().state == "Idle"
        with pytest.raises(slipline.Refused, match="without wires"):
            device.selftest(amplifier=True, sensor_wire=True)


def test_the_brown_out_level_is_read_and_set_behind_a_question(command: Any) -> None:
    shown = command("board", "brown-out", "--port", "sim").answer()
    with slipline.connect("sim") as device:
        found = device.brown_out()
        assert found.to_dict() == {name: value for name, value in shown.items() if name != "schema"}
        assert found.brown_out_guarded and not found.written and found.brown_out_level == found.brown_out_level_needed
        with pytest.raises(slipline.Refused, match="add power_is_safe=True"):
            device.brown_out(set=True)
        assert not device.brown_out(set=True, power_is_safe=True).written


def test_a_current_that_images_may_falsify_is_warned_of() -> None:
    plate = slipline.Plate("al-bending")
    with slipline.connect("sim", actual_plate=plate, sensor_m=0.034) as device:
        device.use(plate)
        circuit: dict[str, Any] = {"input": "current", "points": 16}
        current = device.measure(**circuit)
        # What the rig's data sheets would state: the current of a piezo of 2 nF at 60 V.
        shunt_a = 2.0 * math.pi * current.frequency_hz[0] * 2e-9 * 60.0 / abs(current.response[0])
        circuit |= {"amplifier_v": 60.0, "piezo_f": 2e-9, "shunt_a": float(shunt_a)}
        with pytest.warns(UserWarning, match="state the bandwidth of the amplifier"):
            device.measure(**circuit)
        with pytest.warns(UserWarning, match="may falsify the current by"):
            device.measure(**circuit, amplifier_bandwidth_hz=120e3)
        device.measure(**circuit, amplifier_bandwidth_hz=120e3, filter_bandwidth_hz=120e3)
        device.use(slipline.Plate.from_toml(plate.to_toml() + "\n[actuator]\namplifier_bandwidth_hz = 120000\n"))
        with pytest.warns(UserWarning, match="may falsify the current by"):
            device.measure(**circuit)
        with pytest.raises(slipline.OutOfRange, match="amplifier_bandwidth_hz = 1 Hz"):
            device.measure(**circuit, amplifier_bandwidth_hz=1.0)
