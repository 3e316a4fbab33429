"""Every field of a result is that of the command line's ``--json``, to the bit."""

import struct

import numpy as np
import pytest

import slipline

# What is no field of the computation: the version of the fields, and the files that the command wrote.
OF_THE_COMMAND = {"schema", "files"}


def same(found, printed, name):
    """Walks both."""
    if isinstance(printed, dict) and set(printed) == {"re", "im"}:
        same_number(found.real, printed["re"], name)
        same_number(found.imag, printed["im"], name)
    elif isinstance(printed, dict):
        assert isinstance(found, slipline.Result), name
        fields = found.to_dict()
        assert set(fields) == set(printed) - OF_THE_COMMAND, name
        for field in fields:
            same(getattr(found, field), printed[field], f"{name}.{field}")
    elif isinstance(printed, list):
        assert len(found) == len(printed), name
        is_of_results = any(isinstance(one, dict) and set(one) != {"re", "im"} for one in printed)
        assert isinstance(found, list if is_of_results or not printed else np.ndarray), name
        for number, (one, other) in enumerate(zip(found, printed)):
            same(one, other, f"{name}[{number}]")
    elif printed is None:
        assert found is None or np.isnan(found), name
    elif isinstance(printed, (bool, str)):
        assert found == printed and isinstance(found, (bool, str, np.bool)), name
    else:
        same_number(found, printed, name)


def same_number(found, printed, name):
    assert isinstance(found, (int, np.integer)) == isinstance(printed, int), name
    assert struct.pack("<d", found) == struct.pack("<d", printed), f"{name}: {found!r} is not {printed!r}"


def middle_hz(plate):
    low, high = plate.band_hz
    return float(np.sqrt(low * high))


def with_columns(printed, name):
    """The list of objects of a field as columns, as a table has them."""
    objects = printed.pop(name)
    return {**printed, **{field: [one[field] for one in objects] for field in objects[0]}}


presets = pytest.mark.parametrize("name", slipline.presets())


@presets
def test_the_field_matches_the_command_line(command, name):
    plate = slipline.Plate(name)
    hz = middle_hz(plate)
    asked = command("respond", "--plate", name, "--freq", f"{hz!r}Hz", "--points", 301)
    same(plate.respond(hz, points=301), asked.answer(), name)


@pytest.mark.parametrize("options, arguments", [
    ({"paper_mode": True}, ["--paper-mode"]),
    ({"finger": (0.12, "light")}, ["--finger", "0.12m:light"]),
    ({"finger": (0.12, 0.5, 1e-4, 0.01)}, ["--finger", "0.12m:0.5Ns/m,1e-4kg,0.01m"]),
    ({"two_dimensions": True}, ["--2d"]),
])
def test_the_field_of_each_option_matches_the_command_line(command, options, arguments):
    asked = command("respond", "--plate", "membrane", "--freq", "126Hz", "--points", 101, *arguments)
    plate = slipline.Plate("membrane")
    found = plate.respond(126.0, points=101, **options)
    same(found, asked.answer(), "membrane")
    # With several frequencies each number is an array, and the fields are one.
    several = plate.respond([126.0, 140.0, 126.0], points=101, **options)
    assert several.amplitude.shape == (3, 101)
    for row in (0, 2):
        assert several.amplitude[row].tobytes() == found.amplitude.tobytes()
        for field in ("frequency_hz", "turning_point_m", "peak_amplitude", "edge_width_m"):
            assert getattr(several, field)[row] == getattr(found, field), field
    assert several.turning_point_m.shape == several.peak_present.shape == (3,)
    assert several.peak_present.dtype == bool
    assert set(several.to_dict()) == set(found.to_dict())


@presets
def test_the_table_matches_the_command_line(command, name):
    asked = command("table", "--plate", name, "--knots", 33)
    found = slipline.Plate(name).table(knots=33)
    same(found, with_columns(asked.answer(), "knots"), name)


def test_the_usual_table_matches_the_command_line(command):
    asked = command("table", "--plate", "membrane")
    same(slipline.Plate("membrane").table(), with_columns(asked.answer(), "knots"), "membrane")


@presets
def test_the_lights_match_the_command_line(command, name):
    asked = command("check", "--plate", name)
    same(slipline.Plate(name).check(), asked.answer(), name)


def test_the_lights_of_one_tone_match_the_command_line(command):
    arguments = ["check", "--plate", "membrane", "--level", "0.5", "--off-centre"]
    by_place = command(*arguments, "--turning-point", "0.12m")
    by_frequency = command(*arguments, "--turning-point", "126Hz")
    plate = slipline.Plate("membrane")
    options = {"level": 0.5, "off_centre": True}
    same(plate.check(turning_point_m=0.12, **options), by_place.answer(), "by its place")
    same(plate.check(frequency_hz=126.0, **options), by_frequency.answer(), "by its frequency")


