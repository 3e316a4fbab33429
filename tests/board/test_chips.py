"""What the G474's and the H743's models add to those in `test_models.py`, held against RM0440 and RM0433."""
import pytest

import stm32g474
import stm32h743
from core.clocks import HSEON
from core.uart import SerialHost

G4_RCC, H7_RCC, DAC_G4, DMAMUX, DMA1 = 0x40021000, 0x58024400, 0x50000800, 0x40020800, 0x40020000
PWR_CR5, G4_ACR, TIM6, USART2, GPIOA = 0x40007080, 0x40022000, 0x40001000, 0x40004400, 0x48000000
G4_CR, G4_SR, G4_ECCR, G4_KEYR = 0x40022014, 0x40022010, 0x40022018, 0x40022008
H7_KEYR2, H7_CR2, H7_SR2, CCR = 0x52002104, 0x5200210C, 0x52002110, 0xE000ED14
SLOT, H7_SLOT, RAM = 0x08078000, 0x081C0000, 0x20008000
# DAC_CR: on, TIM6's trigger (7) with its enable, requests. DMA_CCR: circular, from memory, words, whole and half.
DAC_ON, TIM6_TRIGGER, DAC_REQUESTS = 1, 7 << 2 | 1 << 1, 1 << 12
CHANNEL = 1 | 1 << 1 | 1 << 2 | 1 << 4 | 1 << 5 | 1 << 7 | 2 << 8 | 2 << 10


class Chip:
    def __init__(self, package):
        self.board = package.Board()

    def write(self, address, value, size=4):
        self.board.bus_write(address, size, value)

    def read(self, address):
        return self.board.bus_read(address, 4)

    def store(self, address, *words):
        """What the processor stores into the flash."""
        for i, word in enumerate(words):
            self.board.flash.programmed(address + 4 * i, 4, word)
            self.board.cpu.mem_write(address + 4 * i, word.to_bytes(4, "little"))
            self.read(G4_SR if self.board.CORE_HZ == 170e6 else H7_SR2)


@pytest.fixture
def g474():
    chip = Chip(stm32g474)
    for offset, value in ((0x48, 0x107), (0x4C, 1 << 16 | 0x7F), (0x58, 1 << 28 | 1 << 17 | 1 << 4)):
        chip.write(G4_RCC + offset, value)
    return chip


@pytest.fixture
def h743():
    return Chip(stm32h743)


def raise_clock(chip, wait_states=4, divided=2e-6):
    """The tree of the NUCLEO-G474RE's file, with the AHB divided by two for a time after the switch."""
    chip.write(G4_RCC, chip.read(G4_RCC) | HSEON)
    chip.board.run(3e-3)
    chip.write(G4_RCC + 0x0C, 3 | 5 << 4 | 85 << 8 | 1 << 24)
    chip.write(G4_RCC, chip.read(G4_RCC) | 1 << 24)
    chip.board.run(1e-3)
    chip.write(G4_ACR, 0x600 | wait_states)
    if divided:
        chip.write(G4_RCC + 0x08, 3 | 0b1000 << 4)
        chip.board.run(divided)
    chip.write(G4_RCC + 0x08, 3)


def test_170_mhz_need_the_boost_mode(g474):
    with pytest.raises(AssertionError, match="boost"):
        raise_clock(g474)


def test_170_mhz_need_four_wait_states(g474):
    g474.write(PWR_CR5, 0)
    with pytest.raises(AssertionError, match="with 3 wait states"):
        raise_clock(g474, 3)


@pytest.mark.parametrize("divided", [0, 0.9e-6])
def test_170_mhz_need_the_ahb_divided_for_a_microsecond_after_the_switch(g474, divided):
    g474.write(PWR_CR5, 0)
    with pytest.raises(AssertionError, match="us after the switch"):
        raise_clock(g474, divided=divided)


def test_with_boost_mode_and_wait_states_the_timers_run_at_170_mhz(g474):
    g474.write(PWR_CR5, 0)
    raise_clock(g474)
    assert g474.board.clocks.frequencies.timers == {1: 170e6, 2: 170e6}


def play(chip, request=6, trigger=TIM6_TRIGGER):
    """Eight codes in a ring, at 16 MHz / 40 = 400 kHz, for 20 periods."""
    chip.board.cpu.mem_write(RAM, b"".join(code.to_bytes(4, "little") for code in range(100, 108)))
    chip.write(DMAMUX, request)
    for offset, value in ((0x0C, 8), (0x10, DAC_G4 + 8), (0x14, RAM), (0x08, CHANNEL)):
        chip.write(DMA1 + offset, value)
    chip.write(DAC_G4, trigger)
    chip.write(DAC_G4, trigger | DAC_ON | DAC_REQUESTS)
    chip.write(TIM6 + 0x2C, 39)
    chip.write(TIM6 + 0x04, 2 << 4)
    chip.write(TIM6, 1)
    chip.board.run(20.5 / 400_000)
    return chip.board.dac.codes


