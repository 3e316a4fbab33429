"""The folder of a dataset in the Brain Imaging Data Structure (BIDS 1.10): names, descriptions, and files that are on the disk."""

from __future__ import annotations

import json
import math
import os
import platform
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .errors import BadFile, OutOfRange

__all__ = ["Description", "cell", "events_path", "replace"]

BIDS_VERSION = "1.10.0"
#: A column with more texts than this has no list of them.
MOST_LEVELS = 50


def events_path(folder: Path, subject: str, session: str, task: str, run: int | None) -> Path:
    """The path of events.tsv below the dataset's folder."""
    names = {"sub": subject, "ses": session, "task": task}
    for field, label in zip(("subject", "session", "task"), names.values()):
        if not isinstance(label, str) or not re.fullmatch("[A-Za-z0-9]+", label):
            raise OutOfRange(f"{field} = {label!r}: must be a text of letters and digits", field, label)
    if run is not None:
        names["run"] = str(run)
    name = "_".join(f"{key}-{label}" for key, label in names.items())
    return folder / f"sub-{subject}" / f"ses-{session}" / "beh" / f"{name}_events.tsv"


def describe_dataset(folder: Path, version: str) -> None:
    """Writes ``dataset_description.json``, unless there is one."""
    path = folder / "dataset_description.json"
    if not path.exists():
        generated = [{"Name": "slipline", "Version": version}]
        name = folder.resolve().name or "dataset"
        fields = {"Name": name, "BIDSVersion": BIDS_VERSION, "DatasetType": "raw", "GeneratedBy": generated}
        replace(path, json.dumps(fields, indent=2) + "\n")


class Description:
    """``events.json``: the meaning of each column, and the texts that it has. What a person has written into it is kept."""

    def __init__(self, path: Path, task: str, version: str, columns: Mapping[str, Mapping[str, Any]]) -> None:
        self.path = path
        self._columns = columns
        self._written = ""
        software = {"OperatingSystem": platform.platform(), "SoftwareName": "slipline", "SoftwareVersion": version}
        self._fields: dict[str, Any] = {"TaskName": task, "StimulusPresentation": software}
        if path.exists():
            try:
                self._written = path.read_text("utf-8")
                found = json.loads(self._written)
            except ValueError as error:
                raise BadFile(f"{path}: it is no JSON: {error}") from None
            if not isinstance(found, dict):
                raise BadFile(f"{path}: it is no JSON object")
            self._fields.update(found)

    def take(self, fixed: Mapping[str, Mapping[str, Any]], rows: list[dict[str, str]], names: list[str]) -> None:
        """Describes these columns with the values that they have, and writes the file if anything of it is new."""
        for name in names:
            entry: dict[str, Any] = dict(fixed.get(name, {"Description": "Column of the experimenter"}))
            found = self._fields.get(name, {})
            entry.update(found if isinstance(found, dict) else {})
            entry.update(self._columns.get(name, {}))
            self._fields[name] = entry
            if name not in fixed or "Levels" in entry or name in ("trial_type", "response"):
                self._list_levels(name, entry, [row.get(name, "n/a") for row in rows])
        text = json.dumps(self._fields, indent=2, ensure_ascii=False) + "\n"
        if text != self._written:
            replace(self.path, text)
            self._written = text

    def _list_levels(self, name: str, entry: dict[str, Any], cells: list[str]) -> None:
        """A value that is not in the list of its column is an error in BIDS."""
        values = {value for value in cells if value != "n/a"}
        levels = entry.get("Levels", {})
        if len(values) > MOST_LEVELS or not isinstance(levels, dict):
            entry.pop("Levels", None)
        elif levels or any(_is_text(value) for value in values):
            truth = {"yes": "True", "no": "False"}
            entry["Levels"] = {**levels, **{value: truth.get(value, value) for value in sorted(values) if value not in levels}}


def _is_text(value: str) -> bool:
    try:
        float(value)
    except ValueError:
        return True
    return False


def replace(path: Path, text: str) -> None:
    """Writes a whole file or none, and has it on the disk."""
    part = path.with_name(f".{path.name}.part")
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


def _plain(value: Any) -> Any:
    """A value that ``json`` does not know. The text of a long array would leave most of it out."""
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else str(value)


def cell(value: Any) -> str:
    """A value as a cell of a row: what has none is n/a."""
    if value is None or (isinstance(value, (float, np.floating)) and math.isnan(value)):
        return "n/a"
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (dict, list, tuple, np.ndarray)):
        return json.dumps(value, separators=(",", ":"), default=_plain)
    # A tab or a line break in an answer would make another row of it.
    return " ".join(str(value).split()) or "n/a"
