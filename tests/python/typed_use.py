"""Every call of the package with the types that a checker must accept. It is checked, not run: `.ci/run python_types`.

A line that ends in ``# refused`` has a planted error, which mypy and basedpyright must find.
"""

from __future__ import annotations

import asyncio

import numpy as np
import slipline
from numpy.typing import NDArray


def plates() -> None:
    names: list[str] = slipline.presets()
    plate = slipline.Plate(names[0])
    plate = slipline.Plate.from_toml(plate.to_toml())
    changed: slipline.Plate = plate.replace(loss_factor=0.02, taper={"rate_per_m": 4.0})
    span: tuple[float, float] = changed.span_m
    field = plate.respond([126.0, 130.0], points=101, finger=(0.1, "light"))
    rows: NDArray[np.complex128] = field.amplitude
    places: NDArray[np.float64] = field.position_m
    plate.respond(np.linspace(80.0, 200.0, 9), finger=[0.1, 1.0, 1e-3, 0.01])
    plate.respond(turning_point_m=0.16)
    plate.respond(felt_edge_m=0.21, level=0.5)
    check = plate.check(felt_edge_m=0.21, level=0.5)
    colours: list[str] = [light.colour for light in check.lights]
    worst: str = check.worst
    table = plate.table(knots=33)
    gains: NDArray[np.float64] = table.gain
    simulated = plate.simulate(turning_point_m=[0.16, 0.2], level=0.2, duration_s=0.05, actual_plate="secret:1", sheet=False)
    edges: list[float | None] = [tone.measured_felt_edge_m for tone in simulated.tones]
    merits = [merit.contrast_db for merit in plate.merit(turning_point_m=0.16)]
    texture = plate.texture(profile=(places, np.ones(places.size)), tones=4)
    designed = slipline.design("latex", 5e-4, (80.0, 220.0), 0.4, tension_n_per_m=68.4, rim_m=0.03)
    other: slipline.Plate = designed.plate
    print(span, rows, colours, worst, gains, edges, merits, texture.tones, other, plate.to_dict(), check.to_dict())
    check.to_pandas()
    field.to_xarray()
    field.plot()


def measurements(plate: slipline.Plate) -> None:
    frequency_hz = np.linspace(90.0, 200.0, 16)
    measured = slipline.Measurement.from_arrays(frequency_hz, np.ones(16, dtype=complex), place_m=0.03, snr_db=40.0)
    measured.write("measured.csv")
    again = slipline.Measurement.read("measured.csv", plate=plate, place_m=0.03, kind="velocity", snr_db=30.0)
    found = plate.calibrate([measured, again], half_width_m=0.05, end_half_width_m=0.02, length_m=0.4)
    calibrated: slipline.Plate | None = found.plate
    print(calibrated, found.accepted, [parameter.value for parameter in found.parameters])


