"""The fields of a trial: what it may have, and what of it is checked before anything is played."""

from __future__ import annotations

import difflib
import json
import math
import re
import sys
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import OutOfRange
from .results import Texture
from .staircase import PLACES

__all__ = ["Sound", "Trial", "check_on_plate", "checked", "whole"]

#: The fields of what sounds, in a trial or in one of its intervals.
SOUND = (*PLACES, "level", "tones", "texture", "duration_s")
#: The other fields of a trial; any further one is a column of the experimenter.
FIELDS = (*SOUND, "trial_type", "intervals", "gap_s", "iti_s", "timeout_s", "response_time_from")
#: From when a response time counts: `call` is the call of the answer function.
NAMED_ONSETS = ("call", "onset", "last_onset", "end")
USUAL_LEVEL = 0.8
LONGEST_S = 600.0


@dataclass(frozen=True)
class Sound:
    """What sounds in one interval of a trial: tones, a texture, or nothing."""

    #: The asked tones, each with one place, or none, and a level; those of level 0 do not sound.
    tones: tuple[dict[str, float], ...]
    texture: Texture | None
    #: ``None``: until the answer.
    duration_s: float | None

    @property
    def audible(self) -> list[dict[str, float]]:
        """The tones that have a place and a level."""
        return [tone for tone in self.tones if tone["level"] > 0 and len(tone) == 2]

    def asked(self) -> dict[str, Any]:
        """Its fields as plain data."""
        fields: dict[str, Any] = {"tones": list(self.tones), "duration_s": self.duration_s}
        if len(self.tones) == 1:
            fields = {**self.tones[0], "duration_s": self.duration_s}
        if self.texture is not None:
            text = json.dumps(self.texture.to_dict(), sort_keys=True)
            fields = {"texture": f"{zlib.crc32(text.encode()):08x}", "duration_s": self.duration_s}
        return fields


@dataclass(frozen=True)
class Trial:
    """A trial whose fields are allowed."""

    trial_type: str
    sounds: tuple[Sound, ...]
    gap_s: float
    #: The range of the interval before it.
    iti_s: tuple[float, float]
    timeout_s: float | None
    response_time_from: str
    #: The experimenter's own columns.
    own: dict[str, Any]
    #: As it was given.
    given: dict[str, Any]

    def asked(self) -> dict[str, Any]:
        """The fields that are not columns of their own, as plain data: those that a trial of the same row must have, too."""
        fields = self.sounds[0].asked()
        if len(self.sounds) > 1:
            fields = {"intervals": [sound.asked() for sound in self.sounds], "gap_s": self.gap_s}
        return {**fields, "timeout_s": self.timeout_s, "response_time_from": self.response_time_from}


def checked(given: Mapping[str, Any], reserved: Iterable[str] = ()) -> Trial:
    """The trial of these fields; ``reserved`` are the columns that the run writes. Raises ``OutOfRange`` with the wrong field."""
    if not isinstance(given, Mapping):
        text = f"{given!r}: a trial is a dictionary of its fields; a table of pandas is table.to_dict('records')"
        raise OutOfRange(text, "trials", given)
    given = dict(given)
    own = {field: value for field, value in given.items() if field not in FIELDS}
    for field, value in own.items():
        _check_own(field, value, set(reserved))
    trial_type = _text(given, "trial_type", "trial")
    if not trial_type.strip() or any(ord(letter) < 32 for letter in trial_type):
        raise OutOfRange(f"trial_type = {trial_type!r}: must be one line without tabs", "trial_type", trial_type)
    intervals = given.get("intervals")
    if not _is_given(intervals):
        if _is_given(given.get("gap_s")):
            raise OutOfRange("gap_s: only a trial with intervals has a gap", "gap_s", given["gap_s"])
        sounds: tuple[Sound, ...] = (_sound(given),)
    else:
        sounds = _intervals(given, intervals)
    response_time_from = _text(given, "response_time_from", "call")
    if response_time_from not in NAMED_ONSETS:
        text = f"response_time_from = {response_time_from!r}: must be one of {', '.join(NAMED_ONSETS)}"
        raise OutOfRange(text, "response_time_from", response_time_from)
    if response_time_from == "end" and sounds[-1].duration_s is None:
        raise OutOfRange('response_time_from = "end": needs duration_s', "response_time_from", "end")
    gap_s = given.get("gap_s")
    return Trial(
        trial_type=" ".join(trial_type.split()),
        sounds=sounds,
        gap_s=_number("gap_s", gap_s, 0.0, LONGEST_S) if _is_given(gap_s) else 0.5,
        iti_s=_range(given.get("iti_s")),
        timeout_s=_duration("timeout_s", given.get("timeout_s")),
        response_time_from=response_time_from,
        own=own,
        given=given,
    )


