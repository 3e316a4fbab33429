"""The models of clock tree and clock security system, register by register against RM0090 (chapter 7); no program runs."""
import pytest

from bare_chip import (
    APB2ENR, CEN, CFGR, CIR, FLASH_ACR, MICROSECOND, PLLCFGR, PLLON, PLL_IN_USE, RCC, TIM1, TIM6, Registers,
)  # fmt: skip
from core.clocks import CSSON, HSEON
from core.nvic import NMI
from core.timer import ARR, CNT, CR1


def test_the_clock_tree_is_computed_from_the_registers(chip):
    tree = chip.board.clocks.frequencies
    assert (tree.core, tree.apb, tree.timers, tree.usb) == (168e6, {1: 42e6, 2: 84e6}, {1: 84e6, 2: 168e6}, 48e6)
    assert chip.read(CFGR) & 0xC == PLL_IN_USE << 2


def test_the_chip_starts_on_its_internal_oscillator_and_a_crystal_takes_its_time():
    chip = Registers()
    assert chip.board.clocks.frequencies.core == 16e6
    chip.write(RCC, chip.read(RCC) | HSEON)
    assert not chip.read(RCC) & 1 << 17
    chip.board.run(3e-3)
    assert chip.read(RCC) & 1 << 17


@pytest.mark.parametrize(
    "address, value, sentence",
    [
        (PLLCFGR, 8 | 168 << 6 | 1 << 22 | 7 << 24, "PLLCFGR is written while the PLL runs"),
        (CFGR, 0b100 << 10 | 0b100 << 13 | PLL_IN_USE, "apb"),
        (FLASH_ACR, 4, "168.0 MHz with 4 wait states"),
        (RCC, 0x83 | HSEON, "the PLL cannot be stopped"),
    ],
)
def test_what_the_clocks_must_not_do_is_a_failure(chip, address, value, sentence):
    with pytest.raises(AssertionError, match=sentence):
        chip.write(address, value)


def test_a_peripheral_without_its_clock_cannot_be_written(chip):
    chip.write(APB2ENR, 0)
    assert chip.read(TIM1 + ARR) == 0
    with pytest.raises(AssertionError, match="whose clock is off"):
        chip.write(TIM1 + ARR, 1)


def test_a_register_that_is_not_modelled_is_a_failure(chip):
    for address in (TIM1 + 0x60, RCC + 0x200, 0x40003C00, 0xE000EDF0):
        with pytest.raises(AssertionError, match="model"):
            chip.read(address)


def test_the_clock_security_system_falls_back_and_raises_the_nmi_until_it_is_cleared(chip):
    chip.write(RCC, chip.read(RCC) | CSSON)
    chip.write(TIM6 + ARR, 0xFFFF)
    chip.write(TIM6 + CR1, CEN)
    chip.board.run(100 * MICROSECOND)
    chip.board.stop_crystal()
    assert chip.board.nvic.nmi_due and chip.board.next_exception() == (-2, NMI)
    assert chip.board.clocks.frequencies.core == 16e6
    assert chip.read(RCC) & (HSEON | PLLON) == 0 and chip.read(CFGR) & 0xF == 0
    before = chip.read(TIM6 + CNT)
    assert before == 8400, "what was counted stays"
    chip.board.nvic.nmi_due = False
    chip.board.now += 100 * MICROSECOND * chip.board.CORE_HZ
    # APB1 is a quarter of 16 MHz, its timers run at 8 MHz.
    assert chip.read(TIM6 + CNT) - before == 800
    assert chip.board.is_nmi_held() and chip.read(CIR) & 1 << 7
    chip.write(CIR, 1 << 23)
    assert not chip.board.is_nmi_held()


def test_without_the_clock_security_system_everything_but_the_watchdog_stands_still(chip):
    chip.write(TIM6 + ARR, 0xFFFF)
    chip.write(TIM6 + CR1, CEN)
    chip.write(0x40003000, 0xCCCC)
    chip.board.stop_crystal()
    before = chip.read(TIM6 + CNT)
    chip.board.run(0.4)
    assert chip.read(TIM6 + CNT) == before and chip.board.resets == []
    chip.board.run(0.2)
    assert chip.board.resets == ["watchdog"]
