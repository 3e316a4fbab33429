"""The store of a study: a Zarr folder that plain xarray opens, and in which the same study goes on.

A chunk of the store is a chunk of the study. Its ``status`` is written last, so that a chunk with a status is whole.

Chunks are not compressed: random numbers do not get smaller. Such a chunk is a file of its numbers, and is written as that; by zarr it
would cost as much of the one thread that writes as its plates cost the others.
"""

from __future__ import annotations

import hashlib
import math
import os
import shutil
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from ._slipline import VERSION, _Study
from .errors import BadFile

class StudyStore:
    """An open store."""

    def __init__(self, path: Path, group: Any, study: _Study) -> None:
        self._path, self._group = path, group
        self._varied = [name for name, _ in study.varied]
        self._results = [name for name, _, _ in study.results]
        self._worker_failed = study.meanings.index("worker_failed")
        self._arrays = {name: group[name] for name in [*self._varied, *self._results, "status"]}
        self.count = study.count

    @classmethod
    def open(cls, path: Path, study: _Study, chunk: int | None, usual_chunk: int) -> StudyStore:
        """Opens the store of a study, or makes it; ``chunk`` or else ``usual_chunk`` fixes the chunk of a new one.

        Raises ``BadFile`` if it is that of another study.
        """
        zarr = _zarr()
        if not path.exists():
            _make(path, study, chunk or usual_chunk)
        try:
            group = zarr.open_group(path, mode="r+")
            kept = dict(group.attrs)
            kept_chunk = int(group["status"].chunks[0])
        except (OSError, KeyError, ValueError, zarr.errors.BaseZarrError) as error:
            raise BadFile(f"{path}: it is not the store of a study; name another one") from error
        for name, value in _attributes(study).items():
            if kept.get(name) != value:
                raise BadFile(f"{path}: it is the store of another study, {_difference(name, kept.get(name), value)}; name another one")
        if chunk not in (None, kept_chunk):
            raise BadFile(f"{path}: its chunks have {kept_chunk} plates, not {chunk}; leave chunk out, or name another store")
        return cls(path, group, study)

    def due(self) -> list[tuple[int, int]]:
        """The ranges that have no results yet, as (first, end); with those at which a worker has failed, and those of which a power
        cut or a copy has left a part."""
        step = int(self._group["status"].chunks[0])
        spans = [(first, min(first + step, self.count)) for first in range(0, self.count, step)]
        whole = [self._is_whole(span) for span in spans]
        status = self._group["status"][:]
        status = np.where(status == self._worker_failed, 0, status)
        return [(first, end) for (first, end), is_whole in zip(spans, whole) if not (is_whole and status[first:end].all())]

    def _is_whole(self, span: tuple[int, int]) -> bool:
        """Whether each array has this chunk in its whole size; the status of one that is not is removed, so that it can be read."""
        for name, array in self._arrays.items():
            if array.compressors or array.shards:
                # As of a store of an earlier version, whose chunks have no known size.
                return True
            try:
                is_whole = self._file(name, span).stat().st_size == math.prod(array.chunks) * array.dtype.itemsize
            except FileNotFoundError:
                is_whole = False
            if not is_whole:
                self._file("status", span).unlink(missing_ok=True)
                return False
        return True

    def _file(self, name: str, span: tuple[int, int]) -> Path:
        """The file of a chunk by the Zarr specification 3: c/i or c/i/0."""
        array = self._arrays[name]
        return self._path.joinpath(name, "c", str(span[0] // array.chunks[0]), *["0"] * (array.ndim - 1))

    def write(self, span: tuple[int, int], results: Any) -> None:
        """Writes the results of a range, its status last."""
        status, varied, arrays = results
        for name, column in zip(self._varied, varied.T):
            self._put(name, span, column)
        for name, array in zip(self._results, arrays):
            self._put(name, span, array)
        self._put("status", span, status)

    def write_failed(self, span: tuple[int, int]) -> None:
        """Writes that the workers have failed at a range; its numbers stay NaN."""
        self._put("status", span, np.full(span[1] - span[0], self._worker_failed, np.int8))

    def _put(self, name: str, span: tuple[int, int], values: Any) -> None:
        """Writes the chunk of an array."""
        array = self._arrays[name]
        if array.compressors or array.shards:
            # As of a store of an earlier version.
            array[slice(*span)] = values
            return
        # Little-endian, row by row, the last chunk as large as the others.
        chunk = np.full(array.chunks, array.fill_value, array.dtype.newbyteorder("<"))
        chunk[: span[1] - span[0]] = values
        file = self._file(name, span)
        file.parent.mkdir(parents=True, exist_ok=True)
        part = file.with_name(f"{file.name}.part")
        part.write_bytes(chunk.tobytes())
        part.replace(file)

    def dataset(self) -> Any:
        """The store as an ``xarray.Dataset``."""
        import xarray

        # A store of an earlier version does not say that the places are coordinates.
        return xarray.open_zarr(self._path).set_coords("place_m")


def _attributes(study: _Study) -> dict[str, str]:
    spec = study.to_toml()
    return {"slipline_version": VERSION, "spec": spec, "spec_sha256": hashlib.sha256(spec.encode()).hexdigest()}


def _difference(name: str, kept: Any, wanted: str) -> str:
    """What differs, in words: of two specifications the first line that does."""
    if name != "spec":
        return f"its {name} is {kept}, not {wanted}"
    its_lines, lines = str(kept).splitlines(), wanted.splitlines()
    its_own = next((line for line in its_lines if line and line not in lines), "")
    own = next((line for line in lines if line and line not in its_lines), "")
    if its_own and own:
        return f"with {its_own}, not {own}"
    return f"with {its_own}" if its_own else f"without {own}" if own else "its specification has another order"


def _make(path: Path, study: _Study, chunk: int) -> None:
    """Makes an empty store: whole, or none."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    part.mkdir()
    try:
        group = _zarr().open_group(part, mode="w", zarr_format=3, attributes=_attributes(study))
        meanings = study.meanings
        flags = {"flag_values": list(range(len(meanings))), "flag_meanings": " ".join(meanings)}

        def array(name: str, dimensions: dict[str, int], kind: str, fill: float, attributes: dict[str, Any]) -> Any:
            chunks = tuple(chunk if dimension == "plate" else size for dimension, size in dimensions.items())
            return group.create_array(
                name,
                shape=tuple(dimensions.values()),
                chunks=chunks,
                compressors=None,
                dtype=kind,
                fill_value=fill,
                dimension_names=tuple(dimensions),
                attributes=attributes,
            )

        plates, places = {"plate": study.count}, {"place": len(study.place_m)}
        array("status", plates, "int8", 0, {"long_name": "whether a plate has results, and why not", **flags})
        place = {"long_name": "turning point on the nominal plate, from the driven end", "units": "m"}
        array("place_m", places, "float64", np.nan, place)[:] = np.array(study.place_m)
        for name, unit, meaning in study.results:
            # As of CF: xarray then makes it a coordinate.
            attributes = {"long_name": meaning, "units": unit, "coordinates": "place_m"}
            array(name, plates | places, "float64", np.nan, attributes)
        for name, field in study.varied:
            array(name, plates, "float64", np.nan, {"long_name": f"{field} of the plate file, in its unit"})
        with warnings.catch_warnings():
            # Zarr warns that other libraries may not look for it; without it xarray warns that opening is slow.
            warnings.simplefilter("ignore")
            _zarr().consolidate_metadata(part)
        part.replace(path)
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        raise


def _zarr() -> Any:
    try:
        import xarray  # noqa: F401  needed at the end: better missed at the begin
        import zarr
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"{error}; a study's store needs zarr and xarray: pip install slipline[study]") from error
    return zarr
