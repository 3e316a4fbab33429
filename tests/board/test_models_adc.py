"""The models of the ADCs, register by register against RM0090 (chapter 13), RM0440 (chapter 21) and RM0433; no program runs."""
import pytest

import stm32g474
import stm32h743
from bare_chip import AHB1ENR, APB2ENR, GPIOB, TIM8
from core.timer import ARR, CNT, CR1, CR2

ADC, DMA2, GPIOA, RAM = 0x40012000, 0x40026400, 0x40020000, 0x2001C000
SR, ADC_CR2, SMPR2, SQR1, SQR3, CSR, CCR, SECOND = 0x00, 0x08, 0x10, 0x2C, 0x34, 0x300, 0x304, 0x100
ON, RISING, TIM8_TRIGGER = 1, 1 << 28, 14 << 24
# By 6, DMA mode 2 that goes on, regular simultaneous.
COMMON = 2 << 16 | 2 << 14 | 1 << 13 | 6
# A stream of channel 0: circular, from a peripheral, words; with its enable bit.
COLLECT = 1 << 8 | 1 << 10 | 2 << 11 | 2 << 13 | 1
OVERRUNS = 1 << 5 | 1 << 13


def set_up(chip, common=COMMON, channels=(1, 2), samplings=(1, 1), second=ON, trigger=TIM8_TRIGGER | RISING, settle=4e-6):
    """Four words in a ring, of PA1 and PA2, at each of TIM8's updates: 168 MHz / 420."""
    board = chip.board
    chip.write(AHB1ENR, 1 << 22 | 0x1FF)
    chip.write(APB2ENR, 1 << 14 | 0b11 << 8 | 0b11)
    chip.write(GPIOA, 0xA8000000 | 0b1111 << 2)
    for register, value in ((0x18, ADC + 0x308), (0x1C, RAM), (0x14, 4), (0x10, COLLECT)):
        chip.write(DMA2 + register, value)
    chip.write(ADC + CCR, common)
    for adc, channel, sampling in zip((ADC, ADC + SECOND), channels, samplings):
        chip.write(adc + SMPR2, sampling << 3 * channel)
        chip.write(adc + SQR3, channel)
    chip.write(ADC + ADC_CR2, ON)
    chip.write(ADC + SECOND + ADC_CR2, second)
    board.run(settle)
    chip.write(ADC + ADC_CR2, ON | trigger)
    counts = iter(range(1, 1000))
    board.adc.at_pins = lambda: (next(counts), 4000)
    chip.write(TIM8 + ARR, 419)
    chip.write(TIM8 + CR2, 2 << 4)
    chip.write(TIM8 + CR1, 1)


def words(chip):
    memory = chip.board.cpu.mem_read(RAM, 16)
    return [int.from_bytes(memory[i : i + 2], "little") for i in range(0, 16, 2)]


def test_both_codes_of_each_trigger_come_as_one_word_when_both_are_ready(chip):
    set_up(chip)
    # 2 + 15 + 12 cycles of 14 MHz after the first trigger, at 2.5 us.
    chip.board.run(2.5e-6 + 29 / 14e6 - 2e-8)
    assert chip.read(DMA2 + 0x14) == 4
    chip.board.run(4e-8)
    assert chip.read(DMA2 + 0x14) == 3 and words(chip)[:2] == [1, 4000]
    chip.board.run(5 * 2.5e-6)
    assert chip.read(DMA2 + 0x14) == 2 and words(chip) == [5, 4000, 6, 4000, 3, 4000, 4, 4000]


def test_a_word_that_is_not_taken_is_an_overrun_and_ends_the_requests_until_it_is_cleared(chip):
    set_up(chip)
    chip.board.run(2.6e-6)
    chip.board.dma[2].blocked.add(0)
    chip.board.run(1.5 * 2.5e-6)
    assert chip.read(ADC + CSR) & OVERRUNS == 0, "the first one waits"
    chip.board.run(2.5e-6)
    assert chip.read(ADC + CSR) & OVERRUNS == OVERRUNS
    chip.board.dma[2].blocked.clear()
    chip.board.run(1e-4)
    assert chip.read(DMA2 + 0x14) == 4
    chip.write(ADC + CCR, COMMON & ~(3 << 14))
    for adc in (ADC, ADC + SECOND):
        chip.write(adc + SR, 0)
    chip.write(ADC + CCR, COMMON)
    chip.board.run(2 * 2.5e-6)
    assert chip.read(ADC + CSR) & OVERRUNS == 0 and chip.read(DMA2 + 0x14) == 2


@pytest.mark.parametrize(
    "facts, sentence",
    [
        (dict(common=COMMON & ~(3 << 16)), "42.0 MHz"), (dict(common=COMMON & ~31), "only the simultaneous mode"),
        (dict(common=COMMON & ~(1 << 13)), "DDS"), (dict(channels=(1, 1)), "the same pin"),
        (dict(channels=(1, 3)), "not analogue"), (dict(samplings=(1, 2)), "for the same time"),
        (dict(second=0), "not stable"), (dict(settle=1e-6), "not stable"),
        (dict(second=ON | RISING), "a trigger of its own"), (dict(trigger=6 << 24 | 3 << 28), "only the simultaneous"),
        (dict(trigger=9 << 24 | RISING), "EXTSEL 9"), (dict(trigger=TIM8_TRIGGER | RISING | 1 << 1), "not modelled"),
    ],
)  # fmt: skip
def test_a_forbidden_setting_of_the_f407s_adcs_is_a_failure(chip, facts, sentence):
    with pytest.raises(AssertionError, match=sentence):
        set_up(chip, **facts)


