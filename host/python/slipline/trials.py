"""A list of trials on a device, one row of a table for each.

::

    with slipline.connect("sim") as device:
        device.use(slipline.Plate("membrane"))
        device.arm()
        trials = [{"turning_point_m": x, "level": 0.8, "duration_s": 0.5} for x in (0.12, 0.16, 0.2)]
        slipline.trials.run(device, trials, respond=ask, folder="subject-01")

The folder has ``events.tsv`` in the columns of BIDS (the Brain Imaging Data Structure, 1.10: "Task events") and ``events.json``,
which describes the columns. A row is on the disk before the next trial begins: the same call goes on after the last one.
"""

from __future__ import annotations

import json
import math
import os
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .errors import BadFile, OutOfRange, Refused
from .staircase import PLACES, Staircase

__all__ = ["COLUMNS", "run"]

#: The columns of events.tsv, each with its description in events.json. What has no value is n/a.
COLUMNS: Mapping[str, Mapping[str, str]] = {
    "onset": {"Description": "First sample of the trial's drive on the device's sample clock", "Units": "s"},
    "duration": {"Description": "From the onset to the first sample at which the tone fades", "Units": "s"},
    "trial_type": {"Description": "The trial's own type"},
    "response": {"Description": "The answer; yes and no where it was true or false"},
    "response_time": {"Description": "From the call for the answer to the answer, by this computer's clock", "Units": "s"},
    "at_samples": {"Description": "First sample of the trial's drive on the device's sample clock", "Units": "samples"},
    "turning_point_m": {"Description": "Turning point of the tone by the plate in use", "Units": "m"},
    "felt_edge_m": {"Description": "Felt edge of the tone by the plate in use", "Units": "m"},
    "frequency_hz": {"Description": "Frequency of the tone", "Units": "Hz"},
    "level": {"Description": "Level of the tone, 0 to 1 of the table's full scale"},
    "measured_place_m": {"Description": "Measured place, as the answer function reported it", "Units": "m"},
    "measured_level": {"Description": "Measured level, as the answer function reported it"},
    "plate": {"Description": "Name of the plate in use"},
    "table_crc": {"Description": "CRC-32 of the table on the device, eight hexadecimal digits"},
    "seed": {"Description": "Seed of the order of the trials; n/a where they keep their order"},
}
# What the answer function may add to a trial.
MEASURED = ("measured_place_m", "measured_level")
LONGEST_S = 600.0


def run(
    device: Any,
    trials: Iterable[Mapping[str, Any]] | Staircase,
    respond: Callable[[dict[str, Any]], Any],
    *,
    folder: str | os.PathLike[str],
    seed: int | None = None,
) -> list[dict[str, str]]:
    """Runs the trials that have no row yet, and returns the rows of all of them.

    A trial has ``felt_edge_m``, ``turning_point_m`` or ``frequency_hz``, and may have ``level`` (0.8), ``duration_s`` and
    ``trial_type``. Its tone sounds for ``duration_s``, rounded up to a block of 128 samples, and fades within 20 ms; then
    ``respond(trial)`` gives the answer; without ``duration_s`` it sounds until the answer is given. ``respond`` gets the trial with
    the fields of its drive; what it puts into ``measured_place_m`` and ``measured_level`` of it goes to the row. A
    :class:`Staircase` takes true or false.

    With a ``seed`` the trials of a list come in a random order, which the seed alone determines. The device must be armed. A
    folder with the rows of other trials is refused: :class:`BadFile`.
    """
    table = _Table(Path(folder), seed)
    if isinstance(trials, Staircase):
        if seed is not None:
            raise OutOfRange(f"seed = {seed}: a staircase has its own order, so it must be None", "seed", seed)
        for row in table.rows:
            if trials.done:
                raise BadFile(f"{table.path}: it has more rows than the staircase has trials")
            trial = _checked(trials.trial())
            table.check(row, trial)
            trials.take_answer(trial, _yes(row["response"], str(table.path)))
        while not trials.done:
            trial = _checked(trials.trial())
            row = _one(device, trial, respond)
            answer = _yes(_cell(row["response"]), "respond(trial)")
            table.add(row)
            trials.take_answer(trial, answer)
    else:
        listed = [_checked(trial) for trial in trials]
        if seed is not None:
            listed = [listed[number] for number in np.random.default_rng(seed).permutation(len(listed))]
        if len(table.rows) > len(listed):
            raise BadFile(f"{table.path}: it has {len(table.rows)} rows, and there are {len(listed)} trials")
        for row, trial in zip(table.rows, listed):
            table.check(row, trial)
        for trial in listed[len(table.rows) :]:
            table.add(_one(device, trial, respond))
    return table.rows


