"""The trigger input: a drive that waits begins soon after a rise, and for nothing else."""
import re

import pytest

from boards import BOARDS
from copies import on_copy
from host import drive
from messages import AT_TRIGGER
from rig import MILLISECOND, is_silent
from test_trigger import TEXT, TONE, Edges, pulse

BLOCK = 128
# From the rise at the pin to the program's first code at the DAC's pin, in samples: the filter's 1 to 3 us, up to a block
# until the renderer looks, and the block that the DMA plays meanwhile.
SOONEST, LATEST = 129, 260
AGAIN = [(2, 0.7, 0.2)]


def wait_for_trigger(rig, tones=TONE):
    """Sends a drive that waits; returns the index from which on a rise counts."""
    return rig.host.accept("Drive", drive(tones, 5 * MILLISECOND, AT_TRIGGER))


def rise(rig, seconds=20e-6):
    """Raises the input for a while; returns the index of the code that is at the DAC's pin when it rises."""
    at = rig.played() - 1
    rig.board.pins.drive(rig.facts.trigger_input, 1)
    rig.board.run(seconds)
    rig.board.pins.drive(rig.facts.trigger_input, 0)
    return at


def to_phase(rig, phase):
    """Lets time pass until the DAC is at sample `phase` of a block."""
    rig.board.run_until(lambda: rig.played() % BLOCK == phase, 0.001, step=1e-6)


@pytest.mark.every_image
def test_a_drive_begins_within_two_blocks_of_the_rise_and_matches_the_mirror(sounding, mirror):
    """At any moment of a block at which the input rises; the output's edge and the device's report mark the begin."""

    def case(rig):
        host, edges, found = rig.host, Edges(rig), []
        for turn, phase in enumerate((0, 1, 40, 100, 126, 127)):
            wait_for_trigger(rig, (TONE, AGAIN)[turn % 2])
            host.live(0.008)
            state = host.status()["state"]
            to_phase(rig, phase)
            rose = rise(rig)
            host.live(0.002)
            waits, began = host.trigger()
            # The mirror gets the index at which it began, which the answer could not know.
            host.accepted[-1] = (began, host.accepted[-1][1])
            found.append((state, waits, rose, began))
            host.live(0.006)
        until = rig.played()
        return found, edges.seen, host.accepted, until, rig.codes(rig.at, until)

    found, seen, accepted, until, codes = on_copy(sounding, case)
    delays = [began - rose for _, _, rose, began in found]
    print(f"\n{sounding.facts.name}: {min(delays)} to {max(delays)} samples from the rise to the DAC's pin")
    assert [(state, waits) for state, waits, _, _ in found] == [("waiting", False)] * len(found)
    assert SOONEST <= min(delays) and max(delays) <= LATEST
    assert max(delays) - min(delays) >= BLOCK - 10, "soonest and latest are both among them"
    assert seen == [edge for _, _, _, began in found for edge in pulse(began)], "it begins with the rise and never else"
    assert codes == mirror(accepted, sounding.at, until, sounding.limit)


@pytest.mark.every_image
def test_an_earlier_or_too_short_rise_does_not_count(sounding):
    def case(rig):
        host, edges = rig.host, Edges(rig)
        rise(rig)
        host.live(0.002)
        wait_for_trigger(rig)
        host.live(0.008)
        before = host.trigger()
        # A spike of less than the filter's time.
        rise(rig, 0.5e-6)
        host.live(0.004)
        spiked = host.trigger()
        # Another drive takes its place: what rose for the one before it is not for this one.
        to_phase(rig, 20)
        rig.board.pins.drive(rig.facts.trigger_input, 1)
        newer = host.accept("Drive", drive(AGAIN, 5 * MILLISECOND))
        host.live(0.01)
        wait_for_trigger(rig)
        host.live(0.01)
        return before, spiked, newer, host.trigger(), edges.seen

    before, spiked, newer, after, seen = on_copy(sounding, case)
    assert before == spiked == (True, None)
    assert after[0], "a level that stands is no rise"
    began = [] if after[1] is None else pulse(after[1])
    assert seen == sorted(began + pulse(newer), key=lambda edge: edge[1])


# Which drive is dropped is the application's matter, not the chip's: the other images have it at night.
def test_stops_and_the_dead_man_drop_a_waiting_drive(sounding):
    def stopped(message):
        def case(rig):
            host, edges = rig.host, Edges(rig)
            wait_for_trigger(rig)
            host.live(0.008)
            host.accept(message)
            host.live(0.06)
            dropped = host.trigger()
            rise(rig)
            host.live(0.01)
            return dropped, host.trigger(), edges.seen, is_silent(rig.codes(rig.played() - 500, rig.played()))

        return case

    def abandoned(rig):
        host, edges = rig.host, Edges(rig)
        wait_for_trigger(rig)
        host.live(0.008)
        host.lives = False
        # Nothing rises at the input meanwhile: the codes need no watching one by one.
        rig.board.is_hasty = True
        rig.board.run(1.19)
        rig.board.is_hasty = False
        rig.board.run(0.01)
        dropped = host.trigger()
        rise(rig)
        rig.board.run(0.01)
        return dropped, host.trigger(), edges.seen, host.status()["first_fault"]

    # Dropped at once, and not only when the input rises.
    nothing = (False, None)
    for message in ("Stop", "EmergencyStop", "Disarm"):
        assert on_copy(sounding, stopped(message)) == (nothing, nothing, [], True), message
    assert on_copy(sounding, abandoned) == (nothing, nothing, [], "host lost")


@pytest.mark.parametrize("facts", BOARDS, ids=lambda facts: facts.name, scope="function")
def test_the_documents_name_the_input_and_the_delay(facts):
    row = re.search(rf"^\| {re.escape(facts.name)} .*$", TEXT, re.M)[0]
    assert re.search(rf"\b{facts.trigger_input}\b", row), row
    assert f"**{SOONEST} to {LATEST} samples**" in TEXT
