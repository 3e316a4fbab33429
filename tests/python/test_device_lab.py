"""What a lab does with a device besides driving it and measuring: trims, and sweeps for a separate recorder."""

from __future__ import annotations

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
