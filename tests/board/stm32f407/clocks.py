"""RCC of the STM32F407 (RM0090 chapter 7), with the limits of DS8626 Rev 12 (tables 14 and 36) and of RM0090 table 10."""
from core.clocks import AHB_DIVIDERS, CRYSTAL_SECONDS, CSSON, HSEON, INTERNAL_SECONDS, PLL_SECONDS, Clocks, Tree

BASE = 0x40023800
CR, PLLCFGR, CFGR, CIR, BDCR, CSR = 0x00, 0x04, 0x08, 0x0C, 0x70, 0x74
# Of larger F4s; embassy-stm32 clears bits in it on all of them. Here it is reserved: 0, and what is written has no effect.
DCKCFGR = 0x8C
HSION, PLLON, PLLI2SON, PLL_READY = 1 << 0, 1 << 24, 1 << 26, 1 << 25
HSI_HZ = 16e6
FAILED, CLEAR_FAILED = 1 << 7, 1 << 23
PLL_FROM_HSE = 1 << 22
HSI, HSE, PLL = range(3)
AHB1, AHB2, APB1, APB2 = 0x30, 0x34, 0x40, 0x44
# Offset of a reset register from its enable register.
RESET_BEFORE_ENABLE = 0x20
CLEAR_RESET_FLAGS = 1 << 24


def enables():
    """Enable bits by page (RM0090 7.3.10 to 7.3.14)."""
    pages = {0x40020000 + 0x400 * port: (AHB1, port) for port in range(9)}
    pages |= {0x40026000: (AHB1, 21), 0x40026400: (AHB1, 22), 0x50000000: (AHB2, 7)}
    pages |= {0x40000000 + 0x400 * timer: (APB1, timer) for timer in range(6)}
    pages |= {0x40001800: (APB1, 6), 0x40001C00: (APB1, 7), 0x40002000: (APB1, 8)}
    pages |= {0x40007000: (APB1, 28), 0x40007400: (APB1, 29)}
    return pages | {0x40010000: (APB2, 0), 0x40010400: (APB2, 1), 0x40013800: (APB2, 14), 0x40012000: (APB2, 8)}


class F407Clocks(Clocks):
    HSE_HZ = 8e6
    ENABLES = enables()
    RESETS = {page: (register - RESET_BEFORE_ENABLE, bit) for page, (register, bit) in ENABLES.items()}
    OSCILLATORS = {
        HSION: (1 << 1, INTERNAL_SECONDS), HSEON: (1 << 17, CRYSTAL_SECONDS), PLLON: (PLL_READY, PLL_SECONDS),
        PLLI2SON: (1 << 27, PLL_SECONDS),
    }  # fmt: skip

    def reset_values(self):
        """RM0090 7.3."""
        zeros = (CFGR, CIR, AHB2, 0x38, APB1, APB2, BDCR, CSR, 0x10, 0x14, 0x18, 0x20, 0x24, DCKCFGR)
        return dict.fromkeys(zeros, 0) | {CR: 0x83, PLLCFGR: 0x24003010, AHB1: 0x00100000, 0x84: 0x20003000}

    def reset_flags(self, cause):
        """RCC_CSR (7.3.21): every reset sets PINRSTF (bit 26) too; power-on sets BORRSTF (25) and PORRSTF (27)."""
        causes = {"power": 0b111 << 25, "brown-out": 0b11 << 25, "pin": 1 << 26}
        return {CSR: (causes | {"software": 0b101 << 26, "watchdog": 0b1001 << 26})[cause]}

    def read(self, offset):
        if offset == CFGR:
            value = self.registers[CFGR]
            return value & ~0xC | self.source() << 2
        if offset == CIR:
            return self.registers[CIR] & 0x7F00 | (FAILED if self.is_failed else 0)
        if offset in (BDCR, CSR):
            return self.registers[offset] | (self.registers[offset] & 1) << 1
        return super().read(offset)

    def write(self, offset, value):
        if offset == CSR and value & CLEAR_RESET_FLAGS:
            value &= 1
        if offset == CIR and value & CLEAR_FAILED:
            self.is_failed = False
        super().write(offset, value)

    def source(self):
        """What drives the system clock."""
        chosen = self.registers[CFGR] & 3
        self.check_source((HSION, HSEON, PLLON)[chosen])
        return chosen

    def pll(self):
        """VCO input, VCO, P and Q output."""
        value = self.registers[PLLCFGR]
        source = self.hse_hz() if value & PLL_FROM_HSE else HSI_HZ
        step = source / (value & 63)
        vco = step * (value >> 6 & 511)
        return step, vco, vco / (2 * (value >> 16 & 3) + 2), vco / (value >> 24 & 15)

    def tree(self):
        configuration = self.registers[CFGR]
        pll = self.pll()
        core = (HSI_HZ, self.hse_hz(), pll[2])[self.source()]
        ahb = core / AHB_DIVIDERS.get(configuration >> 4 & 15, 1)
        apb, timers = self.buses(ahb, {1: configuration >> 10, 2: configuration >> 13})
        usb = pll[3] if self.registers[CR] & PLLON else 0.0
        return Tree(ahb, ahb, apb, timers, usb)

    def limits(self):
        tree = self.frequencies
        if self.registers[CR] & PLLON and self.has_crystal:
            step, vco, _, usb = self.pll()
            assert 0.95e6 <= step <= 2.1e6, f"the PLL's input is {step / 1e6} MHz"
            assert 100e6 <= vco <= 432e6, f"the PLL's VCO runs at {vco / 1e6} MHz"
            assert usb <= 48.12e6, f"the PLL's Q output has {usb / 1e6} MHz"
        assert tree.ahb <= 168e6 and tree.apb[1] <= 42e6 and tree.apb[2] <= 84e6, tree
        assert tree.ahb <= 144e6 or self.board.power.is_scale_1(), "more than 144 MHz needs voltage scale 1"
        wait_states = self.board.flash.access & 15
        assert tree.ahb <= 30e6 * (wait_states + 1), f"{tree.ahb / 1e6} MHz with {wait_states} wait states"
        if self.is_clocked(0x50000000) and self.has_crystal:
            assert abs(tree.usb - 48e6) <= 0.0025 * 48e6, f"USB has {tree.usb / 1e6} MHz"

    def check_write(self, offset, old, value):
        is_locked = self.registers[CR] & PLLON
        assert offset != PLLCFGR or not is_locked or value == old, "PLLCFGR is written while the PLL runs (RM0090 7.3.2)"
        if offset == CR and self.registers[CFGR] & 3 == PLL:
            assert value & PLLON or self.is_failed, "the PLL cannot be stopped while it is the system clock"

    def fall_back(self):
        control, configuration = self.registers[CR], self.registers[CFGR]
        control = control & ~HSEON | HSION
        if self.registers[PLLCFGR] & PLL_FROM_HSE:
            control &= ~PLLON
        uses_crystal = configuration & 3 == HSE or (configuration & 3 == PLL and not control & PLLON)
        return {CR: control, CFGR: configuration & ~3 if uses_crystal else configuration}
