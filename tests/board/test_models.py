"""The models themselves, held against what the reference manuals say, register by register; no program runs."""
import pytest

from core.clocks import CSSON, HSEON
from core.nvic import NMI
from core.timer import ARR, CCR1, CNT, CR1, CR2, DIER, EGR, PSC, RCR, SR
from core.outputs import BDTR, CCER, CCMR2
from core.pins import AFRL, BSRR, LCKR, MODER, ODR
from stm32f407 import Board
from stm32f407.clocks import BASE as RCC

TIM1, TIM4, TIM8, TIM6, GPIOB, FLASH_ACR, DBGMCU_APB1, DBGMCU_APB2 = 0x40010000, 0x40000800, 0x40010400, 0x40001000, 0x40020400, 0x40023C00, 0xE0042008, 0xE004200C
CFGR, PLLCFGR, CIR, AHB1ENR, APB1ENR, APB2ENR = RCC + 0x08, RCC + 0x04, RCC + 0x0C, RCC + 0x30, RCC + 0x40, RCC + 0x44
PLLON, PLL_IN_USE = 1 << 24, 0b10
# CCER: channel 3's outputs and their polarities. CCMR2: channel 3's modes, forced, and compare with the counter.
CC3E, CC3P, CC3NE, CC3NP = 1 << 8, 1 << 9, 1 << 10, 1 << 11
FORCED_LOW, FORCED_HIGH, PWM1, PWM2 = 4 << 4, 5 << 4, 6 << 4, 7 << 4
MOE, AOE, BKP, BKE, OSSR, OSSI = 1 << 15, 1 << 14, 1 << 13, 1 << 12, 1 << 11, 1 << 10
OIS3, OIS3N = 1 << 12, 1 << 13
CEN, OPM, ARPE = 1, 1 << 3, 1 << 7
CCR3 = CCR1 + 8
# TIM1 at 168 MHz, with the prescaler that makes a count a microsecond.
MICROSECOND, PRESCALER = 1e-6, 167


class Registers:
    """A board without a program, whose registers the test writes."""

    def __init__(self):
        self.board = Board()

    def write(self, address, value):
        self.board.bus_write(address, 4, value)

    def read(self, address):
        return self.board.bus_read(address, 4)

    def run_at_full_speed(self):
        """The clock tree of the F4DISCOVERY's file in firmware/stm32/src/board."""
        self.write(RCC, self.read(RCC) | HSEON)
        self.board.run(3e-3)
        self.write(PLLCFGR, 4 | 168 << 6 | 1 << 22 | 7 << 24)
        self.write(RCC, self.read(RCC) | PLLON)
        self.board.run(1e-3)
        self.write(FLASH_ACR, 5)
        self.write(CFGR, 0b101 << 10 | 0b100 << 13)
        self.write(CFGR, 0b101 << 10 | 0b100 << 13 | PLL_IN_USE)
        self.write(AHB1ENR, 0x1FF)
        self.write(APB2ENR, 1 | 1 << 14)
        self.write(APB1ENR, 1 << 4)

    def timer(self, control, compare, reload, mode=PWM2, enables=CC3NE, main=MOE | BKP):
        """TIM1's channel 3 as the mute timer has it: one count a microsecond, its complementary output on PB1."""
        self.write(TIM1 + PSC, PRESCALER)
        self.write(TIM1 + ARR, reload)
        self.write(TIM1 + CCR3, compare)
        self.write(TIM1 + EGR, 1)
        self.write(TIM1 + SR, 0)
        self.write(TIM1 + CCMR2, mode)
        self.write(TIM1 + CCER, enables)
        self.write(TIM1 + BDTR, main)
        self.write(GPIOB + AFRL, 1 << 4)
        self.write(GPIOB + MODER, 0x280 | 2 << 2)
        self.write(TIM1 + CR1, control)

    def output(self, name="3N"):
        return self.board.timers[1].outputs.level(name)


@pytest.fixture
def chip():
    registers = Registers()
    registers.run_at_full_speed()
    return registers


# --- clocks (RM0090 chapter 7)


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


# --- timers (RM0090 chapter 17)


def test_a_prescaler_waits_for_the_update_event(chip):
    chip.write(TIM1 + ARR, 0xFFFF)
    chip.write(TIM1 + PSC, PRESCALER)
    chip.write(TIM1 + CR1, CEN)
    chip.board.run(100 * MICROSECOND)
    assert chip.read(TIM1 + CNT) == 16_800, "still one count a cycle"
    chip.write(TIM1 + EGR, 1)
    chip.board.run(100 * MICROSECOND)
    assert chip.read(TIM1 + CNT) == 100


