"""Studies: the same bits from threads, processes and the command line, and a store that goes on after whatever ended the study."""

from __future__ import annotations

import asyncio
import csv
import os
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import dask
import distributed
import numpy as np
import pandas
import pytest
import slipline
import xarray
import zarr
from conftest import PROGRAM
from line import Program

#: A field far from 1 refuses some plates, so that reasons occur, too.
SPEC = {
    "plate": "membrane",
    "seed": 7,
    "count": 150,
    "turning_point_m": [0.12, 0.18, 0.24],
    "vary": {
        "model.wave_speed_m_per_s": {"normal": 0.01},
        "loss_factor": {"log_normal": 0.3},
        "taper.rate_per_m": {"uniform": 0.02},
        "taper.half_width_m": {"log_normal": 0.6},
    },
}
#: A whole chunk less than the last one, so that the last one is not whole.
CHUNK = 16
PATIENCE_S = 60.0


def many(count: int) -> dict[str, object]:
    """The study of more plates."""
    return {**SPEC, "count": count}


def bits(dataset: xarray.Dataset) -> dict[str, bytes]:
    """The bytes of every variable."""
    return {name: variable.values.tobytes() for name, variable in dataset.variables.items()}


def until_three_are_done(store: Path) -> None:
    """Waits until the status of three chunks is written."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        if sum(part.name.isdigit() for part in (store / "status" / "c").glob("*")) == 3:
            return
        time.sleep(0.01)


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> xarray.Dataset:
    """The study on the threads of this computer."""
    return slipline.study.run(SPEC, store=tmp_path_factory.mktemp("here") / "study.zarr", chunk=CHUNK)


def test_plain_xarray_opens_a_store_with_its_dimensions_units_and_reasons(here: xarray.Dataset) -> None:
    with xarray.open_zarr(here.encoding["source"]) as found:
        assert dict(found.sizes) == {"plate": 150, "place": 3}
        for name, dimensions, unit in (
            ("place_m", ("place",), "m"),
            ("turning_point_shift_m", ("plate", "place"), "m"),
            ("level_db", ("plate", "place"), "dB"),
        ):
            assert (found[name].dims, found[name].dtype, found[name].units) == (dimensions, np.float64, unit)
        assert found.place_m.values.tolist() == SPEC["turning_point_m"] and "place_m" in found.coords
        assert "place_m" in found.level_db.coords and found.level_db.isel(place=1).place_m == 0.18
        assert {name for name in found if name.startswith("vary_")} == {
            "vary_loss_factor",
            "vary_model_wave_speed_m_per_s",
            "vary_taper_half_width_m",
            "vary_taper_rate_per_m",
        }
        status = found.status
        assert status.dims == ("plate",) and status.dtype == np.int8
        meanings = status.flag_meanings.split()
        assert meanings[:2] == ["not_yet", "done"] and list(status.flag_values) == list(range(len(meanings)))
        counts = np.bincount(status.values, minlength=len(meanings))
        assert counts[0] == 0 and counts[1] > 100 and counts[meanings.index("plate_refused")] > 0, counts
        # A bad plate has no number, and no other plate lacks one.
        assert (np.isnan(found.level_db.values).any(axis=1) == (status.values != 1)).all()
        assert found.status.encoding["chunks"] == (CHUNK,)
        assert found.attrs["slipline_version"] == slipline.__version__
        assert tomllib.loads(found.attrs["spec"])["count"] == 150 and len(found.attrs["spec_sha256"]) == 64


def test_one_thread_and_two_have_the_same_bits(here: xarray.Dataset, tmp_path: Path) -> None:
    allowed = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(allowed)})
        assert slipline._study_workers.ThreadWorkers(slipline.study._Study(slipline.study.spec_text(SPEC))).count() == 1
        one = slipline.study.run(SPEC, store=tmp_path / "one.zarr", chunk=50)
    finally:
        os.sched_setaffinity(0, allowed)
    assert bits(one) == bits(here), "whatever the chunk"


def test_the_command_line_has_the_same_bits(here: xarray.Dataset, tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(here.attrs["spec"])
    line = [PROGRAM, "study", str(tmp_path / "study.toml"), "--out", str(tmp_path / "study.csv")]
    subprocess.run(line, check=True, capture_output=True)
    with (tmp_path / "study.csv").open() as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert [int(row["plate"]) for row in rows] == list(range(150))
    meanings = here.status.flag_meanings.split()
    assert [row["status"] for row in rows] == [meanings[status] for status in here.status.values]

    def column(name: str) -> bytes:
        return np.array([float(row[name] or "nan") for row in rows]).tobytes()

    for name in (name for name in here if name.startswith("vary_")):
        assert column(name) == here[name].values.tobytes(), name
    for place, place_m in enumerate(SPEC["turning_point_m"]):
        for name in ("turning_point_shift_m", "level_db"):
            assert column(f"{name}_at_{place_m}") == here[name].values[:, place].tobytes(), name
    # The file, and the text in the store, name the same study.
    again = slipline.study.run(tmp_path / "study.toml", store=here.encoding["source"])
    assert bits(again) == bits(here)


def test_a_chunk_that_is_computed_alone_has_its_bits(here: xarray.Dataset, tmp_path: Path) -> None:
    store = tmp_path / "study.zarr"
    shutil.copytree(here.encoding["source"], store)
    for name in ("status", "level_db", "turning_point_shift_m", "vary_loss_factor"):
        for part in (store / name / "c").glob("3*"):
            shutil.rmtree(part) if part.is_dir() else part.unlink()
    with xarray.open_zarr(store) as found:
        lost = found.status.values == 0
        assert lost.sum() == CHUNK and lost[3 * CHUNK] and np.isnan(found.level_db.values[lost]).all()
    before = (store / "level_db" / "c" / "2" / "0").stat().st_mtime_ns
    assert bits(slipline.study.run(SPEC, store=store)) == bits(here)
    assert (store / "level_db" / "c" / "2" / "0").stat().st_mtime_ns == before, "it alone"


def test_a_plate_of_a_study_is_the_one_of_its_row(here: xarray.Dataset) -> None:
    i = int(np.flatnonzero(here.status.values == 1)[-1])
    drawn = slipline.study.plate(SPEC, i)
    file = tomllib.loads(drawn.to_toml())
    assert file["loss_factor"] == here.vary_loss_factor.values[i]
    assert file["taper"]["rate_per_m"] == here.vary_taper_rate_per_m.values[i]
    # By the field at the frequency of the nominal plate's table.
    hz = np.interp(0.18, *(getattr(slipline.Plate("membrane").table(), name) for name in ("position_m", "frequency_hz")))
    peak, nominal = (plate.respond(hz).peak_amplitude for plate in (drawn, slipline.Plate("membrane")))
    assert abs(20 * np.log10(peak / nominal) - here.level_db.values[i, 1]) < 0.05
    with pytest.raises(slipline.OutOfRange, match="i = 150: must be 0 to 149"):
        slipline.study.plate(SPEC, 150)
    refused = int(np.flatnonzero(here.status.values == 2)[0])
    with pytest.raises(slipline.OutOfRange, match="plate: "):
        slipline.study.plate(SPEC, refused)


def test_another_specification_seed_chunk_or_version_is_refused(here: xarray.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = Path(here.encoding["source"])
    for change, words in (
        ({"seed": 8}, "with seed = 7, not seed = 8"),
        ({"vary": {**SPEC["vary"], "loss_factor": {"log_normal": 0.2}}}, "log_normal = 0.3"),
        ({"plate": "membrane-heavy"}, "another study"),
        ({"results": ["felt_edge_m"]}, r'another study, without results = \["felt_edge_m"\]; name'),
    ):
        with pytest.raises(slipline.BadFile, match=words):
            slipline.study.run({**SPEC, **change}, store=store)
    with pytest.raises(slipline.BadFile, match="its chunks have 16 plates, not 17"):
        slipline.study.run(SPEC, store=store, chunk=17)
    monkeypatch.setattr(slipline._study_store, "VERSION", "99.0.0")
    with pytest.raises(slipline.BadFile, match="slipline_version is .*, not 99.0.0"):
        slipline.study.run(SPEC, store=store)
    monkeypatch.undo()
    (tmp_path / "other").mkdir()
    (tmp_path / "file").write_text("a file")
    for other in ("other", "file"):
        with pytest.raises(slipline.BadFile, match="not the store of a study"):
            slipline.study.run(SPEC, store=tmp_path / other)
    assert (tmp_path / "file").read_text() == "a file" and not list((tmp_path / "other").iterdir())


def test_what_is_wrong_with_a_specification_is_named(tmp_path: Path) -> None:
    for change, error, words in (
        ({"count": 0}, slipline.OutOfRange, "count = 0: must be 1 to 1000000"),
        ({"plate": "membrame"}, slipline.BadFile, "did you mean membrane?"),
        ({"turning_point_m": [0.12, 9.0]}, slipline.OutOfRange, r"turning_point_m\[1\]"),
        ({"vary": {"loss": {"normal": 0.1}}}, slipline.BadFile, "loss"),
        ({"sed": 1}, slipline.BadFile, "unknown field .sed."),
        ({"plate": None}, TypeError, "plate: a specification has no NoneType"),
        ({"seed": "7"}, slipline.BadFile, "seed: invalid type: string"),
        ({"vary": {"loss_factor": 5}}, slipline.BadFile, "vary: wanted string or table"),
        ({"vary": {"loss_factor": {"normal": 1j}}}, TypeError, "vary.loss_factor.normal: a specification has no complex"),
        ({"turning_point_m": np.ma.array([0.12, 0.2], mask=[0, 1])}, ValueError, "turning_point_m: .* leave the masked ones out"),
    ):
        with pytest.raises(error, match=words):
            slipline.study.run({**SPEC, **change}, store=tmp_path / "store")
    for arguments, words in (
        ({"chunk": 0}, "chunk = 0: must be 1 to 150"),
        ({"chunk": 2.5}, "chunk = 2.5: must be 1 to 150"),
        ({"chunk": True}, "chunk = True: must be 1 to 150"),
        ({"chunk": "3"}, "chunk = '3': must be 1 to 150"),
        ({"retries": -1}, "retries = -1: must be 0 to"),
        ({"retries": None}, "retries = None: must be 0 to"),
        ({"first_worker_s": "60"}, "first_worker_s = '60': must be 1 to 604800 s"),
    ):
        with pytest.raises(slipline.OutOfRange, match=words):
            slipline.study.run(SPEC, store=tmp_path / "store", **arguments)
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("seed = 'seven'\n")
    with pytest.raises(slipline.BadFile, match="wrong.toml: line 1: invalid type: string"):
        slipline.study.run(wrong, store=tmp_path / "store")
    wrong.unlink()
    with pytest.raises(slipline.BadFile, match="none.toml: No such file"):
        slipline.study.run(tmp_path / "none.toml", store=tmp_path / "store")
    assert not list(tmp_path.iterdir())
    fields = {"third": 1 / 3, "small": [5e-324, -0.0, 3], 'a "b\\c"\t\x7f': {"x.y": True}, "none": []}
    assert tomllib.loads(slipline.study.spec_text(fields)) == fields
    # A plate as an object, numbers of numpy.
    named = slipline.Plate.from_toml(slipline.Plate("membrane").to_toml().replace('"membrane"', r'"a \"b\\c\""', 1))
    fields = {**SPEC, "plate": named, "count": np.int64(1), "turning_point_m": np.array(SPEC["turning_point_m"])}
    assert slipline.study.plate(fields, 0).name == named.name
    # Series of pandas and xarray, a file as a path.
    (tmp_path / "named.toml").write_text(named.to_toml())
    for places in (pandas.Series(SPEC["turning_point_m"], index=[7, 9, 8]), xarray.DataArray(SPEC["turning_point_m"])):
        same = {**fields, "plate": tmp_path / "named.toml", "count": np.array(1), "turning_point_m": places}
        assert slipline.study.plate(same, 0) == slipline.study.plate(fields, 0)


def test_a_chunk_that_fails_is_tried_again_and_then_raises_with_a_store_that_goes_on(
    here: xarray.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tries: list[int] = []

    class Broken:
        def run(self, first: int, end: int) -> None:
            raise OSError("a worker that fails")

    class Failing(slipline._study_workers.ThreadWorkers):
        def submit(self, first: int, end: int) -> object:
            tries.append(first)
            if first == 32 and tries.count(32) <= failures:
                self._study, study = Broken(), self._study
                future = super().submit(first, end)
                self._study = study
                return future
            return super().submit(first, end)

    monkeypatch.setattr(slipline.study, "ThreadWorkers", Failing)
    failures = 3
    with pytest.raises(OSError, match="a worker that fails"):
        slipline.study.run(SPEC, store=tmp_path / "study.zarr", chunk=CHUNK)
    assert tries.count(32) == 3
    tries.clear()
    failures = 2
    assert bits(slipline.study.run(SPEC, store=tmp_path / "study.zarr")) == bits(here)
    assert tries.count(32) == 3 and 0 not in tries


def test_a_chunk_that_was_written_in_part_is_computed_again(here: xarray.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    few = bits(here.isel(plate=slice(20)))
    put = slipline._study_store.StudyStore._put
    # The fields that vary, the two results, and the status.
    for whole in range(7):
        writes: list[str] = []

        def interrupted(
            kept: object, name: str, span: tuple[int, int], values: np.ndarray, whole: int = whole, writes: list[str] = writes
        ) -> None:
            if len(writes) == whole:
                raise KeyboardInterrupt
            writes.append(name)
            put(kept, name, span, values)

        store = tmp_path / f"{whole}.zarr"
        slipline._study_store._make(store, slipline.study._Study(slipline.study.spec_text(many(20))), CHUNK)
        with monkeypatch.context() as patched:
            patched.setattr(slipline._study_store.StudyStore, "_put", interrupted)
            with pytest.raises(KeyboardInterrupt):
                slipline.study.run(many(20), store=store)
        assert len(writes) == whole and "status" not in writes
        assert bits(slipline.study.run(many(20), store=store)) == few


@pytest.mark.parametrize("name", ["level_db", "vary_loss_factor", "status"])
@pytest.mark.parametrize("left", [None, 0, 5])
def test_a_chunk_of_which_a_power_cut_has_left_a_part_is_computed_again(tmp_path: Path, name: str, left: int | None) -> None:
    store = tmp_path / "study.zarr"
    few = bits(slipline.study.run(many(20), store=store, chunk=8))
    chunk, = (file for file in (store / name / "c").rglob("*") if file.is_file() and file.relative_to(store / name / "c").parts[0] == "1")
    if left is None:
        chunk.unlink()
    else:
        chunk.write_bytes(chunk.read_bytes()[:left])
    assert bits(slipline.study.run(many(20), store=store)) == few


INTERRUPTED = """
import os, signal, threading
import slipline

