"""The models of timers and their outputs, register by register against RM0090 (chapter 17); no program runs."""
import pytest

from bare_chip import (
    APB1ENR, APB2ENR, ARPE, BKE, BKP, CC3E, CC3NE, CC3NP, CC3P, CCR3, CEN, FORCED_HIGH, FORCED_LOW, GPIOB, MICROSECOND, MOE,
    OIS3N, OPM, OSSI, OSSR, PRESCALER, PWM1, PWM2, RCC, TIM1, TIM4, TIM8,
)  # fmt: skip
from core.clocks import CSSON
from core.outputs import BDTR, CCER, CCMR1, CCMR2
from core.pins import AFRL, MODER
from core.timer import ARR, CCR1, CNT, CR1, CR2, DIER, EGR, PSC, RCR, SR


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
def test_the_outputs_match_the_table(chip, enables, output, complement):
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
    for offset, value in ((0x08, 1), (CR1, 1 << 4), (CCMR2, 2), (0x60, 0)):
        with pytest.raises(AssertionError, match="model"):
            chip.write(TIM1 + offset, value)


# --- captures (RM0090 18.3.5)


def capture(chip, selection=1, edges=1):
    """TIM4's channel 2 captures what comes at PB7, with the longest filter: 256 periods of its 84 MHz."""
    chip.write(APB1ENR, 1 << 4 | 1 << 2)
    chip.write(TIM4 + CCMR1, (selection | 15 << 4) << 8)
    chip.write(TIM4 + CCER, edges << 4)
    chip.write(GPIOB + AFRL, 2 << 28)
    chip.write(GPIOB + MODER, 0x280 | 2 << 14)
    return lambda level: chip.board.pins.drive("PB7", level)


def test_a_rise_that_stands_for_the_filters_time_sets_the_flag_and_nothing_else_does(chip):
    pin, flag = capture(chip), 1 << 2
    pin(1)
    chip.board.run(3.0 * MICROSECOND)
    assert not chip.read(TIM4 + SR) & flag
    pin(0)
    chip.board.run(10 * MICROSECOND)
    assert not chip.read(TIM4 + SR) & flag, "a spike"
    pin(1)
    chip.board.run(3.1 * MICROSECOND)
    assert chip.read(TIM4 + SR) & flag
    chip.write(TIM4 + SR, ~flag & 0xFFFFFFFF)
    pin(0)
    chip.board.run(10 * MICROSECOND)
    assert not chip.read(TIM4 + SR) & flag, "cleared, and a fall is no rise"


@pytest.mark.parametrize("selection, edges, sentence", [(2, 1, "capture is not modelled"), (1, 3, "rising edges")])
def test_an_unmodelled_capture_is_a_failure(chip, selection, edges, sentence):
    with pytest.raises(AssertionError, match=sentence):
        capture(chip, selection, edges)


def test_a_channel_that_is_on_keeps_its_selection_and_a_capture_is_read_only(chip):
    capture(chip)
    with pytest.raises(AssertionError, match="keeps its selection"):
        chip.write(TIM4 + CCMR1, 0)
    with pytest.raises(AssertionError, match="read-only"):
        chip.write(TIM4 + CCR1 + 4, 0)


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
    # The value is buffered: the first round, up to the eighth update, uses the old one.
    assert levels == [0] * 7 + [1, 1, 1, 0, 0, 0, 0, 0] * 2 + [1]
    chip.write(TIM8 + CR1, 0)
    before = chip.read(TIM4 + CNT)
    chip.board.run(20 * update)
    assert chip.read(TIM4 + CNT) == before, "it stands still with it"


@pytest.mark.parametrize("source, mode, sentence", [(3, 4, "slave mode"), (7, 7, "internal trigger 7")])
def test_another_slave_mode_or_source_is_a_failure(chip, source, mode, sentence):
    with pytest.raises(AssertionError, match=sentence):
        block_timer(chip, source, mode)
