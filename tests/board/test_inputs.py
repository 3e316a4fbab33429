"""The inputs: a plate plays back into the ADCs, and every code comes with the index of the DAC's code that made it."""
import re

import pytest

from boards import BOARDS, RENDERER_IRQ
from copies import on_copy
from host import BLOCK, RATE_HZ, drive
from images import ROOT
from rig import MILLISECOND

TEXT = (ROOT / "firmware/BOARDS.md").read_text()
TONES = [(slot, (slot + 0.5) / 17, 0.05) for slot in range(16)]
# Values of a capture at most: 10 ms.
MOST = 4096


def play_back(rig):
    """A plate that answers at once: the sensor sees the DAC's code, the shunt its opposite."""
    board = rig.board
    board.adc.at_pins = lambda: (board.dac.output, 4095 - board.dac.output)


def capture(rig, input=0, values=1000):
    """Captures the codes of an input; how it ended, its first index, and its codes."""
    at = rig.host.capture(input, values)
    rig.host.live(values / RATE_HZ + 0.002)
    progress, begin, codes = rig.host.captured()
    assert begin == at
    return progress, begin, codes


def check(rig, input=0, values=1000):
    """The codes of an input equal the DAC's under the same indices; returns the first one and the codes."""
    progress, begin, codes = capture(rig, input, values)
    played = rig.codes(begin, begin + values)
    assert (progress, codes) == ("finished", [4095 - code for code in played] if input else played)
    return begin, codes


@pytest.mark.every_image
def test_every_code_of_the_inputs_has_the_index_of_the_dacs_code(sounding, mirror):
    """While the renderer has the most to do, and while it has nothing to do."""

    def case(rig):
        host = rig.host
        play_back(rig)
        host.accept("Drive", drive(TONES, 25 * MILLISECOND))
        first, codes = check(rig, 0, MOST)
        check(rig, 1)
        host.accept("Stop")
        host.live(0.04)
        check(rig, 1)
        return first, codes, host.accepted, host.inputs()

    first, codes, accepted, (count, delay, lost) = on_copy(sounding, case)
    assert (count, lost) == (2, 0)
    stated = re.search(rf"^\| {sounding.facts.name} \| 0 to 3\.[03] V \| (\d+) ns", TEXT, re.M)
    assert int(stated[1]) == delay, "the documents state the device's delay"
    assert max(codes) - min(codes) > 400, "it sounds"
    assert codes == mirror(accepted, first, first + len(codes), sounding.limit), "the index is the host's"


# What happens to the ADCs.
LOSSES = {
    "their DMA is kept from the bus": lambda board, dma, lost: (board.dma[dma[0]].blocked.add if lost else board.dma[dma[0]].blocked.discard)(dma[1]),
    "they miss triggers": lambda board, dma, lost: setattr(board.adc, "is_stuck", lost),
}  # fmt: skip


@pytest.mark.every_image
@pytest.mark.parametrize("loss", LOSSES)
@pytest.mark.parametrize("samples", [2, 50, 3000])
def test_lost_codes_do_not_shift_the_indices_of_the_others(sounding, mirror, loss, samples):
    """The capture under way breaks; its codes up to there are right, and so are those of the next. The loss is reported, and
    the DAC's codes do not change. One word may wait for the DMA, so that two must be missing."""

    def case(rig):
        board, host = rig.board, rig.host
        play_back(rig)
        at = host.capture(0, MOST)
        board.run(3.3 * BLOCK / RATE_HZ)
        LOSSES[loss](board, rig.facts.sense_dma, True)
        board.run((samples + 0.5) / RATE_HZ)
        LOSSES[loss](board, rig.facts.sense_dma, False)
        host.live(0.002)
        progress, begin, codes = host.captured()
        assert begin == at and progress == "broken"
        assert codes == rig.codes(at, at + len(codes)) and len(codes) % BLOCK == 0
        check(rig, 0)
        until = min(rig.played(), rig.at + len(rig.expected))
        return rig.codes(rig.at, until), host.inputs()[2], host.status()["underruns"]

    codes, lost, underruns = on_copy(sounding, case)
    assert codes == sounding.expected[: len(codes)] and underruns == 0
    # The blocks in the ring, of four, are not whole either.
    assert samples // BLOCK <= lost <= samples // BLOCK + 6, lost


@pytest.mark.every_image
def test_with_dead_adcs_the_device_works_on_and_every_block_is_lost(sounding):
    def case(rig):
        host = rig.host
        rig.board.adc.is_stuck = True
        before = rig.played()
        progress, _, codes = capture(rig)
        host.live(0.02)
        lost, blocks = host.inputs()[2], (rig.played() - before) // BLOCK
        host.accept("Stop")
        host.live(0.04)
        status = host.status()
        return progress, codes, lost - blocks, status["state"], status["underruns"], rig.codes(rig.at, rig.at + 45 * MILLISECOND)

    progress, captured, more, state, underruns, codes = on_copy(sounding, case)
    assert (progress, captured) == ("broken", []) and abs(more) <= 4
    assert (state, underruns) == ("armed", 0)
    assert codes == sounding.expected[: len(codes)], "up to the stop it plays what it would"


def silence(rig):
    """The renderer is late by two blocks and a half."""
    rig.board.enabled.discard(RENDERER_IRQ)
    rig.board.run(2.5 * BLOCK / RATE_HZ)
    rig.board.enabled.add(RENDERER_IRQ)


def starve(rig):
    """The DAC's DMA does not deliver: its ring, and so the ADCs', restarts."""
    controller, stream = rig.facts.dma
    rig.board.run(37 / RATE_HZ)
    rig.board.dma[controller].blocked.add(stream)
    rig.board.run(0.00002)
    rig.board.dma[controller].blocked.clear()


def mask(rig):
    """The DAC's interrupt is late by a block and a quarter, and two of them are due."""
    # Not at a block's very end: the DMA has read ahead there, and its interrupt has begun.
    rig.board.run_until(lambda: BLOCK * 3 // 4 <= rig.played() % BLOCK < BLOCK * 7 // 8, 0.001, step=1e-6)
    rig.board.enabled.discard(rig.facts.dma_irq)
    rig.board.run(1.5 * BLOCK / RATE_HZ)
    rig.board.enabled.add(rig.facts.dma_irq)


@pytest.mark.every_image
@pytest.mark.parametrize("fault", [silence, starve, mask])
def test_after_a_fault_of_the_dac_the_codes_are_again_those_of_their_index(sounding, mirror, fault):
    """The codes' places are no longer the device's indices then: the mirror gives the codes of an index."""

    def case(rig):
        host = rig.host
        play_back(rig)
        fault(rig)
        host.live(0.03)
        host.accept("ClearFaults")
        host.accept("Arm")
        host.live(0.01)
        at = host.accept("Drive", drive([(0, 0.4, 0.5)], 5 * MILLISECOND))
        return at, capture(rig), host.accepted

    at, (progress, first, codes), accepted = on_copy(sounding, case)
    # The fault has ended the drive that had been sounding.
    accepted = [each for each in accepted if each[0] != sounding.at]
    assert progress == "finished" and at <= first
    assert codes == mirror(accepted, at, first + len(codes), sounding.limit)[first - at :]
    assert max(codes) - min(codes) > 100, "it sounds"


@pytest.mark.parametrize("facts", BOARDS, ids=lambda facts: facts.name, scope="function")
def test_the_documents_name_the_pins_of_the_inputs(facts):
    row = re.search(rf"^\| {re.escape(facts.name)} .*$", TEXT, re.M)[0]
    for pin in facts.inputs:
        assert re.search(rf"\b{pin}\b", row), row