def test_a_buffered_reload_and_the_repetition_counter_wait_too(chip):
    chip.write(TIM1 + PSC, PRESCALER)
    chip.write(TIM1 + ARR, 99)
    chip.write(TIM1 + RCR, 2)
    chip.write(TIM1 + EGR, 1)
    chip.write(TIM1 + SR, 0)
    chip.write(TIM1 + CR1, CEN | ARPE)
    chip.write(TIM1 + ARR, 49)
    chip.board.run(299.5 * MICROSECOND)
    assert chip.read(TIM1 + SR) & 1 == 0, "every third overflow is an update event"
    chip.board.run(1 * MICROSECOND)
    assert chip.read(TIM1 + SR) & 1 == 1
    chip.write(TIM1 + SR, 0)
    chip.board.run(150 * MICROSECOND)
    assert chip.read(TIM1 + SR) & 1 == 1, "now every 50 counts"


def test_a_pulse_ends_by_itself(chip):
    """One-pulse mode and PWM mode 2: low below the compare value, high from there to the reload value, then it stops."""
    chip.timer(CEN | OPM, compare=10, reload=4999)
    assert chip.board.pin("PB1") == 0
    chip.board.run(5 * MICROSECOND)
    assert chip.board.pin("PB1") == 0
    chip.board.run(6 * MICROSECOND)
    assert chip.board.pin("PB1") == 1
    chip.board.run(4985 * MICROSECOND)
    assert chip.board.pin("PB1") == 1
    chip.board.run(10 * MICROSECOND)
    assert chip.board.pin("PB1") == 0
    assert not chip.read(TIM1 + CR1) & CEN and chip.read(TIM1 + CNT) == 0
    edges = [(round(1e6 * at), level) for at, name, level in chip.board.log if name == "PB1" and level is not None]
    (_, low), (rise, high), (fall, end) = edges
    assert (low, high, end) == (0, 1, 0) and fall - rise == 4990, "5000 counts, 10 of them low"


def test_a_pulse_that_is_begun_again_in_time_does_not_end(chip):
    chip.timer(CEN | OPM, compare=1, reload=4999)
    chip.board.run(2 * MICROSECOND)
    chip.board.log.clear()
    for _ in range(10):
        chip.write(TIM1 + CNT, 1)
        chip.board.run(3000 * MICROSECOND)
    assert chip.board.pin("PB1") == 1 and not chip.board.log
    chip.board.run(2100 * MICROSECOND)
    assert chip.board.pin("PB1") == 0


@pytest.mark.parametrize(
    "enables, output, complement",
    [
        # RM0090 table 72, main output on, OSSR = 0, with the reference high: disabled, alone, alone, both.
        (0, None, None), (CC3E, 1, None), (CC3NE, None, 1), (CC3E | CC3NE, 1, 0),
        (CC3E | CC3P, 0, None), (CC3NE | CC3NP, None, 0), (CC3E | CC3NE | CC3NP, 1, 1),
    ],
)  # fmt: skip
def test_the_outputs_are_those_of_the_table(chip, enables, output, complement):
    chip.timer(0, compare=0, reload=99, mode=FORCED_HIGH, enables=enables)
    assert (chip.output("3"), chip.output("3N")) == (output, complement)
    chip.write(TIM1 + BDTR, MOE | BKP | OSSR)
    inactive = (int(bool(enables & CC3P)), int(bool(enables & CC3NP)))
    wanted = [level if level is not None or not enables else idle for level, idle in zip((output, complement), inactive)]
    assert [chip.output("3"), chip.output("3N")] == wanted, "OSSR: what is off is driven to its inactive level"


def test_without_the_main_output_a_pin_floats_or_has_its_idle_level(chip):
    chip.timer(0, compare=0, reload=99, mode=FORCED_HIGH, main=BKP)
    assert chip.board.pin("PB1") is None
    chip.write(TIM1 + BDTR, BKP | OSSI)
    assert chip.board.pin("PB1") == 0
    chip.write(TIM1 + CR2, OIS3N)
    assert chip.board.pin("PB1") == 1


def test_the_forced_modes_do_not_ask_the_counter(chip):
    chip.timer(CEN, compare=50, reload=99, mode=FORCED_LOW)
    chip.board.log.clear()
    chip.board.run(1e-3)
    assert chip.board.pin("PB1") == 0 and not chip.board.log


