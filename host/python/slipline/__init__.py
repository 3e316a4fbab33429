"""Slipline: drag the boundary on a tapered plate.

All quantities are SI numbers, and the name of each ends in its unit.
"""

from ._slipline import __version__
from .errors import BadFile, Error, LinkLost, OutOfRange, Refused, Unattended

__all__ = ["BadFile", "Error", "LinkLost", "OutOfRange", "Refused", "Unattended", "__version__"]
