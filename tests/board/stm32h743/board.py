"""The STM32H743ZI on a NUCLEO-H743ZI2: addresses, interrupts, wiring (RM0433, DS12110 Rev 10)."""
from unicorn.arm_const import UC_CPU_ARM_CORTEX_M7

from core import board, dac, debug, dma_streams, dmamux, pins, registers, timer, watchdog

from . import adc, flash
from .clocks import BASE as RCC
from .clocks import H743Clocks

ITCM, DTCM, AXI, SRAM1 = 0, 0x20000000, 0x24000000, 0x30000000
DMA_IRQS = {1: [11, 12, 13, 14, 15, 16, 17, 47], 2: [56, 57, 58, 59, 60, 68, 69, 70]}
# RM0433 table 140 (vectors), chapters 38 to 43.
TIMERS = {
    1: timer.Facts(0x40010000, (25, 27, 24), bus=2, complementary=3, gated=True), 2: timer.Facts(0x40000000, (28,), 32),
    3: timer.Facts(0x40000400, (29,)), 4: timer.Facts(0x40000800, (30,), masters={0: 1, 1: 2, 2: 3, 3: 8}), 5: timer.Facts(0x40000C00, (50,), 32),
    6: timer.Facts(0x40001000, (54,), channels=0), 7: timer.Facts(0x40001400, (55,), channels=0),
    8: timer.Facts(0x40010400, (44, 46, 43), bus=2, complementary=3, gated=True), 12: timer.Facts(0x40001800, (43,), channels=2),
    15: timer.Facts(0x40014000, (116,), bus=2, channels=2, complementary=1, gated=True),
    16: timer.Facts(0x40014400, (117,), bus=2, channels=1, complementary=1, gated=True),
    17: timer.Facts(0x40014800, (118,), bus=2, channels=1, complementary=1, gated=True),
}  # fmt: skip
# TSEL1 (RM0433 table 218): the timer whose TRGO it is.
DAC_TRIGGERS = {1: 1, 2: 2, 3: 4, 4: 5, 5: 6, 6: 7, 7: 8, 8: 15}
# Inputs of DMAMUX1 (RM0433 table 121).
REQUESTS = {"ADC1": 9, "DAC1": 67, "TIM6_UP": 69, "TIM1_UP": 15, "TIM8_UP": 51}
# DS12110 tables 10 to 20.
ALTERNATES = {
    ("PA13", 0): "SWDIO", ("PA14", 0): "SWCLK", ("PA15", 0): "JTDI", ("PB3", 0): "JTDO", ("PB4", 0): "NJTRST",
    ("PA11", 10): "OTG_FS_DM", ("PA12", 10): "OTG_FS_DP", ("PD14", 2): (4, "IN3"), ("PD15", 2): (4, "4"), ("PE15", 1): (1, "BKIN"), ("PE9", 1): (1, "1"), ("PE11", 1): (1, "2"),
}  # fmt: skip
# RM0433 11.4.1 to 11.4.4.
PORTS = {letter: {pins.MODER: 0xFFFFFFFF} for letter in "CDEFGHIJK"}
PORTS = {
    "A": {pins.MODER: 0xABFFFFFF, pins.OSPEEDR: 0x0C000000, pins.PUPDR: 0x64000000},
    "B": {pins.MODER: 0xFFFFFEBF, pins.OSPEEDR: 0x000000C0, pins.PUPDR: 0x00000100}, **PORTS,
}  # fmt: skip
# DBGMCU's freeze bits (RM0433 60.5.8).
FREEZES = {number: (0x3C, number - 2) for number in range(2, 8)} | {12: (0x3C, 6), debug.WATCHDOG: (0x54, 18)}
FREEZES |= {1: (0x4C, 0), 8: (0x4C, 1), 15: (0x4C, 16), 16: (0x4C, 17), 17: (0x4C, 18)}
REVISION_Y = 0x10036450
# The fix of revision Y's AXI SRAM (ES0392 Rev 8, 2.2.9): AXI_TARG7_FN_MOD.
INTERCONNECT, ISSUING = 0x51008000, 0x108

