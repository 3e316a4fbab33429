"""The staircase: as QUEST+ of the package `questplus`, and how well it finds the place of a simulated observer."""

import math
import os

import numpy as np
import pytest
import questplus

import slipline
from slipline.staircase import Staircase

# Fifty by night.
OBSERVERS = int(os.environ.get("SLIPLINE_OBSERVERS", "10"))


def test_every_place_and_the_posterior_match_questplus():
    ours = Staircase(0.1, 0.2, points=21, spreads=[1e-3, 3e-3, 1e-2], guess=0.05, lapse=0.03)
    theirs = questplus.QuestPlus(
        stim_domain={"intensity": ours.places},
        func="norm_cdf",
        stim_scale="linear",
        param_domain={"mean": ours.thresholds, "sd": ours.spreads, "lower_asymptote": 0.05, "lapse_rate": 0.03},
        outcome_domain={"response": ["yes", "no"]},
        stim_selection_method="min_entropy",
        param_estimation_method="mean",
    )
    rng = np.random.default_rng(1)
    for _ in range(25):
        place_m = theirs.next_stim["intensity"]
        trial = ours.trial()
        assert trial == ours.trial(), "the same until it is answered"
        # Two places may be as good as each other, to the last bit.
        entropy = ours._expected_entropy()
        asked = int(np.argmin(np.abs(ours.places - place_m)))
        assert trial["felt_edge_m"] == pytest.approx(place_m, abs=1e-12) or entropy[asked] - entropy.min() < 1e-12
        answer = bool(rng.random() < chance(place_m, 0.143, 4e-3))
        ours.take_answer({"felt_edge_m": place_m}, answer)
        theirs.update(stim={"intensity": place_m}, outcome={"response": "yes" if answer else "no"})
        posterior = theirs.posterior.squeeze().values
        assert np.abs(ours._posterior.reshape(posterior.shape) - posterior).max() < 1e-7
    assert ours.threshold == pytest.approx(theirs.param_estimate["mean"], abs=1e-8)
    assert ours.spread == pytest.approx(theirs.param_estimate["sd"], abs=1e-8)


def chance(place_m: float, threshold_m: float, spread_m: float) -> float:
    """That of a yes, with a slip in fifty trials."""
    return 0.98 * 0.5 * math.erfc((threshold_m - place_m) / (spread_m * math.sqrt(2)))


def test_a_simulated_observer_s_place_is_found_within_half_a_millimetre_in_40_trials():
    off_mm, deviations_mm = [], []
    for seed in range(OBSERVERS):
        rng = np.random.default_rng(seed)
        threshold_m, spread_m = rng.uniform(0.12, 0.18), rng.uniform(0.5e-3, 2e-3)
        staircase = Staircase(0.1, 0.2)
        trials = 0
        while not staircase.done:
            trial = staircase.trial()
            staircase.take_answer(trial, bool(rng.random() < chance(trial["felt_edge_m"], threshold_m, spread_m)))
            trials += 1
        assert trials == 40
        off_mm.append(1e3 * abs(staircase.threshold - threshold_m))
        deviations_mm.append(1e3 * staircase.deviation)
    print(f"\n{OBSERVERS} observers, 40 trials: {np.median(off_mm):.2f} mm off in the median, {max(off_mm):.2f} mm at most")
    assert np.median(off_mm) < 0.5
    # Its own deviation says how far it is off.
    assert 0.5 < np.median(np.array(off_mm) / np.array(deviations_mm)) / 0.674 < 2


def test_the_fields_of_a_trial_are_those_that_were_given():
    staircase = Staircase(120.0, 140.0, place="frequency_hz", trials=2, level=0.5, duration_s=0.3)
    trial = staircase.trial()
    assert trial == {"trial_type": "staircase", "level": 0.5, "duration_s": 0.3, "frequency_hz": trial["frequency_hz"]}
    assert 120.0 <= trial["frequency_hz"] <= 140.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"low": 0.2, "high": 0.1}, "low must be below high"),
        ({"place": "boundary_m"}, "must be one of felt_edge_m, turning_point_m, frequency_hz"),
        ({"trials": 0}, "trials = 0: must be 1 to 100000"),
        ({"points": 1}, "points = 1: must be 2 to 2001"),
        ({"points": 2001}, "points = 2001 with 7 spreads: must be 2 to 377"),
        ({"spreads": []}, r"spreads = \[\]: must be numbers above 0"),
        ({"spreads": "narrow"}, "spreads = narrow: must be numbers above 0"),
        ({"points": 10.5}, "points = 10.5: must be a whole number"),
        ({"trials": "3"}, "trials = 3: must be 1 to 100000"),
        ({"guess": float("nan")}, "must be 0 to 0.9"),
        ({"guess": 1.0}, "must be 0 to 0.9"),
        ({"lapse": -0.1}, "must be 0 to 0.5"),
        ({"spreads": [0.0]}, "must be numbers above 0"),
        ({"low": float("nan")}, "low must be below high"),
    ],
)
def test_a_refusal_names_the_wrong_value(arguments, message):
    with pytest.raises(slipline.OutOfRange, match=message):
        Staircase(**{"low": 0.1, "high": 0.2, **arguments})


@pytest.mark.parametrize("answer", ["no", "yes", float("nan"), 1, 0.0, None, [True]])
def test_an_answer_is_true_or_false_and_nothing_else(answer):
    staircase = Staircase(0.1, 0.2)
    before = staircase._posterior.copy()
    with pytest.raises(slipline.OutOfRange, match="answer = .*: must be True or False"):
        staircase.take_answer(staircase.trial(), answer)
    assert np.array_equal(staircase._posterior, before) and staircase.left == 40
    staircase.take_answer(staircase.trial(), np.False_)
    assert staircase.left == 39


@pytest.mark.parametrize("place_m", [0.9, 0.1004, float("nan"), "0.1", None])
def test_a_place_that_is_not_on_the_grid_is_refused(place_m):
    staircase = Staircase(0.1, 0.2)
    with pytest.raises(slipline.OutOfRange, match="felt_edge_m = .*: (must be one of the 101 places|the trial must have)"):
        staircase.take_answer({"felt_edge_m": place_m}, True)
    assert staircase.left == 40
    # As a file has it.
    staircase.take_answer({"felt_edge_m": 0.1230000000001}, True)
    assert staircase.left == 39


def test_a_staircases_text_shows_its_progress():
    staircase = Staircase(0.1, 0.2, trials=2)
    staircase.take_answer(staircase.trial(), True)
    text = f"threshold={staircase.threshold:.6g} +- {staircase.deviation:.2g})"
    assert repr(staircase) == f"Staircase(0.1, 0.2, place='felt_edge_m': 1 of 2 trials, {text}"
