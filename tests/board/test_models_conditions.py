"""The model of the core's IT blocks, whose instructions are carried out on a condition (ARMv7-M A7.3): small programs that are
not Slipline's, on chips that watch the words of their flash."""
import struct
from typing import NamedTuple

import pytest
from unicorn import UC_HOOK_MEM_WRITE
from unicorn.arm_const import UC_ARM_REG_FAULTMASK, UC_ARM_REG_R1, UC_ARM_REG_R4, UC_ARM_REG_SP

import stm32g474
import stm32h743
from core.nvic import CCR, NMI
from core.processor import IT_STATE

AHB1ENR, ECCR, IGNORES_BUS_FAULTS = 0x40021048, 0x40022018, 1 << 8
# Code, handler, vectors and stack in RAM, and the count of the handler's runs. Unicorn's own blocks end with a page of 1 KiB.
PAGE, HANDLER, VECTORS, COUNT, STACK = 0x20000800, 0x20001000, 0x20001200, 0x20001400, 0x20002000
# movs r0, #0; itte eq; ldreq r3, [r1]; addeq r4, #1; addne r7, #1; movs r0, #1; b here; here: adds r5, #1; adds r6, #1; b .
PROGRAM = 0x2000, 0xBF06, 0x680B, 0x3401, 0x3701, 0x2001, 0xE7FF, 0x3501, 0x3601, 0xE7FE
BEFORE_ADD, READ = 6, 2
# streq r3, [r1]
WITH_A_STORE = *PROGRAM[:READ], 0x600B, *PROGRAM[READ + 1 :]
# ldr r0, =ECCR; ldr r2, [r0]; str r2, [r0]; ldr r0, =COUNT; ldr r2, [r0]; adds r2, #1; str r2, [r0]; bx lr: what ECCR holds is
# cleared by writing it.
CLEAR_AND_COUNT = struct.pack("<8H2I", 0x4803, 0x6802, 0x6002, 0x4803, 0x6802, 0x3201, 0x6002, 0x4770, ECCR, COUNT)
# The rest of ITTE EQ after its first instruction, in xPSR's form (ARMv7-M A7.3.3, B1.4.2): 0b0000_1100.
LEFT = 0b000011 << 10


class Word(NamedTuple):
    """A word of a flash with error correction that cannot be corrected, and how a program can still read it."""

    chip: type
    address: int

    def board(self):
        board = self.chip()
        if self.chip is stm32g474.Board:
            board.bus_write(AHB1ENR, 4, 0x107)
        else:
            board.bus_write(0xE0000000 + CCR, 4, IGNORES_BUS_FAULTS)
            board.cpu.reg_write(UC_ARM_REG_FAULTMASK, 1)
        board.cpu.mem_write(HANDLER, CLEAR_AND_COUNT)
        board.cpu.mem_write(VECTORS + 4 * NMI, struct.pack("<I", HANDLER | 1))
        board.cpu.mem_write(COUNT, bytes(4))
        board.vectors = VECTORS
        board.flash.tear(self.address)
        return board


WORDS = {"g474": Word(stm32g474.Board, 0x08078000), "h743": Word(stm32h743.Board, 0x081C0000)}


def run(board, program, at, address):
    """What r4, r5, r6 and r7 count."""
    board.cpu.mem_write(at, struct.pack(f"<{len(program)}H", *program))
    for register, value in ((UC_ARM_REG_R1, address), (UC_ARM_REG_SP, STACK), *((UC_ARM_REG_R4 + i, 0) for i in range(4))):
        board.cpu.reg_write(register, value)
    board.pc = at | 1
    board.run(2e-5)
    return [board.cpu.reg_read(UC_ARM_REG_R4 + i) for i in range(4)]


@pytest.mark.parametrize("word", WORDS.values(), ids=WORDS)
@pytest.mark.parametrize("offset", [0, -BEFORE_ADD], ids=["in a page", "across two"])
@pytest.mark.parametrize("is_torn", [True, False], ids=["torn", "whole"])
def test_after_a_read_in_an_it_block_the_code_goes_on_without_conditions(word, offset, is_torn):
    """Both words are watched, because one of them is torn; after the block r5 and r6 are counted whatever its condition was."""
    board = word.board()
    assert run(board, PROGRAM, PAGE + offset, word.address + (0 if is_torn else 64)) == [1, 1, 1, 0]
    runs = is_torn and word.chip is stm32g474.Board
    assert board.cpu.mem_read(COUNT, 1)[0] == runs and not board.faults


def test_after_a_store_in_an_it_block_the_code_goes_on_without_conditions(chip):
    """As after one into the flash, which every chip watches."""
    stored = []
    chip.board.watch_memory(UC_HOOK_MEM_WRITE, lambda *access: stored.append(access), COUNT, COUNT + 3)
    assert run(chip.board, WITH_A_STORE, PAGE, COUNT) == [1, 1, 1, 0] and len(stored) == 1


def test_an_exception_within_an_it_block_stacks_what_is_left_of_it_and_comes_back_to_it():
    """The NMI of the G474's torn word, at the end of a page, where the model looks for exceptions (ARMv7-M B1.5.6)."""
    word = WORDS["g474"]
    board = word.board()
    assert run(board, PROGRAM, PAGE - BEFORE_ADD, word.address) == [1, 1, 1, 0]
    returns_to, state = struct.unpack("<2I", board.cpu.mem_read(STACK - board.FRAME + 24 & ~7, 8))
    assert (returns_to, state & IT_STATE) == (PAGE, LEFT)
    assert board.cpu.mem_read(COUNT, 1)[0] == 1
