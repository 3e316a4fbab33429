"""Slipline: drag the boundary on a tapered plate.

>>> import slipline
>>> plate = slipline.Plate("membrane")
>>> plate.respond(126.0).peak_position_m          # metres from the driven end
>>> plate.table().frequency_hz                    # a numpy array

All quantities are SI numbers, and the name of each ends in its unit. The fields of a result are those of the command of the
same name with ``--json``; host/JSON.md has the meaning of each.
"""

from . import results, study, trials
from ._objective import objective
from ._slipline import VERSION as __version__
from ._slipline import Device, Measurement, Plate, _find_numpy, connect, design, ports, presets
from .errors import BadFile, Error, Fault, LinkLost, OutOfRange, Refused, Unattended
from .results import Result
from .staircase import Staircase

__all__ = [
    "BadFile",
    "Device",
    "Error",
    "Fault",
    "LinkLost",
    "Measurement",
    "OutOfRange",
    "Plate",
    "Refused",
    "Result",
    "Staircase",
    "Unattended",
    "__version__",
    "connect",
    "design",
    "objective",
    "ports",
    "presets",
    "results",
    "study",
    "trials",
]

_find_numpy()
