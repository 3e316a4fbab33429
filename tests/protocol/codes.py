"""The DAC codes that a device plays, by the law on the page: the chapters "Glides and ramps" and "The law of the codes".

`Motion` says where every tone is at an index, `Bank` makes blocks of 128 codes of it.
"""
from __future__ import annotations

import math
import struct
from dataclasses import dataclass, replace
from typing import Iterator, Sequence

from messages import Tone
from table import Table

BLOCK, SLOTS = 128, 16
ONE = 1 << 31
_MOST_STEP = 1932735283 << 32
_SINE_ONE = (1 << 31) - 8
_RADIANS, _THETA = round(2 * math.pi * 2**22 * (1 - (math.pi / 1024) ** 2 / 10)), round(2 * math.pi * 2**28)
_TABLE = [
    tuple(round(_SINE_ONE * wave(2 * math.pi * (bin + 0.5) / 1024)) for wave in (math.sin, math.cos)) for bin in range(1024)
]
_RISE = [round(ONE * (1 - math.cos(math.pi * i / 128)) / 2) for i in range(65)]
_SHAPE = _RISE + [ONE - rise for rise in reversed(_RISE[:64])]
_LOW = (1 << 32) - 1
_TURN = (1 << 64) - 1


# ------------------------------------------------------------------------------------------ glides and ramps


def _raised(u: int) -> int:
    """`s(u)`, both in units of 2^-31."""
    index, rest = divmod(u, 1 << 24)
    if index == 128:
        return ONE
    return _SHAPE[index] + ((_SHAPE[index + 1] - _SHAPE[index]) * rest >> 24)


def _between(a: int, b: int, share: int) -> int:
    return (a * (ONE - share) + b * share) >> 31


def evaluate(table: Table, q: int) -> tuple[int, int]:
    """Step in 2^-64 turns a sample, and gain in 2^-31, at the place `q` in 2^-31 of the span."""
    last = len(table.knots) - 1
    i = min(q * last >> 31, last - 1)
    r = q * last - (i << 31)
    a, b = table.knots[i], table.knots[i + 1]
    return (a.step * (ONE - r) + b.step * r) << 1, (a.gain * (ONE - r) + b.gain * r) >> 31


@dataclass(frozen=True)
class Placed:
    """Where a tone is: its place and level in 2^-31, its step in 2^-64 turns, its gain in 2^-31."""

    place: int = 0
    level: int = 0
    step: int = 0
    gain: int = 0

    @property
    def amplitude(self) -> int:
        """In 2^-31 of full scale."""
        return self.gain * self.level >> 31


@dataclass(frozen=True)
class _Way:
    begin: Placed
    end: Placed
    along: bool
    """Whether step and gain are the table's at each place; else they stay as they are."""
    join: tuple[int, int] = (0, 0)
    """By how much step and gain are off the table's at the begin."""
    phase: int | None = None
    """The phase with which a tone begins that was silent, in 2^-64 turns."""