# RAMECC1: configuration and status of the monitors of the AXI SRAM and of the DTCM's halves (RM0433, RAM ECC monitoring).
RAM_ECC, MONITORS = 0x52009000, (0x20, 0x60, 0x80)

# What pulls pins on the board: the mute pin's resistor (BOARDS.md).
RESISTORS = {"PE9": 0}


class Power(registers.Registers):
    """PWR (RM0433 chapter 6)."""

    CR1, CSR1, CR2, CR3, CPUCR, D3CR = 0x00, 0x04, 0x08, 0x0C, 0x10, 0x18
    DETECTOR, READY, SUPPLY = 1 << 4, 1 << 13, 0b111
    USB_DETECTOR, USB_READY = 1 << 24, 1 << 26

    def __init__(self, clocks):
        self.clocks = clocks
        # 6.8: scale 3; the regulator's lowest bits are written once after power-on.
        values = {self.CR1: 0xF000C000, self.CR2: 0, self.CR3: 0b110, self.CPUCR: 0, self.D3CR: 0x4000}
        super().__init__("PWR", values)

    def reset(self):
        super().reset()
        self.is_supply_chosen = False

    def is_supply_watched(self):
        return bool(self.values[self.CR1] & self.DETECTOR)

    def scale(self):
        return self.values[self.D3CR] >> 14 & 3

    def read(self, offset):
        if offset == self.CSR1:
            return self.READY | self.scale() << 14
        if offset == self.D3CR:
            return self.values[offset] | self.READY
        if offset == self.CR3 and self.values[offset] & self.USB_DETECTOR:
            return self.values[offset] | self.USB_READY
        return super().read(offset)

    def write(self, offset, value):
        if offset == self.CR3:
            # 6.8.4: LDOEN with SCUEN is the board's supply; a second write has no effect on these bits.
            if not self.is_supply_chosen:
                assert value & self.SUPPLY == 0b110, "the core's supply is not the regulator"
            value = value & ~self.SUPPLY | 0b110
            self.is_supply_chosen = True
        super().write(offset, value)
        self.clocks.limits()


class Crs(registers.Registers):
    """CRS (RM0433 chapter 9): what trims HSI48."""

    CR, CFGR = 0x00, 0x04
    ENABLED, AUTOMATIC, SOURCE, OTG_FS = 1 << 5, 1 << 6, 0b11 << 28, 0b00 << 28

    def __init__(self):
        super().__init__("CRS", {self.CR: 0x2000, self.CFGR: 0x2022BB7F})

    def write(self, offset, value):
        assert offset != self.CFGR or not self.values[self.CR] & self.ENABLED, "CRS_CFGR is locked while CEN = 1"
        super().write(offset, value)

    def trims_by_otg_fs(self):
        """Whether HSI48 is exact enough for the USB core on PA11 and PA12."""
        is_on = self.values[self.CR] & (self.ENABLED | self.AUTOMATIC) == self.ENABLED | self.AUTOMATIC
        return is_on and self.values[self.CFGR] & self.SOURCE == self.OTG_FS


