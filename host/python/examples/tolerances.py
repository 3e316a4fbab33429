"""Which tolerance of a plate costs most: python tolerances.py [STORE.zarr] [PLATES]

Of a study, the share of each field in the variance of the boundary's place, by a linear fit to the fields: the squares of the
standardised regression coefficients, which add up to R^2 where the fields vary independently (Saltelli et al., "Global
Sensitivity Analysis: The Primer", Wiley 2008, section 1.2.5). What R^2 lacks of 1 is not linear.
"""

import sys

import numpy as np
import slipline

store = sys.argv[1] if sys.argv[1:] else "tolerances.zarr"
spec = {
    "plate": "membrane",
    "seed": 7,
    "count": int(sys.argv[2]) if sys.argv[2:] else 2000,
    "turning_point_m": [0.12, 0.18, 0.24],
    "vary": {
        "model.wave_speed_m_per_s": {"normal": 0.01},
        "loss_factor": {"log_normal": 0.3},
        "taper.rate_per_m": {"uniform": 0.02},
    },
}
found = slipline.study.run(spec, store=store)
found = found.isel(plate=found.status.values == 1)
names = [name for name in found if name.startswith("vary_")]
fields = np.stack([found[name].values for name in names], axis=1)
fields = (fields - fields.mean(axis=0)) / fields.std(axis=0)

print(f"{found.sizes['plate']} plates; share of each field in the variance of the boundary's place")
print("place / mm", *(f"{name.removeprefix('vary_'):>27}" for name in names), "R^2", "deviation / mm", sep="  ")
for place, place_m in enumerate(found.place_m.values):
    shift_m = found.turning_point_shift_m.values[:, place]
    deviation_m = shift_m.std()
    wanted = (shift_m - shift_m.mean()) / deviation_m
    coefficients, *_ = np.linalg.lstsq(fields, wanted, rcond=None)
    r_squared = 1 - np.mean((wanted - fields @ coefficients) ** 2)
    shares = (f"{100 * share:25.1f} %" for share in coefficients**2)
    print(f"{1e3 * place_m:10.0f}", *shares, f"{r_squared:.3f}", f"{1e3 * deviation_m:.3f}", sep="  ")
