"""The sign of life of a program that drives a device.

It is given by a thread of Python on purpose: where no Python code can run, no sign comes, and the link's own thread stops
and disarms the device within a second.
"""

from __future__ import annotations

import atexit
import logging
import threading
import time
import weakref
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import Device

# What the link and the device report, at the levels of `logging`. Silent unless the program configures it.
_logger = logging.getLogger("slipline")
_logger.addHandler(logging.NullHandler())

# Ten a second; the link waits for a second.
_PERIOD_S = 0.1

_devices: weakref.WeakSet[Device] = weakref.WeakSet()


def begin(device: Device) -> None:
    """Gives signs of life for this device until it is closed or collected."""
    _devices.add(device)
    reference = weakref.ref(device)
    threading.Thread(target=_sign, args=(reference,), name="slipline alive", daemon=True).start()


def _sign(reference: weakref.ref[Device]) -> None:
    while True:
        device = reference()
        if device is None:
            return
        lives = device._sign()
        for level, line in device._log():
            _logger.log(level, "%s", line)
        if not lives:
            return
        # Held no longer than for the sign, so that the device can be collected.
        del device
        time.sleep(_PERIOD_S)


@atexit.register
def _close_all() -> None:
    for device in list(_devices):
        device._close()