def check_on_plate(trials: Iterable[Trial], plate: Any) -> None:
    """Refuses the first tone that this plate does not have, before any trial is run."""
    seen: set[tuple[str, float, float]] = set()
    for number, trial in enumerate(trials, 1):
        for tone in (tone for sound in trial.sounds for tone in sound.audible):
            place = next(field for field in PLACES if field in tone)
            if (key := (place, tone[place], tone["level"])) in seen:
                continue
            seen.add(key)
            try:
                if place == "felt_edge_m":
                    plate.respond(felt_edge_m=tone[place], level=tone["level"], points=8)
                elif place == "turning_point_m":
                    plate.frequency_hz(tone[place])
                else:
                    plate.turning_point_m(tone[place])
            except OutOfRange as error:
                raise OutOfRange(f"trial {number}: {error}", error.field, error.value, error.low, error.high) from None


def _intervals(given: Mapping[str, Any], intervals: Any) -> tuple[Sound, ...]:
    for field in SOUND:
        if _is_given(given.get(field)):
            raise OutOfRange(f"{field}: a trial with intervals has it in each of them", field, given[field])
    if isinstance(intervals, (str, Mapping)) or not isinstance(intervals, Sequence) or not intervals:
        raise OutOfRange("intervals: must be a list of dictionaries, one for each interval", "intervals", intervals)
    for fields in intervals:
        if not isinstance(fields, Mapping):
            raise OutOfRange(f"intervals: {fields!r} is no dictionary", "intervals", intervals)
        for field in fields:
            if field not in SOUND:
                raise OutOfRange(f"{field}: an interval has {', '.join(sorted(SOUND))}", field, fields[field])
        if fields.get("duration_s") is None:
            raise OutOfRange("duration_s: each interval needs it", "duration_s", None, 0.0, LONGEST_S)
    return tuple(_sound(fields) for fields in intervals)


def _sound(fields: Mapping[str, Any]) -> Sound:
    if not any(field in fields for field in (*PLACES, "tones", "texture")):
        names = ", ".join((*PLACES, "tones", "texture"))
        raise OutOfRange(f"a trial has one of {names}, or intervals; None or a level of 0 is a catch trial", "trials", dict(fields))
    duration_s = _duration("duration_s", fields.get("duration_s"))
    level = fields.get("level")
    tones = fields.get("tones")
    tones = tones if _is_given(tones) else ()
    if isinstance(tones, (str, Mapping)) or not isinstance(tones, Sequence):
        raise OutOfRange("tones: must be a list of dictionaries, one for each tone", "tones", tones)
    own = [_tone(fields)] if any(field in fields for field in PLACES) or not tones else []
    listed = (*own, *(_tone(tone, alone=True) for tone in tones))
    texture = fields.get("texture")
    if not _is_given(texture):
        return Sound(listed, None, duration_s)
    if not isinstance(texture, Texture):
        raise OutOfRange("texture: must be the result of plate.texture()", "texture", texture)
    if any(len(tone) == 2 for tone in listed):
        raise OutOfRange("texture: a trial with a texture has no other tones", "texture", texture)
    if _is_given(level) and level != 0:
        raise OutOfRange(f"level = {level}: a texture has its own; 0 is a catch trial", "level", level)
    return Sound((), texture if level is None or not _is_given(level) else None, duration_s)


