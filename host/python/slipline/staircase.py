"""An adaptive staircase over the place of a line.

QUEST+: A. B. Watson, "QUEST+: A general multidimensional Bayesian adaptive psychometric method", Journal of Vision 17(3):10
(2017). The next place is the one after whose answer the entropy of the posterior is expected to be lowest.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import OutOfRange

__all__ = ["Staircase"]

PLACES = ("felt_edge_m", "turning_point_m", "frequency_hz")


#: Most numbers of one of the four tables of a staircase, 32 MB each.
_CELLS_MAX = 4_000_000


class Staircase:
    """Where the answer turns from no to yes, as the place of a line goes from ``low`` to ``high``.

    The chance of a yes at the place x is guess + (1 - guess - lapse) Phi((x - threshold)/spread). Threshold and spread are
    unknown; they are on a grid, where all pairs are as likely at first. :attr:`threshold` and :attr:`spread` are the means of
    the posterior, :attr:`deviation` the standard deviation of the threshold.

    ``place`` is the field that varies: ``felt_edge_m``, ``turning_point_m`` or ``frequency_hz``. ``points`` places from ``low`` to
    ``high`` can be asked, 2 to 2001, and up to 377 with seven ``spreads``. These are those of the grid; by default seven, from a
    hundredth to a third of the range. What ``fields`` holds (``level``, ``duration_s``, ``trial_type``, a column of your own) is that
    of every trial.

    ``slipline.trials.run`` takes a staircase in place of a list of trials, and several by ``slipline.trials.interleaved``. By hand::

        while not staircase.done:
            trial = staircase.trial()
            staircase.take_answer(trial, answer_of(trial))
    """

    def __init__(
        self,
        low: float,
        high: float,
        *,
        place: str = "felt_edge_m",
        trials: int = 40,
        points: int = 101,
        spreads: ArrayLike | None = None,
        guess: float = 0.0,
        lapse: float = 0.02,
        **fields: Any,
    ) -> None:
        if place not in PLACES:
            raise OutOfRange(f"place = {place!r}: must be one of {', '.join(PLACES)}", "place", place)
        if not (is_number(low) and is_number(high) and math.isfinite(low) and math.isfinite(high) and low < high):
            raise OutOfRange(f"low = {low}, high = {high}: low must be below high", "low", low, high=high)
        _check("trials", trials, 1, 100_000)
        _check("points", points, 2, 2001)
        for field, value in (("trials", trials), ("points", points)):
            if value != int(value):
                raise OutOfRange(f"{field} = {value}: must be a whole number", field, value)
        _check("guess", guess, 0.0, 0.9)
        _check("lapse", lapse, 0.0, 0.5)
        if spreads is None:
            spreads = np.geomspace((high - low) / 100, (high - low) / 3, 7)
        try:
            grid = np.atleast_1d(np.asarray(spreads, dtype=float))
        except (TypeError, ValueError):
            grid = np.empty(0)
        if grid.ndim != 1 or grid.size == 0 or not np.all(np.isfinite(grid)) or not np.all(grid > 0):
            raise OutOfRange(f"spreads = {spreads}: must be numbers above 0", "spreads", spreads)
        # The chance of a yes at each place, of each threshold and spread.
        most = math.isqrt(_CELLS_MAX // (4 * grid.size))
        if points > most:
            text = f"points = {points} with {grid.size} spreads: must be 2 to {most}"
            raise OutOfRange(text, "points", points, 2, most)
        self.place = place
        self.trials = int(trials)
        self.fields: Mapping[str, Any] = {"trial_type": "staircase", **fields}
        self.places: NDArray[np.float64] = np.linspace(low, high, int(points))
        # The threshold is known finer than it is asked.
        self.thresholds: NDArray[np.float64] = np.linspace(low, high, 4 * (self.places.size - 1) + 1)
        self.spreads: NDArray[np.float64] = grid
        pairs = (self.thresholds.size, grid.size)
        self._posterior = np.full(pairs, 1.0 / (pairs[0] * pairs[1])).ravel()
        z = (self.places[:, None, None] - self.thresholds[None, :, None]) / grid[None, None, :]
        yes = (guess + (1.0 - guess - lapse) * _normal(z)).reshape(self.places.size, -1)
        # No answer is impossible: a single slip would leave no pair.
        yes = np.clip(yes, 1e-9, 1.0 - 1e-9)
        self._likelihood = {True: yes, False: 1.0 - yes}
        # p ln p of each answer, which the entropy needs at every trial.
        self._entropic = {answer: p * np.log(p) for answer, p in self._likelihood.items()}
        self._answered = 0

    @property
    def done(self) -> bool:
        """Whether all trials have been answered."""
        return self.left <= 0

    @property
    def left(self) -> int:
        """Number of trials to be answered."""
        return self.trials - self._answered

    @property
    def threshold(self) -> float:
        """The mean of the threshold."""
        return float(self._marginal(1) @ self.thresholds)

    @property
    def deviation(self) -> float:
        """The standard deviation of the threshold."""
        return float(np.sqrt(self._marginal(1) @ (self.thresholds - self.threshold) ** 2))

    @property
    def spread(self) -> float:
        """The mean of the spread."""
        return float(self._marginal(0) @ self.spreads)

    def trial(self) -> dict[str, Any]:
        """The next trial; it is the same until it is answered."""
        return {**self.fields, self.place: float(self.places[int(np.argmin(self._expected_entropy()))])}

    def take_answer(self, trial: Mapping[str, Any], answer: bool) -> None:
        """Takes the answer to a trial: true for a yes, false for a no, and nothing else.

        The trial is one of :meth:`trial`, or has another of :attr:`places`.
        """
        if not isinstance(answer, (bool, np.bool_)):
            raise OutOfRange(f"answer = {answer!r}: must be True or False", "answer", answer)
        place: Any = trial.get(self.place)
        if not is_number(place):
            raise OutOfRange(f"{self.place} = {place!r}: the trial must have a place of the staircase", self.place, place)
        off = np.abs(self.places - place)
        asked = int(np.argmin(off))
        low, high = float(self.places[0]), float(self.places[-1])
        # Rounding apart, as of a number that was written with ten digits.
        if not off[asked] <= 1e-6 * (self.places[1] - low):
            text = f"{self.place} = {place}: must be one of the {self.places.size} places from {low:g} to {high:g}"
            raise OutOfRange(text, self.place, place, low, high)
        posterior = self._posterior * self._likelihood[bool(answer)][asked]
        self._posterior = posterior / posterior.sum()
        self._answered += 1

    def __repr__(self) -> str:
        low, high = float(self.places[0]), float(self.places[-1])
        text = f"Staircase({low:g}, {high:g}, place={self.place!r}: {self._answered} of {self.trials} trials"
        return f"{text}, threshold={self.threshold:.6g} +- {self.deviation:.2g})"

    def _marginal(self, axis: int) -> NDArray[np.float64]:
        shape = (self.thresholds.size, self.spreads.size)
        marginal: NDArray[np.float64] = self._posterior.reshape(shape).sum(axis=axis)
        return marginal

    def _expected_entropy(self) -> NDArray[np.float64]:
        # With w = posterior p / c and c = sum(posterior p), the entropy of w times c is
        # c ln c - sum(posterior p ln p) - sum(p posterior ln posterior).
        logarithm = np.log(self._posterior, where=self._posterior > 0, out=np.zeros_like(self._posterior))
        total = np.zeros(self.places.size)
        for answer, likelihood in self._likelihood.items():
            chance = likelihood @ self._posterior
            total += chance * np.log(chance)
            total -= self._entropic[answer] @ self._posterior + likelihood @ (self._posterior * logarithm)
        return total


def _check(field: str, value: float, low: float, high: float) -> None:
    if not is_number(value) or not low <= value <= high:
        raise OutOfRange(f"{field} = {value}: must be {low:g} to {high:g}", field, value, low, high)


def is_number(value: object) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def _normal(z: NDArray[np.float64]) -> NDArray[np.float64]:
    """The normal distribution function; NumPy has none."""
    below: NDArray[np.float64] = np.vectorize(math.erfc, otypes=[float])(-z / math.sqrt(2.0)) / 2.0
    return below
