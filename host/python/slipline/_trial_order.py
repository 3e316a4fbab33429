"""What chance decides in a list of trials, by its seed alone: the order, and the time before each trial."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np

from ._trial_fields import Trial
from .errors import OutOfRange

__all__ = ["check_seed", "interval_s", "ordered", "with_at_most_alike"]


def check_seed(seed: Any) -> None:
    """Refuses what is no seed."""
    if seed is not None and (isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0):
        raise OutOfRange(f"seed = {seed!r}: must be None or a whole number from 0", "seed", seed)


def ordered(trials: Sequence[Trial], seed: int | None, max_alike: int | None, alike: str) -> list[Trial]:
    """The trials in the order of the seed, or in their own where it is ``None``.

    Trials of the same ``block`` stay together, and the blocks in their order. With ``max_alike``, no more trials than that follow
    each other in a block whose field ``alike`` has the same value.
    """
    if seed is None:
        if max_alike is not None:
            raise OutOfRange(f"max_alike = {max_alike}: the order is random only with a seed", "max_alike", max_alike)
        return list(trials)
    blocks: dict[Any, list[Trial]] = {}
    for trial in trials:
        blocks.setdefault(trial.own.get("block"), []).append(trial)
    rng = np.random.default_rng(seed)
    found: list[Trial] = []
    for block in blocks.values():
        if max_alike is None:
            order = [int(number) for number in rng.permutation(len(block))]
        else:
            order = with_at_most_alike([_value(trial, alike) for trial in block], max_alike, rng, alike)
        found += [block[number] for number in order]
    return found


def with_at_most_alike(values: Sequence[Hashable], most: int, rng: np.random.Generator, name: str = "value") -> list[int]:
    """A random order of these values in which at most ``most`` of the same follow each other; their numbers.

    Each value is drawn from those after which the rest can still be ordered: a value that is left c times needs c/most places
    beside the others. Where that holds for every value there is always one to draw, so that no draw is taken back.
    Every allowed order is possible; they are not equally likely.
    """
    left: dict[Hashable, list[int]] = {}
    for number in rng.permutation(len(values)):
        left.setdefault(values[int(number)], []).append(int(number))
    order: list[int] = []
    last: Hashable = None
    run = 0
    if not _can_be_ordered(Counter({value: len(numbers) for value, numbers in left.items()}), None, 0, most):
        value, count = Counter(values).most_common(1)[0]
        text = f"max_alike = {most}: {count} of {len(values)} trials have {name} = {value}, too many for any order"
        raise OutOfRange(text, "max_alike", most)
    while len(order) < len(values):
        counts = Counter({value: len(numbers) for value, numbers in left.items() if numbers})
        chances: dict[Hashable, int] = {}
        for value, count in counts.items():
            length = run + 1 if order and value == last else 1
            if length <= most and _can_be_ordered(counts - Counter([value]), value, length, most):
                chances[value] = count
        shares = np.array(list(chances.values()), dtype=float)
        drawn = list(chances)[int(rng.choice(len(shares), p=shares / shares.sum()))]
        run = run + 1 if order and drawn == last else 1
        last = drawn
        order.append(left[drawn].pop())
    return order


def _can_be_ordered(counts: Counter[Hashable], last: Hashable, run: int, most: int) -> bool:
    """Whether these can follow a run of the value ``last``; without a run, be the first ones."""
    total = sum(counts.values())
    return all(
        count <= most * (total - count) + (most - run if run and value == last else most) for value, count in counts.items()
    )


def _value(trial: Trial, field: str) -> Hashable:
    value: Hashable = trial.trial_type if field == "trial_type" else trial.given.get(field)
    return value


def interval_s(trial: Trial, seed: int | None, number: int) -> float:
    """The time before a trial, which is the ``number``-th of the run, from 0: even in its range."""
    low_s, high_s = trial.iti_s
    if low_s == high_s:
        return low_s
    if seed is None:
        raise OutOfRange(f"iti_s = {trial.iti_s}: a range needs a seed", "iti_s", trial.iti_s)
    # From 1: a seed with a zero behind it is the seed alone, which the order has.
    return float(np.random.default_rng([seed, number + 1]).uniform(low_s, high_s))
