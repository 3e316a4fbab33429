"""Each result has the fields of its class, of the types that the class states, and every form that a lab keeps it in."""

import json
import pickle
import subprocess
import sys
import types
import typing
from pathlib import Path

import numpy as np
import pytest

import slipline
from slipline import results

@pytest.fixture(scope="module")
def plate():
    return slipline.Plate("membrane")


def agrees(value, hint):
    """Whether a value is of an annotated type; of results all of their fields."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        return any(agrees(value, one) for one in arguments)
    if origin is np.ndarray:
        return isinstance(value, np.ndarray) and np.can_cast(value.dtype, typing.get_args(arguments[1])[0], "safe") or value == []
    if origin in (list, results.Results):
        return isinstance(value, list) and all(agrees(one, arguments[0]) for one in value)
    if hint is float:
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    if isinstance(hint, type) and issubclass(hint, results.Result):
        return type(value) is hint and not list(wrong(value))
    return value is None if hint is type(None) else isinstance(value, hint)


def wrong(result):
    """The fields that its class does not have, lacks, or has of another type."""
    hints = {name: hint for name, hint in typing.get_type_hints(type(result)).items() if not name.startswith("_")}
    fields = result._fields()
    # What the command leaves out is None by the class; `from` is a word of Python.
    lacks = {name for name in set(hints) - set(fields) if not hasattr(type(result), name)}
    for name in (set(fields) - set(hints) - {"from"}) | lacks:
        yield type(result).__name__, name
    for name, hint in hints.items():
        if name in fields and not agrees(fields[name], hint):
            yield type(result).__name__, name, hint, fields[name]


def found(plate):
    """A result of each call without a device."""
    yield plate.respond(126.0, points=64)
    yield plate.respond([126.0, 130.0], points=64)
    # The first one has no peak.
    yield plate.respond([62.0, 126.0], points=64)
    yield plate.respond(126.0, points=64, two_dimensions=True)
    yield plate.table(knots=33)
    yield plate.check()
    yield plate.check(felt_edge_m=0.21)
    yield plate.simulate(turning_point_m=[0.16, 0.2], level=0.2, duration_s=0.02)
    yield plate.texture(solid_m=0.24, tones=2)
    yield plate.texture(stripes_m=0.05)
    yield plate.calibrate((), touch=[(0.2, 0.201), (0.23, 0.232)])
    yield slipline.design("latex", 5e-4, (80.0, 220.0), 0.4, tension_n_per_m=68.4)
    yield from plate.merit(turning_point_m=0.16)
    yield from slipline.ports()


def test_each_result_has_the_fields_of_its_class(plate):
    for one in found(plate):
        assert list(wrong(one)) == [], one


def test_a_devices_results_have_the_fields_of_their_classes(plate):
    with slipline.connect() as device:
        yields = [device.status()]
        device.use(plate)
        device.arm()
        yields += [device.drive(turning_point_m=0.16), device.status(), device.play(plate.texture(solid_m=0.24, tones=2))]
        yields += device.sequence([{"at": device.status().now_samples + 100_000}])
        yields.append(device.verify(tones=2, window_s=0.05))
        yields.append(device.selftest(short=True))
        yields.append(device.brown_out())
    for one in yields:
        assert list(wrong(one)) == [], one


def test_each_result_prints_its_values_and_is_plain_data_and_a_pickle(plate):
    for one in found(plate):
        again = json.loads(json.dumps(one.to_dict(), allow_nan=False))
        assert set(again) == set(one._fields())
        assert json.dumps(pickle.loads(pickle.dumps(one)).to_dict()) == json.dumps(one.to_dict())
        assert repr(one).startswith(type(one).__name__ + "(") and "<table>" in one._repr_html_()
    assert "frequency_hz=126" in repr(plate.respond(126.0, points=64))
    html = plate.check()._repr_html_()
    assert "background: #2e7d32" in html and "<th>colour</th>" in html


def test_lights_tones_merits_and_arrays_become_tables(plate):
    pandas = pytest.importorskip("pandas")
    check = plate.check()
    assert list(check.to_pandas().name) == [light.name for light in check.lights] == list(check.lights.to_pandas().name)
    simulated = plate.simulate(turning_point_m=[0.16, 0.2], level=0.2, duration_s=0.02)
    assert list(simulated.to_pandas().turning_point_m) == [0.16, 0.2]
    assert isinstance(plate.merit(turning_point_m=0.16).to_pandas(), pandas.DataFrame)
    assert len(plate.table(knots=33).to_pandas()) == 33
    # As many places as frequencies: a row is a frequency.
    assert "position_m" not in plate.respond(np.linspace(100.0, 150.0, 9), points=9).to_pandas().columns
    with pytest.raises(ValueError, match="the result has the lists lights"):
        check.to_pandas("tones")


def test_a_dataset_has_units_and_long_names(plate):
    pytest.importorskip("xarray")
    field = plate.respond([126.0, 130.0], points=64).to_xarray()
    assert field.position_m.attrs == {"long_name": "position", "units": "m"}
    assert field.frequency_hz.attrs["units"] == "Hz" and field.amplitude.attrs["units"] == "1"


def test_a_field_a_simulation_a_table_and_a_check_are_drawn(plate):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    for one in (
        plate.respond([126.0, 130.0], points=64),
        plate.simulate(turning_point_m=0.16, level=0.2, duration_s=0.02),
        plate.table(knots=33),
        plate.check(),
    ):
        axes = one.plot()
        assert axes.has_data()
    with pytest.raises(ValueError, match="plot"):
        slipline.ports()[0].plot()


def measured(plate, places_m, actual):
    """What a sensor at these places measures of another plate, 60 dB above its noise."""
    frequency_hz = np.linspace(86, 222, 60)
    field = actual.respond(frequency_hz)
    for place_m in places_m:
        response = 1e-5 * np.array([np.interp(place_m, field.position_m, row) for row in field.amplitude])
        yield slipline.Measurement.from_arrays(frequency_hz, response, place_m=place_m, snr_db=60.0)


def test_a_calibration_is_drawn_beside_its_model(plate):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    actual = plate.replace(loss_factor=0.035, **{"taper.rate_per_m": 4.66})
    found = plate.calibrate(list(measured(plate, [0.032, 0.12], actual)))
    assert found.plate is not None, found.reason
    assert list(wrong(found)) == [] and len(found.measurements) == 2
    assert pickle.loads(pickle.dumps(found)).measurements == found.measurements
    assert json.loads(json.dumps(found.to_dict()))["measurements"][0] == found.measurements[0].to_csv()
    for by in ("two places", "one sensor"):
        if by == "one sensor":
            found.by, found.measurements = by, found.measurements[:1]
        off_db = []
        # The plate of its file fits worse.
        for model in (found.plate, plate):
            found.plate = model
            points, line = (line.get_ydata() for line in found.plot().get_lines())
            off_db.append(np.median(np.abs(points - line)))
        assert off_db[0] < 0.3 and off_db[1] > 2 * off_db[0], off_db
        found.plate = actual
    checked = plate.calibrate(list(measured(plate, [0.032, 0.12, 0.176], actual)))
    assert checked.by == "two places and a check" and len(checked.measurements) == 3
    assert "measured, 120 mm over 32 mm" in [line.get_label() for line in checked.plot().get_lines()]
    with pytest.raises(ValueError, match="two places or at one"):
        plate.calibrate((), touch=[(0.2, 0.201), (0.23, 0.232)]).plot()


def test_the_numbers_of_a_plate_are_read_replaced_and_turned_into_each_other(plate):
    places_m = np.linspace(*plate.span_m, 5)
    frequencies_hz = plate.frequency_hz(places_m)
    assert np.allclose(plate.turning_point_m(frequencies_hz), places_m, rtol=0, atol=1e-9)
    assert isinstance(plate.frequency_hz(0.16), float)
    by_place, by_frequency = plate.respond(turning_point_m=0.16, points=64), plate.respond(plate.frequency_hz(0.16), points=64)
    assert by_place.amplitude.tobytes() == by_frequency.amplitude.tobytes()
    edge = plate.check(felt_edge_m=0.21, level=0.8).turning_point_m
    assert plate.respond(felt_edge_m=0.21, points=64).turning_point_m == pytest.approx(edge, abs=1e-6)
    for arguments in ({}, {"frequency_hz": 126.0, "turning_point_m": 0.16}):
        with pytest.raises(TypeError, match="one of frequency_hz, turning_point_m, felt_edge_m"):
            plate.respond(**arguments)

    lossy = plate.replace(loss_factor=0.05)
    assert lossy.to_dict()["loss_factor"] == 0.05 and plate.to_dict()["loss_factor"] != 0.05
    assert lossy.replace(loss_factor=plate.to_dict()["loss_factor"]) == plate
    rate = plate.to_dict()["taper"]["rate_per_m"]
    nested, dotted = plate.replace(taper={"rate_per_m": 1.01 * rate}), plate.replace(**{"taper.rate_per_m": 1.01 * rate})
    assert nested == dotted != plate
    with pytest.raises(TypeError, match="did you mean loss_factor"):
        plate.replace(loss_facto=0.05)
    with pytest.raises(slipline.OutOfRange) as refused:
        plate.replace(loss_factor=9.0)
    assert refused.value.field == "loss_factor"


def test_a_measurement_is_made_of_arrays_and_becomes_a_dataset():
    frequency_hz = np.linspace(90.0, 200.0, 16)
    response = np.exp(1j * np.linspace(0, 3, 16))
    measured = slipline.Measurement.from_arrays(frequency_hz, response, place_m=0.03, sensor="velocity", snr_db=40.0)
    assert np.array_equal(measured.response, response) and np.allclose(measured.noise, 0.01)
    assert measured.sensor == "velocity" and np.isnan(measured.headroom_db).all()
    assert pickle.loads(pickle.dumps(measured)) == measured
    whole = slipline.Measurement.from_arrays(
        list(frequency_hz), list(response), place_m=0.03, noise=np.full(16, 0.02), headroom_db=6.0, sample_rate_hz=400e3,
        unit_per_response=1e-6, place_tolerance_m=1e-4,
    )
    assert whole.headroom_db[0] == 6.0 and whole.sample_rate_hz == 400e3 and whole.unit_per_response == 1e-6
    pytest.importorskip("xarray")
    assert whole.to_xarray().response.dims == ("frequency_hz",) and whole.to_xarray().attrs["place_m"] == 0.03
    for arguments, kind, words in (
        ({"response": response[:8]}, ValueError, "response of 8 numbers, and frequency_hz of 16"),
        ({"noise": 0.1, "snr_db": 30.0}, TypeError, "noise and snr_db"),
        ({"snr_db": 999.0}, slipline.OutOfRange, "snr_db"),
        ({"sensor": "heat"}, slipline.Refused, "one of displacement"),
        ({"place_m": 99.0}, slipline.OutOfRange, "place_m"),
        ({"frequency_hz": frequency_hz[::-1]}, slipline.OutOfRange, "frequency_hz"),
        ({"frequency_hz": frequency_hz.reshape(4, 4)}, ValueError, "shape"),
    ):
        with pytest.raises(kind, match=words):
            slipline.Measurement.from_arrays(**{"frequency_hz": frequency_hz, "response": response, "place_m": 0.03, **arguments})


def test_the_classes_are_those_of_the_page():
    script = Path(__file__).resolve().parents[2] / "host" / "python" / "results_from_page.py"
    made = subprocess.run([sys.executable, "-B", str(script), "--check"], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
