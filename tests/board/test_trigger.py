"""The trigger output: its edges, against the index of the code that is at the DAC's pin in that moment."""
import re

import pytest

from boards import BOARDS, RENDERER_IRQ
from copies import on_copy
from host import BLOCK, RATE_HZ, drive
from images import ROOT
from rig import MILLISECOND

TEXT = (ROOT / "firmware/BOARDS.md").read_text()
# Samples from the pin's rise to the program's first code at the DAC's pin, and samples that the pin stays high (half a block).
LEAD, PULSE = 2, 64
TONE = [(2, 0.5, 0.1)]


class Edges:
    """The trigger pin's changes: (level, index of the code that the DAC passes on with the same update)."""

    def __init__(self, rig):
        self.seen = []
        self.note, self.rig = rig.board.note, rig
        rig.board.note = self.on_note

    def on_note(self, *what):
        if what[0] == self.rig.facts.trigger:
            self.seen.append((what[1], self.rig.played() - 1))
        self.note(*what)


def pulse(at):
    """The edges of a program that begins at an index."""
    return [(1, at - LEAD), (0, at - LEAD + PULSE)]


@pytest.mark.every_image
def test_the_trigger_rises_two_samples_before_the_program_is_at_the_dac(sounding, mirror):
    """Whether the program begins as soon as it can or at an index, and whatever the renderer has to do."""

    def case(rig):
        host, edges = rig.host, Edges(rig)
        next_ = host.accept("Drive", drive(TONE, 5 * MILLISECOND))
        host.live(0.004)
        asked = host.status()["now"] + 3 * MILLISECOND + 5
        later = host.accept("Drive", drive([(slot, (slot + 0.5) / 17, 0.02) for slot in range(16)], 8 * MILLISECOND, asked))
        host.live(0.012)
        host.accept("Stop")
        host.live(0.02)
        until = rig.played()
        return edges.seen, next_, asked, later, host.accepted, until, rig.codes(rig.at, until)

    seen, next_, asked, later, accepted, until, codes = on_copy(sounding, case)
    assert asked <= later < asked + 128 and later % 128 == 0, "it begins at a block's first sample"
    assert seen == pulse(next_) + pulse(later), "and nothing else raises it, not even a stop"
    assert codes == mirror(accepted, sounding.at, until, sounding.limit), "the index is the codes' own"


def test_a_program_that_is_not_played_raises_nothing(sounding):
    """Its block comes too late; and arming, which follows, is no program."""

    def case(rig):
        board, host, edges = rig.board, rig.host, Edges(rig)
        at = host.accept("Drive", drive(TONE, 5 * MILLISECOND, host.status()["now"] + 4 * MILLISECOND))
        board.run_until(lambda: rig.played() > at - 128 - 20, 0.01, step=2e-6)
        board.enabled.discard(RENDERER_IRQ)
        board.run_until(lambda: rig.played() > at + 20, 0.01, step=2e-6)
        board.enabled.add(RENDERER_IRQ)
        host.live(0.005)
        fault = host.status()["first_fault"]
        host.accept("ClearFaults")
        host.accept("Arm")
        host.live(0.01)
        return edges.seen, fault

    assert on_copy(sounding, case) == ([], "underrun")


@pytest.mark.parametrize("stall_us", [20, pytest.param(299, marks=pytest.mark.nightly), 300, 301.5])
def test_the_pin_keeps_in_step_with_the_ring_when_that_has_restarted(sounding, mirror, stall_us):
    """R-43: the DMA does not deliver: the stream is set up again, and the block timer with it. The codes' places are no longer
    the device's indices then, so the begin of the program is found in the codes themselves. The inputs' codes have the places
    of the DAC's, too."""

    def case(rig):
        board, host = rig.board, rig.host
        controller, stream = rig.facts.dma
        board.adc.at_pins = lambda: (board.dac.output, 4095 - board.dac.output)
        board.run(37 / RATE_HZ)
        board.dma[controller].blocked.add(stream)
        board.run(1e-6 * stall_us)
        board.dma[controller].blocked.clear()
        host.live(0.015)
        assert board.dac.underruns >= 1 and host.status()["underruns"] == 1
        host.accept("ClearFaults")
        host.accept("Arm")
        host.live(0.01)
        edges = Edges(rig)
        at = host.accept("Drive", drive([(0, 0.4, 0.5)], 5 * MILLISECOND))
        captured = host.capture(0, 512, at + 8 * BLOCK)
        host.live(0.01)
        assert edges.seen, "the pin does not rise any more"
        rose = edges.seen[0][1]
        sampled = host.captured()
        return edges.seen, at, host.accepted, rig.codes(rose + LEAD, rose + LEAD + 8 * MILLISECOND), captured, sampled

    seen, at, accepted, codes, captured, (progress, begin, sampled) = on_copy(sounding, case)
    assert seen == [(1, seen[0][1]), (0, seen[0][1] + PULSE)]
    # The fault has ended the drive that had been sounding.
    accepted = [each for each in accepted if each[0] != sounding.at]
    assert codes == mirror(accepted, at, at + len(codes), sounding.limit)
    assert max(codes) - min(codes) > 200, "it sounds"
    assert (progress, begin) == ("finished", captured)
    assert sampled == codes[begin - at :][: len(sampled)] and len(sampled) == 512


def test_a_store_does_not_part_the_pin_from_the_codes(sounding):
    """While flash is written the sample timer stands still, and the block timer with it."""

    def case(rig):
        host = rig.host
        host.accept("Disarm")
        host.live(0.1)
        host.accept("Store", patience=6)
        host.live(0.1)
        host.accept("Arm")
        host.live(0.01)
        edges = Edges(rig)
        at = host.accept("Drive", drive([(0, 0.4, 0.5)], 5 * MILLISECOND))
        host.live(0.004)
        return edges.seen, at

    seen, at = on_copy(sounding, case)
    assert seen == pulse(at)


@pytest.mark.parametrize("facts", BOARDS, ids=lambda facts: facts.name, scope="function")
def test_the_documents_name_the_pin_and_the_delay(facts):
    row = re.search(rf"^\| {re.escape(facts.name)} .*$", TEXT, re.M)[0]
    assert re.search(rf"\b{facts.trigger}\b", row), row
    assert f"**{LEAD} samples**" in TEXT
