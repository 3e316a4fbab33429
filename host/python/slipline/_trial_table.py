"""``events.tsv``: a row for each trial, which is on the disk, and the comparison of a later call's trials with the rows."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from ._trial_fields import Trial
from ._trial_files import Description, cell, replace
from .errors import BadFile

__all__ = ["COLUMNS", "Axis", "Rows", "Table", "answer_of", "date_of"]

_YES = {"yes": "True", "no": "False"}

#: The columns that every file has, each with its description. What has no value is n/a.
COLUMNS: Mapping[str, Mapping[str, Any]] = {
    "onset": {
        "Description": "First sample of the trial's drive after that of the first trial: by the device's sample clock; across an "
        "interruption in which it was reset, by this computer's",
        "Units": "s",
    },
    "duration": {"Description": "From the onset to the first sample at which the last tone fades", "Units": "s"},
    "trial_type": {"Description": "The trial's own type"},
    "response": {"Description": "The answer; yes and no where it was true or false"},
    "response_time": {"Description": "From the named onset, or the call for the answer, to the answer", "Units": "s"},
    "session": {"Description": "Label of the session"},
    "part": {"Description": "Number of the call that wrote the row, from 1; each resumption is a further one"},
    "practice": {"Description": "Whether the trial was practice", "Levels": _YES},
    "timed_out": {"Description": "Whether no answer came within the trial's time; n/a where it has no limit", "Levels": _YES},
    "date": {"Description": "The onset in Coordinated Universal Time (UTC), ISO 8601, by this computer's clock"},
    "host_clock_s": {"Description": "The onset on this computer's monotonic clock, near zero at its start", "Units": "s"},
    "unit": {"Description": "Number of the device"},
    "at_samples": {
        "Description": "The onset on the device's sample clock; smaller than in the row before where the device was reset",
        "Units": "samples",
    },
    "felt_edge_m": {"Description": "Felt edge of the first tone: as asked for, or by the plate in use", "Units": "m"},
    "turning_point_m": {"Description": "Turning point of the first tone: as asked for, or by the plate in use", "Units": "m"},
    "frequency_hz": {"Description": "Frequency of the first tone", "Units": "Hz"},
    "level": {"Description": "Level of the first tone, 0 to 1 of the table's full scale; 0 in a catch trial"},
    "iti_s": {"Description": "Time from the end of the trial before to the earliest onset", "Units": "s"},
    "break_s": {"Description": "Length of the break before the trial", "Units": "s"},
    "asked": {"Description": "What was asked for, as JSON"},
    "played": {"Description": "Each interval and its tones as played, as JSON; n/a for a single tone, which the columns describe"},
    "plate": {"Description": "Name of the plate in use"},
    "table_crc": {"Description": "CRC-32 of the table on the device, eight hexadecimal digits"},
    "seed": {"Description": "Seed of the order and of the times between the trials"},
}


class Rows(list[dict[str, str]]):
    """The rows of ``events.tsv``: of each trial its cells as texts, by the names of the columns."""

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with a row for each trial: numbers as numbers, ``n/a`` as missing, names and ``yes`` and ``no`` as
        texts. Needs pandas."""
        import pandas  # type: ignore[import-untyped]

        names = list(self[0]) if self else list(COLUMNS)
        text = "\n".join("\t".join(cells) for cells in (names, *(row.values() for row in self)))
        # Labels such as 01 are no numbers. A cell holds no quotation marks that a reader takes away.
        labels = dict.fromkeys(("session", "unit", "plate", "table_crc"), str)
        return pandas.read_csv(io.StringIO(text), sep="\t", na_values="n/a", keep_default_na=False, dtype=labels, quoting=csv.QUOTE_NONE)


