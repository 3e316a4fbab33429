"""Finds by a staircase where an observer feels the boundary: python trials.py [FOLDER] [TRIALS]

The observer is simulated here: put a question to a person into ``respond``. FOLDER is a BIDS dataset with the rows in
sub-01/ses-01/beh; called again with the same folder it goes on.
"""

import sys

import numpy as np
import slipline

folder = sys.argv[1] if sys.argv[1:] else "study"
count = int(sys.argv[2]) if sys.argv[2:] else 40
observer = np.random.default_rng(1)
FELT_AT_M = 0.168


def respond(trial):
    """Whether the boundary was felt beyond the mark; an observer whose place has a standard deviation of 3 mm."""
    return trial["turning_point_m"] > observer.normal(FELT_AT_M, 3e-3)


staircase = slipline.Staircase(0.12, 0.22, place="turning_point_m", trials=count, level=0.6, duration_s=0.1)
with slipline.connect("sim") as device:
    device.use(slipline.Plate("membrane"))
    device.arm()
    rows = slipline.trials.run(device, staircase, respond, folder=folder, subject="01", task="edge")
print(f"{len(rows)} trials: felt at {1e3 * staircase.threshold:.1f} mm; the observer's place is {1e3 * FELT_AT_M:.1f} mm")
