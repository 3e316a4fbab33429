"""The STM32G474RE on a NUCLEO-G474RE: addresses, interrupts, wiring (RM0440 Rev 9, DS12288 Rev 6)."""
from unicorn import UC_PROT_EXEC, UC_PROT_READ
from unicorn.arm_const import UC_CPU_ARM_CORTEX_M4

from core import board, dac, debug, dma_channels, dmamux, pins, registers, timer, uart, watchdog

from . import adc, flash
from .clocks import BASE as RCC
from .clocks import G474Clocks

SRAM, SYSTEM_MEMORY = 0x20000000, 0x1FFF0000
DMA_IRQS = {1: [11, 12, 13, 14, 15, 16, 17, 96], 2: [56, 57, 58, 59, 60, 97, 98, 99]}
# RM0440 table 97 (vectors), chapters 28 to 31.
TIMERS = {
    1: timer.Facts(0x40012C00, (25, 27, 24), bus=2, complementary=4, gated=True), 2: timer.Facts(0x40000000, (28,), 32),
    3: timer.Facts(0x40000400, (29,), masters={0: 1, 1: 2, 3: 4}), 4: timer.Facts(0x40000800, (30,)), 5: timer.Facts(0x40000C00, (50,), 32),
    6: timer.Facts(0x40001000, (54,), channels=0), 7: timer.Facts(0x40001400, (55,), channels=0),
    8: timer.Facts(0x40013400, (44, 46, 43), bus=2, complementary=4, gated=True),
    15: timer.Facts(0x40014000, (24,), bus=2, channels=2, complementary=1, gated=True),
    16: timer.Facts(0x40014400, (25,), bus=2, channels=1, complementary=1, gated=True),
    17: timer.Facts(0x40014800, (26,), bus=2, channels=1, complementary=1, gated=True),
}  # fmt: skip
# TSEL1 of DAC1 (RM0440 table 186): the timer whose TRGO it is.
DAC_TRIGGERS = {1: 8, 2: 7, 3: 15, 4: 2, 5: 4, 7: 6, 8: 3}
# Inputs of the DMAMUX (RM0440 table 93).
REQUESTS = {
    "ADC1": 5, "DAC1": 6, "TIM6_UP": 8, "USART2_RX": 26, "USART2_TX": 27, "TIM1_UP": 46, "TIM8_UP": 53, "TIM17_UP": 85,
}  # fmt: skip
# DS12288 table 13.
ALTERNATES = {
    ("PA13", 0): "SWDIO", ("PA14", 0): "SWCLK", ("PA15", 0): "JTDI", ("PB3", 0): "JTDO", ("PB4", 0): "NJTRST",
    ("PA2", 7): "USART2_TX", ("PA3", 7): "USART2_RX", ("PA6", 2): (3, "IN1"), ("PC7", 2): (3, "2"), ("PB5", 3): (8, "3N"), ("PB7", 5): (8, "BKIN"), ("PB5", 10): (17, "1"),
}  # fmt: skip
# RM0440 9.4.1 to 9.4.4.
PORTS = {letter: {pins.MODER: 0xFFFFFFFF} for letter in "CDEFG"}
PORTS = {
    "A": {pins.MODER: 0xABFFFFFF, pins.OSPEEDR: 0x0C000000, pins.PUPDR: 0x64000000},
    "B": {pins.MODER: 0xFFFFFEBF, pins.OSPEEDR: 0x000000C0, pins.PUPDR: 0x00000100}, **PORTS,
}  # fmt: skip
# DBGMCU's freeze bits (RM0440 47.16.4 to 47.16.6).
FREEZES = {number: (0x08, number - 2) for number in range(2, 8)} | {debug.WATCHDOG: (0x08, 12)}
FREEZES |= {1: (0x10, 11), 8: (0x10, 13), 15: (0x10, 16), 16: (0x10, 17), 17: (0x10, 18)}
REVISION_X = 0x20036469


def dac_speed(bus_hz):
    """DAC_MCR.HFSEL by the AHB's clock (RM0440 22.7.16)."""
    return 0b10 if bus_hz > 160e6 else 0b01 if bus_hz > 80e6 else 0b00

# What pulls pins on the board: the mute pin's resistor (BOARDS.md).
RESISTORS = {"PB5": 0}


class Power(registers.Registers):
    """PWR (RM0440 chapter 6)."""

    CR1, CR2, CR3, SR2, CR5 = 0x00, 0x04, 0x08, 0x14, 0x80
    DETECTOR, RANGE, RANGE_1, NORMAL = 1 << 0, 3 << 9, 1 << 9, 1 << 8

    def __init__(self, clocks):
        # 6.4.1 to 6.4.5 and 6.4.21.
        values = {self.CR1: self.RANGE_1, self.CR2: 0, self.CR3: 0x8000, 0x0C: 0, self.SR2: 0, self.CR5: self.NORMAL}
        super().__init__("PWR", values)
        self.clocks = clocks

    def is_supply_watched(self):
        return bool(self.values[self.CR2] & self.DETECTOR)

    def is_range_1(self):
        return self.values[self.CR1] & self.RANGE == self.RANGE_1

    def is_boosted(self):
        return not self.values[self.CR5] & self.NORMAL

    def write(self, offset, value):
        super().write(offset, value)
        self.clocks.limits()


