"""Measures a plate at two places, fits the plate file to it, and writes that: python measure_and_calibrate.py [PLATE.toml]

The device is simulated, on a plate whose loss and taper are not those of its file. With a real one: connect("/dev/ttyACM0").
"""

import sys
from pathlib import Path

import slipline

path = Path(sys.argv[1] if sys.argv[1:] else "calibrated.toml")
plate = slipline.Plate("al-bending")
# The actual plate is one that a study of its tolerances draws.
tolerances = {"loss_factor": {"log_normal": 0.2}, "taper.rate_per_m": {"uniform": 0.01}}
spec = {"plate": "al-bending", "seed": 3, "count": 1, "turning_point_m": [sum(plate.span_m) / 2], "vary": tolerances}
actual = slipline.study.plate(spec, 0)

measurements = []
for share in (0.1, 0.4):
    place_m = share * plate.length_m
    with slipline.connect("sim", actual_plate=actual, sensor_m=place_m) as device:
        device.use(plate)
        measurements.append(device.measure(place_m, points=48))
        print(f"measured at {1e3 * place_m:.0f} mm: {len(measurements[-1].frequency_hz)} frequencies")

found = plate.calibrate(measurements)
if found.plate is None:
    sys.exit(f"not calibrated: {found.reason}")
for parameter in found.parameters:
    print(f"{parameter.name}: {parameter.value:.6g}")
path.write_text(found.plate.to_toml())
print(f"written: {path}; the turning points are known to {1e3 * found.turning_point_tolerance_m:.2f} mm")
