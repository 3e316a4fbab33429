"""Plates, measurements, results and refusals as Python has them."""

import inspect
import pickle
import re
import subprocess
import sys
import threading
import tomllib
import wave
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import slipline
from conftest import PROGRAM


@pytest.fixture
def plate():
    return slipline.Plate("membrane")


def test_a_plate_is_a_value(plate, tmp_path):
    again = slipline.Plate.from_toml(plate.to_toml())
    assert again == plate and hash(again) == hash(plate) and plate != slipline.Plate("al-bending")
    assert pickle.loads(pickle.dumps(plate)) == plate
    file = tmp_path / "plate.toml"
    file.write_text(plate.to_toml())
    assert slipline.Plate(file) == slipline.Plate(str(file)) == plate
    assert plate.name == "membrane" and 0 < plate.span_m[0] < plate.span_m[1] < plate.length_m
    assert "membrane" in slipline.presets() and plate != "membrane"


def test_a_measurement_is_a_value(tmp_path):
    rows = "\n".join(f"{100 + 5 * i},0.5,-0.25,0.01,{12.5 if i else ''}" for i in range(8))
    text = f"# place_m = 0.03\n# sensor = velocity\nfrequency_hz,re,im,noise,headroom_db\n{rows}\n"
    measurement = slipline.Measurement.from_csv(text)
    file = tmp_path / "measured.csv"
    measurement.write(file)
    assert slipline.Measurement.read(file) == measurement == pickle.loads(pickle.dumps(measurement))
    assert (measurement.place_m, measurement.sensor, measurement.sample_rate_hz) == (0.03, "velocity", None)
    assert measurement.response.shape == (8,) and (measurement.response == 0.5 - 0.25j).all()
    assert measurement.frequency_hz.tolist() == [100.0 + 5 * i for i in range(8)]
    assert np.isnan(measurement.headroom_db[0]) and measurement.headroom_db[1] == 12.5


def test_the_file_of_another_program_needs_what_it_does_not_state(plate, tmp_path):
    file = tmp_path / "other.frd"
    file.write_text("\n".join(f"{hz} {-20.0 + 0.01 * hz} 0.0" for hz in range(80, 260, 5)))
    with pytest.raises(slipline.BadFile, match="other.frd: .*plate and place_m"):
        slipline.Measurement.read(file)
    with pytest.raises(slipline.BadFile, match="add kind"):
        slipline.Measurement.read(file, plate=plate, place_m=0.03)
    measurement = slipline.Measurement.read(file, plate=plate, place_m=0.03, kind="velocity", snr_db=30.0)
    assert (measurement.place_m, measurement.sensor) == (0.03, "velocity")
    assert measurement.source.startswith("36 rows, ") and "column 1 as frequency in Hz" in measurement.source
    assert pickle.loads(pickle.dumps(measurement)).source is None
    rows = [f"{hz};1;{0.1 + 0.001 * hz};0.5" for hz in range(80, 260, 5)]
    file.write_text("\n".join(["f (Hz);Velocity A (m/s);Velocity B (mm/s);Phase (rad)", *rows]))
    stated = {"plate": plate, "place_m": 0.03}
    with pytest.raises(slipline.BadFile, match="2 columns may be the level.*columns="):
        slipline.Measurement.read(file, **stated)
    measurement = slipline.Measurement.read(file, **stated, columns="frequency=1,velocity=3,phase=4")
    assert measurement.sensor == "velocity" and "*Velocity A (m/s)* left out" in measurement.source
    # The rows below the plate's band are left out, and counted.
    first_hz = measurement.frequency_hz[0]
    assert first_hz == 85 and "6 rows outside the plate's band left out" in measurement.source
    assert measurement.response[0] == pytest.approx(1e-3 * (0.1 + 0.001 * first_hz) * np.exp(-0.5j))
    with pytest.raises(slipline.Refused, match="did you mean frequency"):
        slipline.Measurement.read(file, **stated, columns="frequenci=1")


