"""Inputs that are stuck, lose codes, or are noisy: what the lock-ins of the very image make of them."""
import cmath
import math
import random

import pytest

from copies import on_copy
from host import BLOCK, RATE_HZ, comb, drive
from measuring import listen, listened
from records import Choice
from rig import MID, MILLISECOND
from test_inputs import LOSSES, play_back

SLOTS = 0b11
NOTHING = (0, 0)
# What I and Q of an amplitude of a code are, times the weight (shared/PROTOCOL.md).
LOCK_IN_UNIT = 16383 * BLOCK / 4
# The stuck codes: the ends of the range, where a broken wire pulls an input, and one between.
STUCK = 0, 1234, 4095


@pytest.mark.every_image
def test_an_input_that_is_stuck_answers_nothing_and_its_range_says_so(sounding):
    """R-72: the tones sound, so they are followed; the other input is measured beside it."""
    blocks = 20

    def case(rig, code):
        rig.board.adc.at_pins = lambda: (code, rig.board.dac.output)
        listen(rig.host, blocks, slots=SLOTS, input=None)
        rig.host.live(blocks * BLOCK / RATE_HZ + 0.003)
        return [listened(rig.host, input) for input in (0, 1)]

    for code in STUCK:
        stuck, other = on_copy(sounding, lambda rig: case(rig, code))
        assert (stuck.progress, stuck.blocks, stuck.followed) == ("finished", blocks, SLOTS)
        assert (stuck.lowest, stuck.highest) == (code, code)
        # What is left of the offset by rounding.
        unit = LOCK_IN_UNIT * stuck.weight
        assert max(abs(complex(*answer)) / unit for answer in stuck.answers) < 1e-3 * abs(code - MID)
        assert other.highest - other.lowest > 200 and NOTHING not in other.answers[:2]


@pytest.mark.every_image
def test_a_tone_that_stops_within_the_window_is_not_taken_for_measured(sounding):
    """R-72: two tones sound; the second one falls silent, the first one goes on."""
    blocks = 60

    def case(rig):
        play_back(rig)
        listen(rig.host, blocks, hann=True, slots=SLOTS)
        rig.host.live(0.002)
        rig.host.accept("Drive", drive([(0, 0.3, 0.6)], 5 * MILLISECOND))
        rig.host.live(blocks * BLOCK / RATE_HZ + 0.003)
        return listened(rig.host, 0)

    reading = on_copy(sounding, case)
    assert (reading.progress, reading.blocks, reading.followed) == ("finished", blocks, 0b01)
    assert reading.answers[0] != NOTHING and set(reading.answers[1:]) == {NOTHING}


@pytest.mark.every_image
@pytest.mark.parametrize("loss", LOSSES)
def test_codes_that_are_lost_break_the_lock_ins_whose_sums_are_right_up_to_there(sounding, mirrored_lock_ins, loss):
    """R-71: an overrun, and triggers that have no effect. The next measurement is whole."""
    blocks, lost_after = 40, 10.3

    def case(rig):
        board, host = rig.board, rig.host
        play_back(rig)
        begin = listen(host, blocks, slots=SLOTS)
        board.run((begin - rig.played() + lost_after * BLOCK) / RATE_HZ)
        LOSSES[loss](board, rig.facts.sense_dma, True)
        board.run(50.5 / RATE_HZ)
        LOSSES[loss](board, rig.facts.sense_dma, False)
        host.live(0.004)
        broken = listened(host, 0)
        listen(host, 10, slots=SLOTS)
        host.live(10 * BLOCK / RATE_HZ + 0.003)
        whole = listened(host, 0)
        heard = [rig.codes(reading.begin, reading.begin + reading.blocks * BLOCK) for reading in (broken, whole)]
        return begin, broken, whole, heard, host.accepted, host.inputs()[2]

    begin, broken, whole, heard, accepted, lost = on_copy(sounding, case)
    assert (broken.progress, broken.begin, whole.progress, whole.blocks) == ("broken", begin, "finished", 10)
    assert lost_after - 6 <= broken.blocks <= lost_after and 0 < lost <= 6
    for reading, codes in zip((broken, whole), heard):
        assert (reading.weight, reading.followed, reading.answers) == mirrored_lock_ins(accepted, reading.begin, codes, slots=SLOTS)
        assert (reading.lowest, reading.highest) == (min(codes), max(codes))


# 100 ms, in whole periods of a comb of two tones, at 26 and 41 kHz: harmonic and level.
PERIOD_BLOCKS, PERIODS = 39, 8
TONES = (330, 0.5), (510, 0.0062)
FULL_SCALE, LATE = 2048, 3


