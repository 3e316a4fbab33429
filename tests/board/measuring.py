"""How a test measures the device's inputs."""
from typing import NamedTuple

import messages
from host import words
from messages import HANN, RECTANGULAR

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
    return host.accept("Listen", messages.Listen(at, blocks, HANN if hann else RECTANGULAR, slots, input))


def listened(host, input):
    """The reading of an input: two reads, of eight slots each; while it is under way one read, without answers."""
    lower = _part(host, input, 0)
    if lower.progress == "running":
        return lower
    halves = [lower, _part(host, input, 8)]
    assert halves[0][:-1] == halves[1][:-1], "both are of the same window"
    return halves[0]._replace(answers=halves[0].answers + halves[1].answers)


def _part(host, input, first_slot):
    read = host.ask("ListenRead", messages.ListenRead(input, first_slot), "Listened")
    answers = [(answer.in_phase, answer.quadrature) for answer in read.answers]
    return Listened(words(read.progress), read.begin, read.blocks, read.weight, read.followed, read.lowest, read.highest, answers)
