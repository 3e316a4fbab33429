"""The start's look for the resistor at the mute pin, with what may hang there instead: a resistor, a capacitor, an amplifier that is off."""
import pytest

from boards import G474
from copies import on_copy
from core.load import HIGH, LOW, Wiring

KILO, NANO = 1e3, 1e-9
# Shares of the supply: one that the look with the resistor may not pass, and one that a bare pin reaches.
BARELY, FULL = 0.16, 0.99

# (what it is, wiring, what the start says). What is between 10 kOhm and 130 kOhm depends on the chip's own pull-up and threshold: here
# both are typical.
TYPICAL = (
    ("a pull-down of 47 kOhm", Wiring(47 * KILO), "missing"),
    ("an amplifier's own pull-up of 22 kOhm while it is off", Wiring(22 * KILO), "present"),
)
# With every chip of the data sheets.
CERTAIN = (
    ("nothing", Wiring(), "missing"),
    ("1 nF", Wiring(farads=1 * NANO), "missing"),
    ("10 nF", Wiring(farads=10 * NANO), "missing"),
    ("47 nF", Wiring(farads=47 * NANO), "missing"),
    ("a pull-down of 130 kOhm", Wiring(130 * KILO), "missing"),
    ("4.7 kOhm", Wiring(4.7 * KILO), "present"),
    ("10 kOhm", Wiring(10 * KILO), "present"),
    ("4.7 kOhm and 100 nF", Wiring(4.7 * KILO, 100 * NANO), "present"),
    ("an amplifier's own pull-up of 10 kOhm while it is off", Wiring(10 * KILO), "present"),
)


def looked(rig, wiring):
    """What the start says of the pin, for how long it looks, and the highest level that the pin has meanwhile, as a share of the supply."""
    rig.board.pins.wire(rig.facts.unmute, wiring)
    load = rig.board.pins.loads[rig.facts.unmute]
    rig.board.run_until(lambda: load.driven == 0, 0.1, step=1e-3)
    seconds = load.driven_at - load.pulled_at
    # Only a pin that stays low is watched to the end; `test_without_the_resistor_the_mute_pin_never_rises` shows what
    # follows.
    return "present" if seconds > 5e-3 else "missing", seconds, load.highest


def pull_ups(facts):
    """The strongest and the weakest of the chip's own, in Ohm (the data sheets' I/O characteristics)."""
    return (25e3, 55e3) if facts is G474 else (30e3, 50e3)


def test_a_capacitor_is_no_resistor_and_a_bare_pin_is_none(rig):
    """R-82."""
    # The slowest to rise, and the one that a pull-down keeps lowest: the weakest pull-up. The one that lifts a resistor most: the strongest.
    strongest, weakest = pull_ups(rig.facts)
    for name, wiring, expected in CERTAIN:
        pull_up, threshold = (weakest, HIGH) if expected == "missing" else (strongest, LOW)
        wiring = wiring._replace(pull_up=pull_up, threshold=threshold)
        assert on_copy(rig, lambda copy: looked(copy, wiring))[0] == expected, name
    for name, wiring, expected in TYPICAL:
        assert on_copy(rig, lambda copy: looked(copy, wiring))[0] == expected, name


def test_the_look_at_the_amplifiers_enable_matches_the_documents(rig):
    """R-82."""
    strongest, weakest = pull_ups(rig.facts)
    _, seconds, highest = on_copy(rig, lambda copy: looked(copy, Wiring(pull_up=strongest)))
    assert seconds == pytest.approx(61e-6, abs=3e-6) and highest > FULL
    _, seconds, highest = on_copy(rig, lambda copy: looked(copy, Wiring(farads=47 * NANO, pull_up=weakest, threshold=HIGH)))
    assert seconds < 3.3e-3 and highest < 0.73
    _, seconds, highest = on_copy(rig, lambda copy: looked(copy, Wiring(4.7 * KILO, pull_up=strongest)))
    assert seconds == pytest.approx(5.1e-3, rel=0.02) and highest < BARELY
    # Beyond the look.
    assert on_copy(rig, lambda copy: looked(copy, Wiring(farads=100 * NANO, pull_up=weakest, threshold=HIGH)))[0] == "present"
