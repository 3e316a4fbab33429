"""Draws where the plate vibrates for three tones, one picture of it: python envelope.py [PICTURE.png]"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import slipline

plate = slipline.Plate("membrane")
table = plate.table()
places_m = (0.12, 0.18, 0.24)
# The table has the frequency of each turning point.
field = plate.respond(np.interp(places_m, table.position_m, table.frequency_hz))

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for frequency_hz, turning_point_m, amplitude in zip(field.frequency_hz, field.turning_point_m, field.amplitude):
    (line,) = axes.plot(1e3 * field.position_m, np.abs(amplitude) / np.abs(amplitude).max(), label=f"{frequency_hz:.1f} Hz")
    axes.axvline(1e3 * turning_point_m, color=line.get_color(), linestyle=":", linewidth=1)
axes.set(title=f"{plate.name}: amplitude, and the turning point", xlabel="place / mm", ylabel="amplitude / its peak", ylim=(0, None))
axes.legend()
picture = sys.argv[1] if sys.argv[1:] else "envelope.png"
figure.savefig(picture, dpi=150)
print(f"written: {picture}")