@pytest.mark.parametrize("cause", ["program", "clock"])
def test_a_break_switches_the_main_output_off_and_it_stays_off(chip, cause):
    chip.write(RCC, chip.read(RCC) | CSSON)
    chip.timer(CEN, compare=0, reload=99, mode=FORCED_HIGH, main=MOE | BKE | BKP | OSSI)
    chip.write(TIM1 + DIER, 1 << 7)
    assert chip.board.pin("PB1") == 1
    if cause == "program":
        chip.write(TIM1 + EGR, 1 << 7)
    else:
        chip.board.stop_crystal()
    assert chip.board.pin("PB1") == 0
    assert chip.read(TIM1 + SR) & 1 << 7 and 24 in chip.board.pending
    assert not chip.read(TIM1 + BDTR) & MOE
    chip.board.run(1e-3)
    assert chip.board.pin("PB1") == 0
    chip.write(TIM1 + BDTR, MOE | BKE | BKP | OSSI)
    assert chip.board.pin("PB1") == 1, "until the program switches it on again"


def test_a_clock_failure_breaks_only_where_the_break_is_enabled(chip):
    chip.write(RCC, chip.read(RCC) | CSSON)
    chip.timer(CEN, compare=0, reload=99, mode=FORCED_HIGH, main=MOE | BKP)
    chip.board.stop_crystal()
    assert chip.board.pin("PB1") == 1


def test_a_break_input_without_a_pin_is_low_and_so_breaks_if_low_is_active(chip):
    chip.timer(CEN, compare=0, reload=99, mode=FORCED_HIGH, main=MOE | BKE)
    assert chip.board.pin("PB1") is None and not chip.read(TIM1 + BDTR) & MOE


def test_the_lock_keeps_modes_polarities_and_the_break_but_not_the_main_output(chip):
    chip.timer(0, compare=0, reload=99, mode=PWM2, main=MOE | BKE | BKP | OSSI | 3 << 8)
    chip.write(TIM1 + CCMR2, FORCED_HIGH)
    assert chip.read(TIM1 + CCMR2) == PWM2
    chip.write(TIM1 + CCER, CC3NE | CC3NP)
    assert chip.read(TIM1 + CCER) == CC3NE
    chip.write(TIM1 + CR2, OIS3N)
    assert chip.read(TIM1 + CR2) == 0
    chip.write(TIM1 + BDTR, 0)
    assert chip.read(TIM1 + BDTR) == BKE | BKP | OSSI | 3 << 8
    chip.write(TIM1 + BDTR, MOE)
    assert chip.read(TIM1 + BDTR) & MOE


def test_what_the_timer_model_lacks_is_a_failure(chip):
    for offset, value in ((0x08, 1), (CR1, 1 << 4), (CCMR2, 1), (0x60, 0)):
        with pytest.raises(AssertionError, match="model"):
            chip.write(TIM1 + offset, value)


# --- pins (RM0090 chapter 8)


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


# --- one timer clocked by another (RM0090 18.3.15, 18.4.3)


def block_timer(chip, source=3, mode=7, compare=3):
    """TIM4 counts TIM8's updates, eight to a round; its channel 3 is high at first."""
    chip.write(APB1ENR, 1 << 4 | 1 << 2)
    chip.write(APB2ENR, 1 | 1 << 1 | 1 << 14)
    chip.write(TIM8 + ARR, 419)
    chip.write(TIM8 + CR2, 2 << 4)
    chip.write(TIM4 + ARR, 7)
    chip.write(TIM4 + CCMR2, PWM1 | 1 << 3)
    chip.write(TIM4 + CCR3, compare)
    chip.write(TIM4 + CCER, CC3E)
    chip.write(TIM4 + 0x08, source << 4 | mode)
    chip.write(TIM4 + CR1, CEN)
    chip.write(TIM8 + CR1, CEN)


def test_a_timer_counts_anothers_updates_and_takes_its_compare_value_over_at_its_own(chip):
    block_timer(chip)
    update = 420 / 168e6
    levels = []
    for _ in range(24):
        chip.board.run(update)
        levels.append(chip.board.timers[4].outputs.level("3"))
    # The value is buffered: the first round, up to the eighth update, goes by the old one.
    assert levels == [0] * 7 + [1, 1, 1, 0, 0, 0, 0, 0] * 2 + [1]
    chip.write(TIM8 + CR1, 0)
    before = chip.read(TIM4 + CNT)
    chip.board.run(20 * update)
    assert chip.read(TIM4 + CNT) == before, "it stands still with it"


@pytest.mark.parametrize("source, mode, sentence", [(3, 4, "slave mode"), (7, 7, "internal trigger 7")])
def test_another_slave_mode_or_source_is_a_failure(chip, source, mode, sentence):
    with pytest.raises(AssertionError, match=sentence):
        block_timer(chip, source, mode)


# --- a debugger, and the clock security system


def test_a_debugger_stops_the_timers_that_it_is_told_to_stop_and_no_other(chip):
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


def test_the_clock_security_system_falls_back_and_raises_the_nmi_until_it_is_told(chip):
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
