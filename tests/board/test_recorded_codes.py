"""What the images have always played: digests of random drives, recorded before the device had rules of its own. A rule may refuse a command; it never changes a code of one that is accepted.
"""
import random
import zlib

import pytest

from copies import on_copy
from host import BLOCK, RATE_HZ, chord, comb, drive
from rig import LIMIT_PERIOD, MILLISECOND

# The first program's index, whatever the start has taken.
FIRST = -(-500 * MILLISECOND // BLOCK) * BLOCK
# Seconds of random programs, and the CRC-32 of their codes as 16 bits each: the same on every image.
RECORDED = {0.3: 0xFFD54D02, 10: 0x473B19B5}
# The thermal limit for the next period is read at its end: no command keeps the thread from its turn there.
GUARD = 40 * MILLISECOND


def parts(chance, tones):
    """Random levels of this number of tones, 0.5 in all."""
    shares = [0.1 + chance.random() for _ in range(tones)]
    return [0.5 * share / sum(shares) for share in shares]


def spread(chance, count, first, end):
    """At most `count` different whole numbers, rising."""
    return sorted({first + int(chance.random() * (end - first)) for _ in range(count)})


def program(chance, at, is_silent):
    """The next program: its message, its body, and whether it ends in silence."""
    glide = int((5 + 55 * chance.random()) * MILLISECOND)
    kind = chance.random()
    if not is_silent and kind < 0.3:
        return "Drive", drive([], 20 * MILLISECOND, at), True
    if is_silent and kind < 0.7:
        # From 21 to 58 kHz; the table has 20 to 60.
        multiples = spread(chance, 1 + int(16 * chance.random()), 225, 595)
        tones = [(multiple, level, chance.random()) for multiple, level in zip(multiples, parts(chance, len(multiples)))]
        return ("Chord", chord(12, tones, glide, at), False) if kind < 0.35 else ("Comb", comb(33, tones, glide, at), False)
    slots = spread(chance, 1 + int(16 * chance.random()), 0, 16)
    return "Drive", drive([(slot, chance.random(), level) for slot, level in zip(slots, parts(chance, len(slots)))], glide, at), False


def play(rig, seconds):
    """The codes of random programs, each at an index of its own choice."""
    host, chance = rig.host, random.Random(31)
    rig.board.is_hasty = True
    at, until, began, is_silent = FIRST, FIRST + round(seconds * RATE_HZ), 0, True
    assert rig.played() < FIRST - 10 * MILLISECOND
    while at < until:
        host.live(max(0, began - rig.played()) / RATE_HZ + 0.001)
        if rig.played() % LIMIT_PERIOD > LIMIT_PERIOD - GUARD:
            host.live((LIMIT_PERIOD - rig.played() % LIMIT_PERIOD) / RATE_HZ + 0.003)
        message, body, is_silent = program(chance, at, is_silent)
        assert host.accept(message, body) == at
        began = at
        at += (70 * MILLISECOND + int(chance.random() * 60 * MILLISECOND)) // BLOCK * BLOCK
    host.live((until - rig.played()) / RATE_HZ + 0.001)
    status = host.status()
    assert (status["faults"], status["underruns"]) == (set(), 0)
    return rig.codes(FIRST, until)


@pytest.mark.parametrize("seconds", [0.3, pytest.param(10, marks=pytest.mark.nightly)])
def test_random_drives_play_the_codes_that_were_recorded(armed, seconds):
    codes = on_copy(armed, lambda rig: play(rig, seconds))
    assert len(codes) == seconds * RATE_HZ and max(codes) - min(codes) > 500
    digest = zlib.crc32(b"".join(code.to_bytes(2, "little") for code in codes))
    assert digest == RECORDED[seconds], f"{seconds} s of codes: {digest:#010x}"