class Board(board.Board):
    CPU_MODEL, CORE_HZ = UC_CPU_ARM_CORTEX_M4, 170e6
    # The stack has the lowest 24 KiB of SRAM1 and SRAM2 (memory/g474re.x). The core-coupled SRAM, which appears behind them
    # as well, is modelled at its own address only.
    FLASH_START, STACK = flash.START, (SRAM, 24 << 10)
    SYSTEM_MEMORY, UNIQUE_ID = SYSTEM_MEMORY, 0x1FFF7590
    INTERNAL_REFERENCE = 0x1FFF75AA, 4095, 3.0
    MEMORIES = {flash.START: flash.SIZE, SRAM: 96 << 10, 0x10000000: 1 << 15, SYSTEM_MEMORY: 1 << 15}
    RAMS, PERIPHERALS = (0x10000000, SRAM), (0x40000000, 0x48000000, 0x50000000, 0xE0000000)
    CORE_REGISTERS, MPU_REGIONS = {0xED00: 0x410FC241}, 8
    UART_IRQ = 38
    # SYSCFG_CFGR2: PVDL, CLL (RM0440 10.2).
    BREAK_SOURCES = 0x1C, 1 << 2, 1 << 0
    # USART3: one of those by which the ROM bootloader listens (AN2606).
    ROM_IRQ = 39

    def make_peripherals(self):
        self.flash = flash.Flash(self)
        # The chip boots from the flash, so address 0 shows it, too (RM0440 2.6).
        self.memories[flash.START].map(0, flash.SIZE, UC_PROT_READ | UC_PROT_EXEC)
        self.clocks = G474Clocks(self)
        self.power = Power(self.clocks)
        others = (0x04, 0x10, 0x20, 0x24, 0x28, 0x2C, 0x30, 0x34)
        self.exti = registers.Exti(mask=0x00, rising=0x08, falling=0x0C, waiting=0x14, others=others)
        self.system = registers.Registers("SYSCFG", dict.fromkeys(range(0x00, 0x2C, 4), 0))
        self.pins = pins.Pins(self, ALTERNATES, PORTS, RESISTORS)
        self.timers |= {number: timer.Timer(self, number, facts) for number, facts in TIMERS.items()}
        self.dac = dac.DacWithMode(self, 54, DAC_TRIGGERS, lambda: self.clocks.frequencies.ahb, dac_speed)
        reaches = ((SRAM, 96 << 10), (0x10000000, 1 << 15), (flash.START, flash.SIZE))
        bases = {1: 0x40020000, 2: 0x40020400}
        self.dma = {n: dma_channels.Channels(self, base, DMA_IRQS[n], reaches) for n, base in bases.items()}
        self.adc = adc.G474Adc(self)
        self.dma[1].settle = self.adc.settle
        self.mux = dmamux.Dmamux()
        functions = {"PA2": "USART2_TX", "PA3": "USART2_RX"}
        self.uart = uart.Uart(self, "USART2", self.UART_IRQ, 1, "PA2", "PA3", functions)
        self.dma[1].on_enabled = self.uart.ask
        self.watchdog = watchdog.Watchdog(self)
        self.debug = debug.Debug(self, REVISION_X, FREEZES)
        self.others = self.mux, self.uart, self.system
        self.pages = {each.base: each for each in (*self.timers.values(), *self.dma.values())}
        self.pages |= {0x48000000 + 0x400 * i: port for i, port in enumerate(self.pins.ports.values())}
        self.pages |= {
            RCC: self.clocks, flash.BASE: self.flash, 0x40007000: self.power, 0x40010000: self.system,
            0x40010400: self.exti, 0x50000800: self.dac, adc.BASE: self.adc, 0x40003000: self.watchdog, 0xE0042000: self.debug,
            0x40020800: self.mux, 0x40004400: self.uart,
        }  # fmt: skip

    def serving(self, name):
        """The channel that a request reaches, or None. Channels of both controllers are counted through by the DMAMUX."""
        channels = self.mux.channels(REQUESTS[name])
        return self.dma[channels[0] // 8 + 1].streams[channels[0] % 8] if channels else None

    def request_dma(self, name):
        if not self.clocks.is_clocked(0x40020800):
            return False
        channels = self.mux.channels(REQUESTS[name])
        assert len(channels) <= 1, "a request reaches several channels"
        for channel in channels:
            dma = self.dma[channel // 8 + 1]
            return self.clocks.is_clocked(dma.base) and dma.request(channel % 8)
        return False
