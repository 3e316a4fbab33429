"""Arguments in the forms that a lab has them, and those that no call takes. No length ends the interpreter."""

import math
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest

import slipline


@pytest.fixture(scope="module")
def plate():
    return slipline.Plate("membrane")


def test_any_series_of_numbers_is_a_series(plate):
    xarray = pytest.importorskip("xarray")
    wanted = plate.respond([126.0, 130.0], points=64).amplitude
    whole = np.ma.array([126.0, 130.0], mask=False)
    for series in (
        (126, 130),
        range(126, 131, 4),
        np.array([126.0, 130.0]),
        np.array([126.0, 0.0, 130.0])[::2],
        np.array([126, 130], dtype=np.uint8),
        [Fraction(126), Fraction(130)],
        whole,
        xarray.DataArray([126.0, 130.0], dims="frequency_hz"),
        memoryview(np.array([126.0, 130.0])),
    ):
        assert plate.respond(series, points=64).amplitude.tobytes() == wanted.tobytes(), series


def test_a_column_of_pandas_is_a_series(plate):
    pandas = pytest.importorskip("pandas")
    wanted = plate.respond([126.0, 130.0], points=64).amplitude
    for kind in ("float64", "Int64"):
        column = pandas.Series([126, 130], index=[7, 9], dtype=kind)
        assert plate.respond(column, points=64).amplitude.tobytes() == wanted.tobytes()
    # What is missing in the column is NaN.
    with pytest.raises(slipline.OutOfRange, match="frequency_hz = NaN Hz: must be"):
        plate.respond(pandas.Series([126, None], dtype="Int64"))


@pytest.mark.parametrize("given, kind, words", [
    ([], ValueError, "frequency_hz of no number: must be one or more"),
    (np.empty(0), ValueError, "frequency_hz of no number: must be one or more"),
    ([[126.0, 130.0]], ValueError, r"frequency_hz of the shape \(1, 2\): must be"),
    ([[126.0], [126.0, 130.0]], ValueError, "frequency_hz of series of different lengths"),
    (np.ma.array([126.0, 130.0], mask=[False, True]), ValueError, "frequency_hz with masked values"),
    ([126.0 + 0j], TypeError, "frequency_hz of complex numbers: must be real numbers"),
    (126j, TypeError, "frequency_hz of complex numbers: must be real numbers"),
    ("126", TypeError, "frequency_hz = '126': must be a number, or a series of numbers"),
    ([126.0, None], TypeError, "frequency_hz = .*: must be a number, or a series of numbers"),
    ([126.0, "130"], TypeError, "frequency_hz = .*: must be a number, or a series of numbers"),
    (np.array(None), TypeError, "frequency_hz = array.None.*: must be a number, or a series of numbers"),
    (np.array([126.0, "130"], dtype=object), TypeError, "frequency_hz = .*: must be a number, or a series of numbers"),
    ({126.0}, TypeError, "frequency_hz = .*: must be a number, or a series of numbers"),
    (True, TypeError, "frequency_hz = True: must be a number, or a series of numbers"),
])
def test_an_argument_that_is_no_series_of_numbers_is_refused_by_its_name(plate, given, kind, words):
    with pytest.raises(kind, match=words):
        plate.respond(given)


def test_any_sequence_stands_for_a_tuple(plate):
    wanted = plate.respond(126.0, points=64, finger=(0.1, "light")).amplitude
    assert plate.respond(126.0, points=64, finger=[0.1, "light"]).amplitude.tobytes() == wanted.tobytes()
    contact = plate.respond(126.0, points=64, finger=np.array([0.1, 1.0, 1e-3, 0.01])).amplitude
    assert contact.tobytes() == plate.respond(126.0, points=64, finger=(0.1, 1.0, 1e-3, 0.01)).amplitude.tobytes()
    places_m, wishes = np.linspace(0.06, 0.3, 30), np.linspace(1.0, 0.2, 30)
    tones = [tone.level for tone in plate.texture(profile=(places_m, wishes), tones=3).tones]
    for profile in ([places_m.tolist(), wishes.tolist()], np.array([places_m, wishes])):
        assert [tone.level for tone in plate.texture(profile=profile, tones=3).tones] == tones
    for call, words in (
        (lambda: plate.respond(126.0, finger=(0.1,)), "finger = .*: must be"),
        (lambda: plate.respond(126.0, finger=(0.1, "soft")), "finger = .*: must be"),
        (lambda: plate.texture(profile=[places_m]), "profile: must be two series"),
        (lambda: plate.texture(profile=5.0), "profile: must be two series"),
        (lambda: plate.texture(beat=(0.1,)), "beat = .*: must be"),
        (lambda: plate.calibrate("no measurement"), "measurements = .*: must be a sequence of Measurement"),
        (lambda: plate.calibrate((), touch=[(0.2,)]), "touch = .*: must be a sequence of pairs of numbers"),
        (lambda: slipline.design("latex", 5e-4, (80.0,), 0.4), "band_hz = .*: must be"),
    ):
        with pytest.raises(TypeError, match=words):
            call()


