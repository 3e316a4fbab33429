"""Trials on a device: each is played, answered, and written as a row of a BIDS dataset before the next one.

::

    with slipline.connect("sim") as device:
        device.use(slipline.Plate("membrane"))
        device.arm()
        trials = [{"turning_point_m": x, "level": 0.8, "duration_s": 0.5} for x in (0.12, 0.16, 0.2)]
        slipline.trials.run(device, trials, respond=ask, folder="study", subject="01", task="edge", seed=1)

The dataset (Brain Imaging Data Structure, BIDS 1.10) has ``sub-01/ses-01/beh/sub-01_ses-01_task-edge_events.tsv`` and a description
of its columns in ``.._events.json``. The same call goes on after the last row, also after a kill.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, SupportsIndex

import numpy as np

from ._slipline import VERSION
from ._trial_fields import FIELDS, Trial, check_on_plate, checked, whole
from ._trial_files import Description, describe_dataset, events_path
from ._trial_order import check_seed, interval_s, ordered
from ._trial_play import ANSWERED, Played, Player, columns_of
from ._trial_table import COLUMNS, Axis, Rows, Table, answer_of, date_of
from .errors import BadFile, OutOfRange, Unattended
from .staircase import Staircase

__all__ = ["COLUMNS", "Interleaved", "Rows", "interleaved", "run"]

#: What a trial may not name: the columns that the run writes, and what ``respond`` gets besides the trial.
RESERVED = [*(column for column in COLUMNS if column not in FIELDS), "number"]


class Interleaved:
    """Staircases whose trials come mixed; what :func:`interleaved` returns."""

    def __init__(self, staircases: tuple[Staircase, ...], seed: int) -> None:
        self.staircases = staircases
        self._seed = seed

    def __iter__(self) -> Generator[dict[str, Any], Any, None]:
        rng = np.random.default_rng(self._seed)
        while left := [staircase for staircase in self.staircases if not staircase.done]:
            # As if the trials of all were shuffled: none is left to the end alone.
            shares = np.array([staircase.left for staircase in left], dtype=float)
            staircase = left[int(rng.choice(len(left), p=shares / shares.sum()))]
            trial = staircase.trial()
            answer = yield trial
            if answer is not None:
                staircase.take_answer(trial, answer)

    def __repr__(self) -> str:
        return f"interleaved({', '.join(map(repr, self.staircases))}, seed={self._seed})"


def interleaved(*staircases: Staircase, seed: int = 0) -> Interleaved:
    """Staircases run at the same time: each trial is one of a staircase that is not done, drawn by the seed from the trials left.

    :func:`run` takes it, and so does ``yield from`` in a generator of your own. A trial without an answer is asked again.
    """
    check_seed(seed)
    if not staircases or not all(isinstance(staircase, Staircase) for staircase in staircases):
        raise OutOfRange("staircases: interleaved() takes one staircase or more", "staircases", staircases)
    return Interleaved(staircases, seed)


def run(
    device: Any,
    trials: Iterable[Mapping[str, Any]] | Staircase,
    respond: Callable[[dict[str, Any]], Any],
    *,
    folder: str | os.PathLike[str],
    subject: str,
    task: str,
    session: str = "01",
    run: SupportsIndex | None = None,
    seed: SupportsIndex | None = None,
    max_alike: SupportsIndex | None = None,
    alike: str = "trial_type",
    practice: Iterable[Mapping[str, Any]] = (),
    break_every: SupportsIndex | None = None,
    take_break: Callable[[dict[str, Any]], Any] | None = None,
    columns: Mapping[str, Mapping[str, Any]] | None = None,
) -> Rows:
    """Runs the trials that have no row yet, and returns the rows of all of them. The device must be armed.

    **A trial** is a dictionary. What sounds: ``felt_edge_m``, ``turning_point_m`` or ``frequency_hz`` with ``level`` (0.8);
    further ``tones``, a list of a place and a level each; or a ``texture`` of ``plate.texture()``. A place of ``None``, a level
    of 0 or ``"tones": []`` is a catch trial: a tone of level 0, with the timing and the trigger output of any other.
    ``duration_s`` is rounded up to a block of 128 samples, and the tone fades within 20 ms; without it the tone sounds until
    the answer, ``timeout_s`` at the longest. ``intervals`` is a list of such dictionaries, ``gap_s`` (0.5) apart, in one trial.
    ``trial_type`` is a text, ``iti_s`` the time from the end of the trial before, a number or a range of seconds; all times are
    up to 600 s. Any other field is a column of your own. A list, tuple or array is checked before its first trial, by the plate
    in use, too; the trials of an iterator are taken one at a time.

    **The answer**, the result of ``respond(trial)``, is a truth value, a number, a text, ``None``, or a dictionary of
    ``response``, ``response_time`` in seconds where it knows it better, and columns of your own. ``respond`` gets the trial
    with the places and ``at_samples`` of its tone, ``number`` from 0 and ``practice``. It is called when the tone has faded or,
    without ``duration_s``, when it has begun. The response time counts from that call, or as ``response_time_from`` names:
    ``"end"`` of the last tone, ``"onset"``, or ``"last_onset"`` of the last interval; with an onset ``respond`` is called while
    the tone sounds. With ``timeout_s`` an answer after more than that, or ``None``, is ``timed_out``: ``respond`` returns by
    then. A generator gets the answer from ``answer = yield trial`` as its cell reads: true or false, a number, a text, or
    ``None`` for none in time. A ``Staircase`` takes true or false and repeats a trial without an answer.

    **Order.** With a ``seed`` a list comes in a random order, in which trials of the same ``block`` stay together and no more
    than ``max_alike`` with the same field ``alike`` follow each other in a block. The seed draws ``iti_s``, too. ``practice``
    is a list of trials that come first, in their order. ``take_break(trial)`` is called before the first trial after the
    practice, of another block, and after each ``break_every`` trials: the device is disarmed meanwhile, for as long as it
    takes, and armed when it returns.

    **Rows.** ``folder`` is a BIDS dataset; ``subject``, ``session``, ``task`` and ``run`` name the file in it. ``columns``
    describes columns in ``events.json`` (``{"confidence": {"Description": .., "Levels": {..}}}``); what you write into that
    file is kept. A later call goes on after the last row. It refuses by its name what differs from the rows: :class:`BadFile`.

    Raises ``OutOfRange`` for a wrong trial. ``Unattended`` where an answer took longer than the device's ``unattended_s``: its
    row is written; after ``device.arm()`` the same call goes on.
    """
    check_seed(seed)
    seed = None if seed is None else int(seed)
    run, max_alike, break_every = whole("run", run), whole("max_alike", max_alike), whole("break_every", break_every)
    if break_every is not None and take_break is None:
        raise OutOfRange("break_every: needs take_break, which is called in the break", "break_every", break_every)
    for field, function in (("respond", respond), ("take_break", take_break)):
        if not callable(function) and (field, function) != ("take_break", None):
            raise OutOfRange(f"{field} = {function!r}: must be a function of the trial", field, function)
    columns = {} if columns is None else columns
    if not isinstance(columns, Mapping) or not all(isinstance(entry, Mapping) for entry in columns.values()):
        text = f'columns = {columns!r}: must be a dictionary such as {{"sure": {{"Description": ".."}}}}'
        raise OutOfRange(text, "columns", columns)
    plate = getattr(device, "plate", None)
    first = _checked_list(practice, plate, seed)
    source = _source(trials, seed, max_alike, alike, plate)
    path = events_path(Path(folder), subject, session, task, run)
    description = Description(path.with_suffix(".json"), task, VERSION, columns)
    table = Table(path, description)
    describe_dataset(Path(folder), VERSION)
    runner = _Runner(device, respond, take_break, break_every, table, {"session": session, "seed": seed}, len(first))
    takes_yes = isinstance(trials, (Staircase, Interleaved))
    before: Trial | None = None
    number = -1
    try:
        for number, (trial, take_answer) in enumerate(_each(first, source)):
            runner.have_row(number, trial, before, takes_yes)
            take_answer(answer_of(table.rows[number]))
            before = trial
    except Unattended as error:
        raise Unattended(f"{error}; the answers so far are written: device.arm(), and the same call goes on") from error
    finally:
        source.close()
    if len(table.rows) > number + 1:
        raise BadFile(f"{path}: it has {len(table.rows)} rows, and there are {number + 1} trials")
    return table.rows


class _Runner:
    """Trials on a device with the rows that they have, or get."""

    def __init__(
        self,
        device: Any,
        respond: Callable[[dict[str, Any]], Any],
        take_break: Callable[[dict[str, Any]], Any] | None,
        break_every: int | None,
        table: Table,
        cells: dict[str, Any],
        practice: int,
    ) -> None:
        self._device = device
        self._player = Player(device, respond)
        self._take_break = take_break
        self._break_every = break_every
        self._table = table
        self._axis = Axis(table.rows, table.path)
        self._first = len(table.rows)
        self._practice = practice
        part = table.rows[-1]["part"] if table.rows else "0"
        if not part.isdecimal():
            raise BadFile(f"{table.path}, line {len(table.rows) + 1}: its part is {part}, not a number")
        self._cells = {**cells, "part": int(part) + 1}

    def have_row(self, number: int, trial: Trial, before: Trial | None, takes_yes: bool) -> None:
        """Compares the trial with its row; plays it, if it has none."""
        is_practice = number < self._practice
        iti_s = interval_s(trial, self._cells["seed"], number)
        if number < len(self._table.rows):
            self._table.check(number, trial, {"seed": self._cells["seed"], "practice": is_practice, "iti_s": iti_s})
            return
        if number == self._first:
            plate = getattr(self._device, "plate", None)
            self._table.check_device(getattr(plate, "name", None), getattr(self._device.status().table, "crc", None))
        shown = {**trial.given, "trial_type": trial.trial_type, "number": number, "practice": is_practice}
        break_s = None
        if self._take_break is not None and before is not None and self._is_due(number, trial, before):
            break_s = self._player.rest(self._take_break, shown)
        played = self._player.play(trial, iti_s, shown)
        answer = columns_of(played.answer, [*COLUMNS, *trial.own])
        response = answer["response"]
        if takes_yes and not is_practice and not (response is None or isinstance(response, (bool, np.bool_))):
            text = f"respond(trial) returned {response!r}: a staircase takes true or false, or None for no answer"
            raise OutOfRange(text, "respond", response)
        self._write(played, trial, answer, {"practice": is_practice, "break_s": break_s})
        if played.error is not None:
            raise played.error

    def _is_due(self, number: int, trial: Trial, before: Trial) -> bool:
        """Whether a break comes before this trial."""
        main = number - self._practice
        is_counted = self._break_every is not None and main > 0 and main % self._break_every == 0
        return main == 0 or is_counted or before.own.get("block") != trial.own.get("block")

    def _write(self, played: Played, trial: Trial, answer: Mapping[str, Any], values: Mapping[str, Any]) -> None:
        onset_s = self._axis.onset_s(played.values["at_samples"], played.unit, played.rate_hz, played.unix_s, played.monotonic_s)
        cells = {**self._cells, **played.values, **values, "onset": onset_s, "unit": played.unit}
        cells |= {"date": date_of(played.unix_s), "host_clock_s": round(played.monotonic_s, 6)}
        cells |= {column: answer[column] for column in ANSWERED if column in answer}
        if trial.timeout_s is not None:
            time_s = cells["response_time"]
            in_time = isinstance(time_s, (int, float, np.floating)) and time_s <= trial.timeout_s
            cells["timed_out"] = answer["response"] is None or not in_time
        own = {column: value for column, value in answer.items() if column not in ANSWERED}
        self._table.add(cells, {**trial.own, **own})


def _checked_list(trials: Iterable[Mapping[str, Any]], plate: Any, seed: int | None) -> list[Trial]:
    found = []
    for number, trial in enumerate(trials, 1):
        try:
            found.append(checked(trial, RESERVED))
            interval_s(found[-1], seed, 0)
        except OutOfRange as error:
            raise OutOfRange(f"trial {number}: {error}", error.field, error.value, error.low, error.high) from None
    if plate is not None:
        check_on_plate(found, plate)
    return found


def _source(
    trials: Iterable[Mapping[str, Any]] | Staircase, seed: int | None, max_alike: int | None, alike: str, plate: Any
) -> Generator[Trial, Any, None]:
    """The trials one at a time, which takes the answer to each. What is known of them is checked before."""
    if isinstance(trials, Staircase):
        trials = Interleaved((trials,), 0)
    if isinstance(trials, (Interleaved, Iterator)):
        if max_alike is not None:
            raise OutOfRange(f"max_alike = {max_alike}: the trials of an iterator have their own order", "max_alike", max_alike)
        return _one_at_a_time(iter(trials))
    listed = ordered(_checked_list(trials, plate, seed), seed, max_alike, alike)
    return (trial for trial in listed)


def _one_at_a_time(trials: Iterator[Mapping[str, Any]]) -> Generator[Trial, Any, None]:
    send = getattr(trials, "send", None)
    try:
        trial = next(trials)
        while True:
            answer = yield checked(trial, RESERVED)
            trial = next(trials) if send is None else send(answer)
    except StopIteration:
        return
    finally:
        close = getattr(trials, "close", None)
        if close is not None:
            close()


def _each(first: list[Trial], source: Generator[Trial, Any, None]) -> Iterator[tuple[Trial, Callable[[Any], None]]]:
    """The practice, and then the trials, each with the function that takes its answer."""
    for trial in first:
        yield trial, lambda _answer: None
    answers: list[Any] = []
    try:
        trial = next(source)
        while True:
            yield trial, answers.append
            trial = source.send(answers.pop())
    except StopIteration:
        return
