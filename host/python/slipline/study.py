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

With ``kind = "2d"`` each plate is solved in two dimensions: in milliseconds, with air in up to a second for each place. A chunk is one
plate then, and a plate at which the workers have failed more than ``retries`` times is a row with the status ``worker_failed``, which
the next call tries again. A worker needs 100 MB besides Dask's own memory. On a cluster with a queue of jobs, by ``dask-jobqueue``::

    from dask_jobqueue import SLURMCluster                                   # or PBSCluster, SGECluster ..

    if __name__ == "__main__":
        cluster = SLURMCluster(cores=1, processes=1, memory="1GB", walltime="04:00:00")
        cluster.adapt(minimum_jobs=1, maximum_jobs=200)
        spec = {"plate": "membrane", "kind": "2d", "seed": 7, "count": 5000, "turning_point_m": [0.12, 0.18],
                "vary": {"taper.rate_per_m": {"uniform": 0.02}}}
        slipline.study.run(spec, cluster.scheduler_address, store="study.zarr", first_worker_s=86400)
"""

from __future__ import annotations

import os
import re
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ._slipline import Plate, _Study
from ._study_store import StudyStore
from ._study_workers import ClusterWorkers, ThreadWorkers
from .errors import BadFile, Error, OutOfRange
from .staircase import is_number

__all__ = ["plate", "run"]

Spec = str | os.PathLike[str] | Mapping[str, Any]

# Chunks of a study: enough for the workers to end together, few against what a chunk costs beside its plates.
_CHUNKS = 64
# Most plates of a chunk: what is computed twice after an interruption.
_CHUNK_MAX = 2500
# The largest specification: slipline study reads no larger one.
_SPEC_BYTES_MAX = 1 << 21
_RETRIES_MAX = 1000
_WEEK_S = 604_800.0


def run(
    spec: Spec,
    address: str | None = None,
    *,
    store: str | os.PathLike[str],
    chunk: int | None = None,
    retries: int = 2,
    first_worker_s: float = 60.0,
) -> Any:
    """Computes the plates that ``store`` does not have yet, and returns the store, opened as an ``xarray.Dataset``.

    ``spec`` is a TOML file or a dictionary of the same fields, whose ``plate`` may be a :class:`slipline.Plate`. Without
    ``address`` the threads of this computer compute; ``"local"`` is a Dask cluster of processes here, ``"tcp://.."`` the
    scheduler of one elsewhere, whose workers need this package but neither the specification's files nor the store; its first
    worker may take ``first_worker_s`` to come, 1 second to a week.

    ``chunk`` is the number of plates that are computed at once, fixed when the store is made; by default a 64th of the plates, at
    most 2500, and one plate in two dimensions. A chunk that fails, because its worker died or for any other reason, is computed
    again up to ``retries`` times; then its error is raised, and in two dimensions written as a row.

    The store, a Zarr folder, has each of the ``results`` of the specification over (plate, place), by default
    ``turning_point_shift_m`` and ``level_db``, ``status`` and a variable ``vary_..`` for each field that varies over plate, and the
    coordinate ``place_m`` over place. A plate that the plate file refuses, or that has no boundary at a place, has NaN, and its
    status says why.

    Raises ``OutOfRange`` and ``BadFile`` for the specification; ``BadFile`` if the store is that of another specification,
    seed, chunk or version of this package.
    """
    study = study_of(spec)
    retries = _whole("retries", retries, 0, _RETRIES_MAX)
    chunk = None if chunk is None else _whole("chunk", chunk, 1, study.count)
    if not is_number(first_worker_s) or not 1 <= first_worker_s <= _WEEK_S:
        text = f"first_worker_s = {first_worker_s!r}: must be 1 to {_WEEK_S:.0f} s"
        raise OutOfRange(text, "first_worker_s", first_worker_s, 1, _WEEK_S)
    kept = StudyStore.open(Path(store), study, chunk, _usual_chunk(study.count, study.is_2d))
    due = kept.due()
    if due:
        workers = ThreadWorkers(study) if address is None else ClusterWorkers(study, address, first_worker_s)
        try:
            _compute(kept, due, workers, retries, fails=not study.is_2d)
        finally:
            workers.close()
    return kept.dataset()


def _whole(field: str, value: int, low: int, high: int) -> int:
    if not is_number(value) or not low <= value <= high or value != int(value):
        raise OutOfRange(f"{field} = {value!r}: must be {low} to {high}, a whole number", field, value, low, high)
    return int(value)


def plate(spec: Spec, i: int) -> Plate:
    """Plate ``i`` of a study, from 0.

    Raises ``OutOfRange`` if there is none, and for a number that the plate file refuses.
    """
    return study_of(spec).plate(i)


def _compute(
    kept: StudyStore, due: list[tuple[int, int]], workers: ThreadWorkers | ClusterWorkers, retries: int, *, fails: bool
) -> None:
    """Computes these ranges and writes each as it comes: this process alone writes. Of a range that cannot be computed the error is
    raised where it ``fails``, and otherwise the range is written as failed."""
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
                if failed[span[0]] <= retries:
                    waiting.append(span)
                    continue
                if fails:
                    raise
                kept.write_failed(span)
                progress.add(span[1] - span[0])
                continue
            kept.write(span, results)
            progress.add(span[1] - span[0])
    finally:
        progress.end()


def _usual_chunk(count: int, is_2d: bool) -> int:
    """The plates of a chunk, by the count alone: a store may move to another computer."""
    return 1 if is_2d else min(-(-count // _CHUNKS), _CHUNK_MAX)


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


def study_of(spec: Spec) -> _Study:
    """The study of a specification. An error in it names the file, or the field of the dictionary."""
    text = spec_text(spec)
    try:
        return _Study(text)
    except BadFile as error:
        if not isinstance(spec, Mapping):
            raise BadFile(f"{os.fspath(spec)}: {error}") from error
        # Each field is a line of its own.
        line = re.match(r"line (\d+): ", str(error))
        if line is None:
            raise
        raise BadFile(f"{list(spec)[int(line[1]) - 1]}: {str(error)[line.end():]}") from error


def spec_text(spec: Spec) -> str:
    """The text of a specification: of a file, or of its fields."""
    if isinstance(spec, Mapping):
        fields = dict(spec)
        if isinstance(fields.get("plate"), Plate):
            fields["plate"] = tomllib.loads(fields["plate"].to_toml())
        elif isinstance(fields.get("plate"), os.PathLike):
            fields["plate"] = os.fspath(fields["plate"])
        return "".join(f"{_toml(str(name))} = {_toml(value, str(name))}\n" for name, value in fields.items())
    path = Path(spec)
    try:
        with path.open("rb") as file:
            text = file.read(_SPEC_BYTES_MAX + 1)
        return text.decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadFile(f"{path}: {getattr(error, 'strerror', None) or error}") from error


def _toml(value: object, field: str = "") -> str:
    """A value in TOML; ``field`` names it in an error."""
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
        return "{ " + ", ".join(f"{_toml(str(name))} = {_toml(item, f'{field}.{name}')}" for name, item in value.items()) + " }"
    if hasattr(value, "__array__"):
        if np.ma.is_masked(value):
            raise ValueError(f"{field}: must be numbers: leave the masked ones out")
        # Of NumPy, pandas or xarray: a list, or a number where it has no dimension.
        return _toml(np.asarray(value).tolist(), field)
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray)):
        return "[" + ", ".join(_toml(item, field) for item in value) + "]"
    raise TypeError(f"{field}: a specification has no {type(value).__name__}: {value!r}")
