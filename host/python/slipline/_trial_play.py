"""One trial on a device: its intervals, the answer, and when each was by the clocks of the device and of this computer."""

from __future__ import annotations

import itertools
import re
import time
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial
from typing import Any

from ._trial_fields import Sound, Trial
from ._waiting import on_a_thread
from .errors import Refused
from .staircase import PLACES

__all__ = ["ANSWERED", "Played", "Player", "columns_of"]

#: The columns of the run that an answer function may give itself: the response time of a keyboard, as an example.
ANSWERED = ("response", "response_time")
#: The device takes an end up to a minute ahead; ``stop`` waits with one farther ahead than 50 s.
_AHEAD_S = 45.0
#: An end is at the first sample of a block of this size.
_BLOCK = 128


@dataclass
class Played:
    """A trial that was played and answered."""

    #: The cells of its row, as far as they are known here.
    values: dict[str, Any]
    #: As the answer function returned it.
    answer: Any
    unit: str
    rate_hz: float
    #: Of its onset.
    unix_s: float
    monotonic_s: float
    #: What the device raised after the answer; the row is written before it is raised.
    error: BaseException | None


@dataclass
class _Interval:
    sound: Sound
    drive: Any
    at_samples: int
    #: Where it fades; ``None`` until the answer.
    end: int | None
    #: What sends that end, where it is too far ahead for the device.
    later: Future[int] | None = None

    def check_end(self) -> None:
        """Raises why the end could not be sent, if it could not."""
        if self.later is not None and self.later.done():
            self.later.result()

    def asked_tone(self) -> dict[str, float]:
        """Its first tone that sounds, or else the first one."""
        tones = self.sound.audible or self.sound.tones
        return tones[0] if tones else {}

    def is_silent(self) -> bool:
        return not self.sound.audible and self.sound.texture is None

    def tones(self) -> list[dict[str, Any]]:
        """Its tones as played."""
        tones = [] if self.is_silent() else self.drive.tones
        return [{field: getattr(tone, field) for field in (*PLACES, "level")} for tone in tones]


