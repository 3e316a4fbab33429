"""The boards, as far as a test's expectations differ: from firmware/stm32/src/board and the chips' reference manuals."""
import re
from typing import NamedTuple

import pytest

import stm32f407
import stm32g474
import stm32h743
from core.uart import SerialHost
from core.usb import UsbHost

# On all three chips: UART5, whose vector the renderer has, the DAC's underrun, and the time's timer.
RENDERER_IRQ, DAC_IRQ, TIME_IRQ = 53, 54, 50
# An OUT packet of an endpoint that does not exist (`UsbHost.push`).
UNKNOWN_ENDPOINT = 2, 9, b"\0"


class Facts(NamedTuple):
    feature: str
    # What the hello says.
    name: str
    chip: type
    cable: type
    unmute: str
    mute_timer: int
    # The trigger output and input.
    trigger: str
    trigger_input: str
    lamp: str
    button: str
    stop_input: str
    # The watchdog's nominal period, the one around an erasure, and how slow its oscillator may be (nominally 32 kHz).
    watchdog_seconds: float
    erasure_watchdog_seconds: float
    watchdog_slowest_hz: float
    # The interrupts of the DAC's DMA and of the link (those above the renderer, and those that wake the link), and that DMA's controller and stream.
    dma_irq: int
    urgent_link_irqs: tuple
    waking_link_irqs: tuple
    dma: tuple
    # Those of the inputs, and the inputs' pins: the sensor's and the shunt's.
    sense_dma: tuple
    inputs: tuple
    # The ROM bootloader, and the register and value that map it to address 0, or None.
    rom: int
    rom_map: tuple
    # The longest that storing may take: a slot's erasure, and the writing.
    store_seconds: float
    # What is erased and written, each one operation of the flash, to store a table of 33 knots.
    erasures: int
    word_bytes: int
    # The supply detector's threshold: register of PWR, lowest bit of its three, and value; and the brown-out level's bits of
    # the option bytes, as a chip has them when it is delivered and as the board needs them.
    detector: tuple
    delivered: int
    guarded: int
    # A crash's message if the program meets what it does not expect (`break_program`).
    crash: str

    def break_program(self, rig):
        """Makes the program panic."""
        if self.cable is UsbHost:
            # A core that reports an endpoint that does not exist.
            rig.cable.push(*UNKNOWN_ENDPOINT)
        else:
            # An NMI that no torn word of the flash explains (ICSR.NMIPENDSET).
            rig.board.bus_write(0xE000ED04, 4, 1 << 31)


F407 = Facts(
    feature="board-f4discovery", name="STM32F4DISCOVERY", chip=stm32f407.Board, cable=UsbHost, unmute="PB1", mute_timer=1, trigger="PB8", trigger_input="PB7", lamp="PD12", button="PA0", stop_input="PE15",
    watchdog_seconds=0.3, erasure_watchdog_seconds=4.0, watchdog_slowest_hz=17e3,
    dma_irq=16, urgent_link_irqs=(), waking_link_irqs=(67,), dma=(1, 5), sense_dma=(2, 0), inputs=("PA1", "PA2"), rom=0x1FFF0000, rom_map=(0x40013800, 1),
    store_seconds=1.5, erasures=1, word_bytes=4, detector=(0x00, 5, 0b100),
    delivered=0b11 << 2, guarded=0b01 << 2, crash="ep_num",
)  # fmt: skip
G474 = Facts(
    feature="board-nucleo-g474re", name="NUCLEO-G474RE", chip=stm32g474.Board, cable=SerialHost, unmute="PB5", mute_timer=8, trigger="PC7", trigger_input="PA6", lamp="PA5", button="PC13", stop_input="PB7",
    watchdog_seconds=0.3, erasure_watchdog_seconds=2.0, watchdog_slowest_hz=29.5e3,
    dma_irq=11, urgent_link_irqs=(38,), waking_link_irqs=(13, 14), dma=(1, 0), sense_dma=(1, 1), inputs=("PA0", "PA1"), rom=0x1FFF0000, rom_map=(0x40010000, 1),
    store_seconds=0.5, erasures=8, word_bytes=8, detector=(0x04, 1, 0b110), delivered=0, guarded=0b100 << 8,
    crash="NMI",
)  # fmt: skip
H743 = Facts(
    feature="board-nucleo-h743zi2", name="NUCLEO-H743ZI2", chip=stm32h743.Board, cable=UsbHost, unmute="PE9", mute_timer=1, trigger="PD15", trigger_input="PD14", lamp="PB0", button="PC13", stop_input="PE15",
    watchdog_seconds=0.3, erasure_watchdog_seconds=10.0, watchdog_slowest_hz=29.8e3,
    dma_irq=11, urgent_link_irqs=(), waking_link_irqs=(101,), dma=(1, 0), sense_dma=(1, 1), inputs=("PA3", "PC0"), rom=0x1FF09800, rom_map=None,
    store_seconds=4.5, erasures=1, word_bytes=32, detector=(0x00, 5, 0b110),
    delivered=0, guarded=0b11 << 2, crash="ep_num",
)  # fmt: skip
BOARDS = F407, G474, H743


def on_f407(test):
    """For what is said of the F407's image alone."""
    return on(F407)(test)


def on(*boards):
    """For what concerns these boards' images."""
    return pytest.mark.parametrize("facts", boards, ids=name, indirect=True)


def on_usb(test):
    """For the images whose link is a USB core."""
    return on(*(facts for facts in BOARDS if facts.cable is UsbHost))(test)


def on_serial(test):
    """For the images whose link is a serial line."""
    return on(*(facts for facts in BOARDS if facts.cable is SerialHost))(test)


def name(facts):
    """A board's short name, for a test's."""
    return re.sub(r"board-(nucleo-)?", "", facts.feature)
