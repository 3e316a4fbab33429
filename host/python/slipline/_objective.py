"""What the tolerances of a plate cost, as a function of its numbers: for optimisers that ask and tell."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from threading import Event
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._slipline import Plate
from ._study_workers import allowed_processors
from .errors import BadFile, OutOfRange, Refused
from .study import study_of

#: The results of a study by their names, each of shape (plates, places), and ``status`` of shape (plates,), 1 for a plate with all
#: its numbers.
Results = Mapping[str, NDArray[Any]]


#: Plates that are computed between two looks at Ctrl-C.
_STEP = 500
#: What is raised for a point whose plate is refused, or on which the study is.
_BAD_POINT = (OutOfRange, BadFile, Refused)


class Objective:
    """A function of points from 0 to 1 in each of the plate's numbers, to be minimised. Made by :func:`slipline.objective`."""

    def __init__(
        self,
        plate: Plate | str | os.PathLike[str],
        numbers: Mapping[str, tuple[float, float]],
        *,
        turning_point_m: ArrayLike,
        vary: Mapping[str, Mapping[str, float]],
        cost: Callable[[Results], float] | None,
        results: Sequence[str] | None,
        count: int,
        seed: int,
        kind: str,
    ) -> None:
        self._nominal = plate if isinstance(plate, Plate) else Plate(plate)
        #: The numbers of the plate file that are free, in the order of a point's coordinates.
        self.names = list(numbers) if isinstance(numbers, Mapping) else []
        self._low, self._high = _bounds(numbers)
        self._spec = {"seed": seed, "count": count, "turning_point_m": turning_point_m, "kind": kind, "vary": vary}
        if results is not None:
            self._spec["results"] = results
        # What is wrong with the names or the specification is said now; what is wrong with a point only makes it bad.
        with suppress(*_BAD_POINT):
            self.plate(np.zeros(len(self.names)))
        study = study_of({**self._spec, "plate": self._nominal})
        if cost is None and not any(name.endswith("_shift_m") for name, _, _ in study.results):
            names = ", ".join(name for name, _, _ in study.results)
            raise ValueError(f"cost = None: must be a function of the results {names}, none of which is a shift")
        if cost is not None and not callable(cost):
            raise TypeError(f"cost = {cost!r}: must be a function of the results")
        self._cost = cost or _rms_shift_m

    def __call__(self, points: ArrayLike) -> Any:
        """The cost of a point, a number; or of several, shape (points, numbers), an array, computed by the threads of this computer.

        A point whose plate is refused, or on which the study is, costs infinity.
        """
        several = self._points(points, 2)
        if several.ndim == 1:
            return self._of(several, Event())
        ends = Event()
        with ThreadPoolExecutor(len(allowed_processors()), "slipline-objective") as pool:
            try:
                return np.array(list(pool.map(lambda point: self._of(point, ends), several)))
            finally:
                # After Ctrl-C the points under way are left.
                ends.set()

    def plate(self, point: ArrayLike) -> Plate:
        """The plate of a point.

        Raises ``OutOfRange`` for one that the plate file refuses.
        """
        values = self._low + self._points(point, 1) * (self._high - self._low)
        return self._nominal.replace(**{name: float(value) for name, value in zip(self.names, values)})

    def point(self, plate: Plate) -> NDArray[np.float64]:
        """The point of a plate, such as that from which an optimiser begins; outside 0 to 1 where the plate is outside the bounds."""
        values = np.array([_number(plate, name) for name in self.names])
        share: NDArray[np.float64] = (values - self._low) / (self._high - self._low)
        return share

    def _points(self, points: ArrayLike, most: int) -> NDArray[np.float64]:
        """Points as an array of up to this many dimensions."""
        several = np.asarray(points, float)
        if several.shape[-1:] != (len(self.names),) or several.ndim > most:
            raise ValueError(f"points of shape {several.shape}: must have {len(self.names)} coordinates, of {', '.join(self.names)}")
        return several

    def _of(self, point: NDArray[np.float64], ends: Event) -> float:
        try:
            study = study_of({**self._spec, "plate": self.plate(point)})
        except _BAD_POINT:
            return math.inf
        names = [*(name for name, _, _ in study.results), "status"]
        parts: dict[str, list[NDArray[Any]]] = {name: [] for name in names}
        # A call into the compiled part is over before Python sees Ctrl-C.
        step = 1 if study.is_2d else _STEP
        for first in range(0, study.count, step):
            if ends.is_set():
                return math.nan
            status, _, arrays = study.run(first, first + step)
            for name, array in zip(names, (*arrays, status)):
                parts[name].append(array)
        cost = float(self._cost({name: np.concatenate(arrays) for name, arrays in parts.items()}))
        return math.inf if math.isnan(cost) else cost


def objective(
    plate: Plate | str | os.PathLike[str],
    numbers: Mapping[str, tuple[float, float]],
    *,
    turning_point_m: ArrayLike,
    vary: Mapping[str, Mapping[str, float]],
    cost: Callable[[Results], float] | None = None,
    results: Sequence[str] | None = None,
    count: int = 64,
    seed: int = 1,
    kind: str = "1d",
) -> Objective:
    """A function that says what the tolerances ``vary`` cost a plate, for any optimiser that asks for points and receives their costs::

        objective = slipline.objective("membrane", {"taper.rate_per_m": (3.5, 5.5)}, turning_point_m=[0.12, 0.2],
                                       vary={"model.wave_speed_m_per_s": {"normal": 0.01}})
        search = cma.CMAEvolutionStrategy(objective.point(slipline.Plate("membrane")), 0.2, {"bounds": [0, 1]})
        while not search.stop():
            points = search.ask()
            search.tell(points, objective(points))
        objective.plate(search.result.xbest).to_toml()

    ``numbers`` are the free numbers of the plate file with their bounds. At each point a study draws ``count`` plates around that
    point's plate; ``turning_point_m``, ``vary``, ``results``, ``seed`` and ``kind`` are those of the specification, see
    :mod:`slipline.study`. The draws are the same at every point, so that the cost is a smooth function. ``cost`` makes a number of the
    results, a mapping of arrays (plates, places) and ``status``; without it the cost is the RMS of the first result that is a shift,
    where a plate without a number counts as a shift of 1 m.

    Raises ``OutOfRange``, ``BadFile`` and ``Refused`` for what is wrong at the plate itself.
    """
    return Objective(
        plate, numbers, turning_point_m=turning_point_m, vary=vary, cost=cost, results=results, count=count, seed=seed, kind=kind
    )


def _bounds(numbers: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The lower and the upper bounds."""
    try:
        low, high = np.array([[float(end) for end in pair] for pair in numbers.values()]).T
    except (AttributeError, TypeError, ValueError):
        low = high = np.zeros(1)
    if not (np.isfinite([low, high]).all() and (high > low).all()):
        raise ValueError(f"numbers = {numbers!r}: must be names of the plate file with a lower and a higher bound")
    return low, high


def _rms_shift_m(found: Results) -> float:
    shifts_m = next(array for name, array in found.items() if name.endswith("_shift_m"))
    return float(np.sqrt(np.mean(np.where(np.isnan(shifts_m), 1.0, shifts_m) ** 2)))


def _number(plate: Plate, path: str) -> float:
    value: Any = plate.to_dict()
    for name in path.split("."):
        if name not in value:
            raise ValueError(f"{path}: the plate {plate.name!r} has no such number")
        value = value[name]
    return float(value)
