"""The lock-ins of the very image that is flashed, ordered and read through the protocol: a plate plays back into the ADCs, and
what they measure is, bit for bit, what the host's own lock-ins make of the same codes."""
import cmath
import math
import random

import pytest

from copies import on_copy
from host import BLOCK, comb, drive
from measuring import EVERY_SLOT, listen, listened
from messages import RECTANGULAR, Listen
from rig import MID, MILLISECOND

PERIOD_BLOCKS = 40
# From 3 to 179 kHz: harmonic, level, phase in turns.
TONES = [(39 + 150 * n + n % 3, 0.05, 0.37 * n) for n in range(16)]


class Plate:
    """A resonance of 26.5 kHz with a loss of a tenth, two samples late, 40 codes above mid-scale, with a code of noise. The shunt
    sees half of the DAC's code. `codes` are the samples of both, from the index `first` on."""

    POLE = cmath.exp(complex(-0.05, 1) * 2 * math.pi * 26_500 / 400_000)
    LATE = 2

    def __init__(self, rig):
        self.dac, self.noise = rig.board.dac, random.Random(7)
        self.first, self.codes = rig.played(), ([], [])
        self.state, self.before = 0j, [0] * self.LATE
        rig.board.adc.at_pins = self.sample

    def sample(self):
        self.before.append(self.dac.output - MID)
        self.state = self.POLE * self.state + self.before.pop(0)
        moves = (1 - abs(self.POLE)) * self.state.imag
        sensed = round(MID + 40 + moves + self.noise.gauss(0, 1)), MID + (self.dac.output - MID) // 2
        for codes, code in zip(self.codes, sensed):
            codes.append(code)
        return sensed

    def answer(self, frequency):
        """The sensor's code for a code of `e^(i p)`, by its frequency in turns a sample."""
        z = cmath.exp(2j * math.pi * frequency)
        plus, minus = 1 / (1 - self.POLE / z), 1 / (1 - self.POLE.conjugate() / z)
        return (1 - abs(self.POLE)) * (plus - minus) / 2j / z**self.LATE

    def sampled(self, input, begin, blocks):
        return self.codes[input][begin - self.first :][: BLOCK * blocks]


def measure(rig, blocks, **window):
    """Measures; returns the plate, and the reading and the sampled codes of every measured input."""
    plate = Plate(rig)
    rig.host.live(0.001)
    begin = listen(rig.host, blocks, **window)
    rig.host.live(blocks * BLOCK / 400_000 + 0.003)
    inputs = (0, 1) if window["input"] is None else (window["input"],)
    return plate, [(reading := listened(rig.host, input), plate.sampled(input, begin, reading.blocks)) for input in inputs]


def check(reading, codes, mirrored):
    weight, followed, answers = mirrored
    assert reading.progress == "finished" and reading.blocks * BLOCK == len(codes)
    assert (reading.weight, reading.followed, reading.answers) == (weight, followed, answers)
    assert (reading.lowest, reading.highest) == (min(codes), max(codes))


@pytest.mark.every_image
def test_the_lock_ins_of_a_comb_match_the_hosts_bit_for_bit_and_the_plate(sounding, mirrored_lock_ins):
    """Sixteen tones, at one input and then at the other, each time over a period of the comb."""

    def case(rig):
        # It begins in silence.
        rig.host.accept("Stop")
        rig.host.live(0.04)
        rig.host.accept("Comb", comb(PERIOD_BLOCKS, TONES, 5 * MILLISECOND))
        rig.host.live(0.01)
        _, [shunt] = measure(rig, PERIOD_BLOCKS, input=1)
        plate, [sensor] = measure(rig, PERIOD_BLOCKS, input=0)
        return shunt, sensor, rig.host.accepted, [plate.answer(m / (BLOCK * PERIOD_BLOCKS)) for m, _, _ in TONES]

    *both, accepted, truth = on_copy(sounding, case)
    for reading, codes in both:
        check(reading, codes, mirrored_lock_ins(accepted, reading.begin, codes))
        assert reading.followed == 0xFFFF
    (shunt, _), (sensor, _) = both
    for sent, answer, true in zip(shunt.answers, sensor.answers, truth):
        # The noise leaves 0.03 codes (RMS), and at the shunt the faintest tone has 13, half of what is sent.
        assert abs(complex(*answer) / complex(*sent) / 2 - true) < 0.006
    assert 0.2 < max(map(abs, truth)) < 1, "it has a resonance"


@pytest.mark.every_image
@pytest.mark.parametrize("input", [0, 1, None])
def test_the_lock_ins_of_a_drag_match_the_hosts_bit_for_bit(sounding, mirrored_lock_ins, input):
    """While every tone glides from one place to another; both inputs at once have half of the slots."""
    slots = 0xF0F0 if input is None else 0xFFFF

    def case(rig):
        rig.host.accept("Drive", drive([(slot, (slot + 0.5) / 17, 0.05) for slot in range(16)], 5 * MILLISECOND))
        rig.host.live(0.01)
        rig.host.accept("Drive", drive([(slot, (16 - slot) / 17, 0.05) for slot in range(16)], 20 * MILLISECOND))
        _, reading = measure(rig, 50, hann=True, slots=slots, input=input)
        return reading, rig.host.accepted

    seen, accepted = on_copy(sounding, case)
    for reading, codes in seen:
        check(reading, codes, mirrored_lock_ins(accepted, reading.begin, codes, hann=True, slots=slots))
        assert reading.followed == slots


@pytest.mark.every_image
def test_more_tones_than_a_block_has_time_for_are_refused(sounding):
    """Both inputs at once: half of the lock-ins."""

    def case(rig):
        return rig.host.exchange("Listen", Listen(None, 10, RECTANGULAR, EVERY_SLOT, None)).name

    assert on_copy(sounding, case) == "Refused"