@pytest.mark.parametrize("material, thickness, band, length, options, arguments", [
    ("aluminium", 2e-3, (20e3, 40e3), 0.3, {}, []),
    ("aluminium", 2e-3, (20e3, 40e3), 0.3, {"edge": "clamped", "air": "baffle", "thin": True, "loss_factor": 0.002},
     ["--edge", "clamped", "--air", "baffle", "--thin", "--loss", "0.002"]),
    ("latex", 5e-4, (80.0, 220.0), 0.4, {"tension_n_per_m": 68.4, "rim_m": 0.03, "name": "skin", "end_margin_m": 0.08},
     ["--tension", "68.4N/m", "--rim", "0.03m", "--name", "skin", "--end-margin", "0.08m"]),
    ("latex", 5e-4, (80.0, 220.0), 0.4, {"wave_speed_m_per_s": 12.0, "full_scale_m": 2e-4, "start_margin_m": 0.05},
     ["--wave-speed", "12m/s", "--full-scale", "2e-4m", "--start-margin", "0.05m"]),
    ("acrylic", 2e-3, (20e3, 40e3), 0.3, {"shear": True}, ["--shear"]),
])
def test_a_design_matches_the_command_line(command, material, thickness, band, length, options, arguments):
    asked = command(
        "design", "--material", material, "--thickness", f"{thickness!r}m", "--band", f"{band[0]!r}Hz..{band[1]!r}Hz",
        "--length", f"{length!r}m", *arguments,
    )
    found = slipline.design(material, thickness, band, length, **options)
    printed = asked.answer()
    plate = found.plate
    assert plate == slipline.Plate.from_toml(printed["toml"])
    assert plate.name == printed.pop("plate")
    same(without_plate(found), printed, material)


def without_plate(found):
    """A result but for the plate and the measurements in it."""
    return slipline.Result({name: getattr(found, name) for name in found.to_dict() if name not in ("plate", "measurements")})


@presets
def test_a_simulated_drive_matches_the_command_line(command, name):
    plate = slipline.Plate(name)
    hz = middle_hz(plate)
    asked = command("simulate", "--plate", name, "--turning-point", f"{hz!r}Hz", "--level", "0.2", "--for", "0.02s")
    same(plate.simulate(frequency_hz=hz, level=0.2, duration_s=0.02), asked.answer(), name)


@pytest.mark.parametrize("places, options, arguments", [
    ({"felt_edge_m": 0.21}, {}, ["--felt-edge", "0.21m"]),
    ({"turning_point_m": [0.12, 0.2]}, {"level": [0.3, 0.2], "actual_plate": "secret:3"},
     ["--turning-point", "0.12m:0.3", "--turning-point", "0.2m:0.2", "--actual-plate", "secret:3"]),
    ({"turning_point_m": 0.16}, {"no_table": True, "finger": (0.25, "light"), "level": 0.2},
     ["--turning-point", "0.16m", "--no-table", "--finger", "0.25m:light", "--level", "0.2"]),
])
def test_a_simulated_drive_with_options_matches_the_command_line(command, places, options, arguments):
    asked = command("simulate", "--plate", "membrane", "--for", "0.1s", *arguments)
    found = slipline.Plate("membrane").simulate(**places, **options, duration_s=0.1)
    same(found, asked.answer(), str(arguments))


def test_a_setup_and_a_feeling_of_files_sound_as_on_the_command_line(command, tmp_path):
    setup = tmp_path / "setup.toml"
    command("texture", "--plate", "membrane", "--solid", "0.25m", "--tones", 3, "--out", setup).answer()
    asked = command("simulate", "--setup", setup, "--for", "0.05s")
    plate = slipline.Plate("membrane")
    same(plate.simulate(setup=str(setup), duration_s=0.05), asked.answer(), "setup")
    asked = command("simulate", "--plate", "membrane", "--felt-edge", "0.21m", "--feeling", setup, "--for", "0.05s")
    same(plate.simulate(felt_edge_m=0.21, feeling=str(setup), duration_s=0.05), asked.answer(), "feeling")


@presets
def test_an_even_area_matches_the_command_line(command, name):
    plate = slipline.Plate(name)
    low, high = plate.span_m
    # Where a tone of the middle of the span is felt to end is on the plate for most; the others refuse on both sides.
    place_m = low + 0.6 * (high - low)
    asked = command("texture", "--plate", name, "--solid", f"{place_m!r}m", "--tones", 3)
    both(lambda: plate.texture(solid_m=place_m, tones=3), asked, name)


def both(compute, asked, name):
    """The same fields, or a refusal on both sides."""
    try:
        found = compute()
    except slipline.Error:
        asked.refusal()
    else:
        same(found, asked.answer(), name)


