"""Waits of a device that Python code carries out: in ``asyncio``, and as an iterator."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

from .errors import Refused

if TYPE_CHECKING:
    from . import Device
    from .results import Result, Status


async def wait_async(device: Device, at_samples: int | Result | None, seconds: float | None, timeout: float | None) -> int:
    """Waits on a thread of the event loop's executor; after a cancellation that thread ends within 50 ms."""
    cancelled = threading.Event()
    loop = asyncio.get_running_loop()
    try:
        return await loop.run_in_executor(None, device._wait, at_samples, seconds, timeout, cancelled.is_set)
    finally:
        cancelled.set()


def watch(device: Device, period_s: float) -> Iterator[Status]:
    """The status of a device, again and again until it is closed."""
    while not device.closed:
        try:
            status = device.status()
        except Refused:
            if device.closed:
                return
            raise
        yield status
        time.sleep(period_s)