def _checked(trial: Mapping[str, Any]) -> dict[str, Any]:
    allowed = {*PLACES, "level", "duration_s", "trial_type"}
    for field in trial:
        if field not in allowed:
            raise OutOfRange(f"{field}: a trial has {', '.join(sorted(allowed))}", field, trial[field])
    places = [field for field in PLACES if trial.get(field) is not None]
    if len(places) != 1:
        raise OutOfRange(f"a trial has one of {', '.join(PLACES)}: this one has {len(places)}", "trials", dict(trial))
    duration_s = trial.get("duration_s")
    if duration_s is not None and not 0.0 < duration_s <= LONGEST_S:
        text = f"duration_s = {duration_s}: must be above 0, up to {LONGEST_S:g} s"
        raise OutOfRange(text, "duration_s", duration_s, 0.0, LONGEST_S)
    trial_type = str(trial.get("trial_type", "trial"))
    if not trial_type or any(ord(letter) < 32 for letter in trial_type):
        raise OutOfRange(f"trial_type = {trial_type!r}: must be one line without tabs", "trial_type", trial_type)
    given = {field: float(trial[field]) for field in places}
    level = float(trial.get("level", 0.8))
    return {"trial_type": trial_type, **given, "level": level, "duration_s": duration_s}


def _one(device: Any, trial: dict[str, Any], respond: Callable[[dict[str, Any]], Any]) -> dict[str, Any]:
    """Runs one trial; its row, as values."""
    place = {field: trial[field] for field in PLACES if field in trial}
    rate_hz = device.status().sample_rate_hz
    drive = device.drive(**place, level=trial["level"])
    if drive.superseded:
        raise Refused("the trial's drive never began: another thread drives or stops the device")
    at_samples = drive.at_samples
    tone = drive.tones[0]
    stopped = None
    if trial["duration_s"] is not None:
        # Before it has begun: the end is then at its sample, whatever this program is doing.
        stopped = device.stop(at=at_samples + round(trial["duration_s"] * rate_hz))
    device.wait(drive)
    # The requested place as it was given, the others by the plate.
    places = {**{field: getattr(tone, field) for field in PLACES}, **place}
    asked = {**trial, **places, "at_samples": at_samples}
    if stopped is not None:
        # A stop of another thread ends it before.
        stopped = min(stopped, device.wait(stopped))
    began_s = time.monotonic()
    response = respond(asked)
    response_time_s = time.monotonic() - began_s
    if stopped is None:
        stopped = device.stop()
    return {
        "onset": at_samples / rate_hz,
        "duration": (stopped - at_samples) / rate_hz,
        "trial_type": trial["trial_type"],
        "response": response,
        "response_time": response_time_s,
        "at_samples": at_samples,
        **places,
        "level": trial["level"],
        **{field: asked.get(field) for field in MEASURED},
        "plate": drive.plate,
        "table_crc": drive.table.crc,
    }


class _Table:
    """events.tsv, of which every row is on the disk."""

    def __init__(self, folder: Path, seed: int | None) -> None:
        self.path = folder / "events.tsv"
        self.seed = seed
        self.rows: list[dict[str, str]] = []
        header = "\t".join(COLUMNS)
        folder.mkdir(parents=True, exist_ok=True)
        _replace(folder / "events.json", json.dumps(COLUMNS, indent=2) + "\n")
        if not self.path.exists():
            _replace(self.path, header + "\n")
        text = self.path.read_bytes()
        # A process that was killed while writing a row has left a part of it.
        whole = text[: text.rfind(b"\n") + 1]
        lines = whole.decode("utf-8").splitlines()
        if not lines or lines[0] != header:
            raise BadFile(f"{self.path}: its first line has other columns than a list of trials writes")
        for number, line in enumerate(lines[1:], 2):
            cells = line.split("\t")
            if len(cells) != len(COLUMNS):
                raise BadFile(f"{self.path}, line {number}: it has {len(cells)} cells, not {len(COLUMNS)}")
            self.rows.append(dict(zip(COLUMNS, cells)))
        if len(whole) != len(text):
            with self.path.open("r+b") as file:
                file.truncate(len(whole))
                os.fsync(file.fileno())

    def add(self, values: Mapping[str, Any]) -> dict[str, str]:
        """Writes a row; it is on the disk when this returns."""
        row = {column: _cell({**values, "seed": self.seed}.get(column)) for column in COLUMNS}
        with self.path.open("ab") as file:
            file.write(("\t".join(row.values()) + "\n").encode("utf-8"))
            file.flush()
            os.fsync(file.fileno())
        self.rows.append(row)
        return row

    def check(self, row: Mapping[str, str], trial: Mapping[str, Any]) -> None:
        """Refuses the row of another trial."""
        wanted = {field: trial[field] for field in (*PLACES, "trial_type", "level") if field in trial}
        for field, value in {"seed": self.seed, **wanted}.items():
            if row[field] != _cell(value):
                number = 2 + next(number for number, other in enumerate(self.rows) if other is row)
                raise BadFile(
                    f"{self.path}, line {number}: it is of another list of trials, its {field} is {row[field]}, not "
                    f"{_cell(value)}; name another folder"
                )


def _replace(path: Path, text: str) -> None:
    """Writes a whole file or none, and has it on the disk."""
    part = path.with_name(path.name + ".part")
    with part.open("wb") as file:
        file.write(text.encode("utf-8"))
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)
    if hasattr(os, "O_DIRECTORY"):
        descriptor = os.open(path.parent, os.O_DIRECTORY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _cell(value: Any) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "n/a"
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    # A tab or a line break in an answer would make another row of it.
    return " ".join(str(value).split()) or "n/a"


def _yes(response: str, where: str) -> bool:
    if response not in ("yes", "no"):
        raise BadFile(f"{where}: a staircase takes true or false (yes or no), not {response!r}")
    return response == "yes"
