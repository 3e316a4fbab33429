"""The calibration by the ratio of two places against scipy's `least_squares`, on the same data.

Wave, residuals and priors are written from PHYSICS.md (sections 1, 2 and 9) once more. The program is the example
`oracle` of the plate crate; SLIPLINE_ORACLE names it.
"""
import os
import subprocess
import unittest

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

PROGRAM = os.environ.get("SLIPLINE_ORACLE", "target/debug/examples/oracle")
STEPS = 2000
# Wave speed, loss, taper, width, how far the edges give (0.3 mm), and the places.
PRIORS = np.array([0.1, 1.0, 4e-3, 3e-3, 3e-4, 2e-4, 2e-4])
OF_PLATE = 5
MODEL_ERROR = 0.015


class Membrane:
    """The preset `membrane`; the calibration fits its coordinates."""

    name, length, frequencies = "membrane", 0.32, np.geomspace(82.0, 233.0, 60)
    bend = 1.0
    names = ["model.wave_speed_m_per_s", "loss_factor", "taper.rate_per_m", "taper.half_width_m", "edge_give_m"]
    names += ["place_m", "place_m"]

    @staticmethod
    def numbers(u):
        return np.array([12.0 * np.exp(u[0]), 0.03 * np.exp(u[1]), 4.62 * (1 + u[2]), 0.05 * np.exp(u[3]), u[4]])

    @staticmethod
    def wavenumber_squared(numbers, omega):
        speed, loss = numbers[:2]
        return (omega / speed) ** 2 * (1 + 1j * loss)


class Aluminium:
    """The preset `al-bending`: a thin plate on supported edges."""

    name, length, frequencies = "al-bending", 0.34, np.geomspace(17.5e3, 44.5e3, 150)
    bend = 2 * 0.33 - 1
    names = ["model.youngs_modulus_pa"] + Membrane.names[1:]

    @staticmethod
    def numbers(u):
        return np.array([70e9 * np.exp(4 * u[0]), 0.002 * np.exp(u[1]), 4.62 * (1 + u[2]), 0.02 * np.exp(u[3]), u[4]])

    @staticmethod
    def wavenumber_squared(numbers, omega):
        modulus, loss = numbers[:2]
        stiffness = modulus * 0.002**3 / (12 * (1 - 0.33**2))
        return omega * np.sqrt(2700 * 0.002 / stiffness) * (1 + 0.5j * loss)


def wave(plate, u):
    """Magnitudes of f at both places, one row per frequency: Numerov's method from beyond the turning point."""
    numbers = plate.numbers(u)
    rate, half_width, give = numbers[2:]
    h = plate.length / STEPS
    x = np.arange(int(1.6 * STEPS)) * h
    cut = half_width * np.exp(-rate * x)
    width = cut + give
    slope, curvature = -rate * cut / width, rate**2 * cut / width
    # The arc that meets both edges at right angles, the term of edges that bend, and (sqrt W)''/sqrt W.
    barrier = (np.pi / 2 * slope / np.arctan(slope * width)) ** 2 + (1 - plate.bend) * curvature / 2 - slope**2 / 4
    k2 = plate.wavenumber_squared(numbers, 2 * np.pi * plate.frequencies)
    q = k2[None, :] - barrier[:, None]
    p = 1 + h * h / 12 * q
    y = np.zeros_like(p)
    y[-1], y[-2] = 1e-200, 1e-200 * np.exp(h * np.sqrt(-q[-1]))
    for i in range(len(x) - 2, 0, -1):
        y[i - 1] = (12 / p[i] - 10) * y[i] - y[i + 1]
        # The solution grows by many powers of ten on its way to the drive.
        if i % 50 == 0:
            y[i - 1 :] /= np.abs(y[i - 1])
    on_plate = slice(0, STEPS + 1)
    field = (y / p)[on_plate] / np.sqrt(width[on_plate])[:, None]
    return np.abs(CubicSpline(x[on_plate], field)(np.array(plate.places) + u[OF_PLATE:])).T


