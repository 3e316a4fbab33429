"""The model of the memory protection unit, against ARMv7-M B3.5: a small program on an F407 that is not Slipline's."""
import pytest
from unicorn.arm_const import UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_SP

from core.nvic import BFAR, CFSR, HARD_FAULT, MMFAR

MPU_TYPE, MPU_CTRL, MPU_RNR, MPU_RBAR, MPU_RASR = range(0xE000ED90, 0xE000EDA4, 4)
ENABLE, HFNMIENA, PRIVDEFENA = 1, 2, 4
CODE, HANDLER, SIZE = 0x08000500, 0x08000600, 12
START, END = 0x20002000, 0x20004000
STORE, LOAD, CALL, LOOP = b"\x01\x60", b"\x01\x68", b"\x80\x47", b"\xfe\xe7"
VALUE, OLD = 0x600DF00D, 0x01D01D01


@pytest.fixture
def guarded(chip):
    """With a region of 8 KiB that nobody may touch, and a hard fault's handler that loops."""
    board = chip.board
    board.cpu.mem_write(board.FLASH_START + 4 * HARD_FAULT, (HANDLER | 1).to_bytes(4, "little"))
    board.cpu.mem_write(HANDLER, LOOP)
    chip.write(MPU_RNR, 7)
    chip.write(MPU_RBAR, START)
    chip.write(MPU_RASR, 1 << 28 | SIZE << 1 | ENABLE)
    chip.write(MPU_CTRL, PRIVDEFENA | ENABLE)
    return chip


def does(chip, code, address, at=CODE):
    """Runs an instruction on an address; returns whether it was done."""
    board = chip.board
    board.cpu.mem_write(address & ~1, OLD.to_bytes(4, "little"))
    board.cpu.mem_write(at, code + LOOP)
    board.cpu.reg_write(UC_ARM_REG_R0, address)
    board.cpu.reg_write(UC_ARM_REG_R1, VALUE)
    board.pc = at | 1
    board.run(1e-6)
    stored = int.from_bytes(board.cpu.mem_read(address & ~1, 4), "little")
    if code == STORE:
        assert stored == (OLD if board.active else VALUE)
    return not board.active


@pytest.mark.parametrize("address", [START, START + 0x1000, END - 4])
@pytest.mark.parametrize("code", [STORE, LOAD])
def test_an_access_in_the_region_is_a_fault_and_is_not_made(guarded, code, address):
    assert not does(guarded, code, address)
    registers = guarded.board.nvic.registers
    assert (registers[CFSR], registers[MMFAR]) == (1 << 7 | 1 << 1, address)
    assert [exception for _, exception in guarded.board.active] == [HARD_FAULT]


@pytest.mark.parametrize("address", [START - 4, END])
@pytest.mark.parametrize("code", [STORE, LOAD])
def test_an_access_beside_the_region_is_made(guarded, code, address):
    assert does(guarded, code, address)


def test_a_fetch_from_the_region_is_a_fault(guarded):
    assert not does(guarded, CALL, START | 1)
    assert guarded.board.nvic.registers[CFSR] == 1 << 0


def test_without_the_enable_bits_nothing_is_refused(guarded):
    guarded.write(MPU_CTRL, PRIVDEFENA)
    assert does(guarded, STORE, START)
    guarded.write(MPU_RASR, SIZE << 1)
    guarded.write(MPU_CTRL, PRIVDEFENA | ENABLE)
    assert does(guarded, STORE, START)


def test_a_region_that_is_moved_leaves_its_old_place(guarded):
    guarded.write(MPU_RBAR, END)
    assert does(guarded, STORE, START)
    assert not does(guarded, STORE, END)


def test_a_reset_switches_the_mpu_off(guarded):
    assert guarded.read(MPU_TYPE) == 8 << 8
    guarded.board.reset("pin")
    assert guarded.read(MPU_CTRL) == 0
    assert does(guarded, STORE, START)


@pytest.mark.parametrize("control, may", [(0, True), (HFNMIENA, False)])
def test_the_hard_fault_handler_runs_without_the_mpu_unless_configured_otherwise(guarded, control, may):
    board = guarded.board
    guarded.write(MPU_CTRL, PRIVDEFENA | ENABLE | control)
    assert not does(guarded, STORE, START)
    board.cpu.mem_write(START, OLD.to_bytes(4, "little"))
    board.cpu.mem_write(HANDLER + 0x10, STORE + LOOP)
    board.cpu.reg_write(UC_ARM_REG_R0, START)
    board.pc = HANDLER + 0x11
    board.run(1e-6)
    assert int.from_bytes(board.cpu.mem_read(START, 4), "little") == (VALUE if may else OLD)
    assert board.is_locked_up is not may


def test_a_frame_that_would_lie_in_the_region_is_not_written_and_the_interrupt_waits_behind_the_fault(guarded):
    board = guarded.board
    board.cpu.mem_write(START, b"\x55" * (END - START))
    board.cpu.reg_write(UC_ARM_REG_SP, END + 16)
    guarded.write(0xE000E100, 1)
    board.pend(0)
    board.run(1e-6)
    assert board.nvic.registers[CFSR] == 1 << 4
    assert [exception for _, exception in board.active] == [HARD_FAULT] and 0 in board.pending
    assert set(board.cpu.mem_read(START, END - START)) == {0x55}


def test_a_read_outside_the_memory_is_a_bus_fault(guarded):
    board = guarded.board
    board.cpu.mem_write(CODE, LOAD + LOOP)
    board.cpu.reg_write(UC_ARM_REG_R0, 0x60000000)
    board.pc = CODE | 1
    board.run(1e-6)
    assert (board.nvic.registers[CFSR], board.nvic.registers[BFAR]) == (1 << 15 | 1 << 9, 0x60000000)