def test_codes_come_by_the_dmamux_and_the_timers_trigger(g474):
    assert play(g474) == [0, *range(100, 108), *range(100, 108), *range(100, 103)]
    assert g474.read(DMA1) & 0b0111 == 0b0111 and 11 in g474.board.pending


def test_another_request_or_another_trigger_gives_no_codes(g474):
    assert set(play(g474, request=7)) == {0} and g474.board.dac.underruns == 1
    g474.board.reset("pin")
    for offset, value in ((0x48, 0x107), (0x4C, 1 << 16 | 0x7F), (0x58, 1 << 28 | 1 << 17 | 1 << 4)):
        g474.write(G4_RCC + offset, value)
    assert play(g474, trigger=3 << 2 | 1 << 1) == []


def test_the_dac_wants_its_speed_its_trigger_and_its_mode_set_while_it_is_off(g474):
    g474.write(DAC_G4, DAC_ON | TIM6_TRIGGER)
    for address, value in ((DAC_G4, DAC_ON | 3 << 2 | 2), (DAC_G4 + 0x3C, 2 << 14)):
        with pytest.raises(AssertionError, match="while the channel is on"):
            g474.write(address, value)
    g474.write(DAC_G4, TIM6_TRIGGER)
    g474.write(PWR_CR5, 0)
    raise_clock(g474)
    with pytest.raises(AssertionError, match="HFSEL must be 2"):
        g474.write(DAC_G4, DAC_ON | TIM6_TRIGGER)


def unlock(chip, keys, control, value):
    for key in (0x45670123, 0xCDEF89AB):
        chip.write(keys, key)
    chip.write(control, value)


def wait(chip, status):
    while chip.read(status) & 0x10005:
        pass


def test_the_g4s_flash_takes_double_words_once_and_reports_other_writes(g474):
    with pytest.raises(AssertionError, match="locked"):
        g474.store(SLOT, 1)
    unlock(g474, G4_KEYR, G4_CR, 1)
    before = g474.board.seconds
    g474.store(SLOT, 0x11111111, 0x22222222)
    assert g474.board.seconds - before == pytest.approx(100e-6)
    assert g474.board.cpu.mem_read(SLOT, 8) == b"\x11" * 4 + b"\x22" * 4
    g474.store(SLOT, 3, 3)
    wait(g474, G4_SR)
    assert g474.read(G4_SR) & 1 << 3, "PROGERR"
    assert g474.board.cpu.mem_read(SLOT, 8) == b"\x11" * 4 + b"\x22" * 4


def test_erasing_takes_its_time_and_lets_the_rest_run(g474):
    g474.write(0x40003000, 0xCCCC)
    unlock(g474, G4_KEYR, G4_CR, 0)
    g474.board.cpu.mem_write(SLOT, bytes(0x1000))
    before = g474.board.seconds
    # Bank 2's page 112.
    g474.write(G4_CR, 1 << 1 | 112 << 3 | 1 << 11 | 1 << 16)
    with pytest.raises(AssertionError, match="busy"):
        g474.write(G4_CR, 0)
    wait(g474, G4_SR)
    assert g474.board.seconds - before == pytest.approx(24.5e-3)
    assert g474.board.cpu.mem_read(SLOT, 0x1000) == b"\xff" * 0x800 + bytes(0x800), "a page and no more"


def test_a_torn_word_raises_the_g4s_nmi_when_it_is_read(g474):
    unlock(g474, G4_KEYR, G4_CR, 1)
    g474.board.flash.cut_at = g474.board.flash.operations
    g474.store(SLOT, 0x11111111, 0x22222222)
    g474.board.flash.on_read(None, None, SLOT + 8, 4)
    assert not g474.board.nvic.nmi_due, "its neighbour is whole"
    g474.board.flash.on_read(None, None, SLOT + 4, 4)
    assert g474.board.nvic.nmi_due and g474.read(G4_ECCR) & 1 << 31
    g474.write(G4_ECCR, 1 << 31)
    assert not g474.board.is_nmi_held()


def test_a_torn_word_is_a_bus_fault_on_the_h7_unless_faults_are_ignored(h743):
    from unicorn.arm_const import UC_ARM_REG_FAULTMASK

    unlock(h743, H7_KEYR2, H7_CR2, 1 << 1 | 2 << 4)
    h743.board.flash.cut_at = h743.board.flash.operations
    h743.store(H7_SLOT, *range(8))
    h743.board.flash.on_read(None, None, H7_SLOT, 4)
    assert h743.board.bus_error == H7_SLOT and h743.read(H7_SR2) & 1 << 26
    h743.board.bus_error = None
    h743.write(CCR, h743.read(CCR) | 1 << 8)
    h743.board.flash.on_read(None, None, H7_SLOT, 4)
    assert h743.board.bus_error == H7_SLOT, "CCR alone is not enough"
    h743.board.bus_error = None
    h743.board.cpu.reg_write(UC_ARM_REG_FAULTMASK, 1)
    h743.board.flash.on_read(None, None, H7_SLOT, 4)
    assert h743.board.bus_error is None