def test_a_result_has_its_fields_in_every_form(plate):
    found = plate.simulate(turning_point_m=0.16, level=0.2, duration_s=0.02)
    plain = found.to_dict()
    assert isinstance(plain["tones"][0], dict) and isinstance(plain["feeling"], dict)
    assert isinstance(found.tones, list) and found.tones[0].level == plain["level"] == 0.2
    assert type(found).__module__ == "slipline.results" and set(plain) <= set(dir(found)) and "tones" in repr(found)
    again = pickle.loads(pickle.dumps(found))
    assert again.position_m.tobytes() == found.position_m.tobytes()
    with pytest.raises(AttributeError, match="has no attribute 'turning'"):
        found.turning


def test_arrays_become_a_dataset(plate):
    pytest.importorskip("xarray")
    one = plate.respond(126.0, points=101).to_xarray()
    assert one.amplitude.dims == ("position_m",) and one.attrs["frequency_hz"] == 126.0
    several = plate.respond([126.0, 140.0], points=101).to_xarray()
    assert several.amplitude.dims == ("frequency_hz", "position_m")
    assert several.turning_point_m.sel(frequency_hz=140.0) == several.turning_point_m[1]
    assert plate.table(knots=33).to_xarray().gain.dims == ("position_m",)


@pytest.mark.parametrize("call, field, value, low, high", [
    (lambda plate: plate.respond(5.0), "frequency_hz", 5.0, None, None),
    (lambda plate: plate.respond([126.0, np.nan]), "frequency_hz", np.nan, None, None),
    (lambda plate: plate.respond(126.0, points=7), "points", 7.0, 8.0, 200001.0),
    (lambda plate: plate.respond(126.0, finger=(9.0, "light")), "finger place", 9.0, None, None),
    (lambda plate: plate.table(knots=1), "knots", 1.0, 2.0, 1025.0),
    (lambda plate: plate.table(sample_rate_hz=1.0), "sample_rate_hz", 1.0, None, None),
    (lambda plate: plate.check(level=1.5), "level", 1.5, 0.0, 1.0),
    (lambda plate: plate.check(turning_point_m=0.9), "turning_point_m", 0.9, None, None),
    (lambda plate: plate.check(frequency_hz=1.0), "frequency_hz", 1.0, None, None),
    (lambda plate: plate.merit(turning_point_m=9.0), "turning_point_m", 9.0, None, None),
    (lambda plate: plate.simulate(turning_point_m=0.16, level=-0.1), "level", -0.1, 0.0, 1.0),
    (lambda plate: plate.simulate(turning_point_m=0.16, duration_s=0.0), "duration_s", 0.0, 0.01, 600.0),
    (lambda plate: plate.simulate(turning_point_m=[0.1] * 17), "turning_point_m", 17.0, 1.0, 16.0),
    (lambda plate: plate.simulate(felt_edge_m=0.001), "felt_edge_m", 0.001, None, None),
    (lambda plate: plate.check(felt_edge_m=210.0), "felt_edge_m", 210.0, None, None),
    (lambda plate: plate.respond(np.full(100_001, 126.0)), "frequency_hz", 100_001.0, 1.0, 100_000.0),
    (lambda plate: plate.texture(solid_m=9.0), "solid_m", 9.0, None, None),
    (lambda plate: plate.texture(stripes_m=1.0, tones=17), "tones", 17.0, 1.0, 16.0),
    (lambda plate: plate.calibrate((), touch=[(0.2, 9.0)]), "touch", 9.0, 0.0, None),
    (lambda _: slipline.design("latex", 1.0, (80.0, 220.0), 0.4), "thickness_m", 1.0, None, None),
    (lambda _: slipline.design("latex", 5e-4, (80.0, 220.0), 0.4, tension_n_per_m=0.0), "tension_n_per_m", 0.0, None, None),
    (lambda plate: slipline.Plate.from_toml(re.sub("length_m = .*", "length_m = 11.0", plate.to_toml())),
     "length_m", 11.0, None, None),
])
def test_a_number_that_is_not_allowed_names_its_field_and_range(plate, call, field, value, low, high):
    with pytest.raises(slipline.OutOfRange) as refused:
        call(plate)
    error = refused.value
    assert isinstance(error, ValueError) and isinstance(error, slipline.Error)
    assert error.field == field and (error.value == value or np.isnan(value))
    assert error.low < error.high and not error.low <= error.value <= error.high
    assert low in (None, error.low) and high in (None, error.high)
    assert re.search("must be|cannot enter", str(error)), error


