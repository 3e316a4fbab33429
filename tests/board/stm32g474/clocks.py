"""RCC of the STM32G474 (RM0440 chapter 7), with the limits of DS12288 Rev 6 (table 46) and of RM0440 6.1.5 and 3.3.3."""
from core.clocks import AHB_DIVIDERS, CRYSTAL_SECONDS, HSEON, INTERNAL_SECONDS, PLL_SECONDS, Clocks, Tree

BASE = 0x40021000
CR, ICSCR, CFGR, PLLCFGR, CIER, CIFR, CICR, CCIPR, BDCR, CSR, CRRCR = (
    0x00, 0x04, 0x08, 0x0C, 0x18, 0x1C, 0x20, 0x88, 0x90, 0x94, 0x98,
)  # fmt: skip
AHB1, AHB2, AHB3, APB11, APB12, APB2 = 0x48, 0x4C, 0x50, 0x58, 0x5C, 0x60
RESET_BEFORE_ENABLE = 0x20
# Of CFGR; and how long the AHB must be divided after the switch to what needs the boost mode (RM0440 6.1.5).
SWITCH, DIVIDED_SECONDS = 0b11, 1e-6
HSION, PLLON, PLL_READY = 1 << 8, 1 << 24, 1 << 25
HSI_HZ = 16e6
HSI, HSE, PLL = 1, 2, 3
FAILED = 1 << 8
CLEAR_RESET_FLAGS = 1 << 23


def enables():
    """Enable bits by page (RM0440 7.4.14 to 7.4.19)."""
    pages = {0x40020000: (AHB1, 0), 0x40020400: (AHB1, 1), 0x40020800: (AHB1, 2), 0x40022000: (AHB1, 8)}
    pages |= {0x48000000 + 0x400 * port: (AHB2, port) for port in range(7)} | {0x50000000: (AHB2, 13), 0x50000800: (AHB2, 16)}
    pages |= {0x40000000 + 0x400 * timer: (APB11, timer) for timer in range(6)}
    pages |= {0x40002000: (APB11, 8), 0x40004400: (APB11, 17), 0x40007000: (APB11, 28)}
    pages |= {0x40010000: (APB2, 0), 0x40012C00: (APB2, 11), 0x40013400: (APB2, 13)}
    return pages | {0x40014000: (APB2, 16), 0x40014400: (APB2, 17), 0x40014800: (APB2, 18)}


