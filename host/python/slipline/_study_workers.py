"""Who computes the ranges of a study: threads of this computer, or the workers of a Dask cluster."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import lru_cache
from queue import SimpleQueue
from typing import Any

from ._slipline import VERSION, _Study
from .errors import Refused

# How long a cluster may take to have its first worker.
_FIRST_WORKER_S = 60.0


class ThreadWorkers:
    """A thread for each processor that this process may use."""

    def __init__(self, study: _Study) -> None:
        self._study = study
        allowed = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else range(os.cpu_count() or 1)
        self._count = len(allowed)
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

    def __init__(self, study: _Study, address: str) -> None:
        try:
            from distributed import Client, LocalCluster, as_completed
        except ModuleNotFoundError as error:
            raise ModuleNotFoundError(f"{error}; an address needs Dask: pip install slipline[cluster]") from error
        self._text = study.to_toml()
        self._cluster = None
        if address == "local":
            self._cluster = LocalCluster(threads_per_worker=1, dashboard_address=None)
        try:
            self._client = Client(self._cluster or address, set_as_default=False)
            self._client.wait_for_workers(1, timeout=_FIRST_WORKER_S)
        except (OSError, TimeoutError, ValueError) as error:
            self.close()
            raise Refused(f"address = {address!r}: {error}") from error
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
        for it in (getattr(self, "_client", None), self._cluster):
            if it is not None:
                it.close()


def _range(version: str, text: str, first: int, end: int) -> Any:
    """A range of a study, on a worker."""
    if version != VERSION:
        raise Refused(f"a worker has slipline {VERSION}, and the study is one of {version}: its numbers may differ")
    return _study(text).run(first, end)


#: The study of a text; its table is computed once for each process.
_study: Callable[[str], _Study] = lru_cache(maxsize=4)(_Study)
