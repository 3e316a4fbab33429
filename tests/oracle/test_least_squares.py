"""Non-negative least squares and the least largest error against scipy's `nnls` and `linprog`.

The program is the example `oracle` of the plate crate; SLIPLINE_ORACLE names it.
"""
import os
import subprocess
import unittest

import numpy as np
from scipy.optimize import linprog, nnls

PROGRAM = os.environ.get("SLIPLINE_ORACLE", "target/debug/examples/oracle")


def humps(random, rows, count):
    """Columns like the fields of neighbouring tones: humps side by side, nearly alike."""
    places = np.linspace(0, 1, rows)[:, None]
    middles, widths = np.linspace(0, 1, count), random.uniform(0.02, 0.12, count)
    return np.exp(-(((places - middles) / widths) ** 2))


def target(random, rows):
    """Steps of random heights."""
    heights = random.uniform(0, 1, random.integers(1, 10))
    return heights[np.arange(rows) * len(heights) // rows]


def solved(problems):
    """What the program finds: x and the least largest error of each."""
    words = []
    for a, b in problems:
        words += [f"{a.shape[0]} {a.shape[1]}", " ".join(map(repr, map(float, a.T.flat))), " ".join(map(repr, map(float, b)))]
    run = subprocess.run([PROGRAM, "least_squares"], input="\n".join(words), capture_output=True, text=True, check=True)
    lines = [np.array(line.split(), float) for line in run.stdout.splitlines()]
    return [(line[:-1], line[-1]) for line in lines]


def largest_error(a, b):
    """min e with -e <= A x - b <= e, x >= 0."""
    rows, count = a.shape
    ones = np.ones((rows, 1))
    result = linprog(
        np.r_[np.zeros(count), 1],
        A_ub=np.block([[a, -ones], [-a, -ones]]),
        b_ub=np.r_[b, -b],
        bounds=[(0, None)] * (count + 1),
        method="highs",
    )
    assert result.success, result.message
    return result.fun


class LeastSquares(unittest.TestCase):
    def test_a_thousand_random_targets_have_scipys_error(self):
        random = np.random.default_rng(1)
        problems = [(humps(random, 40, 30), target(random, 40)) for _ in range(1000)]
        for number, ((a, b), (x, _)) in enumerate(zip(problems, solved(problems), strict=True)):
            error, theirs = np.linalg.norm(a @ x - b), nnls(a, b, maxiter=10_000)[1]
            self.assertLessEqual(abs(error - theirs), 1e-6 * max(theirs, 1e-3), number)
            gradient = a.T @ (b - a @ x)
            breach = np.where(x > 0, np.abs(gradient), np.maximum(gradient, 0)).max()
            self.assertLessEqual(breach, 1e-8 * np.abs(a.T @ b).max(), number)
            self.assertGreaterEqual(x.min(), 0)

    def test_the_least_largest_error_is_linprogs(self):
        random = np.random.default_rng(2)
        problems = [(humps(random, 30, 20), target(random, 30)) for _ in range(50)]
        for number, ((a, b), (_, error)) in enumerate(zip(problems, solved(problems), strict=True)):
            self.assertLessEqual(abs(error - largest_error(a, b)), 1e-6, number)


if __name__ == "__main__":
    unittest.main()