@pytest.mark.parametrize("call, words", [
    (lambda plate: plate.simulate(), "no place: must be one of felt_edge_m, turning_point_m and frequency_hz"),
    (lambda plate: plate.simulate(felt_edge_m=0.2, frequency_hz=126.0), "more than one place"),
    (lambda plate: plate.simulate(turning_point_m=0.1, sheat=True), "unexpected keyword argument 'sheat'"),
    (lambda plate: plate.simulate(turning_point_m=0.1, duration_s="long"), "must be real number, not str"),
    (lambda plate: plate.simulate(turning_point_m=[0.1, 0.2], level=[0.1] * 3), "3 levels of 2 tones"),
    (lambda plate: plate.simulate(felt_edge_m=0.2, no_table=True), "no_table beside felt_edge_m"),
    (lambda plate: plate.texture(), "no texture: must be one of"),
    (lambda plate: plate.texture(solid_m=0.1, stripes_m=0.1), "more than one texture"),
    (lambda plate: plate.texture(profile=([0.1], [1.0, 2.0])), "two series of the same length"),
    (lambda plate: plate.respond(126.0, finger="light"), "finger = light: must be (place_m, \"light\")"),
    (lambda plate: plate.calibrate(()), "0 measurements"),
    (lambda plate: plate.calibrate((), half_width_m=0.05), "half_width_m"),
    (lambda _: slipline.design("latex", 5e-4, (80.0, 220.0), 0.4, shear=True, edge="clamped"), "more than one wave"),
])
def test_arguments_that_do_not_belong_together_are_a_type_error(plate, call, words):
    with pytest.raises(TypeError, match=re.escape(words)):
        call(plate)


@pytest.mark.parametrize("call, words", [
    (lambda plate: plate.respond(126.0, paper_mode=True, two_dimensions=True), "choose one"),
    (lambda plate: plate.simulate(turning_point_m=0.1, actual_plate="secret:x"), "secret:SEED"),
    (lambda _: slipline.design("latex", 5e-4, (80.0, 220.0), 0.4, edge="loose"), "one of supported, clamped"),
    (lambda _: slipline.Measurement.read(__file__, kind="heat"), "one of displacement"),
])
def test_what_cannot_be_done_is_refused(plate, call, words):
    with pytest.raises(slipline.Refused, match=words):
        call(plate)


def test_a_file_that_cannot_be_read_is_named(plate, tmp_path):
    with pytest.raises(slipline.BadFile, match="did you mean membrane"):
        slipline.Plate("menbrane")
    bad = tmp_path / "bad.toml"
    bad.write_text("length_m = [")
    for call in (
        lambda: slipline.Plate(bad),
        lambda: slipline.Measurement.read(bad),
        lambda: plate.simulate(setup=str(bad)),
        lambda: plate.simulate(turning_point_m=0.1, feeling=str(bad)),
        lambda: plate.texture(image=bad),
    ):
        with pytest.raises(slipline.BadFile, match="bad.toml"):
            call()


def test_other_threads_run_during_a_computation(plate):
    turns, is_done = 0, threading.Event()

    def turn():
        nonlocal turns
        while not is_done.wait(0.001):
            turns += 1

    thread = threading.Thread(target=turn)
    thread.start()
    plate.respond([126.0] * 12000, points=301)
    is_done.set()
    thread.join()
    assert turns > 10


@pytest.mark.parametrize("call", [
    # Both take a good deal longer than the 50 ms after which a call looks for signals.
    "plate.respond([126.0] * 12000, points=301)",
    "plate.merit()",
])
def test_ctrl_c_ends_a_call_long_before_its_end(call):
    script = f"""
import os, signal, threading, time, slipline
plate = slipline.Plate("membrane")
begin = time.perf_counter()
{call}
whole = time.perf_counter() - begin
threading.Timer(0.2 * whole, os.kill, (os.getpid(), signal.SIGINT)).start()
begin = time.perf_counter()
try:
    {call}
except KeyboardInterrupt:
    print((time.perf_counter() - begin) / whole)
"""
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert ended.returncode == 0 and float(ended.stdout) < 0.7, (ended.stdout, ended.stderr)


