"""The turning-point table: for each place of the plate its frequency and its gain."""
from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from typing import Iterator, Sequence

from errors import FieldError
from messages import Knot, TableChunk, TableHeader
from postcard import check_integer
from records import Fields

FEWEST_KNOTS, MOST_KNOTS = 2, 1025
KNOTS_PER_CHUNK = 22


@dataclass(frozen=True)
class Table:
    """Knots, uniform in position over a span of the plate from `span_start_um` to `span_end_um`."""

    span_start_um: int
    span_end_um: int
    sample_rate_hz: int
    knots: Sequence[Knot]

    def __post_init__(self) -> None:
        if not FEWEST_KNOTS <= len(self.knots) <= MOST_KNOTS:
            raise FieldError("knots", f"{FEWEST_KNOTS} to {MOST_KNOTS} of them", len(self.knots))
        check_integer(self.span_start_um, 0, self.span_end_um - 1, "span_start_um")
        for index, knot in enumerate(self.knots):
            Fields(Knot).check(knot, f"knots[{index}]")
        steps = [knot.step for knot in self.knots]
        falls = steps[1] < steps[0]
        for index, (before, after) in enumerate(zip(steps, steps[1:]), start=1):
            if before == after or (after < before) != falls:
                raise FieldError(f"knots[{index}].step", f"strictly {'below' if falls else 'above'} {before}", after)

    @classmethod
    def from_frequencies(
        cls, span_um: tuple[int, int], sample_rate_hz: int, frequencies_hz: Sequence[float], gains: Sequence[float]
    ) -> Table:
        """A table from frequencies in Hz (above 0, at most 0.45 of the rate) and gains (above 0, at most 1)."""
        if len(frequencies_hz) != len(gains):
            raise FieldError("gains", f"{len(frequencies_hz)} numbers, one for each frequency", len(gains))
        knots = [
            Knot(round(frequency / sample_rate_hz * 2**32), round(gain * 2**31))
            for frequency, gain in zip(frequencies_hz, gains)
        ]
        return cls(*span_um, sample_rate_hz, knots)

    @property
    def crc(self) -> int:
        """The CRC by which the device knows this table."""
        head = struct.pack("<IIIH", self.span_start_um, self.span_end_um, self.sample_rate_hz, len(self.knots))
        return zlib.crc32(head + b"".join(struct.pack("<II", knot.step, knot.gain) for knot in self.knots))

    @property
    def header(self) -> TableHeader:
        """What an upload begins with."""
        return TableHeader(len(self.knots), self.span_start_um, self.span_end_um, self.sample_rate_hz, self.crc)

    def chunks(self) -> Iterator[TableChunk]:
        """The knots in order, as many at a time as a chunk holds."""
        for first in range(0, len(self.knots), KNOTS_PER_CHUNK):
            yield TableChunk(first, tuple(self.knots[first : first + KNOTS_PER_CHUNK]))
