"""The amplitude equation at many frequencies: scipy's banded solver, second order, one frequency after the other.

f'' + (W'/W) f' + k^2 f = 0 on an exponential taper in bending, f(0) = 1 and f(L) = 0, k^2 = kb^2 (1 + j eta/2) -
(pi/2W)^2. The plate is the preset `al-bending-displacement`.
"""

import pathlib
import time
import tomllib

import numpy as np
from scipy.linalg import solve_banded

PRESET = pathlib.Path(__file__).parents[2] / "presets" / "al-bending-displacement.toml"


def on_solve_banded(points, frequencies, runs):
    """(milliseconds for all frequencies, largest |f| at frequency 40)."""
    plate = tomllib.loads(PRESET.read_text())
    taper, model = plate["taper"], plate["model"]
    half_width, rate, length = taper["half_width_m"], taper["rate_per_m"], plate["length_m"]
    thickness, nu = model["thickness_m"], model["poisson_ratio"]
    stiffness = model["youngs_modulus_pa"] * thickness**3 / (12 * (1 - nu**2))
    spread = np.sqrt(stiffness / (model["density_kg_per_m3"] * thickness))
    eta = plate["loss_factor"] / 2
    x = np.linspace(0, length, points)
    h = x[1] - x[0]
    width_term = (np.pi / (2 * half_width * np.exp(-rate * x))) ** 2
    solutions = {}

    def run():
        for number, frequency in enumerate(frequencies):
            k2 = 2 * np.pi * frequency / spread * (1 + 1j * eta) - width_term
            bands = np.zeros((3, points), complex)
            bands[0, 1:] = 1 / h**2 - rate / (2 * h)
            bands[1] = -2 / h**2 + k2
            bands[2, :-1] = 1 / h**2 + rate / (2 * h)
            right = np.zeros(points, complex)
            bands[1, 0], bands[0, 1], right[0] = 1, 0, 1
            bands[1, -1], bands[2, -2] = 1, 0
            solutions[number] = solve_banded((1, 1), bands, right, overwrite_ab=True, overwrite_b=True)

    times = []
    for _ in range(runs):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times) * 1e3, float(np.abs(solutions[40]).max())
