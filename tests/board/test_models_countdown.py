"""The model of a wait that counts a register down: the rounds that are left out change nothing."""
import struct

import pytest
from unicorn.arm_const import UC_ARM_REG_R0, UC_ARM_REG_R5

from core import processor
from core.countdown import counted
from stm32f407 import Board

PAGE, WAIT, ROUNDS = 0x20000800, 0x20000802, 1000
# b wait; wait: subs r0, #1; bne wait; adds r5, #1; b .
PROGRAM = 0xE7FF, 0x3801, 0xD1FD, 0x3501, 0xE7FE


def course(executes, rounds):
    """Time, place and registers of a program with this wait, after each piece of its time and at each event, by a processor for which
    `executes` is called with the blocks of code that it executes."""
    board = Board()
    on_block = board.on_block
    board.cpu.hook_del(board.block_hook)
    board.block_hook = board.cpu.hook_add(processor.UC_HOOK_BLOCK, lambda *block: (executes(block[1]), on_block(*block)))
    board.cpu.mem_write(PAGE, struct.pack(f"<{len(PROGRAM)}H", *PROGRAM))
    board.cpu.reg_write(UC_ARM_REG_R0, rounds)
    board.cpu.reg_write(UC_ARM_REG_R5, 0)
    board.pc = PAGE | 1
    seen = []

    def look():
        seen.append((board.now, board.pc, board.cpu.reg_read(UC_ARM_REG_R0), board.cpu.reg_read(UC_ARM_REG_R5)))

    cycle = board.cycle / board.CORE_HZ
    for piece in (1, 333.5, 900, 4000):
        board.at(board.now + 0.4 * piece * board.cycle, look)
        board.run(piece * cycle)
        look()
    return seen


@pytest.mark.parametrize("rounds", [1, 2, ROUNDS])
def test_a_wait_of_which_rounds_are_left_out_takes_the_same_time_and_ends_with_the_same_registers(rounds, monkeypatch):
    few, each = [], []
    by_leaps = course(few.append, rounds)
    monkeypatch.setattr(processor, "counted", lambda _: None)
    assert by_leaps == course(each.append, rounds)
    assert by_leaps[-1][2:] == (0, 1)
    assert each.count(WAIT) >= rounds
    assert rounds < ROUNDS or few.count(WAIT) < 20


def test_other_loops_are_executed_round_by_round():
    for code in ("<HHH", 0x3801, 0xD1FD, 0xBF00), ("<HH", 0x3802, 0xD1FD), ("<HH", 0x3001, 0xD1FD), ("<HH", 0x3801, 0xD1FC), ("<HH", 0x3801, 0xD0FD):
        assert counted(struct.pack(*code)) is None
