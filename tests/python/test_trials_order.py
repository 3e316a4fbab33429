"""What the seed decides: the order of a list, the times between its trials, and which staircase is next."""

import itertools
from collections import Counter

import numpy as np
import pytest

import slipline
from slipline import trials
from slipline._trial_order import with_at_most_alike
from slipline.staircase import Staircase
from trial_device import RATE_HZ, device, run  # noqa: F401


def listed(count, **fields):
    return [{"turning_point_m": 0.1 + 0.01 * i, "trial_type": str(i), **fields} for i in range(count)]


def test_a_seed_orders_the_trials_and_stands_in_every_row(device, tmp_path):
    orders = []
    for name, seed in [("a", 5), ("b", 5), ("c", 6)]:
        rows = run(device(), listed(10), lambda trial: True, tmp_path / name, seed=seed)
        orders.append([row["trial_type"] for row in rows])
        assert {row["seed"] for row in rows} == {str(seed)}
    assert orders[0] == orders[1] != orders[2]
    assert sorted(orders[0]) == sorted(orders[2]) == [str(i) for i in range(10)]
    for seed in (-1, 1.5, True):
        with pytest.raises(slipline.OutOfRange, match="seed"):
            run(device(), listed(3), lambda trial: True, tmp_path, seed=seed)


def runs(values):
    """The lengths of the runs of equal values."""
    return [len(list(group)) for _, group in itertools.groupby(values)]


@pytest.mark.parametrize("most", [1, 2, 3])
def test_an_order_is_found_exactly_where_there_is_one(most):
    """All lists of up to seven of three values, beside a search of all their orders."""
    rng = np.random.default_rng(most)
    for counts in itertools.product(range(5), range(3), range(3)):
        values = [value for value, count in zip("abc", counts) for _ in range(count)]
        if not values or len(values) > 7:
            continue
        is_possible = any(max(runs(order)) <= most for order in set(itertools.permutations(values)))
        if is_possible:
            for _ in range(5):
                order = with_at_most_alike(values, most, rng)
                assert sorted(order) == list(range(len(values)))
                assert max(runs([values[number] for number in order])) <= most
        else:
            with pytest.raises(slipline.OutOfRange, match="too many for any order"):
                with_at_most_alike(values, most, rng)


def test_every_order_that_is_allowed_comes_up():
    rng = np.random.default_rng(1)
    found = Counter("".join("aaabb"[number] for number in with_at_most_alike("aaabb", 2, rng)) for _ in range(2000))
    allowed = {"".join(order) for order in itertools.permutations("aaabb") if max(runs(order)) <= 2}
    assert set(found) == allowed and min(found.values()) > 50


def test_no_more_than_n_alike_follow_each_other_in_a_block(device, tmp_path):
    trials_ = [{"turning_point_m": 0.12, "trial_type": kind, "block": block} for block in (1, 2) for kind in "aaaabbbb"]
    rows = run(device(), trials_, lambda trial: True, tmp_path, seed=9, max_alike=2)
    assert [row["block"] for row in rows] == ["1"] * 8 + ["2"] * 8
    kinds = [row["trial_type"] for row in rows]
    assert max(runs(kinds[:8])) <= 2 >= max(runs(kinds[8:])) and kinds[:8] != kinds[8:]
    for more, message in [
        ({"max_alike": 2}, "only with a seed"),
        ({"max_alike": 0, "seed": 1}, "a whole number from 1"),
        ({"run": np.int64(0)}, "a whole number from 1"),
        ({"break_every": 1.5, "take_break": print}, "a whole number from 1"),
        ({"columns": {"sure": 5}}, "columns = {'sure': 5}: must be a dictionary"),
        ({"take_break": 5}, "take_break = 5: must be a function"),
        ({"columns": 5}, "columns = 5: must be a dictionary"),
        ({"max_alike": 3, "seed": 1, "alike": "block"}, "8 of 8 trials have block = 1"),
    ]:
        with pytest.raises(slipline.OutOfRange, match=message):
            run(device(), trials_, lambda trial: True, tmp_path / "x", **more)
    with pytest.raises(slipline.OutOfRange, match="respond = None: must be a function"):
        run(device(), trials_, None, tmp_path / "x")
    assert not (tmp_path / "x").exists()
    # Numbers of NumPy, as of a table.
    numbers = {"seed": np.int64(9), "max_alike": np.int64(2), "break_every": np.int64(9), "take_break": len, "run": np.int64(2)}
    assert [row["trial_type"] for row in run(device(), trials_, lambda trial: True, tmp_path, **numbers)] == kinds
    with pytest.raises(slipline.OutOfRange, match="have their own order"):
        run(device(), iter(trials_), lambda trial: True, tmp_path / "x", max_alike=1, seed=1)


def test_the_time_between_trials_is_even_in_its_range_and_the_seed_s(device, tmp_path):
    drawn = {}
    for name, seed in [("a", 1), ("b", 1), ("c", 2)]:
        display = device()
        forty = listed(40, iti_s=(1.0, 2.0), duration_s=0.5)
        rows = run(display, forty, lambda trial: display.pass_s(0.25), tmp_path / name, seed=seed)
        drawn[name] = [float(row["iti_s"]) for row in rows]
        ends = [float(row["onset"]) + float(row["duration"]) + float(row["response_time"]) for row in rows]
        # The stand-in begins a drive a tenth of a second after its call.
        passed = [float(row["onset"]) - end for row, end in zip(rows[1:], ends)]
        assert passed == pytest.approx([iti_s + 0.1 for iti_s in drawn[name][1:]], abs=4 / RATE_HZ)
    assert drawn["a"] == drawn["b"] != drawn["c"]
    assert 1.0 <= min(drawn["a"]) < 1.2 and 1.8 < max(drawn["a"]) <= 2.0


def two(trials_=6):
    low = Staircase(0.1, 0.15, place="turning_point_m", trials=trials_, staircase="low", trial_type="low")
    return low, Staircase(0.15, 0.2, place="turning_point_m", trials=trials_, staircase="high", trial_type="high")


def respond(trial):
    return trial["turning_point_m"] > (0.121 if trial["staircase"] == "low" else 0.178)


def test_staircases_run_interleaved_in_the_order_of_the_seed_and_go_on(device, tmp_path):
    whole = two()
    rows = run(device(), trials.interleaved(*whole, seed=3), respond, tmp_path / "whole")
    order = [row["staircase"] for row in rows]
    assert Counter(order) == {"low": 6, "high": 6} and max(runs(order)) < 6
    assert all(staircase.done for staircase in whole) and whole[0].threshold < 0.15 < whole[1].threshold
    parts = two()

    def leaves(trial):
        if trial["number"] == 5:
            raise KeyboardInterrupt
        return respond(trial)

    with pytest.raises(KeyboardInterrupt):
        run(device(), trials.interleaved(*two(), seed=3), leaves, tmp_path / "parts")
    again = run(device(), trials.interleaved(*parts, seed=3), respond, tmp_path / "parts")
    assert [row["turning_point_m"] for row in again] == [row["turning_point_m"] for row in rows]
    assert [staircase.threshold for staircase in parts] == [staircase.threshold for staircase in whole]
    with pytest.raises(slipline.BadFile, match="another list of trials"):
        run(device(), trials.interleaved(*two(), seed=4), respond, tmp_path / "parts")
    with pytest.raises(slipline.OutOfRange, match="one staircase or more"):
        trials.interleaved()
    assert repr(trials.interleaved(two()[0], seed=3)).startswith("interleaved(Staircase(0.1, 0.15, place='turning_point_m'")