def _tone(fields: Mapping[str, Any], alone: bool = False) -> dict[str, float]:
    """A tone's place, if it has one, and level."""
    if alone:
        if not isinstance(fields, Mapping):
            raise OutOfRange(f"tones: {fields!r} is no dictionary", "tones", fields)
        for field in fields:
            if field not in (*PLACES, "level"):
                raise OutOfRange(f"{field}: a tone has {', '.join((*PLACES, 'level'))}", field, fields[field])
    places = [field for field in PLACES if _is_given(fields.get(field))]
    if len(places) > 1 or (alone and not places):
        raise OutOfRange(f"a tone has one of {', '.join(PLACES)}: this one has {len(places)}", "trials", dict(fields))
    level = fields.get("level")
    tone = {field: _number(field, fields[field], 0.0, math.inf) for field in places}
    return {**tone, "level": _number("level", level, 0.0, 1.0) if _is_given(level) else USUAL_LEVEL if places else 0.0}


def _check_own(field: Any, value: Any, reserved: set[str]) -> None:
    if not isinstance(field, str) or not (field.isascii() and field.isidentifier()):
        raise OutOfRange(f"{field!r}: the name of a column has letters, digits and _", str(field), value)
    if field in reserved:
        raise OutOfRange(f"{field}: the run writes this column itself; a trial has {', '.join(FIELDS)}", field, value)
    near = difflib.get_close_matches(field, FIELDS, 1, 0.8)
    near = near or [name for name in FIELDS if _without_unit(name) == _without_unit(field)]
    if near:
        raise OutOfRange(f"{field}: did you mean {near[0]}? Name a column of your own otherwise", field, value)
    if not (value is None or isinstance(value, (str, bool, int, float, np.bool_, np.integer, np.floating))):
        raise OutOfRange(f"{field}: a column has one number, text or truth value in a row", field, value)


def _without_unit(field: str) -> str:
    """A field's name before its unit."""
    return re.sub("_(m|cm|mm|um|s|ms|hz|khz)$", "", field)


def _is_given(value: Any) -> bool:
    """Whether a field has a value: an empty cell of a table is NaN."""
    return not (value is None or (isinstance(value, (float, np.floating)) and math.isnan(value)))


def _text(fields: Mapping[str, Any], field: str, usual: str) -> str:
    value = fields.get(field)
    return str(value) if _is_given(value) else usual


def _number(field: str, value: Any, low: float, high: float) -> float:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise OutOfRange(f"{field} = {value!r}: must be a number", field, value)
    # A whole number may be beyond the largest float.
    if not low <= value <= high or not -sys.float_info.max <= value <= sys.float_info.max:
        allowed = "0 or above, and finite" if math.isinf(high) else f"{low:g} to {high:g}"
        raise OutOfRange(f"{field} = {value}: must be {allowed}", field, value, low, high)
    return float(value)


def whole(field: str, value: Any) -> int | None:
    """A whole number from 1, or ``None``: also one of NumPy."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < 1:
        raise OutOfRange(f"{field} = {value!r}: must be None or a whole number from 1", field, value)
    return int(value)


def _duration(field: str, value: Any) -> float | None:
    if not _is_given(value):
        return None
    if _number(field, value, -math.inf, math.inf) <= 0 or value > LONGEST_S:
        raise OutOfRange(f"{field} = {value}: must be above 0, up to {LONGEST_S:g} s", field, value, 0.0, LONGEST_S)
    return float(value)


def _range(iti_s: Any) -> tuple[float, float]:
    """A number of seconds, or a range of them."""
    if not _is_given(iti_s):
        return (0.0, 0.0)
    ends = list(iti_s) if isinstance(iti_s, (tuple, list, np.ndarray)) else [iti_s, iti_s]
    if len(ends) != 2:
        raise OutOfRange(f"iti_s = {iti_s}: must be a number of seconds or a pair of them", "iti_s", iti_s, 0.0, LONGEST_S)
    low, high = (_number("iti_s", end, 0.0, LONGEST_S) for end in ends)
    if low > high:
        raise OutOfRange(f"iti_s = {iti_s}: its first number must not be above the second", "iti_s", iti_s, 0.0, LONGEST_S)
    return (low, high)
