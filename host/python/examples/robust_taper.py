"""A taper that tolerances harm least: python robust_taper.py [PLATE.toml] [ROUNDS]; needs cma (pip install cma).

CMA-ES (Hansen and Ostermeier, Evolutionary Computation 9, 159, 2001) asks for tapers and receives the cost of the tolerances of each: the
spread of the line's place in mm and of its level in dB, over 64 plates within them. A line moves by the relative change of the wave
speed over the taper's rate, so the search ends near the steepest taper that the bounds allow.
"""

import sys

import cma
import numpy as np
import slipline

target = sys.argv[1] if sys.argv[1:] else "robust.toml"
rounds = int(sys.argv[2]) if sys.argv[2:] else 30


def cost(found):
    """Millimetres and decibels weigh the same; a plate without a line weighs 100."""
    shifts_mm, levels_db = 1e3 * found["turning_point_shift_m"], found["level_db"]
    spread = shifts_mm**2 + (levels_db - np.nanmean(levels_db)) ** 2
    return np.sqrt(np.mean(np.nan_to_num(spread, nan=1e4)))


nominal = slipline.Plate("membrane")
objective = slipline.objective(
    nominal,
    {"taper.rate_per_m": (3.5, 6.0), "taper.half_width_m": (0.035, 0.065)},
    turning_point_m=[0.15, 0.2],
    vary={"model.wave_speed_m_per_s": {"normal": 0.01}, "loss_factor": {"log_normal": 0.3}, "taper.rate_per_m": {"uniform": 0.02}},
    cost=cost,
)
start = objective.point(nominal)
search = cma.CMAEvolutionStrategy(start, 0.2, {"bounds": [0, 1], "seed": 7, "maxiter": rounds, "verbose": -9})
while not search.stop():
    points = search.ask()
    search.tell(points, objective(points))
best = search.result.xbest
with open(target, "w", encoding="utf-8") as file:
    file.write(objective.plate(best).to_toml())
print(f"cost: before {objective(start):.3f}, after {objective(best):.3f}; written: {target}")
