"""What the tolerances of a plate cost, as a function of its numbers: for optimisers that ask and tell."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._slipline import Plate, _Study
from ._study_workers import allowed_processors
from .errors import BadFile, OutOfRange, Refused
from .study import spec_text

#: The results of a study by their names, each of shape (plates, places), and ``status`` of shape (plates,), 1 for a plate with all
#: its numbers.
Results = Mapping[str, NDArray[Any]]


class Objective:
    """A function of points from 0 to 1 in each of the plate's numbers, to be minimised. Made by :func:`slipline.objective`."""

    def __init__(
        self,
        plate: Plate | str,
        numbers: Mapping[str, tuple[float, float]],
        *,
        turning_point_m: Sequence[float],
        vary: Mapping[str, Mapping[str, float]],
        cost: Callable[[Results], float] | None,
        results: Sequence[str] | None,
        count: int,
        seed: int,
        kind: str,
    ) -> None:
        self._nominal = Plate(plate) if isinstance(plate, str) else plate
        #: The numbers of the plate file that are free, in the order of a point's coordinates.
        self.names = list(numbers)
        self._low, self._high = np.array([numbers[name] for name in self.names], float).reshape(-1, 2).T
        if not self.names or not (self._high > self._low).all():
            raise ValueError(f"numbers = {dict(numbers)!r}: must be names of the plate file with a lower and a higher bound")
        self._cost = cost or _rms_shift_m
        self._spec = {"seed": seed, "count": count, "turning_point_m": list(turning_point_m), "kind": kind, "vary": dict(vary)}
        if results is not None:
            self._spec["results"] = list(results)
        # What is wrong with the specification is said now; what is wrong with a point only makes it bad.
        _Study(spec_text({**self._spec, "plate": self._nominal}))

    def __call__(self, points: ArrayLike) -> Any:
        """The cost of a point, a number; or of several, shape (points, numbers), an array, computed by the threads of this computer.

        A point whose plate is refused, or on which the study is, costs infinity.
        """
        several = np.asarray(points, float)
        if several.shape[-1:] != (len(self.names),) or several.ndim > 2:
            raise ValueError(f"points of shape {several.shape}: must have {len(self.names)} coordinates, of {', '.join(self.names)}")
        if several.ndim == 1:
            return self._of(several)
        with ThreadPoolExecutor(len(allowed_processors()), "slipline-objective") as pool:
            return np.array(list(pool.map(self._of, several)))

    def plate(self, point: ArrayLike) -> Plate:
        """The plate of a point.

        Raises ``OutOfRange`` for one that the plate file refuses.
        """
        share = np.asarray(point, float)
        values = self._low + share * (self._high - self._low)
        return self._nominal.replace(**{name: float(value) for name, value in zip(self.names, values)})

    def point(self, plate: Plate) -> NDArray[np.float64]:
        """The point of a plate, such as that from which an optimiser begins; outside 0 to 1 where the plate is outside the bounds."""
        values = np.array([_number(plate.to_dict(), name) for name in self.names])
        return (values - self._low) / (self._high - self._low)

    def _of(self, point: NDArray[np.float64]) -> float:
        try:
            study = _Study(spec_text({**self._spec, "plate": self.plate(point)}))
        except (OutOfRange, BadFile, Refused):
            return math.inf
        status, _, arrays = study.run(0, study.count)
        found: dict[str, NDArray[Any]] = {name: array for (name, _, _), array in zip(study.results, arrays)}
        cost = float(self._cost({**found, "status": status}))
        return math.inf if math.isnan(cost) else cost


def objective(
    plate: Plate | str,
    numbers: Mapping[str, tuple[float, float]],
    *,
    turning_point_m: Sequence[float],
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
    results, a mapping of arrays (plates, places) and ``status``; without it the cost is the RMS of the first result in metres, where a
    plate without a number counts as a shift of 1 m.

    Raises ``OutOfRange``, ``BadFile`` and ``Refused`` for what is wrong at the plate itself.
    """
    return Objective(
        plate, numbers, turning_point_m=turning_point_m, vary=vary, cost=cost, results=results, count=count, seed=seed, kind=kind
    )


def _rms_shift_m(found: Results) -> float:
    shifts_m = next(array for name, array in found.items() if name.endswith("_shift_m"))
    return float(np.sqrt(np.mean(np.where(np.isnan(shifts_m), 1.0, shifts_m) ** 2)))


def _number(file: Mapping[str, Any], path: str) -> float:
    value: Any = file
    for name in path.split("."):
        value = value[name]
    return float(value)