vary = {"loss_factor": {"normal": 0.01}}
objective = slipline.objective("membrane", {"taper.rate_per_m": (4.0, 5.5)}, turning_point_m=[0.12], vary=vary, count=1_000_000)
for points in ([0.5], [[0.2], [0.5], [0.8]]):
    try:
        threading.Timer(0.3, os.kill, [os.getpid(), signal.SIGINT]).start()
        objective(points)
    except KeyboardInterrupt:
        print("interrupted")
"""


def test_ctrl_c_ends_an_objective_however_many_plates_it_draws() -> None:
    ended = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stdout) == (0, "interrupted\n" * 2), ended.stderr


#: A study of which no range from the fourth on is ever ready.
IN_THE_MIDDLE = """
import concurrent.futures, sys
import slipline
from slipline._study_workers import ThreadWorkers

begin = ThreadWorkers.submit
ThreadWorkers.submit = lambda workers, first, end: (
    begin(workers, first, end) if first < 3 * CHUNK else concurrent.futures.Future()
)
slipline.study.run(SPEC, store=sys.argv[1], chunk=CHUNK)
"""


def test_ctrl_c_leaves_a_store_that_goes_on(here: xarray.Dataset, tmp_path: Path) -> None:
    store = tmp_path / "study.zarr"
    with Program(IN_THE_MIDDLE, str(store), SPEC=repr(SPEC), CHUNK=str(CHUNK)) as running:
        until_three_are_done(store)
        running.signal(signal.SIGINT)
        code, errors = running.end()
    assert code in (1, -signal.SIGINT) and "KeyboardInterrupt" in errors
    with xarray.open_zarr(store) as found:
        written = found.status.values != 0
        assert written.tolist() == [i < 3 * CHUNK for i in range(150)]
        assert found.level_db.values[written].tobytes() == here.level_db.values[written].tobytes()
    assert bits(slipline.study.run(SPEC, store=store)) == bits(here)


def test_two_processes_have_the_same_bits_even_where_one_is_killed(tmp_path: Path) -> None:
    whole = slipline.study.run(many(800), store=tmp_path / "whole.zarr", chunk=800)
    store = tmp_path / "study.zarr"
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50}
    with distributed.LocalCluster(**options) as cluster:
        killed: list[int] = []
        write = slipline._study_store.StudyStore.write

        def and_kill(kept: object, span: tuple[int, int], results: object) -> None:
            write(kept, span, results)
            if not killed:
                killed.append(cluster.workers[0].pid)
                os.kill(killed[0], signal.SIGKILL)

        slipline._study_store.StudyStore.write = and_kill
        try:
            found = slipline.study.run(many(800), cluster.scheduler_address, store=store, chunk=CHUNK)
        finally:
            slipline._study_store.StudyStore.write = write
        assert killed and bits(found) == bits(whole)


def test_the_address_local_begins_processes_here(here: xarray.Dataset, tmp_path: Path) -> None:
    assert bits(slipline.study.run(SPEC, "local", store=tmp_path / "study.zarr", chunk=CHUNK)) == bits(here)


def test_an_address_without_a_scheduler_is_refused(tmp_path: Path) -> None:
    with dask.config.set({"distributed.comm.timeouts.connect": "0.1s"}):
        with pytest.raises(slipline.Refused, match="tcp://127.0.0.1:1"):
            slipline.study.run(SPEC, "tcp://127.0.0.1:1", store=tmp_path / "study.zarr")


@pytest.mark.parametrize(("count", "plates"), [(1, 1), (64, 1), (65, 2), (150, 3), (10_000, 157), (160_000, 2500), (1_000_000, 2500)])
def test_the_usual_chunk_is_a_64th_of_the_plates_and_at_most_2500_whatever_the_computer(count: int, plates: int) -> None:
    assert slipline.study._usual_chunk(count, False) == plates
    assert slipline.study._usual_chunk(count, True) == 1


def test_a_store_of_an_earlier_version_is_read_and_goes_on(here: xarray.Dataset, tmp_path: Path) -> None:
    """As it was before the places were coordinates; its chunk is one that no rule of today gives."""
    store = tmp_path / "study.zarr"
    whole = slipline.study.run(SPEC, store=store, chunk=53)
    group = zarr.open_group(store, mode="r+")
    # Compressed, too.
    for name, variable in whole.variables.items():
        if name != "place_m":
            attributes = dict(group[name].attrs)
            kwargs = {"chunks": (53, *variable.shape[1:]), "fill_value": group[name].fill_value, "dimension_names": variable.dims}
            array = group.create_array(name, shape=variable.shape, dtype=variable.dtype, overwrite=True, attributes=attributes, **kwargs)
            array[:] = variable.values
            assert array.compressors
    for name in ("level_db", "turning_point_shift_m"):
        del group[name].attrs["coordinates"]
    group["status"].attrs["flag_meanings"] = " ".join(here.status.flag_meanings.split()[:6])
    group["status"][53:106] = 0
    zarr.consolidate_metadata(store)
    with xarray.open_zarr(store) as found:
        assert "place_m" not in found.coords
    found = slipline.study.run(SPEC, store=store)
    assert bits(found) == bits(here) and "place_m" in found.coords
    assert found.status.encoding["chunks"] == (53,)


#: All results that a study can have.
RESULTS = ["turning_point_shift_m", "level_db", "peak_shift_m", "felt_edge_m", "contrast_db", "ripple_db", "crest_db"]


def test_results_are_named_and_the_store_has_those_alone(here: xarray.Dataset, tmp_path: Path) -> None:
    spec = {**many(8), "turning_point_m": [0.15, 0.18], "results": RESULTS[::-1]}
    found = slipline.study.run(spec, store=tmp_path / "all.zarr")
    assert [name for name in found if not name.startswith("vary_")] == sorted([*RESULTS, "status"])
    done = found.isel(plate=found.status.values == 1)
    assert done.sizes["plate"] >= 4
    for name in RESULTS:
        # A wide plate may have no peak, or be felt to its end.
        assert np.isfinite(done[name].values).any(axis=0).all(), name
        assert done[name].units == ("dB" if name.endswith("_db") else "m") and done[name].long_name
    # The same numbers as without the others.
    for name in RESULTS[:2]:
        assert found[name].values[:, 1:].tobytes() == here[name].values[:8, 1:2].tobytes(), name
    few = slipline.study.run({**spec, "results": ["felt_edge_m"]}, store=tmp_path / "few.zarr")
    assert [name for name in few if not name.startswith("vary_")] == ["felt_edge_m", "status"]
    assert few.felt_edge_m.values.tobytes() == found.felt_edge_m.values.tobytes()
    with pytest.raises(slipline.BadFile, match='did you mean felt_edge_m'):
        slipline.study.run({**spec, "results": ["felt_edge"]}, store=tmp_path / "no.zarr")
    with pytest.raises(slipline.BadFile, match="another study"):
        slipline.study.run(spec, store=tmp_path / "few.zarr")


def plane(count: int) -> dict[str, object]:
    """A study in two dimensions."""
    return {**many(count), "kind": "2d", "turning_point_m": [0.18]}


def test_two_dimensions_are_a_plate_a_chunk_and_the_solver_of_respond(tmp_path: Path) -> None:
    found = slipline.study.run(plane(4), store=tmp_path / "study.zarr")
    assert found.status.encoding["chunks"] == (1,)
    assert {"level_db", "peak_shift_m"} < set(found) and "turning_point_shift_m" not in found
    hz = np.interp(0.18, *(getattr(slipline.Plate("membrane").table(), name) for name in ("position_m", "frequency_hz")))
    nominal_m = slipline.Plate("membrane").respond(hz, two_dimensions=True).peak_position_m
    for i in np.flatnonzero(found.status.values == 1):
        peak_m = slipline.study.plate(plane(4), i).respond(hz, two_dimensions=True).peak_position_m
        assert abs(found.peak_shift_m.values[i, 0] - (peak_m - nominal_m)) < 1e-5


def test_a_plate_at_which_the_workers_fail_is_a_row_in_two_dimensions_and_tried_again_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = slipline.study.run(plane(5), store=tmp_path / "whole.zarr")
    tries: list[int] = []

    class Dying:
        def run(self, first: int, end: int) -> None:
            raise OSError("a worker that dies")

    class Failing(slipline._study_workers.ThreadWorkers):
        def submit(self, first: int, end: int) -> object:
            tries.append(first)
            if first != 2:
                return super().submit(first, end)
            self._study, study = Dying(), self._study
            future = super().submit(first, end)
            self._study = study
            return future

    with monkeypatch.context() as patched:
        patched.setattr(slipline.study, "ThreadWorkers", Failing)
        found = slipline.study.run(plane(5), store=tmp_path / "study.zarr")
    meanings = found.status.flag_meanings.split()
    assert [meanings[status] == "worker_failed" for status in found.status.values] == [i == 2 for i in range(5)]
    assert np.isnan(found.level_db.values[2]).all() and tries.count(2) == 3
    assert bits(slipline.study.run(plane(5), store=tmp_path / "study.zarr")) == bits(whole)


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the peak of the memory is read in /proc")
def test_a_worker_in_two_dimensions_needs_less_than_the_stated_100_megabytes() -> None:
    body = """
    import re
    import slipline

    plate = slipline.Plate("latex-membrane")
    places = [place for place in plate.span_m]
    spec = {"plate": plate, "kind": "2d", "seed": 7, "count": 1, "turning_point_m": places, "vary": {"loss_factor": {"uniform": 0.1}}}
    status, _, _ = slipline.study._Study(slipline.study.spec_text(spec)).run(0, 1)
    print(status[0], re.search(r"VmHWM:\\s*([0-9]+) kB", open("/proc/self/status").read())[1])
    """
    with Program(body) as program:
        status, kilobytes = program.line().split()
        program.end()
    # With Python and numpy: the largest plate with air.
    assert status == "1" and int(kilobytes) < 100_000


@pytest.mark.parametrize("after_s", [0.3, 1.5])
def test_ctrl_c_while_a_cluster_starts_is_a_keyboard_interrupt(tmp_path: Path, after_s: float) -> None:
    body = """
    import logging, os, signal, sys, threading, time
    import distributed
    import slipline

    if __name__ == "__main__":
        logging.disable()
        press = threading.Timer(float(sys.argv[2]), os.kill, (os.getpid(), signal.SIGINT))
        try:
            press.start()
            slipline.study.run(SPEC, "local", store=sys.argv[1], chunk=1)
        except BaseException as error:
            print(type(error).__name__)
        print("ended")
    """
    with Program(body, str(tmp_path / "study.zarr"), str(after_s), SPEC=repr(many(100_000))) as program:
        assert program.line() == "KeyboardInterrupt"
        assert program.line() == "ended"
        code, _ = program.end()
    assert code == 0


@pytest.mark.parametrize("made_of_it", [RuntimeError("worker failed to start"), OSError("timed out"), asyncio.CancelledError()])
def test_whatever_the_library_makes_of_ctrl_c_it_is_a_keyboard_interrupt(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, made_of_it: BaseException
) -> None:
    def start(**_: object) -> None:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            raise made_of_it from None

    monkeypatch.setattr(distributed, "LocalCluster", start)
    with pytest.raises(KeyboardInterrupt):
        slipline.study.run(SPEC, "local", store=tmp_path / "study.zarr")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_objective_is_the_study_of_each_points_plate_and_the_same_from_threads() -> None:
    numbers = {"taper.rate_per_m": (4.0, 5.5), "loss_factor": (0.02, 0.06)}
    vary = {"model.wave_speed_m_per_s": {"normal": 0.01}}
    objective = slipline.objective("membrane", numbers, turning_point_m=[0.12, 0.2], vary=vary, count=16, seed=3)
    start = objective.point(slipline.Plate("membrane"))
    assert objective.names == list(numbers) and ((start > 0) & (start < 1)).all()
    assert objective.plate(start).to_dict()["taper"]["rate_per_m"] == pytest.approx(4.62)
    # A faster wave turns nearer by the logarithm of its speed over the rate: a steeper taper moves its line less.
    costs = objective([[share, 0.5] for share in (0.0, 0.5, 1.0)])
    assert costs[0] > costs[1] > costs[2] and costs[0] / costs[2] == pytest.approx(5.5 / 4.0, rel=0.05)
    assert objective([0.5, 0.5]) == costs[1]
    # By the user's own cost, of a result by name.
    seen: list[tuple[int, ...]] = []

    def felt(found: dict[str, np.ndarray]) -> float:
        seen.append((*found["felt_edge_m"].shape, found["status"].size))
        return float(np.nanstd(found["felt_edge_m"]))

    own = slipline.objective("membrane", numbers, turning_point_m=[0.2], vary=vary, count=8, results=["felt_edge_m"], cost=felt)
    assert 0 < own(start) < 0.02 and seen == [(8, 1, 8)]
    # A point whose plate cannot be costs infinity, and says why when asked.
    assert objective([0.5, -5.0]) == np.inf
    with pytest.raises(slipline.OutOfRange, match="loss_factor"):
        objective.plate([0.5, -5.0])
    for wrong, words in (([0.5], "2 coordinates"), ([[[0.5, 0.5]]], "2 coordinates")):
        with pytest.raises(ValueError, match=words):
            objective(wrong)
    bounds: Any
    for bounds in ({"loss_factor": (0.1, 0.1)}, {"loss_factor": 0.1}, {"loss_factor": (0.1, np.inf)}, {}, 5):
        with pytest.raises(ValueError, match="lower and a higher bound"):
            slipline.objective("membrane", bounds, turning_point_m=[0.2], vary=vary)
    with pytest.raises(TypeError, match="los_factor .did you mean loss_factor"):
        slipline.objective("membrane", {"los_factor": (0.1, 0.2)}, turning_point_m=[0.2], vary=vary)
    with pytest.raises(ValueError, match="cost = None: must be a function of the results felt_edge_m"):
        slipline.objective("membrane", numbers, turning_point_m=[0.2], vary=vary, results=["felt_edge_m"])
    with pytest.raises(ValueError, match="3 coordinates|2 coordinates"):
        objective.plate([0.5, 0.5, 0.5])
    with pytest.raises(ValueError, match="taper.rate_per_m: the plate 'tungsten-membrane' has no such number"):
        objective.point(slipline.Plate("tungsten-membrane"))
    with pytest.raises(slipline.OutOfRange, match="turning_point_m"):
        slipline.objective("membrane", numbers, turning_point_m=[9.0], vary=vary)


def test_progress_says_how_long_the_rest_takes(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    now_s = 100.0
    monkeypatch.setattr(slipline.study, "time", SimpleNamespace(monotonic=lambda: now_s))
    # 60 plates are in the store already.
    progress = slipline.study._Progress(160, 100)
    for _ in range(4):
        now_s += 0.25
        progress.add(5)
    progress.end()
    lines = capsys.readouterr().err.strip().split("\r")
    assert [line.strip() for line in lines] == ["study: 70 of 160 plates, 4 s left", "study: 80 of 160 plates, 4 s left"]
    # What is done at once says nothing.
    slipline.study._Progress(1, 1).end()
    assert capsys.readouterr().err == ""