class Board(board.Board):
    CPU_MODEL, CORE_HZ = UC_CPU_ARM_CORTEX_M7, 400e6
    # The stack has the lowest 32 KiB of the DTCM (memory/h743zi.x).
    FLASH_START, STACK = flash.START, (DTCM, 1 << 15)
    SYSTEM_MEMORY, UNIQUE_ID = 0x1FF09800, 0x1FF1E800
    INTERNAL_REFERENCE = 0x1FF1E860, 65535, 3.3
    MEMORIES = {ITCM: 1 << 16, flash.START: flash.SIZE, DTCM: 1 << 17, AXI: 1 << 19, 0x1FF00000: 1 << 17}
    RAMS = (ITCM, AXI, DTCM)
    PERIPHERALS = (0x40000000, 0x51000000, 0x52000000, 0x58000000, 0x5C000000, 0xE0000000)
    # CPUID of r1p1; the caches' sizes (CLIDR, CCSIDR: 16 KiB of instructions, 4 ways of 128 sets of 32 bytes).
    CORE_REGISTERS = {0xED00: 0x411FC271, 0xED78: 0x09000003, 0xED80: 0xF01FE019, 0xED84: 0, 0xEF50: 0}
    MPU_REGIONS = 16
    # SYSCFG_CFGR: PVDL, CM7L (RM0433 12.3).
    BREAK_SOURCES = 0x18, 1 << 2, 1 << 6
    USB, USB_IRQ = 0x40080000, 101
    # USART3: one of those by which the ROM bootloader listens (AN2606).
    ROM_IRQ = 39

    def make_peripherals(self):
        self.flash = flash.Flash(self)
        self.clocks = H743Clocks(self)
        self.power = Power(self.clocks)
        self.exti = registers.Exti(mask=0x80, rising=0x00, falling=0x04, waiting=0x88, others=(0x08, 0x84))
        self.system = registers.Registers("SYSCFG", dict.fromkeys((0x04, 0x08, 0x0C, 0x10, 0x14, 0x18, 0x20, 0x2C), 0))
        self.crs = Crs()
        self.interconnect = registers.Registers("AXI interconnect", {ISSUING: 0})
        self.ram_ecc = registers.Registers("RAMECC", {monitor + part: 0 for monitor in MONITORS for part in (0, 4)})
        self.pins = pins.Pins(self, ALTERNATES, PORTS, RESISTORS)
        self.timers |= {number: timer.Timer(self, number, facts) for number, facts in TIMERS.items()}
        # Revision Y has no HFSEL.
        self.dac = dac.DacWithMode(self, 54, DAC_TRIGGERS)
        # DMA1 and DMA2 reach everything on the AXI bus and domain 2's memories, not the DTCM (RM0433 2.1).
        reaches = ((AXI, 1 << 19), (SRAM1, 1 << 17), (flash.START, flash.SIZE))
        bases = {1: 0x40020000, 2: 0x40020400}
        self.dma = {n: dma_streams.Streams(self, base, DMA_IRQS[n], reaches) for n, base in bases.items()}
        self.adc = adc.H743Adc(self)
        self.adc3 = adc.H743Adc(self)
        self.dma[1].settle = self.adc.settle
        self.mux = dmamux.Dmamux()
        self.watchdog = watchdog.Watchdog(self)
        self.debug = debug.Debug(self, REVISION_Y, FREEZES)
        self.others = self.mux, self.system, self.interconnect, self.ram_ecc, self.adc3, self.crs
        self.pages = {each.base: each for each in (*self.timers.values(), *self.dma.values())}
        self.pages |= {0x58020000 + 0x400 * i: port for i, port in enumerate(self.pins.ports.values())}
        self.pages |= {
            RCC: self.clocks, flash.BASE: self.flash, 0x58024800: self.power, 0x58000400: self.system,
            0x58000000: self.exti, 0x40007400: self.dac, adc.BASE: self.adc, adc.BASE_3: self.adc3, 0x58004800: self.watchdog, 0x5C001000: self.debug,
            0x40020800: self.mux, 0x40008400: self.crs, INTERCONNECT: self.interconnect, RAM_ECC: self.ram_ecc,
        }  # fmt: skip

    def serving(self, name):
        """The stream that a request reaches, or None. Streams of both controllers are counted through by the DMAMUX."""
        streams = self.mux.channels(REQUESTS[name])
        return self.dma[streams[0] // 8 + 1].streams[streams[0] % 8] if streams else None

    def request_dma(self, name):
        streams = self.mux.channels(REQUESTS[name])
        assert len(streams) <= 1, "a request reaches several streams"
        for stream in streams:
            dma = self.dma[stream // 8 + 1]
            return self.clocks.is_clocked(dma.base) and dma.request(stream % 8)
        return False