def test_the_h7s_flash_wants_whole_words_in_order_and_never_twice(h743):
    unlock(h743, H7_KEYR2, H7_CR2, 1 << 1 | 2 << 4)
    h743.store(H7_SLOT, *range(8))
    wait(h743, H7_SR2)
    with pytest.raises(AssertionError, match="twice"):
        h743.store(H7_SLOT, *range(8))
    chip = Chip(stm32h743)
    unlock(chip, H7_KEYR2, H7_CR2, 1 << 1 | 2 << 4)
    chip.store(H7_SLOT, 1)
    assert chip.read(H7_SR2) & 1 << 1, "WBNE"
    with pytest.raises(AssertionError, match="INCERR"):
        chip.store(H7_SLOT + 8, 1)


def test_a_pll_of_the_h7_wants_the_range_of_its_input(h743):
    h743.write(H7_RCC, h743.read(H7_RCC) | HSEON)
    h743.board.run(3e-3)
    # HSE / 1 = 8 MHz, and a range of 1 to 2 MHz.
    h743.write(H7_RCC + 0x28, 2 | 1 << 4)
    h743.write(H7_RCC + 0x2C, 1 << 16)
    with pytest.raises(AssertionError, match="PLL1's input is 8.0 MHz"):
        h743.write(H7_RCC, h743.read(H7_RCC) | 1 << 24)


def test_a_running_pll_keeps_its_divider_and_its_source(h743):
    h743.write(H7_RCC + 0x28, 1 | 1 << 4)
    h743.write(H7_RCC + 0x2C, 1 << 2 | 1 << 16)
    h743.write(H7_RCC + 0x30, 99 | 1 << 9)
    h743.write(H7_RCC, h743.read(H7_RCC) | 1 << 7 | 1 << 24)
    h743.write(H7_RCC + 0x28, 0)
    assert h743.read(H7_RCC + 0x28) == 1 | 1 << 4


def test_the_h7s_dma_does_not_reach_the_cores_own_memory(h743):
    h743.write(H7_RCC + 0xD8, 1)
    for offset, value in ((0x14, 8), (0x18, 0x40007408), (0x1C, 0x20008000)):
        h743.write(DMA1 + offset, value)
    with pytest.raises(AssertionError, match="no way"):
        h743.write(DMA1 + 0x10, 1 | 1 << 6 | 1 << 8 | 1 << 10 | 2 << 11 | 2 << 13)


def serial(chip, baud_divider=17, fifo=1 << 29):
    """USART2 at 16 MHz / 17 = 941 176 baud, 2.1 % above 921 600, or what the divider gives."""
    chip.write(GPIOA + 0x20, 0x7700)
    chip.write(GPIOA, 0xABFFFFFF & ~(0b1111 << 4) | 0b1010 << 4)
    chip.write(USART2 + 0x0C, baud_divider)
    chip.write(USART2, 1 | 1 << 2 | 1 << 3 | fifo)
    return SerialHost(chip.board)


def test_bytes_take_their_time_and_wait_in_the_fifo(g474):
    host = serial(g474)
    host.baud = 941_176
    host.send(b"12345678")
    g474.board.run(8.5 * 10 / host.baud)
    assert g474.read(USART2 + 0x1C) & 0b111000 == 1 << 5, "eight bytes, no overrun, not idle yet"
    assert bytes(g474.read(USART2 + 0x24) for _ in range(8)) == b"12345678"
    g474.board.run(20 / host.baud)
    assert g474.read(USART2 + 0x1C) & 1 << 4, "the line is idle"
    host.send(b"123456789")
    g474.board.run(12 * 10 / host.baud)
    assert g474.read(USART2 + 0x1C) & 1 << 3, "the ninth byte is lost"


def test_a_wrong_baud_rate_gives_noise(g474):
    host = serial(g474)
    host.send(b"A")
    g474.board.run(1e-4)
    assert g474.read(USART2 + 0x1C) & 1 << 1 and g474.read(USART2 + 0x24) != ord("A")


def test_what_is_sent_leaves_in_order_and_complete_says_when(g474):
    host = serial(g474)
    host.baud = 941_176
    for byte in b"abc":
        g474.write(USART2 + 0x28, byte, 1)
    g474.board.run(2.5 * 10 / host.baud)
    assert not g474.read(USART2 + 0x1C) & 1 << 6
    g474.board.run(1 * 10 / host.baud)
    assert g474.read(USART2 + 0x1C) & 1 << 6 and host.receive() == b"abc"


def test_a_pin_that_is_not_given_to_the_usart_carries_nothing(g474):
    host = serial(g474)
    host.baud = 941_176
    g474.write(GPIOA, 0xABFFFFFF & ~(0b1111 << 4))
    host.send(b"A")
    g474.write(USART2 + 0x28, ord("B"), 1)
    g474.board.run(1e-4)
    assert not g474.read(USART2 + 0x1C) & 1 << 5 and host.receive() == b""