class Table:
    """The rows of one file."""

    def __init__(self, path: Path, description: Description) -> None:
        self.path = path
        self.rows = Rows()
        self.names = list(COLUMNS)
        self._description = description
        path.parent.mkdir(parents=True, exist_ok=True)
        # A killed process has left it.
        for whole_file in (path, description.path):
            whole_file.with_name(f".{whole_file.name}.part").unlink(missing_ok=True)
        if not path.exists():
            replace(path, "\t".join(self.names) + "\n")
        text = path.read_bytes()
        # A process that was killed while writing a row has left a part of it.
        whole = text[: text.rfind(b"\n") + 1]
        lines = whole.decode("utf-8", "replace").splitlines()
        header = lines[0].split("\t") if lines else []
        if header[: len(self.names)] != self.names or len(set(header)) != len(header):
            raise BadFile(f"{path}: its first line has other columns than a list of trials writes")
        self.names = header
        for number, line in enumerate(lines[1:], 2):
            cells = line.split("\t")
            if len(cells) != len(header):
                raise BadFile(f"{path}, line {number}: it has {len(cells)} cells, not {len(header)}")
            self.rows.append(dict(zip(header, cells)))
        # One with all its cells may be whole: an editor leaves the last line end out.
        if text[len(whole) :].count(b"\t") == len(header) - 1:
            raise BadFile(f"{path}, line {len(lines) + 1}: it has no line end: add one, or remove the line where it is cut")
        description.take(COLUMNS, self.rows, self.names)
        if len(whole) != len(text):
            with path.open("r+b") as file:
                file.truncate(len(whole))
                os.fsync(file.fileno())

    def add(self, values: Mapping[str, Any], own: Mapping[str, Any]) -> None:
        """Writes a row; it is on the disk when this returns. A column that is new is n/a in the rows before."""
        row = {column: cell(values.get(column)) for column in COLUMNS}
        row |= {column: cell(value) for column, value in own.items()}
        names = [*self.names, *(name for name in row if name not in self.names)]
        row = {name: row.get(name, "n/a") for name in names}
        rows = Rows([*self.rows, row])
        # Before the row: its values must be in the description.
        self._description.take(COLUMNS, rows, names)
        if names == self.names:
            with self.path.open("ab") as file:
                file.write((_line(row, names) + "\n").encode("utf-8"))
                file.flush()
                os.fsync(file.fileno())
        else:
            lines = ["\t".join(names), *(_line(row, names) for row in rows)]
            replace(self.path, "\n".join(lines) + "\n")
            rows = Rows({name: row.get(name, "n/a") for name in names} for row in rows)
        self.names = names
        self.rows = rows

    def check(self, number: int, trial: Trial, fields: Mapping[str, Any]) -> None:
        """Refuses the row of a trial that is another one than this; ``fields`` are cells that it must have, too."""
        row = self.rows[number]
        try:
            asked = json.loads(row["asked"])
        except ValueError:
            asked = None
        if not isinstance(asked, dict):
            raise BadFile(f"{self.path}, line {number + 2}: the cell asked is no JSON object")
        wanted = json.loads(json.dumps(trial.asked()))
        cells = {**fields, "trial_type": trial.trial_type, **trial.own}
        pairs = {field: (row.get(field, "n/a"), cell(value)) for field, value in cells.items()}
        pairs |= {field: (asked.get(field), wanted.get(field)) for field in {**asked, **wanted}}
        for field, (found, expected) in pairs.items():
            if found != expected:
                raise BadFile(
                    f"{self.path}, line {number + 2}: it is of another list of trials, its {field} is {_shown(found)}, not "
                    f"{_shown(expected)}; name another session or run"
                )

    def check_device(self, plate: str | None, table_crc: str | None) -> None:
        """Refuses to go on with another plate or table than that of the rows."""
        for field, value in (("plate", plate), ("table_crc", table_crc)):
            if self.rows and value is not None and self.rows[-1][field] != cell(value):
                raise BadFile(
                    f"{self.path}, line {len(self.rows) + 1}: its {field} is {self.rows[-1][field]}, and the device's is "
                    f"{cell(value)}; use that of the rows, or name another session or run"
                )


class Axis:
    """Onsets on one axis, whose zero is the first trial: by the device's clock as long as it and the computer's agree."""

    #: Most that both may differ between two trials: half a second, and a part in a thousand.
    TOLERANCE_S, TOLERANCE = 0.5, 1e-3

    def __init__(self, rows: list[dict[str, str]], path: Path) -> None:
        """The axis of these rows of the file ``path``."""
        # Where the device's clock was last compared with the axis: sample index and onset.
        self._anchor: tuple[int, float] | None = None
        # Of the latest trial: sample index, onset, unit, and the host's clock, which is the monotonic one in the same process.
        self._latest: tuple[int, float, str, float, bool] | None = None
        if rows:
            row = rows[-1]
            try:
                at_samples, onset_s = int(row["at_samples"]), float(row["onset"])
                unix_s = datetime.fromisoformat(row["date"]).timestamp()
            except ValueError:
                text = f"{path}, line {len(rows) + 1}: its onset, at_samples or date cannot be read"
                raise BadFile(text) from None
            self._anchor = (at_samples, onset_s)
            self._latest = (at_samples, onset_s, row["unit"], unix_s, False)

    def onset_s(self, at_samples: int, unit: str, rate_hz: float, unix_s: float, monotonic_s: float) -> float:
        """The onset of the next trial."""
        if self._anchor is None or self._latest is None:
            self._anchor = (at_samples, 0.0)
            onset_s = 0.0
        else:
            latest_samples, latest_s, latest_unit, host_s, is_monotonic = self._latest
            by_host_s = (monotonic_s if is_monotonic else unix_s) - host_s
            by_device_s = (at_samples - latest_samples) / rate_hz
            differ_s = abs(by_device_s - by_host_s)
            if unit == latest_unit and by_device_s > 0 and differ_s <= self.TOLERANCE_S + self.TOLERANCE * abs(by_host_s):
                onset_s = self._anchor[1] + (at_samples - self._anchor[0]) / rate_hz
            else:
                onset_s = latest_s + max(by_host_s, 0.0)
                self._anchor = (at_samples, onset_s)
        self._latest = (at_samples, onset_s, unit, monotonic_s, True)
        return onset_s


def date_of(unix_s: float) -> str:
    """A time as the column ``date`` has it."""
    return datetime.fromtimestamp(unix_s, UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")


def answer_of(row: Mapping[str, str]) -> Any:
    """The answer of a row as its cell reads: a truth value, a number, a text; ``None`` for none, or one that came too late."""
    response = row["response"]
    if response == "n/a" or row["timed_out"] == "yes":
        return None
    if response in ("yes", "no"):
        return response == "yes"
    # Python reads more as a number than a cell of one has: 1_000, and the digits of other scripts.
    if response.isascii() and "_" not in response:
        for kind in (int, float):
            try:
                return kind(response)
            except ValueError:
                pass
    return response


def _line(row: Mapping[str, str], names: list[str]) -> str:
    return "\t".join(row.get(name, "n/a") for name in names)


def _shown(value: Any) -> str:
    return "n/a" if value is None else cell(value)
