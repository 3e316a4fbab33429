"""The sign of life of a program that drives a device.

It is given by a thread of Python on purpose: where no Python code can run, no sign comes, and the link's own thread stops
and disarms the device within a second.
"""

from __future__ import annotations

import atexit
import logging
import threading
import time
import traceback
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
    # Two threads: a handler of the program's that is slow, or fails, must not keep a sign back.
    for target, name in ((_sign, "slipline alive"), (_write_log, "slipline log")):
        threading.Thread(target=target, args=(reference,), name=name, daemon=True).start()


def _sign(reference: weakref.ref[Device]) -> None:
    while (device := reference()) is not None and device._sign():
        # Held no longer than for the sign, so that the device can be collected.
        del device
        time.sleep(_PERIOD_S)


def _write_log(reference: weakref.ref[Device]) -> None:
    while (device := reference()) is not None:
        is_last = device.closed
        lines = device._log()
        del device
        for level, line in lines:
            try:
                _logger.log(level, "%s", line)
            except Exception:  # A filter's or a handler's own: the lines after it are written.
                traceback.print_exc()
        if is_last:
            return
        time.sleep(_PERIOD_S)


@atexit.register
def _close_all() -> None:
    for device in list(_devices):
        device._close()