def residuals(u, plate, data):
    p = wave(plate, u)
    square = np.abs(data["response"]) ** 2 - 2 * np.log(2) * data["noise"] ** 2
    magnitude = np.sign(square) * np.sqrt(np.abs(square))
    v = data["noise"] ** 2 + (MODEL_ERROR * magnitude) ** 2
    spread = v[:, 0] * p[:, 1] ** 2 + v[:, 1] * p[:, 0] ** 2
    of_data = (magnitude[:, 0] * p[:, 1] - magnitude[:, 1] * p[:, 0]) / np.sqrt(spread)
    return np.r_[of_data, u / PRIORS]


def measured(plate, truth, random):
    """An unknown source, 40 dB above the noise."""
    p = wave(plate, truth)
    n = len(plate.frequencies)
    t = np.linspace(0, 1, n)
    source = np.exp(np.sin(5 * t + random.uniform(0, 6)) + 1j * random.uniform(5, 40) * t)
    # All rows of the wave have their own scale: that of a wave which is 1 at the first place's largest.
    clean = source[:, None] * p / p.max(axis=1)[:, None]
    noise = 0.01 * np.sqrt((np.abs(clean) ** 2).mean(axis=0)) * np.ones((n, 1))
    response = clean + noise * (random.normal(size=clean.shape) + 1j * random.normal(size=clean.shape))
    return {"response": response, "noise": noise}


def calibrated(plate, data):
    """The program's parameters: rows of value, low and high; then chi^2 per residual."""
    rows = zip(plate.frequencies, data["response"], data["noise"], strict=True)
    words = [plate.name, *plate.places, *PRIORS[OF_PLATE:], len(plate.frequencies)]
    for frequency, response, noise in rows:
        words.append(frequency)
        words += [word for r, s in zip(response, noise, strict=True) for word in (r.real, r.imag, s)]
    text = " ".join(word if isinstance(word, str) else repr(float(word)) for word in words)
    run = subprocess.run([PROGRAM, "calibrate"], input=text, capture_output=True, text=True, check=True)
    lines = [line.split() for line in run.stdout.splitlines()]
    return [line[0] for line in lines[:-1]], np.array([line[1:] for line in lines[:-1]], float), float(lines[-1][0])


class Calibration(unittest.TestCase):
    def compare(self, plate, seed):
        random = np.random.default_rng(seed)
        truth = np.r_[random.uniform([-0.05, -0.6, -4e-3, -3e-3, -3e-4], [0.05, 0.9, 4e-3, 3e-3, 3e-4]), 0, 0]
        data = measured(plate, truth, random)
        names, found, chi2 = calibrated(plate, data)
        self.assertEqual(names, plate.names)
        # In the units of the priors: a derivative over a step that suits the speed says nothing of a tenth of a millimetre.
        fit = least_squares(
            lambda z: residuals(z * PRIORS, plate, data), truth / PRIORS, jac="3-point", diff_step=1e-4, xtol=1e-11, ftol=1e-14
        )
        best = fit.x * PRIORS
        theirs = np.r_[plate.numbers(best), np.array(plate.places) + best[OF_PLATE:]]
        interval = found[:, 2] - found[:, 1]
        for name, mine, their, width in zip(names, found[:, 0], theirs, interval, strict=True):
            self.assertLessEqual(abs(mine - their), 1e-3 * width, f"{plate.name} {seed} {name}: {mine} {their} {width}")
        self.assertLessEqual(abs(chi2 * len(plate.frequencies) - 2 * fit.cost), 1e-3, f"{plate.name} {seed}")
        # The interval itself: 1.96 standard deviations of scipy's covariance to both sides.
        deviation = PRIORS * np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))
        scale = 1.96 * max(1.0, np.sqrt(chi2))
        ends = [plate.numbers(best + side * scale * np.r_[deviation[:OF_PLATE], 0, 0]) for side in (-1, 1)]
        theirs = np.r_[ends[1] - ends[0], 2 * scale * deviation[OF_PLATE:]]
        self.assertLessEqual(np.abs(interval / theirs - 1).max(), 1e-3, f"{plate.name} {seed}: {interval} {theirs}")

    def test_membranes(self):
        Membrane.places = [0.1 * Membrane.length, 0.55 * Membrane.length]
        for seed in range(2):
            self.compare(Membrane, seed)

    def test_aluminium(self):
        Aluminium.places = [0.1 * Aluminium.length, 0.55 * Aluminium.length]
        self.compare(Aluminium, 7)


if __name__ == "__main__":
    unittest.main()