@pytest.mark.parametrize(
    "noise, most_db, most_degrees",
    [pytest.param(0.5, (0.05, 1.0), 0.3, id="half a code"), pytest.param(0.0, (0.2, None), 1.0, id="none", marks=pytest.mark.nightly)],
)
def test_tones_at_40_and_80_db_below_full_scale_are_measured_through_the_noise(sounding, noise, most_db, most_degrees):
    """R-73: the sensor receives what the DAC plays, three samples late and so weak that the first tone has -40 dBFS and the second
    one -80. The shunt receives all of it, so that what the DAC's 12 bits do to the tones is known."""
    draw = random.Random(11)

    def case(rig):
        host, dac = rig.host, rig.board.dac
        # A comb begins in silence.
        host.accept("Stop")
        host.live(0.04)
        host.accept("Comb", comb(PERIOD_BLOCKS, [(harmonic, level, 0.3) for harmonic, level in TONES], 5 * MILLISECOND))
        host.live(0.01)
        loudest = max(abs(code - MID) for code in rig.codes(rig.played() - 4 * MILLISECOND, rig.played()))
        gain, before = FULL_SCALE / 100 / loudest, [0] * LATE

        def at_pins():
            before.append(dac.output - MID)
            return round(MID + gain * before.pop(0) + draw.gauss(0, noise)), dac.output

        rig.board.adc.at_pins = at_pins
        host.live(0.002)
        listen(host, PERIODS * PERIOD_BLOCKS, hann=True, slots=SLOTS, input=None)
        host.live(PERIODS * PERIOD_BLOCKS * BLOCK / RATE_HZ + 0.005)
        return gain, [listened(host, input) for input in (0, 1)]

    gain, (sensor, shunt) = on_copy(sounding, case)
    assert {(reading.progress, reading.followed) for reading in (sensor, shunt)} == {("finished", SLOTS)}
    unit = LOCK_IN_UNIT * sensor.weight
    for (harmonic, _), heard, played, most, level in zip(TONES, sensor.answers, shunt.answers, most_db, (40, 80)):
        turns = harmonic / (BLOCK * PERIOD_BLOCKS)
        answer = complex(*heard) / complex(*played) / gain * cmath.exp(2j * math.pi * turns * LATE)
        db, degrees = 20 * math.log10(abs(answer)), math.degrees(cmath.phase(answer))
        below = -20 * math.log10(abs(complex(*played)) / unit * gain / FULL_SCALE)
        print(f"{below:.2f} dB below full scale, {noise} codes of noise: {db:+.4f} dB, {degrees:+.3f} degrees")
        assert below == pytest.approx(level, abs=0.5)
        assert most is None or abs(db) <= most
        assert level == 80 or abs(degrees) <= most_degrees


# Windows of a hold, with the pause after each.
WINDOW_BLOCKS, PAUSE_BLOCKS = 20, 12
PERIOD = (WINDOW_BLOCKS + PAUSE_BLOCKS) * BLOCK / RATE_HZ
# A tone's state when it is lost, and why.


def hear_noise(rig):
    """Of one code: the signal of an unconnected input."""
    draw = random.Random(9)
    rig.board.adc.at_pins = lambda: (MID + draw.randint(-1, 1), MID)


def stick(rig):
    rig.board.adc.at_pins = lambda: (STUCK[1], MID)


def clip(rig):
    """At both ends, as of a sensor that is far too loud."""
    dac = rig.board.dac
    rig.board.adc.at_pins = lambda: (min(max(MID + 20 * (dac.output - MID), 0), 4095), MID)


def overrun(rig):
    lose = LOSSES["their DMA is kept from the bus"]
    lose(rig.board, rig.facts.sense_dma, True)
    rig.board.run(50.5 / RATE_HZ)
    lose(rig.board, rig.facts.sense_dma, False)


def loudness(rig, at=None):
    """Of the last 10 ms that were played, or of those from an index on."""
    at = rig.played() - 10 * MILLISECOND if at is None else at
    return math.hypot(*(code - MID for code in rig.codes(at, at + 10 * MILLISECOND)))


@pytest.mark.parametrize("fails, cause", [(hear_noise, "TooWeak"), (stick, "Stuck"), (clip, "Clipped"), (overrun, "Broken")])
def test_a_held_input_that_fails_gives_the_drives_levels_back_and_is_reported(cool, fails, cause):
    """R-71, R-72, R-73: the hold has turned all tones down. They never get louder than the drive, and are the drive's again."""
    host, dac = cool.host, cool.board.dac
    host.accept("Drive", drive([(slot, (slot + 0.5) / 17, 0.05) for slot in range(16)], 5 * MILLISECOND))
    host.live(0.02)
    driven = loudness(cool)
    cool.board.adc.at_pins = lambda: (MID + (dac.output - MID) // 2, MID)
    host.hold([(slot, 8) for slot in range(16)], WINDOW_BLOCKS)
    host.live(3 * PERIOD)
    held, begin = loudness(cool), cool.played()
    assert host.held()[0] == "on" and held < 0.7 * driven
    fails(cool)
    for _ in range(10):
        host.live(PERIOD)
        progress, _, tones = host.held()
        if progress == "lost":
            break
    lost = Choice("Lost", value=Choice(cause))
    assert progress == "lost" and all((state, correction) == (lost, 0) for _, state, correction in tones)
    host.live(1.5 * PERIOD)
    loudest = max(loudness(cool, at) for at in range(begin, cool.played() - 10 * MILLISECOND, 2 * MILLISECOND))
    assert loudness(cool) == pytest.approx(driven, rel=0.02) and loudest < 1.05 * driven
    assert host.status()["underruns"] == 0