def test_the_other_textures_match_the_command_line(command, tmp_path):
    plate = slipline.Plate("membrane")
    profile = tmp_path / "profile.csv"
    profile.write_text("0.02,1\n0.1,1\n0.15,0.4\n0.22,0.1\n")
    places_m, amplitudes = np.array([0.02, 0.1, 0.15, 0.22]), [1, 1, 0.4, 0.1]
    image = tmp_path / "image.png"
    image.write_bytes(grey_png([255, 255, 200, 120, 40, 0, 0, 0]))
    asked = {
        option: command("texture", "--plate", "membrane", "--tones", 3, f"--{option}", text)
        for option, text in
        [("profile", profile), ("image", image), ("stripes", "0.05m"), ("beat", "0.12m:20Hz")]
    }
    printed = asked["profile"].answer()
    # What the command has read of its file.
    del printed["read"]
    same(plate.texture(profile=(places_m, amplitudes), tones=3), printed, "profile")
    same(plate.texture(image=image, tones=3), asked["image"].answer(), "image")
    same(plate.texture(stripes_m=0.05), asked["stripes"].answer(), "stripes")
    same(plate.texture(beat=(0.12, 20.0)), asked["beat"].answer(), "beat")


def grey_png(row):
    """An image of one row."""
    import zlib

    def chunk(kind, data):
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    header = struct.pack(">IIBBBBB", len(row), 1, 8, 0, 0, 0, 0)
    pixels = zlib.compress(bytes([0, *row]))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")


@presets
def test_the_figures_of_merit_match_the_command_line(command, name):
    plate = slipline.Plate(name)
    low, high = plate.span_m
    place_m = low + 0.7 * (high - low)
    asked = command("merit", "--plate", name, "--turning-point", f"{place_m!r}m")
    try:
        found = plate.merit(turning_point_m=place_m)
    except slipline.Error:
        asked.refusal()
    else:
        same(slipline.Result({"plate": name, "turning_points": found}), asked.answer(), name)


def test_the_figures_of_merit_over_the_span_match_the_command_line(command):
    asked = command("merit", "--plate", "membrane")
    found = slipline.Plate("membrane").merit()
    assert len(found) > 1
    same(slipline.Result({"plate": "membrane", "turning_points": found}), asked.answer(), "membrane")


def measured(plate, place_m, count=24):
    """The response of a displacement sensor on this plate, as a file's text."""
    low, high = plate.band_hz
    frequencies = np.geomspace(0.8 * low, high, count)
    field = plate.respond(frequencies, points=2001)
    place = int(round(place_m / plate.length_m * 2000))
    responses = field.amplitude[:, place]
    noise = 1e-3 * float(np.abs(responses).max())
    rows = [f"{hz!r},{f.real!r},{f.imag!r},{noise!r}" for hz, f in zip(frequencies.tolist(), responses.tolist())]
    head = [f"# place_m = {field.position_m[place]}", "# sensor = displacement", "frequency_hz,re,im,noise"]
    return "\n".join(head + rows) + "\n"


@pytest.mark.parametrize("name", ["membrane", "al-bending"])
def test_a_calibration_matches_the_command_line(command, tmp_path, name):
    plate = slipline.Plate(name)
    files, measurements = [], []
    for share in (0.2, 0.45):
        text = measured(plate, share * plate.length_m)
        files.append(tmp_path / f"{share}.csv")
        files[-1].write_text(text)
        measurements.append(slipline.Measurement.read(files[-1]))
    fitted = tmp_path / "fitted.toml"
    asked = command("calibrate", "--plate", name, "--data", files[0], "--data", files[1], "--out", fitted)
    found = plate.calibrate(measurements)
    printed = asked.answer(codes=(0, 1))
    same_calibration(found, printed, fitted)


def same_calibration(found, printed, fitted):
    del printed["plate"], printed["read"]
    same(without_plate(found), printed, "calibrate")
    assert found.accepted == fitted.exists()
    if found.accepted:
        assert found.plate == slipline.Plate(fitted)
    else:
        assert found.plate is None


def test_a_calibration_by_touches_matches_the_command_line(command, tmp_path):
    fitted = tmp_path / "fitted.toml"
    touches = [(0.2, 0.202), (0.28, 0.277)]
    asked = command(
        "calibrate", "--plate", "membrane", *[word for asked, felt in touches for word in ("--touch", f"{asked}m:{felt}m")],
        "--touched-drive", "as-told", "--touch-tolerance", "0.003m", "--out", fitted,
    )
    found = slipline.Plate("membrane").calibrate((), touch=touches, touched_drive="as-told", touch_tolerance_m=0.003)
    same_calibration(found, asked.answer(codes=(0, 1)), fitted)