def test_a_trigger_that_comes_while_they_convert_is_a_failure(chip):
    set_up(chip, samplings=(2, 2))
    with pytest.raises(AssertionError, match="while the ADCs convert"):
        chip.board.run(1e-5)


def test_nothing_is_converted_for_another_timer(chip):
    set_up(chip, trigger=8 << 24 | RISING)
    chip.board.run(1e-4)
    assert chip.read(DMA2 + 0x14) == 4


# --- the fast ADCs


def fast(package):
    """A chip with clocks for its ADCs; its ADCs' base, and what writes to them."""
    board = package.Board()
    write = lambda address, value: board.bus_write(address, 4, value)
    if package is stm32g474:
        write(0x40021000 + 0x4C, 1 << 13 | 0x7F)
        write(0x48000000, 0xABFFFFFF)
        return board, 0x50000000, write
    write(0x58024400 + 0xD8, 1 << 5)
    write(0x58024400 + 0xE0, 0x7FF)
    return board, 0x40022000, write


FAST_CR, FAST_CFGR, FAST_SQR1, FAST_CCR = 0x08, 0x0C, 0x30, 0x308
REGULATOR, ASLEEP, CALIBRATE, START, FAST_ON = 1 << 28, 1 << 29, 1 << 31, 1 << 2, 1


@pytest.mark.parametrize("package", [stm32g474, stm32h743], ids=["g474", "h743"])
@pytest.mark.parametrize(
    "steps, sentence",
    [
        ([(FAST_CR, ASLEEP | REGULATOR)], "deep power-down"), ([(FAST_CR, 0), (FAST_CR, CALIBRATE)], "before its regulator"),
        ([(FAST_CR, 0), (FAST_CR, REGULATOR), (FAST_CR, REGULATOR | CALIBRATE)], "before its regulator"),
        ([(FAST_CR, 0), (FAST_CR, REGULATOR), None, (FAST_CR, REGULATOR | FAST_ON)], "before it is calibrated"),
        ([(FAST_CR, 0), (FAST_CR, REGULATOR), (FAST_SQR1, 1 << 6)], "its regulator is off"),
        ([(FAST_CR, 0), (FAST_CR, REGULATOR), None, (FAST_CR, REGULATOR | START)], "only the simultaneous mode"),
    ],
)  # fmt: skip
def test_an_order_that_the_manuals_forbid_is_a_failure(package, steps, sentence):
    """None is a wait for the regulator."""
    board, base, write = fast(package)
    with pytest.raises(AssertionError, match=sentence):
        for step in steps:
            if step is None:
                board.run(21e-6)
            else:
                write(base + step[0], step[1])


def start_g474(board, base, write, common=3 << 16 | 2 << 14 | 1 << 13 | 6, configuration=1 << 31 | 12 << 5 | 1 << 10, wait=21e-6, after=1e-6):
    write(base + FAST_CCR, common)
    for adc in (base, base + SECOND):
        write(adc + FAST_CR, 0)
        write(adc + FAST_CR, REGULATOR)
        board.run(wait)
        write(adc + 0x14, 4 << 3 | 4 << 6)
        write(adc + FAST_SQR1, (1 if adc == base else 2) << 6)
        write(adc + FAST_CR, REGULATOR | CALIBRATE)
        while board.bus_read(adc + FAST_CR, 4) & CALIBRATE:
            pass
        board.run(after)
        write(adc + FAST_CR, REGULATOR | FAST_ON)
        while not board.bus_read(adc, 4) & 1:
            board.run(1e-7)
    write(base + FAST_CFGR, configuration)
    write(base + FAST_CR, REGULATOR | FAST_ON | START)


def test_the_g474s_start_when_all_is_right_and_only_then():
    chip = fast(stm32g474)
    start_g474(*chip)
    assert chip[0].adc.timer() == 4
    for facts, sentence in (
        (dict(common=2 << 14 | 1 << 13 | 6), "only the clocks of the bus"), (dict(common=3 << 16 | 2 << 14 | 6), "only the simultaneous"),
        (dict(configuration=1 << 31 | 12 << 5), "the master has the trigger"), (dict(configuration=1 << 31 | 5 << 5 | 1 << 10), "EXTSEL 5"),
        (dict(configuration=1 << 31 | 12 << 5 | 1 << 10 | 1 << 13), "besides"), (dict(wait=1e-5), "regulator"), (dict(after=1e-9), "too soon"),
    ):  # fmt: skip
        with pytest.raises(AssertionError, match=sentence):
            start_g474(*fast(stm32g474), **facts)