def test_a_place_in_millimetres_is_asked_about(plate):
    for call, field in (
        (lambda: plate.check(felt_edge_m=210.0), "felt_edge_m"),
        (lambda: plate.check(turning_point_m=160.0), "turning_point_m"),
        (lambda: plate.texture(solid_m=240.0), "solid_m"),
    ):
        with pytest.raises(slipline.OutOfRange, match=r"; did you mean 0\.\d+ m\?$") as refused:
            call()
        assert refused.value.field == field
    with pytest.raises(slipline.OutOfRange) as refused:
        plate.check(turning_point_m=0.9)
    assert "did you mean" not in str(refused.value)
    # No length, though its name ends as one.
    with pytest.raises(slipline.OutOfRange) as refused:
        plate.replace(taper={"rate_per_m": 4620.0})
    assert "did you mean" not in str(refused.value)


def test_a_number_out_of_its_range_is_refused_by_the_name_of_its_argument(plate, tmp_path):
    table = tmp_path / "other.csv"
    rows = [f"{frequency_hz},1,2" for frequency_hz in np.linspace(90.0, 200.0, 16)]
    table.write_text("\n".join(["Frequency (Hz),Magnitude (dB),Phase (deg)", *rows]) + "\n")

    def read(**more):
        return slipline.Measurement.read(table, **{"plate": plate, "place_m": 0.03, "kind": "velocity", **more})

    assert read().frequency_hz.size == 16
    with slipline.connect("sim", actual_plate=plate, sensor_m=0.1) as device:
        device.use(plate)
        for field, value, call in (
            ("points", -1, lambda: plate.respond(126.0, points=-1)),
            ("knots", -1, lambda: plate.table(knots=-1)),
            ("tones", -1, lambda: plate.texture(solid_m=0.25, tones=-1)),
            ("tones", 256, lambda: device.verify(tones=256)),
            ("points", -8, lambda: device.measure(0.1, points=-8)),
            ("low_hz", math.nan, lambda: device.measure(0.1, low_hz=math.nan)),
            ("high_hz", 1.0, lambda: device.measure(0.1, high_hz=1.0)),
            ("high_hz", 1.0, lambda: device.sweep(tmp_path / "sweep.toml", high_hz=1.0)),
            ("duration_s", 0.05, lambda: device.sweep(tmp_path / "sweep.toml", duration_s=0.05)),
            ("turning_point_m", math.nan, lambda: device.drive(tones=[{"turning_point_m": math.nan}])),
            ("sensor_m", 34.0, lambda: slipline.connect("sim", actual_plate=plate, sensor_m=34.0)),
            ("channel", 0, lambda: read(channel=0)),
            ("place_m", 30.0, lambda: read(place_m=30.0)),
            ("snr_db", -1.0, lambda: read(snr_db=-1.0)),
        ):
            with pytest.raises(slipline.OutOfRange, match=f"^{field} = ") as refused:
                call()
            assert refused.value.field == field and math.isfinite(refused.value.low) and math.isfinite(refused.value.high), field
            assert refused.value.value == value or math.isnan(value)
        assert device.status().state == "Idle"
    with pytest.raises(slipline.Refused, match="^sensor = .bogus.: must be one of displacement"):
        slipline.Measurement.from_arrays(np.linspace(90.0, 200.0, 16), np.ones(16), place_m=0.03, sensor="bogus")


LENGTHS = """
from itertools import repeat

import numpy as np
import slipline

class Long:
    "A sequence that claims to be as long as no computer has memory for."
    def __len__(self): return 1 << 60
    def __getitem__(self, i): return 126.0
    def __iter__(self): return iter(())

plate = slipline.Plate("membrane")
endless, deep = {}, {}
endless["taper"] = endless
inner = deep
for _ in range(100_000):
    inner["taper"] = inner = {}
measurement = slipline.Measurement.from_arrays(np.linspace(90.0, 200.0, 16), np.ones(16), place_m=0.03)
calls = [
    lambda: plate.respond(np.full(4_000_000, 126.0)),
    lambda: plate.respond(np.full(100_000, 126.0), points=200_001),
    lambda: plate.respond(Long()),
    lambda: plate.simulate(turning_point_m=np.full(4_000_000, 0.16)),
    lambda: plate.texture(profile=(np.linspace(0, 0.3, 4_000_000), np.ones(4_000_000))),
    lambda: plate.calibrate(repeat(measurement)),
    lambda: plate.replace(**endless),
    lambda: plate.replace(**deep),
    lambda: plate.calibrate((), touch=repeat((0.2, 0.2))),
    lambda: slipline.Plate.from_toml("#" * 100_000_000),
    lambda: slipline.Measurement.from_csv("#" * 300_000_000),
    lambda: slipline._slipline._Study("#" * 100_000_000),
    lambda: slipline.Measurement.from_arrays(np.ones(4_000_000), np.ones(4_000_000), place_m=0.03),
    lambda: slipline.connect().drive(tones=repeat({"turning_point_m": 0.16})),
    lambda: slipline.connect().sequence(repeat({"at": 0})),
]
for number, call in enumerate(calls):
    try:
        call()
    except (slipline.Error, ValueError, TypeError, MemoryError, OverflowError) as error:
        print(number, type(error).__name__)
    else:
        raise AssertionError(number)
print("whole")
"""


def test_no_length_of_an_argument_ends_the_interpreter():
    ended = subprocess.run([sys.executable, "-c", LENGTHS], capture_output=True, text=True)
    assert ended.returncode == 0 and ended.stdout.endswith("whole\n"), (ended.returncode, ended.stdout, ended.stderr[-2000:])