class G474Clocks(Clocks):
    HSE_HZ = 24e6
    ENABLES = enables()
    RESETS = {page: (register - RESET_BEFORE_ENABLE, bit) for page, (register, bit) in ENABLES.items()}
    OSCILLATORS = {
        HSION: (1 << 10, INTERNAL_SECONDS), HSEON: (1 << 17, CRYSTAL_SECONDS), PLLON: (PLL_READY, PLL_SECONDS),
    }  # fmt: skip

    def reset(self, cause="power"):
        # When the system clock was switched last.
        self.switched_at = 0.0
        super().reset(cause)

    def reset_values(self):
        """RM0440 7.4."""
        zeros = (CIER, CIFR, CICR, CCIPR, 0x9C, BDCR, AHB2, AHB3, APB12, APB2, 0x28, 0x2C, 0x30, 0x38, 0x3C, 0x40)
        values = dict.fromkeys(zeros, 0) | {CR: HSION, CFGR: HSI, PLLCFGR: 0x1000, CRRCR: 0, ICSCR: 0x40000000}
        # The flash's clock is on, and the RTC's interface bit (7.4.14, 7.4.17).
        return values | {AHB1: 0x100, APB11: 0x400}

    def reset_flags(self, cause):
        """RCC_CSR (7.4.28): every reset sets PINRSTF (26); power-on and brown-out set BORRSTF (27), the option bytes' loader OBLRSTF (25)."""
        flags = {"power": 0b11 << 26, "brown-out": 0b11 << 26, "pin": 1 << 26, "software": 0b101 << 26, "options": 0b11 << 25}
        return {CSR: (flags | {"watchdog": 0b1001 << 26})[cause]}

    def read(self, offset):
        if offset == CFGR:
            return self.registers[CFGR] & ~0xC | self.source() << 2
        if offset == CIFR:
            return FAILED if self.is_failed else 0
        if offset in (BDCR, CSR, CRRCR):
            return self.registers[offset] | (self.registers[offset] & 1) << 1
        return super().read(offset)

    def write(self, offset, value):
        if offset == CSR and value & CLEAR_RESET_FLAGS:
            value &= 1
        if offset == CICR:
            if value & FAILED:
                self.is_failed = False
            value = 0
        if offset == CFGR and (value ^ self.registers[CFGR]) & SWITCH:
            self.switched_at = self.board.now
        super().write(offset, value)

    def source(self):
        """What drives the system clock."""
        chosen = self.registers[CFGR] & 3
        assert chosen, "SW = 00 is reserved (RM0440 7.4.3)"
        self.check_source({HSI: HSION, HSE: HSEON, PLL: PLLON}[chosen])
        return chosen

    def pll(self):
        """VCO input, VCO and R output."""
        value = self.registers[PLLCFGR]
        source = {2: HSI_HZ, 3: self.hse_hz()}.get(value & 3, 0.0)
        step = source / ((value >> 4 & 15) + 1)
        vco = step * (value >> 8 & 127)
        return step, vco, vco / (2 * (value >> 25 & 3) + 2) if value & 1 << 24 else 0.0

    def tree(self):
        configuration = self.registers[CFGR]
        core = {HSI: HSI_HZ, HSE: self.hse_hz(), PLL: self.pll()[2]}[self.source()]
        ahb = core / AHB_DIVIDERS.get(configuration >> 4 & 15, 1)
        return Tree(ahb, ahb, *self.buses(ahb, {1: configuration >> 8, 2: configuration >> 11}))

    def limits(self):
        tree, power = self.frequencies, self.board.power
        if self.registers[CR] & PLLON and self.has_crystal:
            step, vco, _ = self.pll()
            assert 2.66e6 <= step <= 16e6, f"the PLL's input is {step / 1e6} MHz"
            assert 96e6 <= vco <= 344e6, f"the PLL's VCO runs at {vco / 1e6} MHz"
        # RM0440 6.1.5 and table 29: what the voltage range lets the core do, at each number of wait states.
        assert power.is_range_1(), "range 2 is not modelled"
        most, each = (170e6, 34e6) if power.is_boosted() else (150e6, 30e6)
        divided = (self.board.now - self.switched_at) / self.board.CORE_HZ
        assert tree.ahb <= 150e6 or divided >= DIVIDED_SECONDS, f"the AHB was divided for {divided * 1e6:.2f} us after the switch"
        assert tree.ahb <= most, f"{tree.ahb / 1e6} MHz needs range 1's boost mode"
        wait_states = self.board.flash.access & 15
        assert tree.ahb <= each * (wait_states + 1), f"{tree.ahb / 1e6} MHz with {wait_states} wait states"

    def check_write(self, offset, old, value):
        is_running = self.registers[CR] & PLLON
        settings = ~(1 << 16 | 1 << 20 | 1 << 24)
        assert offset != PLLCFGR or not is_running or not (value ^ old) & settings, (
            "PLLCFGR is written while the PLL runs (RM0440 7.4.4)"
        )
        if offset == CR and self.registers[CFGR] & 3 == PLL:
            assert value & PLLON or self.is_failed, "the PLL cannot be stopped while it is the system clock"

    def fall_back(self):
        control, configuration = self.registers[CR], self.registers[CFGR]
        control = control & ~HSEON | HSION
        if self.registers[PLLCFGR] & 3 == 3:
            control &= ~PLLON
        uses_crystal = configuration & 3 == HSE or (configuration & 3 == PLL and not control & PLLON)
        return {CR: control, CFGR: configuration & ~3 | HSI if uses_crystal else configuration}
