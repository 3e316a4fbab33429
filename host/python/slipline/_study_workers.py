"""Who computes the ranges of a study: threads of this computer, or the workers of a Dask cluster."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import lru_cache
from queue import SimpleQueue
from types import FrameType
from typing import Any

from ._slipline import VERSION, _Study
from .errors import Refused


class ThreadWorkers:
    """A thread for each processor that this process may use."""

    def __init__(self, study: _Study) -> None:
        self._study = study
        self._count = len(allowed_processors())
        self._pool = ThreadPoolExecutor(self._count, "slipline-study")
        self._done: SimpleQueue[Future[Any]] = SimpleQueue()

    def count(self) -> int:
        """How many ranges are computed at once."""
        return self._count

    def submit(self, first: int, end: int) -> Future[Any]:
        """Begins a range."""
        future: Future[Any] = self._pool.submit(self._study.run, first, end)
        future.add_done_callback(self._done.put)
        return future

    def next_done(self) -> Future[Any]:
        """Waits for one of the ranges that were begun."""
        return self._done.get()

    def close(self) -> None:
        """Begins no further range; what is computed ends by itself, within a chunk."""
        self._pool.shutdown(wait=False, cancel_futures=True)


class ClusterWorkers:
    """The workers of a Dask cluster. They get the specification's text and a range, and send arrays back."""

    def __init__(self, study: _Study, address: str, first_worker_s: float) -> None:
        try:
            from distributed import Client, LocalCluster, as_completed
        except ModuleNotFoundError as error:
            raise ModuleNotFoundError(f"{error}; an address needs Dask: pip install slipline[cluster]") from error
        self._text = study.to_toml()
        # None only until the constructor has ended, or has failed.
        self._client: Any = None
        self._cluster: Any = None
        try:
            with _ctrl_c_is_raised():
                if address == "local":
                    # Without workers at first: what has begun can then be ended, whenever Ctrl-C comes. Nobody looks at the profile
                    # that Dask takes of each worker a hundred times a second, a sixth of its time.
                    config = {"distributed.worker.profile.enabled": False}
                    self._cluster = LocalCluster(n_workers=0, threads_per_worker=1, dashboard_address=None, config=config)
                    self._cluster.scale(len(allowed_processors()))
                self._client = Client(self._cluster or address, set_as_default=False)
                self._client.wait_for_workers(1, timeout=first_worker_s)
        except (OSError, TimeoutError, ValueError) as error:
            self.close()
            raise Refused(f"address = {address!r}: {error}") from error
        except BaseException:
            self.close()
            raise
        self._completed = as_completed(loop=self._client.loop)

    def count(self) -> int:
        """How many ranges are computed at once; workers come and go."""
        return max(1, sum(self._client.nthreads().values()))

    def submit(self, first: int, end: int) -> Any:
        """Begins a range."""
        future = self._client.submit(_range, VERSION, self._text, first, end, pure=False)
        self._completed.add(future)
        return future

    def next_done(self) -> Any:
        """Waits for one of the ranges that were begun."""
        return next(self._completed)

    def close(self) -> None:
        """Leaves the cluster; one that was begun here ends."""
        for it in (self._client, self._cluster):
            if it is not None:
                it.close()


def allowed_processors() -> Collection[int]:
    """The processors that this process may use."""
    return os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else range(os.cpu_count() or 1)


@contextmanager
def _ctrl_c_is_raised() -> Iterator[None]:
    """Whatever a library makes of Ctrl-C inside, ``KeyboardInterrupt`` leaves the block."""
    in_main = threading.current_thread() is threading.main_thread()
    if not in_main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        # Python raises it in the main thread only; a program's own handler stays.
        yield
        return
    is_pressed = False

    def press(number: int, frame: FrameType | None) -> None:
        nonlocal is_pressed
        is_pressed = True
        signal.default_int_handler(number, frame)

    signal.signal(signal.SIGINT, press)
    try:
        yield
    except BaseException as error:
        if is_pressed and not isinstance(error, KeyboardInterrupt):
            raise KeyboardInterrupt from error
        raise
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if is_pressed:
        raise KeyboardInterrupt


def _range(version: str, text: str, first: int, end: int) -> Any:
    """A range of a study, on a worker."""
    if version != VERSION:
        raise Refused(f"a worker has slipline {VERSION}, and the study is one of {version}: its numbers may differ")
    return _study(text).run(first, end)


#: The study of a text; its table is computed once for each process.
_study: Callable[[str], _Study] = lru_cache(maxsize=4)(_Study)