async def devices(plate: slipline.Plate) -> None:
    ports: list[str] = [port.port for port in slipline.ports()]
    with slipline.connect(ports[0], actual_plate=plate, sensor_m=0.03) as device:
        device.use(plate)
        device.arm()
        drive = device.drive(felt_edge_m=0.21, tones=[{"turning_point_m": 0.16, "level": 0.2}])
        trimmed: slipline.Plate = device.trim(0.034, duration_s=10.0).plate
        shares: list[float] = [later.wave_speed_share for later in device.trim(0.034, level=0.4).later]
        apart_s: float = device.sweep("sweep.toml", duration_s=0.15).apart_s
        kept = device.profile().profile
        name: str | None = kept.name if kept is not None else device.store_profile("name = 'x'").stored
        print(trimmed, shares, apart_s, name, device.erase_profile().stored)
        if drive.at_samples is not None and not drive.superseded:
            end: int = device.stop(at=drive.at_samples + 40_000, glide_s=0.01)
            device.wait(end, timeout=1.0)
        device.wait(drive)
        device.wait(seconds=0.1)
        index: int = await device.wait_async(seconds=0.1)
        waits: asyncio.Task[int] = asyncio.create_task(device.wait_async(seconds=0.1))
        print(await waits)
        device.sequence([{"at": index + 100_000, "turning_point_m": 0.16}, {"at": index + 200_000}])
        for status in device.watch(0.1):
            print(status.state, status.now_samples)
            break
        device.play(plate.texture(solid_m=0.24), at="trigger")
        device.hold(6.0, timeout=1.0)
        measured: slipline.Measurement = device.measure(0.03, points=16, low_hz=90.0, high_hz=180.0, sweep=False)
        print(measured, device.verify(tones=3).equal, device.sample_rate_hz)
        report = device.selftest(sensor_wire=True, trigger_wire=True, amplifier_unplugged=False, short=True)
        device.selftest(amplifier=True)
        level: int = device.brown_out(set=False, power_is_safe=False).brown_out_level
        harmonics = device.measure_harmonics(0.03, points=8, level=0.8)
        stated: slipline.Plate = harmonics.plate
        ratios: list[NDArray[np.float64]] = [one.ratio_db for one in harmonics.harmonics]
        device.drive(turning_point_m=0.16, cancel_harmonics=True)
        device.measure(input="current", amplifier_v=60.0, piezo_f=2e-9, shunt_a=1.0, amplifier_bandwidth_hz=1.2e5, filter_bandwidth_hz=1.2e5)
        print(stated, ratios, plate.check(linear_share=0.88).worst, harmonics.warnings)
        print(report.passed, [step.verdict for step in report.steps], report.steps[0].readings[0].value)
        try:
            device.emergency_stop()
        except slipline.Fault as fault:
            print(fault.faults, fault.remedy)
        device.clear_faults()
        device.reconnect()
        device.disarm()
    slipline.connect().open().close()


def studies(plate: slipline.Plate) -> None:
    vary = {"taper.rate_per_m": {"uniform": 0.02}}
    spec = {"plate": plate, "kind": "2d", "seed": 7, "count": 9, "turning_point_m": [0.12], "results": ["felt_edge_m"], "vary": vary}
    slipline.study.run(spec, "tcp://scheduler:8786", store="study.zarr", retries=1, first_worker_s=3600.0)
    drawn: slipline.Plate = slipline.study.plate(spec, 3)
    objective = slipline.objective(plate, {"taper.rate_per_m": (4.0, 5.5)}, turning_point_m=np.array([0.12]), vary=vary, count=16)
    costs: NDArray[np.float64] = objective(np.zeros((3, 1)))
    print(drawn, costs, objective.names, objective.plate(objective.point(plate)))


def sessions(plate: slipline.Plate, device: slipline.Device) -> None:
    in_use: slipline.Plate | None = device.plate
    with device.rest():
        pass
    device.rest().go_on()
    low = slipline.Staircase(0.19, 0.22, trials=5, staircase="low")
    low.take_answer(low.trial(), True)
    pair = slipline.trials.interleaved(low, slipline.Staircase(0.22, 0.25), seed=1)
    listed = [{"felt_edge_m": 0.21, "level": 0, "iti_s": (1.0, 2.0)}, {"texture": plate.texture(solid_m=0.24), "duration_s": 1.0}]
    rows: slipline.trials.Rows = slipline.trials.run(device, pair, lambda trial: True, folder="study", subject="01", task="edge")
    rows.to_pandas()
    response: str = rows[0]["response"]
    slipline.trials.run(device, listed, len, folder="study", subject="01", task="edge", seed=np.int64(1), max_alike=2, take_break=print)
    print(in_use, rows, response, low)


def typos(plate: slipline.Plate, device: slipline.Device) -> None:
    field = plate.respond(126.0)
    field.amplitud  # refused
    plate.simulate(second=2)  # refused
    plate.simulate(turning_point_m=0.16, seconds=2.0)  # refused
    plate.check().light  # refused
    plate.check().lights[0].color  # refused
    plate.calibrate((), half_width=0.05)  # refused
    slipline.design("latex", 5e-4, (80.0, 220.0), 0.4, tension=68.4)  # refused
    device.drive(turning_point_m="0.16")  # refused
    device.drive(felt_edge=0.21)  # refused
    device.stop(0.1)  # refused
    device.drive(turning_point_m=0.16).at_sample  # refused
    slipline.objective(plate, {}, turning_points_m=[0.12], vary={})  # refused
    slipline.trials.run(device, [], len, folder="study", subject="01")  # refused
    slipline.conect()  # refused
