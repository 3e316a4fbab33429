"""The serial ports: one of a Slipline board, and another one."""

from __future__ import annotations

from types import SimpleNamespace


def comports() -> list[SimpleNamespace]:
    """Two ports."""
    return [SimpleNamespace(device="/dev/ttyACM7", product="Slipline tactile display"), SimpleNamespace(device="/dev/ttyS0", product=None)]