def test_every_call_is_described_with_its_units():
    for described in (slipline, slipline.Plate, slipline.Measurement, slipline.Result, slipline.design, slipline.OutOfRange):
        assert inspect.getdoc(described), described
    for name, member in inspect.getmembers(slipline.Plate):
        assert name.startswith("_") or inspect.getdoc(member), name


def test_a_series_of_one_frequency_is_a_series_and_what_was_computed_before_changes_no_bit():
    plate = slipline.Plate("membrane")
    for one in ([126.0], (126.0,), np.array([126.0])):
        assert plate.respond(one).amplitude.shape == (1, 2001)
    for number in (126, 126.0, np.float64(126.0), np.array(126.0)):
        assert plate.respond(number).amplitude.shape == (2001,)
    frequencies_hz = np.linspace(*plate.band_hz, 9)
    for points in (301, 2001, 301):
        fresh = slipline.Plate("membrane").respond(frequencies_hz, points=points)
        # Other grids and another order of them; in two threads at once.
        with ThreadPoolExecutor(2) as pool:
            again = pool.map(lambda hz: plate.respond(hz, points=points), (frequencies_hz[::-1], frequencies_hz))
        for found, order in zip(again, (slice(None, None, -1), slice(None))):
            assert found.amplitude[order].tobytes() == fresh.amplitude.tobytes()


def recording(path, description, gain):
    """A stereo recording at 48 kHz of what a description of a sweep says, in its second channel; at a constant gain."""
    rate_hz = 48_000
    sweep_s, apart_s = (description[name] / description["sample_rate_hz"] for name in ("sweep_samples", "apart_samples"))
    first_hz, ratio = description["first_hz"], description["last_hz"] / description["first_hz"]
    times_s = np.arange(round((1.5 + apart_s + sweep_s + description["ring_s"] * 2) * rate_hz)) / rate_hz
    heard = np.zeros(len(times_s))
    for begin_s, level in ((0.7, 1.0), (0.7 + apart_s, 0.5)):
        share = (times_s - begin_s) / sweep_s
        within = (share >= 0) & (share < 1)
        turns = first_hz * sweep_s / np.log(ratio) * (ratio ** share[within] - 1)
        shape = np.interp(share[within], np.linspace(0, 1, len(description["gain"])), description["gain"])
        heard[within] += level * description["level"] * shape * np.cos(2 * np.pi * turns)
    both = np.stack([np.zeros(len(heard)), np.clip(gain * heard, -1, 1)], axis=1)
    with wave.open(str(path), "wb") as file:
        file.setparams((2, 2, rate_hz, len(both), "NONE", ""))
        file.writeframes((32767 * both).astype("<i2").tobytes())


def test_a_recording_of_a_sweep_is_read_with_its_description(tmp_path):
    described = tmp_path / "sweep.toml"
    line = [PROGRAM, "sweep", "--port", "sim", "--plate", "membrane", "--for", "800ms", "--out", str(described)]
    subprocess.run(line, check=True, capture_output=True)
    plate, wav = slipline.Plate("membrane"), tmp_path / "near.wav"
    recording(wav, tomllib.loads(described.read_text()), 0.8)
    whole = {"plate": plate, "place_m": 0.05, "kind": "velocity", "played": described, "channel": 2}
    read = slipline.Measurement.read(wav, **whole)
    assert (read.place_m, read.sensor, read.sample_rate_hz) == (0.05, "velocity", 400e3)
    # The gain is the same at all frequencies, and nothing of the other channel.
    strength = np.abs(read.response)
    assert len(strength) > 20 and strength.std() < 0.02 * strength.mean(), strength
    recording(wav, tomllib.loads(described.read_text()), 0.4)
    half = np.abs(slipline.Measurement.read(wav, **whole).response)
    assert np.allclose(half, strength / 2, rtol=0.01)
    for missing, words in (
        ("played", "a recording: add played"),
        ("plate", "does not state its place: add plate and place_m"),
        ("place_m", "does not state its place: add plate and place_m"),
        ("kind", "does not state what its sensor measures: add kind"),
        ("channel", "near.wav: "),
    ):
        with pytest.raises(slipline.BadFile, match=words):
            slipline.Measurement.read(wav, **{name: value for name, value in whole.items() if name != missing})
    with pytest.raises(slipline.BadFile, match="channel 3: must be 1 to 2"):
        slipline.Measurement.read(wav, **{**whole, "channel": 3})
