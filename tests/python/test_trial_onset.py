"""The sample index in a row of trials against the device's own record: a digest of the codes that it has played.

What the codes must be follows from the commands on the line and from the row's index, by `tests/protocol/codes.py`, which is
written from the page of the protocol.
"""

from __future__ import annotations

import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import slipline
from line import Line
from codes import Motion, bytes_of, played  # isort: skip
from frame import Frame, FrameReader  # isort: skip
from messages import COMMANDS, EVENTS, Accepted, DigestStart  # isort: skip
from table import Table  # isort: skip

BLOCK = 128
#: From the order of the digest to its first code, and its length: the drive of a trial begins in it, silence is before.
AHEAD, LENGTH = 400 * BLOCK, 800 * BLOCK

_ARMING = {COMMANDS[name].id for name in ("Arm", "ArmFor")}


class DigestLine(Line):
    """A line on which arming becomes another command. The program has none for digests, and a device forgets
    its digest with the session: so the test asks in the program's own."""

    def __enter__(self) -> DigestLine:
        self._next: tuple[str, Any] | None = None
        self._exchanged: dict[int, Frame] = {}
        self._answers = FrameReader()
        self.crc: int | None = None
        super().__enter__()
        return self

    def instead_of_arming(self, device: slipline.Device, command: str, body: Any = None) -> None:
        """Sends a command in the place of arming; the program gets the answer to that."""
        self._next = command, body
        device.arm()
        assert self._next is None

    def _to_device(self, data: bytes, reader: FrameReader) -> bytes:
        frames = [frame for frame in reader.feed(data) if isinstance(frame, Frame)]
        self._note(frames)
        return b"".join(self._command(frame).encode() for frame in frames)

    def _command(self, frame: Frame) -> Frame:
        if self._next is not None and frame.id in _ARMING:
            kind = COMMANDS[self._next[0]]
            self._exchanged[frame.sequence] = replace(frame, id=kind.id, body=kind.encode(self._next[1]))
            self._next = None
        # One that is sent again, too.
        return self._exchanged.get(frame.sequence, frame) if frame.id in _ARMING else frame

    def _to_program(self, data: bytes) -> bytes:
        frames = [frame for frame in self._answers.feed(data) if isinstance(frame, Frame)]
        for number, frame in enumerate(frames):
            if frame.id == EVENTS["Digest"].id:
                digest = EVENTS["Digest"].decode(frame.body)
                self.crc = digest.crc
                accepted = EVENTS["Accepted"]
                frames[number] = replace(frame, id=accepted.id, body=accepted.encode(Accepted(digest.from_)))
        return b"".join(frame.encode() for frame in frames)


def crc_if_it_begins_at(line: Line, at_samples: int, begin: int) -> int:
    """The digest of the window that begins there, of silence and then the last drive on the line."""
    header, chunks = line.bodies("TableBegin")[0], {chunk.first: chunk.knots for chunk in line.bodies("TableChunk")}
    knots = [knot for first in sorted(chunks) for knot in chunks[first]]
    table = Table(header.span_start_um, header.span_end_um, header.sample_rate_hz, knots)
    assert table.crc == header.crc
    drive = line.bodies("Drive")[-1]
    motion = Motion(table).drive(drive.tones, at_samples, drive.glide)
    silence = bytes_of([2048] * (at_samples - begin))
    return zlib.crc32(silence + bytes_of(list(played([motion], at_samples, begin + LENGTH))))


def test_at_samples_of_a_row_is_the_first_sample_of_its_drive_in_the_devices_own_record(tmp_path: Path) -> None:
    listed: list[dict[str, float]] = []
    proven = 0
    with DigestLine() as line, slipline.connect(line.port) as device:
        device.use(slipline.Plate("membrane"))
        device.arm()
        for number in range(10):
            begin = (device.status().now_samples + AHEAD) // BLOCK * BLOCK
            line.instead_of_arming(device, "DigestStart", DigestStart(begin, LENGTH))

            def read_digest(_trial: object, end: int = begin + LENGTH) -> None:
                device.wait(end + 1000)
                line.instead_of_arming(device, "DigestRead")

            listed.append({"turning_point_m": 0.12 + 0.01 * number, "level": 0.5})
            device.wait(begin)
            rows = slipline.trials.run(device, listed, read_digest, folder=tmp_path, subject="01", task="edge")
            at_samples = int(rows[-1]["at_samples"])
            # Silent before the next.
            device.wait(device.status().now_samples + 40_000)
            # A machine that was held up begins the drive later: the next trial.
            if not begin <= at_samples < begin + LENGTH - BLOCK:
                continue
            assert line.crc == crc_if_it_begins_at(line, at_samples, begin)
            assert line.crc not in [crc_if_it_begins_at(line, at_samples + off, begin) for off in (-BLOCK, BLOCK)]
            proven += 1
            if proven == 2:
                return
    raise AssertionError(f"only {proven} of {len(listed)} drives began in their windows")
