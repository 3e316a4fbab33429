"""Waits of a device that Python code carries out: in ``asyncio``, and as an iterator."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from functools import partial
from typing import TYPE_CHECKING

from .errors import Refused

if TYPE_CHECKING:
    from . import Device
    from .results import Result, Status


#: Longest time between two looks at what ends a pause.
_GLANCE_S = 0.05


async def wait_async(device: Device, at_samples: int | Result | None, seconds: float | None, timeout: float | None) -> int:
    """Waits on a thread of its own; after a cancellation that thread ends within 50 ms.

    The executor of the event loop has few threads: where waits take all of them, the call that would end them never begins.
    """
    cancelled = threading.Event()
    try:
        return await asyncio.wrap_future(on_a_thread(partial(device._wait, at_samples, seconds, timeout, cancelled.is_set)))
    finally:
        cancelled.set()


def on_a_thread(call: Callable[[], int]) -> Future[int]:
    """A call that runs on a thread of its own, which the end of the program does not wait for."""
    future: Future[int] = Future()
    # It runs: whoever waits for it can be cancelled, and it cannot.
    future.set_running_or_notify_cancel()

    def run() -> None:
        try:
            future.set_result(call())
        except BaseException as error:
            future.set_exception(error)

    threading.Thread(target=run, name="slipline wait", daemon=True).start()
    return future


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
        until_s = time.monotonic() + period_s
        # Another thread may close the device meanwhile.
        while not device.closed and (left_s := until_s - time.monotonic()) > 0:
            time.sleep(min(left_s, _GLANCE_S))
