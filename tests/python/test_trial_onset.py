"""The sample index in a row of trials against the device's own record: a digest of the codes that it has played.

The test orders the digest before the program under test connects, and reads it after. What the codes must be follows from the
commands on the line and from the row's index, by `tests/protocol/codes.py`, which is written from the page of the protocol.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from pathlib import Path

import slipline
from line import Client, Line
from codes import Motion, bytes_of, played  # isort: skip  its folder is known by the line
from messages import DigestStart  # isort: skip
from table import Table  # isort: skip

#: From the order of the digest to its first code, and its length: the drive of a trial begins in it, silence is before.
AHEAD_S, LENGTH_S = 1.5, 0.25


def run_trials(line: Line, listed: list[dict[str, float]], begin: int, end: int, folder: Path) -> dict[str, str]:
    """Runs the last of these trials, the others have their rows, from the begin of a window to beyond its end."""
    with slipline.connect(line.port) as device:
        device.use(slipline.Plate("membrane"))
        device.arm()
        device.wait(begin)
        sounds_on: Callable[[object], object] = lambda trial: device.wait(end + 1000)  # noqa: E731
        return slipline.trials.run(device, listed, sounds_on, folder=folder)[-1]


def codes_crc(line: Line, at_samples: int, begin: int, end: int) -> int:
    """The digest of silence and of the last drive on the line, if that begins at this index."""
    header, chunks = line.bodies("TableBegin")[0], {chunk.first: chunk.knots for chunk in line.bodies("TableChunk")}
    knots = [knot for first in sorted(chunks) for knot in chunks[first]]
    table = Table(header.span_start_um, header.span_end_um, header.sample_rate_hz, knots)
    assert table.crc == header.crc
    drive = line.bodies("Drive")[-1]
    motion = Motion(table).drive(drive.tones, at_samples, drive.glide)
    silence = bytes_of([2048]) * (at_samples - begin)
    return zlib.crc32(silence + bytes_of(list(played([motion], at_samples, end))))


def test_at_samples_of_a_row_is_the_first_sample_of_its_drive_in_the_devices_own_record(tmp_path: Path) -> None:
    listed: list[dict[str, float]] = []
    proven = 0
    with Line() as line:
        for number in range(10):
            with Client.at_socket(line.server.path) as client:
                rate, block = client.device.sample_rate_hz, client.device.block
                begin = (client.status().now + round(AHEAD_S * rate)) // block * block
                end = begin + round(LENGTH_S * rate) // block * block
                client.channel.request("DigestStart", DigestStart(begin, end - begin))
            listed.append({"turning_point_m": 0.12 + 0.01 * number, "level": 0.5})
            at_samples = int(run_trials(line, listed, begin, end, tmp_path)["at_samples"])
            # A machine that was held up has begun the drive later: the next trial.
            if not begin <= at_samples < end - block:
                continue
            with Client.at_socket(line.server.path) as client:
                played_crc = client.channel.request("DigestRead")[1].crc
            assert played_crc == codes_crc(line, at_samples, begin, end)
            for off in (-block, block):
                assert played_crc != codes_crc(line, at_samples + off, begin, end)
            proven += 1
            if proven == 2:
                return
    raise AssertionError(f"only {proven} of {len(listed)} drives began in their windows")
