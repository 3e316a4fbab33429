"""The models of pins and debug unit, register by register against RM0090 (chapters 8 and 38); no program runs."""
import pytest

from bare_chip import AHB1ENR, BKP, CEN, DBGMCU_APB1, DBGMCU_APB2, FORCED_HIGH, GPIOB, MICROSECOND, MOE, OPM, OSSI, TIM6
from core.pins import AFRL, BSRR, LCKR, MODER, ODR
from core.timer import ARR, CNT, CR1


def test_a_pin_follows_its_mode(chip):
    levels = []
    for mode, output in ((0, 2), (1, 2), (1, 0), (3, 2)):
        chip.write(GPIOB + BSRR, output or 2 << 16)
        chip.write(GPIOB + MODER, 0x280 | mode << 2)
        levels.append(chip.board.pin("PB1"))
    assert levels == [None, 1, 0, None]


def lock(chip, *values):
    for value in values:
        chip.write(GPIOB + LCKR, value)
    return chip.read(GPIOB + LCKR)


def test_a_locked_pin_keeps_its_mode_and_function_until_the_reset(chip):
    chip.write(GPIOB + MODER, 0x280 | 1 << 2)
    assert lock(chip, 0x10002, 0x2, 0x10002) == 0x10002
    chip.write(GPIOB + MODER, 0)
    chip.write(GPIOB + AFRL, 0x1111)
    assert (chip.read(GPIOB + MODER), chip.read(GPIOB + AFRL)) == (1 << 2, 0x1101)
    chip.write(GPIOB + BSRR, 2)
    assert chip.read(GPIOB + ODR) == 2, "its level is not locked"
    chip.board.reset("software")
    chip.write(AHB1ENR, 0x1FF)
    chip.write(GPIOB + MODER, 0)
    assert chip.read(GPIOB + MODER) == 0


@pytest.mark.parametrize(
    "values", [(0x10002, 0x2), (0x10002, 0x10002, 0x10002), (0x10002, 0x3, 0x10002), (0x2, 0x10002, 0x2)]
)
def test_another_sequence_locks_nothing(chip, values):
    assert lock(chip, *values) == 0
    chip.write(GPIOB + MODER, 0)
    assert chip.read(GPIOB + MODER) == 0


def test_a_debugger_stops_the_chosen_timers_and_no_other(chip):
    """RM0090 38.16.4: and then the outputs of a timer with a break are off, as if MOE were 0."""
    chip.write(DBGMCU_APB1, 1 << 4)
    chip.write(TIM6 + ARR, 0xFFFF)
    chip.write(TIM6 + CR1, CEN)
    chip.timer(CEN | OPM, compare=1, reload=4999)
    chip.board.run(100 * MICROSECOND)
    chip.board.halt()
    stopped = chip.read(TIM6 + CNT)
    chip.board.run(4000 * MICROSECOND)
    assert chip.board.pin("PB1") == 1
    chip.board.run(1000 * MICROSECOND)
    assert chip.board.pin("PB1") == 0, "the mute timer runs out"
    assert chip.read(TIM6 + CNT) == stopped
    chip.board.resume()
    chip.board.run(100 * MICROSECOND)
    assert chip.read(TIM6 + CNT) == stopped + 8400


def test_the_outputs_of_a_stopped_timer_are_off(chip):
    chip.write(DBGMCU_APB2, 1)
    chip.timer(CEN, compare=0, reload=99, mode=FORCED_HIGH, main=MOE | BKP | OSSI)
    assert chip.board.pin("PB1") == 1
    chip.board.halt()
    assert chip.board.pin("PB1") == 0
    chip.board.resume()
    assert chip.board.pin("PB1") == 1


def test_the_debug_unit_keeps_its_registers_until_the_power_goes(chip):
    chip.write(DBGMCU_APB1, 1 << 4)
    chip.board.reset("software")
    assert chip.read(DBGMCU_APB1) == 1 << 4
    chip.board.reset("power")
    assert chip.read(DBGMCU_APB1) == 0


def test_the_watchdog_runs_on_in_a_halted_chip_unless_it_is_frozen(chip):
    chip.write(0x40003000, 0xCCCC)
    chip.board.halt()
    chip.write(DBGMCU_APB1, 1 << 12)
    chip.board.run(2)
    assert chip.board.resets == []
    chip.write(DBGMCU_APB1, 0)
    chip.board.run(0.6)
    assert chip.board.resets == ["watchdog"]
