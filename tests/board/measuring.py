"""The messages by which the device measures its inputs, and a plate that plays back into them."""
from typing import NamedTuple

from host import LISTEN, PROGRESS, Reader, varint

LISTEN_READ, LISTENED_REPLY = 0x62, 0xE2
EVERY_SLOT = 0xFFFF


class Listened(NamedTuple):
    """What the lock-ins of one input have measured: `answers` has I and Q of each slot."""

    progress: str
    begin: int
    blocks: int
    weight: int
    followed: int
    lowest: int
    highest: int
    answers: list


def listen(host, blocks, hann=False, slots=EVERY_SLOT, at=None, input=0):
    """Begins to measure an input, at an index or with the next block; returns the first sample's index."""
    from_ = b"\0" if at is None else b"\1" + varint(at)
    of = b"\0" if input is None else bytes([1, input])
    return host.accept(LISTEN, from_ + varint(blocks) + bytes([hann]) + varint(slots) + of)


def listened(host, input):
    """The reading of an input: two reads, of eight slots each; while it is under way one read, without answers."""
    lower = _part(host, input, 0)
    if lower.progress == "running":
        return lower
    halves = [lower, _part(host, input, 8)]
    assert halves[0][:-1] == halves[1][:-1], "both are of the same window"
    return halves[0]._replace(answers=halves[0].answers + halves[1].answers)


def _part(host, input, first_slot):
    _, reply, body = host.exchange(LISTEN_READ, bytes([input, first_slot]))
    assert reply == LISTENED_REPLY, f"{reply:#x} {body.hex()}"
    r = Reader(body)
    progress = PROGRESS[r.number()]
    if progress == "broken":
        r.number()
    facts = [r.number() for _ in range(6)]
    return Listened(progress, *facts, [(r.signed(), r.signed()) for _ in range(r.number())])