class Player:
    """Plays trials on a device and asks for the answers."""

    def __init__(self, device: Any, respond: Callable[[dict[str, Any]], Any]) -> None:
        self._device = device
        self._respond = respond
        self._silent_m: float | None = None
        self._ended_s = time.monotonic()

    def rest(self, take_break: Callable[[dict[str, Any]], Any], shown: dict[str, Any]) -> float:
        """Takes a break, in which the device is disarmed; returns its length in seconds."""
        began_s = time.monotonic()
        with self._device.rest():
            take_break(shown)
        self._ended_s = time.monotonic()
        return round(self._ended_s - began_s, 6)

    def play(self, trial: Trial, iti_s: float, shown: dict[str, Any]) -> Played:
        """Plays a trial ``iti_s`` after the one before, and asks for its answer."""
        device, rate_hz = self._device, float(self._device.sample_rate_hz)
        if (rest_s := self._ended_s + iti_s - time.monotonic()) > 0:
            device.wait(seconds=rest_s)
        has_end = trial.sounds[-1].duration_s is not None
        # An answer that counts from an onset is one that may come while the tone sounds.
        while_it_sounds = not has_end or trial.response_time_from in ("onset", "last_onset")
        intervals: list[_Interval] = []
        for number, sound in enumerate(trial.sounds, 1):
            if intervals:
                device.wait((intervals[-1].end or 0) + round(trial.gap_s * rate_hz))
            length_s = trial.timeout_s if sound.duration_s is None else sound.duration_s
            is_answered = while_it_sounds and number == len(trial.sounds)
            intervals.append(self._begin(sound, length_s, rate_hz, is_answered))
        first, last = intervals[0], intervals[-1]
        before_s = time.monotonic()
        status = device.status()
        now_s, now_samples = (before_s + time.monotonic()) / 2, int(status.now_samples)

        def host_s(at_samples: int) -> float:
            return now_s - (now_samples - at_samples) / rate_hz

        if not while_it_sounds and last.end is not None:
            # A stop of another thread ends it before.
            last.end = min(last.end, device.wait(last.end))
        shown = {**shown, **self._places(first), "at_samples": first.at_samples}
        called_s = time.monotonic()
        try:
            answer = self._respond(shown)
        except BaseException:
            if last.later is not None:
                # An end that is sent later would end what sounds then.
                device.stop()
            raise
        answered_s = time.monotonic()
        error: BaseException | None = None
        try:
            if not has_end:
                stopped = device.stop()
                last.end = stopped if last.end is None else min(last.end, stopped)
            elif while_it_sounds and last.end is not None:
                last.end = min(last.end, device.wait(last.end))
                last.check_end()
        except BaseException as raised:  # The answer is not lost by it.
            error = raised
        named = {"onset": host_s(first.at_samples), "last_onset": host_s(last.at_samples), "call": called_s}
        if last.end is not None:
            named["end"] = host_s(last.end)
        response_time_s = answered_s - named[trial.response_time_from]
        onset_s = host_s(first.at_samples)
        played: list[dict[str, Any]] = [
            {"at_samples": it.at_samples, "duration_s": _between_s(it.at_samples, it.end, rate_hz), "tones": it.tones()}
            for it in intervals
        ]
        is_plain = len(intervals) == 1 and len(played[0]["tones"]) <= 1 and first.sound.texture is None
        values = {
            "duration": _between_s(first.at_samples, last.end, rate_hz),
            "trial_type": trial.trial_type,
            "response_time": round(response_time_s, 6),
            "at_samples": first.at_samples,
            **self._places(first),
            "iti_s": iti_s,
            "asked": trial.asked(),
            "played": None if is_plain else played,
            "plate": first.drive.plate,
            "table_crc": first.drive.table.crc,
        }
        self._ended_s = time.monotonic()
        unix_s = time.time() - (self._ended_s - onset_s)
        return Played(values, answer, str(status.unit), rate_hz, unix_s, onset_s, error)

    def _begin(self, sound: Sound, length_s: float | None, rate_hz: float, is_answered: bool) -> _Interval:
        """Begins a sound of this length; ``is_answered`` while it sounds."""
        drive = self._drive(sound)
        if drive.superseded:
            raise Refused("the trial's drive never began: another thread drives or stops the device")
        at_samples = int(drive.at_samples)
        end, later = None, None
        if length_s is not None:
            end = at_samples + round(length_s * rate_hz)
            if is_answered and length_s > _AHEAD_S:
                # The answer must not wait until the end can be sent.
                end = -(-end // _BLOCK) * _BLOCK
                later = on_a_thread(partial(self._device.stop, at=end))
            else:
                # Before it has begun: the end is then at its sample, whatever this program is doing.
                end = self._device.stop(at=end)
        self._device.wait(drive)
        return _Interval(sound, drive, at_samples, end, later)

    def _drive(self, sound: Sound) -> Any:
        if sound.texture is not None:
            return self._device.play(sound.texture)
        if sound.audible:
            first, *further = sound.audible
            return self._device.drive(**first, tones=further) if further else self._device.drive(**first)
        # A tone of level 0: the timing and the trigger output are those of any other trial.
        if self._silent_m is None:
            table = self._device.status().table
            if table is None:
                raise Refused("the device has no plate: call use(plate) first")
            self._silent_m = (table.span_start_m + table.span_end_m) / 2
        return self._device.drive(turning_point_m=self._silent_m, level=0.0)

    def _places(self, interval: _Interval) -> dict[str, Any]:
        """The columns of the first tone: the requested place as it was given, the others by the plate."""
        asked = interval.asked_tone()
        if interval.is_silent():
            return {**dict.fromkeys(PLACES), **asked, "level": 0.0}
        return {**interval.tones()[0], **asked}


def columns_of(answer: Any, taken: Iterable[str]) -> dict[str, Any]:
    """The columns of what an answer function returned: ``response``, and those of a dictionary.

    No answer is lost: a name that is taken, or cannot be that of a column, begins with ``answer_``, and ends in ``_2`` where that
    is taken, too.
    """
    if not isinstance(answer, Mapping):
        return {"response": answer}
    columns = {"response": None, **{name: answer[name] for name in ANSWERED if name in answer}}
    taken = {*taken, *columns}
    for name, value in answer.items():
        if name in ANSWERED:
            continue
        column = re.sub("[^A-Za-z0-9_]", "_", str(name))
        if column != name or column in taken or not column.isidentifier():
            column = f"answer_{column}"
        numbered = (column if number == 1 else f"{column}_{number}" for number in itertools.count(1))
        column = next(name for name in numbered if name not in taken)
        taken.add(column)
        columns[column] = value
    return columns


def _between_s(start: int, end: int | None, rate_hz: float) -> float | None:
    return None if end is None else (end - start) / rate_hz