class Motion:
    """The tones from the index of an accepted drive on."""

    def __init__(self, table: Table, start: int = 0, glide: int = 1, ways: Sequence[_Way] = (_Way(Placed(), Placed(), False),) * SLOTS):
        self.table, self.start, self.glide, self.ways = table, start, glide, ways

    def at(self, index: int) -> list[Placed]:
        """Where the tones are at an index."""
        elapsed = max(0, index - self.start)
        u = ONE if elapsed >= self.glide else elapsed * ((1 << 63) // self.glide) >> 32
        s = _raised(u)
        return [self._placed(way, u, s) for way in self.ways]

    def _placed(self, way: _Way, u: int, s: int) -> Placed:
        place, level = _between(way.begin.place, way.end.place, u), _between(way.begin.level, way.end.level, s)
        if not way.along:
            return Placed(place, level, way.begin.step, way.begin.gain)
        (step, gain), (off, louder), left = evaluate(self.table, place), way.join, ONE - s
        step, gain = step + (off * left >> 31), gain - (-louder * left >> 31)
        return Placed(place, level, min(max(step, 0), _MOST_STEP), min(max(gain, 0), ONE))

    def drive(self, tones: Sequence[Tone], start: int, glide: int) -> Motion:
        """The motion of a drive with the master level 0, whose answer named this index, in the same table."""
        wanted = {tone.slot: tone for tone in tones}
        return Motion(self.table, start, glide, [self._way(here, wanted.get(slot)) for slot, here in enumerate(self.at(start))])

    def swap(self, table: Table, start: int, glide: int) -> Motion:
        """The motion of a table that comes into force at this index: every tone goes on to its place and level."""
        ways = []
        for way, here in zip(self.ways, self.at(start)):
            step, gain = evaluate(table, here.place)
            ways.append(replace(way, begin=here, along=way.end.level > 0, join=(here.step - step, here.gain - gain), phase=None))
        return Motion(table, start, glide, ways)

    def stop(self, start: int, ramp: int) -> Motion:
        """The ramp to silence from this index on."""
        ways = [_Way(here, replace(here, level=0), along=False) for here in self.at(start)]
        return Motion(self.table, start, ramp, ways)

    def _way(self, here: Placed, tone: Tone | None) -> _Way:
        if tone is None:
            return _Way(here, replace(here, level=0), along=False)
        place = ((tone.position << 31) + 32767) // 65535
        target = Placed(place, (tone.level << 31) // 65535, *evaluate(self.table, place))
        if here.level == 0:
            return _Way(replace(target, level=0), target, along=False, phase=tone.phase << 48 if target.level else None)
        return _Way(here, target, along=True)


# ------------------------------------------------------------------------------------------ the bank


def _signed(x: int) -> int:
    x &= _LOW
    return x - (1 << 32) if x >> 31 else x


def _high(a: int, b: int) -> int:
    return a * b >> 32


def _rounded(x: int, a: int, b: int) -> int:
    return ((x << 32) + a * b + (1 << 31)) >> 32


def _less(x: int, a: int, b: int) -> int:
    return ((x << 32) - a * b) >> 32


def sine_cosine(phase: int) -> tuple[int, int]:
    """Of a phase in 2^-32 turns."""
    sine, cosine = _TABLE[phase >> 22]
    r = _high(_signed(phase << 10 ^ ONE), _RADIANS)
    h = _high(r, r) >> 1
    return _less(sine + _high(cosine, r), sine, h), _less(_less(cosine, sine, r), cosine, h)


def _turned(s: int, c: int, turn_s: int, turn_c: int) -> tuple[int, int]:
    return _rounded(_rounded(0, s, turn_c), c, turn_s) << 1, _rounded(_rounded(0, c, turn_c), s, -turn_s) << 1


def _half(amplitude: int) -> int:
    return min(amplitude >> 1, (1 << 30) - 1)


@dataclass(frozen=True)
class ToneBlock:
    """A tone over a block: phase and step in 2^-64 turns, amplitude in 2^-31; step and amplitude at its begin and end."""

    phase: int
    step: int
    step_end: int
    amplitude: int
    amplitude_end: int

    @property
    def is_steady(self) -> bool:
        return (self.step, self.amplitude) == (self.step_end, self.amplitude_end)


def _steady(tone: ToneBlock, samples: list[int]) -> None:
    turn_s, turn_c = sine_cosine(tone.step >> 32)
    wide_s, wide_c = sine_cosine((tone.step << 5 & _TURN) >> 32)
    s, c = sine_cosine((((tone.phase + (tone.step << 6)) & _TURN) >> 32) - (tone.step >> 33) & _LOW)
    a = _half(tone.amplitude)
    p, q = _high(a, s), _high(a, c)
    along_p, along_q = _high(p, wide_c), _high(q, wide_c)
    even = _less(along_p, q, wide_s), along_p + _high(q, wide_s)
    odd = along_q + _high(p, wide_s), _less(along_q, p, wide_s)
    for n in range(32):
        if n % 8 == 0:
            s, c = sine_cosine((((tone.step >> 1) * (1 + 2 * n)) & _TURN) >> 32)
        for part in (0, 1):
            e, o, centre = _high(c, even[part]), _high(s, odd[part]), 64 * part + 32
            samples[centre + n] += e + o
            samples[centre - 1 - n] += e - o
        s, c = _turned(s, c, turn_s, turn_c)


def _gliding(tones: Sequence[ToneBlock]) -> list[int]:
    even, odd = [[0] * 8 for _ in range(8)], [[0] * 8 for _ in range(8)]
    even_bend, odd_bend = [[0] * 8 for _ in range(8)], [[0] * 8 for _ in range(8)]
    for tone in tones:
        change = _signed((tone.step_end - tone.step & _TURN) >> 32)
        d = max(-(1 << 22), min(change, (1 << 22) - 1)) << 8 | (tone.step_end - tone.step & _TURN) >> 24 & 0xFF
        s, c = sine_cosine(((tone.step >> 32) + _high(d, 127 << 16) & _LOW) >> 1)
        turn_s, turn_c = _rounded(0, s, c) << 2, _rounded(_rounded(0, c, c), s, -s) << 1
        words = []
        for n in range(8):
            bent = (1 << 15) + _high(c, -(2 * n + 1) << 26), (1 << 15) + _high(s, -(2 * n + 1) << 26)
            words.append((c, s, s >> 18, bent[0] >> 16, c >> 18, bent[1] >> 16))
            s, c = _turned(s, c, turn_s, turn_c)
        angle = (tone.phase >> 32) + ((tone.step << 3 & _TURN) >> 32) - (tone.step >> 33) + _high(d, 225 << 14)
        gain = ((tone.step << 4 & _TURN) >> 32) + _high(d, 31 << 20)
        theta = _high(d, _THETA)
        start = _half(tone.amplitude)
        ramp = _half(tone.amplitude_end) - start
        a = start + _high(ramp, 15 << 24)
        detune = theta - (theta << 2) - (theta >> 1)
        straight = _high(theta, 5 << 23)
        lean, slope = (1 << 15) + _high(ramp, straight), ramp + (1 << 15)
        swell = (1 << 15) + _high(a, theta >> 2) + _high(ramp, detune >> 4)
        swelling = _high(ramp >> 3, theta >> 2) + _high(ramp, theta >> 4)
        for j in range(8):
            s, c = sine_cosine(angle & _LOW)
            seeds = _high(a >> 1, s), _high(a >> 1, c)
            imaginary = lean + _high(a, detune)
            real = _less(slope, imaginary, straight)
            curl = _high(imaginary, detune) >> 21
            s, c = s >> 16, c >> 16
            re, im, swollen = real >> 16, imaginary >> 16, swell >> 16
            f, g = ((1 << 15) + re * c - im * s) >> 16, ((1 << 15) + curl * s - swollen * c) >> 16
            h, k = ((1 << 15) + re * s + im * c) >> 16, ((1 << 15) + curl * c + swollen * s) >> 16
            for n, (cosine, sine, small_s, x, small_c, y) in enumerate(words):
                even[j][n] += _high(cosine, seeds[0])
                odd[j][n] += _high(sine, seeds[1])
                even_bend[j][n] += small_s * f + x * g
                odd_bend[j][n] += small_c * h + y * k
            angle += _signed(gain)
            gain += d >> 7
            a, detune, swell = a + (ramp >> 3), detune + theta, swell + swelling
    samples = [0] * BLOCK
    for j in range(8):
        for n in range(8):
            e = even[j][n] + _high(even_bend[j][n], (2 * n + 1) << 25)
            o = odd[j][n] + _high(odd_bend[j][n], (2 * n + 1) << 25)
            samples[16 * j + 8 + n], samples[16 * j + 7 - n] = e + o, e - o
    return samples


class Bank:
    """The phases of all tones, and the blocks that follow from them and a motion."""

    def __init__(self) -> None:
        self._phases = [0] * SLOTS
        self._before = [(0, 0)] * SLOTS

    def tones(self, motion: Motion, first: int) -> list[ToneBlock]:
        """The tones over the block that begins at an index. Request the blocks one after the other, without a gap."""
        if first == motion.start:
            for slot, way in enumerate(motion.ways):
                if way.phase is not None:
                    self._phases[slot], self._before[slot] = way.phase, (way.begin.step, 0)
        placed = motion.at(first + BLOCK)
        tones = [
            ToneBlock(phase, step, there.step, amplitude, there.amplitude)
            for phase, (step, amplitude), there in zip(self._phases, self._before, placed)
        ]
        self._before = [(there.step, there.amplitude) for there in placed]
        self._phases = [(tone.phase + ((tone.step + tone.step_end) << 6)) & _TURN for tone in tones]
        return tones


def codes(tones: Sequence[ToneBlock]) -> list[int]:
    """The codes of a block with these tones. A silent tone adds nothing."""
    if all(tone.is_steady for tone in tones):
        samples = [0] * BLOCK
        for tone in tones:
            if tone.amplitude:
                _steady(tone, samples)
    else:
        samples = _gliding([tone for tone in tones if tone.amplitude or tone.amplitude_end])
    return [max(0, min(4095, ((sample * (2047 << 5) + (1 << 31)) >> 32) + 2048)) for sample in samples]


def bytes_of(codes: Sequence[int]) -> bytes:
    """The codes as a digest counts them."""
    return struct.pack(f"<{len(codes)}H", *codes)


def played(motions: Sequence[Motion], begin: int, end: int) -> Iterator[int]:
    """The codes from one block's begin to another's, of motions that follow each other from silence."""
    bank = Bank()
    for first in range(motions[0].start, end, BLOCK):
        tones = bank.tones([motion for motion in motions if motion.start <= first][-1], first)
        if first >= begin:
            yield from codes(tones)
