"""The images' own copy of memory, which most of what the thread does goes through."""
import random

import pytest

import m4_cycles
from boards import BOARDS, name
from images import firmware

FROM, TO, GUARD = 0x20010000, 0x20012000, 8
# By the alignment that the caller promises: cycles a byte, as the documentation says.
COPIES = {"__aeabi_memcpy": (1, 1.2), "__aeabi_memcpy4": (4, 0.8)}


@pytest.mark.parametrize("facts", BOARDS, ids=name)
def test_copies_of_any_length_and_alignment_are_exact(facts):
    board, draw = m4_cycles.Board(firmware(facts.feature)), random.Random(5)
    assert board.symbols["__aeabi_memcpy4"] == board.symbols["__aeabi_memcpy8"]
    board.map(FROM, 0x4000)
    for copy, (alignment, most) in COPIES.items():
        for length in (*range(140), 255, 1000):
            for _ in range(3):
                source, target = FROM + draw.randrange(0, 8, alignment), TO + draw.randrange(0, 8, alignment)
                data, before = draw.randbytes(length), draw.randbytes(length + 2 * GUARD)
                board.cpu.mem_write(source, data)
                board.cpu.mem_write(target - GUARD, before)
                board.call(copy, [target, source, length], trace=False)
                after = bytes(board.cpu.mem_read(target - GUARD, len(before)))
                assert after == before[:GUARD] + data + before[-GUARD:], (copy, length, source, target)
        cycles, _ = board.cycles(board.call(copy, [TO + alignment, FROM + 2 * alignment, 1000], trace=True))
        assert cycles < most * 1000, copy
