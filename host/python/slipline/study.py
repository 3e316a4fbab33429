"""Studies: many plates drawn around a nominal one, on the threads of this computer or on a cluster.

::

    found = slipline.study.run("study.toml", store="study.zarr")             # threads here
    found = slipline.study.run("study.toml", "local", store="study.zarr")    # processes here, by Dask
    found = slipline.study.run("study.toml", "tcp://scheduler:8786", store="study.zarr")
    found.turning_point_shift_m.std("plate")                                 # metres, at each place

The specification is that of ``slipline study``; host/plate/PLATES.md has its fields. Each plate has the same bits wherever it
is computed. A study that was interrupted, by Ctrl-C or by a power cut, goes on with the same call. Needs zarr and xarray
(``pip install slipline[study]``), and Dask for an address (``pip install slipline[cluster]``).

A program that names ``"local"`` needs ``if __name__ == "__main__":``, as any program of several processes.
"""

from __future__ import annotations

import os
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

from ._slipline import Plate, _Study
from ._study_store import StudyStore
from ._study_workers import ClusterWorkers, ThreadWorkers
from .errors import BadFile, Error, OutOfRange

__all__ = ["plate", "run"]

Spec = str | os.PathLike[str] | Mapping[str, Any]

# Time of a chunk: long against what a chunk costs beside its plates, short against the wait for the last one.
_CHUNK_S = 0.7
# The largest specification: slipline study reads no larger one.
_SPEC_BYTES_MAX = 1 << 21
_RETRIES_MAX = 1000


def run(spec: Spec, address: str | None = None, *, store: str | os.PathLike[str], chunk: int | None = None, retries: int = 2) -> Any:
    """Computes the plates that ``store`` does not have yet, and returns the store, opened as an ``xarray.Dataset``.

    ``spec`` is a TOML file or a dictionary of the same fields, whose ``plate`` may be a :class:`slipline.Plate`. Without
    ``address`` the threads of this computer compute; ``"local"`` is a Dask cluster of processes here, ``"tcp://.."`` the
    scheduler of one elsewhere, whose workers need this package but neither the specification's files nor the store.
    ``chunk`` is the number of plates that are computed at once, fixed when the store is made; by default what takes 0.7 s
    here. A chunk that fails, because its worker died or for any other reason, is computed again up to ``retries`` times.

    The store, a Zarr folder, has ``turning_point_shift_m`` and ``level_db`` over (plate, place), ``status`` and a variable
    ``vary_..`` for each field that varies over plate, ``place_m`` over place. A plate that the plate file refuses, or that has
    no boundary at a place, has NaN, and its status says why.

    Raises ``OutOfRange`` and ``BadFile`` for the specification; ``BadFile`` if the store is that of another specification,
    seed, chunk or version of this package.
    """
    study = _Study(_text(spec))
    if not 0 <= retries <= _RETRIES_MAX:
        raise OutOfRange(f"retries = {retries}: must be 0 to {_RETRIES_MAX}", "retries", retries, 0, _RETRIES_MAX)
    if chunk is not None and not 1 <= chunk <= study.count:
        raise OutOfRange(f"chunk = {chunk}: must be 1 to {study.count}", "chunk", chunk, 1, study.count)
    kept = StudyStore.open(Path(store), study, chunk, lambda: _plates_of_a_chunk(study))
    due = kept.due()
    if due:
        workers = ThreadWorkers(study) if address is None else ClusterWorkers(study, address)
        try:
            _compute(kept, due, workers, retries)
        finally:
            workers.close()
    return kept.dataset()


def plate(spec: Spec, i: int) -> Plate:
    """Plate ``i`` of a study, from 0.

    Raises ``OutOfRange`` if there is none, and for a number that the plate file refuses.
    """
    return _Study(_text(spec)).plate(i)


def _compute(kept: StudyStore, due: list[tuple[int, int]], workers: ThreadWorkers | ClusterWorkers, retries: int) -> None:
    """Computes these ranges and writes each as it comes: this process alone writes."""
    failed: Counter[int] = Counter()
    progress = _Progress(kept.count, sum(end - first for first, end in due))
    waiting = due[::-1]
    in_flight: dict[Any, tuple[int, int]] = {}
    try:
        while waiting or in_flight:
            # Two for each: one more is ready when one is done.
            while waiting and len(in_flight) < 2 * workers.count():
                span = waiting.pop()
                in_flight[workers.submit(*span)] = span
            future = workers.next_done()
            span = in_flight.pop(future)
            try:
                results = future.result()
            except Error:
                raise
            except Exception:
                failed[span[0]] += 1
                if failed[span[0]] > retries:
                    raise
                waiting.append(span)
                continue
            kept.write(span, results)
            progress.add(span[1] - span[0])
    finally:
        progress.end()


def _plates_of_a_chunk(study: _Study) -> int:
    """The plates of about 0.7 s on this computer, by a probe."""
    plates = 1
    while True:
        begin_s = time.perf_counter()
        study.run(0, plates)
        took_s = time.perf_counter() - begin_s
        if took_s > 0.03 or plates >= study.count:
            return max(1, min(study.count, round(_CHUNK_S * plates / took_s)))
        plates = min(4 * plates, study.count)


class _Progress:
    """A line on the standard error: how much is done, and the time left."""

    def __init__(self, count: int, due: int) -> None:
        self._count, self._due, self._done = count, due, 0
        self._begin_s = self._shown_s = time.monotonic()

    def add(self, plates: int) -> None:
        self._done += plates
        now_s = time.monotonic()
        if now_s - self._shown_s < 0.5:
            return
        self._shown_s = now_s
        left_s = (self._due - self._done) * (now_s - self._begin_s) / self._done
        done = self._count - self._due + self._done
        print(f"\rstudy: {done} of {self._count} plates, {left_s:.0f} s left   ", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self._shown_s != self._begin_s:
            print(file=sys.stderr)


def _text(spec: Spec) -> str:
    """The text of a specification: of a file, or of its fields."""
    if isinstance(spec, Mapping):
        fields = dict(spec)
        if isinstance(fields.get("plate"), Plate):
            fields["plate"] = tomllib.loads(fields["plate"].to_toml())
        return "".join(f"{_toml(str(name))} = {_toml(value)}\n" for name, value in fields.items())
    path = Path(spec)
    try:
        with path.open("rb") as file:
            text = file.read(_SPEC_BYTES_MAX + 1)
        return text.decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadFile(f"{path}: {getattr(error, 'strerror', None) or error}") from error


def _toml(value: object) -> str:
    """A value in TOML."""
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return '"' + "".join(letter if ord(letter) > 31 and letter != "\x7f" else f"\\u{ord(letter):04x}" for letter in escaped) + '"'
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value)).lower()
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_toml(str(name))} = {_toml(item)}" for name, item in value.items()) + " }"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_toml(item) for item in cast(Any, value)) + "]"
    raise TypeError(f"a specification has no {type(value).__name__}: {value!r}")
