"""The STM32F407VG on an STM32F4DISCOVERY: addresses, interrupts, wiring (RM0090 Rev 21, DS8626 Rev 12)."""
from unicorn.arm_const import UC_CPU_ARM_CORTEX_M4

from core import board, dac, debug, dma_streams, pins, registers, timer, watchdog

from . import adc, flash, system
from .clocks import BASE as RCC
from .clocks import F407Clocks

CCM, SRAM = 0x10000000, 0x20000000
IRQS = {1: [11, 12, 13, 14, 15, 16, 17, 47], 2: [56, 57, 58, 59, 60, 68, 69, 70]}
# Timers (RM0090 table 1, table 62): TIM1 and TIM8 have three complementary outputs. TIM4's internal triggers: 18.4.3.
TIMERS = {
    1: timer.Facts(0x40010000, (25, 27, 24), bus=2, complementary=3), 2: timer.Facts(0x40000000, (28,), 32),
    3: timer.Facts(0x40000400, (29,)), 4: timer.Facts(0x40000800, (30,), masters={0: 1, 1: 2, 2: 3, 3: 8}), 5: timer.Facts(0x40000C00, (50,), 32),
    6: timer.Facts(0x40001000, (54,), channels=0), 7: timer.Facts(0x40001400, (55,), channels=0),
    8: timer.Facts(0x40010400, (44, 46, 43), bus=2, complementary=3), 12: timer.Facts(0x40001800, (43,), channels=2),
    14: timer.Facts(0x40002000, (45,), channels=1),
}  # fmt: skip
# TSEL1: the timer whose TRGO it is (RM0090 table 76).
DAC_TRIGGERS = {0: 6, 1: 8, 2: 7, 3: 5, 4: 2, 5: 4}
# Who asks for a transfer: controller, stream and channel (RM0090 tables 43 and 44).
DMA_REQUESTS = {"DAC1": (1, 5, 7), "ADC1": (2, 0, 0), "TIM6_UP": (1, 1, 7), "TIM1_UP": (2, 5, 6), "TIM8_UP": (2, 1, 7)}
# What the pins' alternate functions are (DS8626 table 9): those of the debug port, which a reset leaves on, and what
# the firmware may use.
ALTERNATES = {
    ("PA13", 0): "SWDIO", ("PA14", 0): "SWCLK", ("PA15", 0): "JTDI", ("PB3", 0): "JTDO", ("PB4", 0): "NJTRST",
    ("PA11", 10): "OTG_FS_DM", ("PA12", 10): "OTG_FS_DP", ("PB1", 1): (1, "3N"), ("PB1", 2): (3, "4"),
    ("PB1", 3): (8, "3N"), ("PB7", 2): (4, "IN2"), ("PE15", 1): (1, "BKIN"), ("PB8", 2): (4, "3"), ("PE9", 1): (1, "1"), ("PE11", 1): (1, "2"), ("PE13", 1): (1, "3"),
}  # fmt: skip
MODER, OSPEEDR, PUPDR = pins.MODER, pins.OSPEEDR, pins.PUPDR
# The ports' registers after a reset (RM0090 8.4.1 to 8.4.4).
PORTS = {letter: {} for letter in "ABCDEFGHI"} | {
    "A": {MODER: 0xA8000000, OSPEEDR: 0x0C000000, PUPDR: 0x64000000},
    "B": {MODER: 0x00000280, OSPEEDR: 0x000000C0, PUPDR: 0x00000100},
}
# DBGMCU's freeze bits (RM0090 38.16.4, 38.16.5).
FREEZES = {number: (0x08, number - 2) for number in range(2, 8)} | {
    12: (0x08, 6), 14: (0x08, 8), debug.WATCHDOG: (0x08, 12), 1: (0x0C, 0), 8: (0x0C, 1),
}  # fmt: skip
REVISION_Y = 0x100F6413

# What pulls pins on the board: the mute pin's resistor (BOARDS.md).
RESISTORS = {"PB1": 0}


class Power(registers.Registers):
    """PWR (RM0090 chapter 5)."""

    CR, CSR = 0x00, 0x04
    DETECTOR, SCALE_1, SCALE_READY = 1 << 4, 1 << 14, 1 << 14

    def __init__(self):
        super().__init__("PWR", {self.CR: self.SCALE_1, self.CSR: self.SCALE_READY})

    def is_supply_watched(self):
        return bool(self.values[self.CR] & self.DETECTOR)

    def is_scale_1(self):
        return bool(self.values[self.CR] & self.SCALE_1)


class Board(board.Board):
    CPU_MODEL, CORE_HZ = UC_CPU_ARM_CORTEX_M4, 168e6
    FLASH_START, STACK = flash.START, (CCM, 32 << 10)
    SYSTEM_MEMORY, UNIQUE_ID = 0x1FFF0000, 0x1FFF7A10
    INTERNAL_REFERENCE = 0x1FFF7A2A, 4095, 3.3
    MEMORIES = {flash.START: flash.SIZE, CCM: 1 << 16, SRAM: 1 << 17, 0x1FFF0000: 1 << 16}
    RAMS, PERIPHERALS = (CCM, SRAM), (0x40000000, 0x50000000, 0xE0000000)
    CORE_REGISTERS, MPU_REGIONS = {0xED00: 0x410FC241}, 8
    USB, USB_IRQ = 0x50000000, 67
    # USART3: one of those by which the ROM bootloader listens (AN2606).
    ROM_IRQ = 39

    def make_peripherals(self):
        self.flash, self.power = flash.Flash(self), Power()
        self.clocks = F407Clocks(self)
        self.exti = registers.Exti(mask=0x00, rising=0x08, falling=0x0C, waiting=0x14, others=(0x04, 0x10))
        self.system = system.SystemConfiguration(self)
        self.pins = pins.Pins(self, ALTERNATES, PORTS, RESISTORS)
        self.timers |= {number: timer.Timer(self, number, facts) for number, facts in TIMERS.items()}
        self.dac = dac.Dac(self, 54, DAC_TRIGGERS)
        # Only the bus matrix's DMA ports count: the core-coupled RAM is the core's alone (RM0090 2.1).
        reaches = ((SRAM, 1 << 17), (flash.START, flash.SIZE))
        self.dma = {1: dma_streams.Streams(self, 0x40026000, IRQS[1], reaches), 2: dma_streams.Streams(self, 0x40026400, IRQS[2], reaches)}
        self.adc = adc.F407Adc(self)
        self.dma[1].settle, self.dma[2].settle = self.dac.settle, self.adc.settle
        self.watchdog = watchdog.Watchdog(self)
        self.debug = debug.Debug(self, REVISION_Y, FREEZES)
        self.pages = {each.base: each for each in (*self.timers.values(), *self.dma.values())}
        self.pages |= {0x40020000 + 0x400 * i: port for i, port in enumerate(self.pins.ports.values())}
        self.pages |= {
            RCC: self.clocks, flash.BASE: self.flash, 0x40007000: self.power, 0x40013800: self.system,
            0x40013C00: self.exti, 0x40007400: self.dac, adc.BASE: self.adc, 0x40003000: self.watchdog, 0xE0042000: self.debug,
        }  # fmt: skip

    def reset(self, cause):
        self.system.reset()
        super().reset(cause)

    def request_dma(self, name):
        controller, stream, channel = DMA_REQUESTS[name]
        return self.dma[controller].request(stream, channel)

    def serving(self, name):
        controller, stream, _ = DMA_REQUESTS[name]
        return self.dma[controller].streams[stream]
