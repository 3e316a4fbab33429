"""The images' own copy of memory, which most of what the thread does goes through."""
import random

import pytest

import m4_cycles
from boards import BOARDS, name
from images import firmware

FROM, TO, GUARD = 0x20010000, 0x20012000, 8
COPIES = "__aeabi_memcpy", "__aeabi_memcpy4", "__aeabi_memcpy8"


@pytest.mark.parametrize("facts", BOARDS, ids=name)
def test_copies_of_any_length_and_alignment_are_exact(facts):
    board, draw = m4_cycles.Board(firmware(facts.feature)), random.Random(5)
    assert len({board.symbols[copy] for copy in COPIES}) == 1, "one function, whatever alignment is promised"
    board.map(FROM, 0x4000)
    for length in (*range(70), 255, 1000):
        for _ in range(3):
            source, target = FROM + draw.randrange(4), TO + draw.randrange(4)
            data, before = draw.randbytes(length), draw.randbytes(length + 2 * GUARD)
            board.cpu.mem_write(source, data)
            board.cpu.mem_write(target - GUARD, before)
            board.call(COPIES[0], [target, source, length], trace=False)
            after = bytes(board.cpu.mem_read(target - GUARD, len(before)))
            assert after == before[:GUARD] + data + before[-GUARD:], (length, source, target)
    cycles, _ = board.cycles(board.call(COPIES[0], [TO + 1, FROM + 2, 1000], trace=True))
    assert cycles < 1.2 * 1000, "the documentation says one a byte"
