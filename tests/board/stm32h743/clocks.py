"""RCC of the STM32H743 (RM0433 chapter 8), with the limits of DS12110 Rev 10 (general operating conditions, PLL
characteristics) and of RM0433 table 17 (wait states)."""
from core.clocks import AHB_DIVIDERS, CRYSTAL_SECONDS, HSEON, INTERNAL_SECONDS, PLL_SECONDS, Clocks, Tree

BASE = 0x58024400
CR, ICSCR, CRRCR, CFGR, D1CFGR, D2CFGR, D3CFGR, PLLCKSELR, PLLCFGR = 0x00, 0x04, 0x08, 0x10, 0x18, 0x1C, 0x20, 0x28, 0x2C
# Dividers and fractions of the three PLLs.
DIVIDERS, FRACTIONS = (0x30, 0x38, 0x40), (0x34, 0x3C, 0x44)
D1CCIPR, D2CCIP1R, D2CCIP2R, D3CCIPR, CIER, CIFR, CICR, BDCR, CSR, RSR = (
    0x4C, 0x50, 0x54, 0x58, 0x60, 0x64, 0x68, 0x70, 0x74, 0xD0,
)  # fmt: skip
AHB3, AHB1, AHB2, AHB4, APB3, APB1L, APB1H, APB2, APB4 = range(0xD4, 0xF8, 4)
AHB1LPENR = 0x100
RESETS = dict(zip((AHB3, AHB1, AHB2, AHB4, APB3, APB1L, APB1H, APB2, APB4), range(0x7C, 0xA0, 4)))
HSION, CSION, HSI48ON = 1 << 0, 1 << 7, 1 << 12
PLLONS = (1 << 24, 1 << 26, 1 << 28)
HSI_HZ, CSI_HZ, HSI48_HZ = 64e6, 4e6, 48e6
HSI, CSI, HSE, PLL1 = range(4)
FAILED, CLEAR_RESET_FLAGS = 1 << 10, 1 << 16
# VOS of PWR_D3CR: the most of the core, of AHB and of APB.
SCALES = {0b11: (400e6, 200e6, 100e6), 0b10: (300e6, 150e6, 75e6), 0b01: (200e6, 100e6, 50e6)}
# The most of the AXI bus by (LATENCY, WRHIGHFREQ) at scale 1 (RM0433 table 17).
WAIT_STATES = {(0, 0): 70e6, (1, 1): 140e6, (2, 1): 185e6, (2, 2): 210e6, (3, 2): 225e6}
# VCO input by PLLxRGE.
INPUTS = ((1e6, 2e6), (2e6, 4e6), (4e6, 8e6), (8e6, 16e6))


def enables():
    """Enable bits by page (RM0433 8.7.38 to 8.7.46). The DMAMUX has the DMAs' clock."""
    pages = {0x40020000: (AHB1, 0), 0x40020400: (AHB1, 1), 0x40020800: (AHB1, 0), 0x40080000: (AHB1, 27)}
    pages |= {0x58020000 + 0x400 * port: (AHB4, port) for port in range(11)}
    pages |= {0x40000000 + 0x400 * timer: (APB1L, timer) for timer in range(9)}
    pages |= {0x40007400: (APB1L, 29), 0x40008400: (APB1H, 1), 0x58000400: (APB4, 1)}
    pages |= {0x40010000: (APB2, 0), 0x40010400: (APB2, 1), 0x40022000: (AHB1, 5), 0x58026000: (AHB4, 24)}
    return pages | {0x40014000: (APB2, 16), 0x40014400: (APB2, 17), 0x40014800: (APB2, 18)}


class H743Clocks(Clocks):
    HSE_HZ = 8e6
    ENABLES = enables()
    RESETS = {page: (RESETS[register], bit) for page, (register, bit) in ENABLES.items() if page != 0x40020800}
    # What feeds OSC_IN is the ST-LINK's clock: ready as soon as it runs.
    OSCILLATORS = {
        HSION: (1 << 2, INTERNAL_SECONDS), CSION: (1 << 8, INTERNAL_SECONDS), HSI48ON: (1 << 13, INTERNAL_SECONDS),
        HSEON: (1 << 17, CRYSTAL_SECONDS), **{on: (on << 1, PLL_SECONDS) for on in PLLONS},
    }  # fmt: skip

    def reset(self, cause="power"):
        # Bits 25 to 28 of AHB1ENR. The ROM's DFU appears only if they were clear (ST's forum, thread 148198).
        self.was_usb_on_at_reset = cause != "power" and bool(self.registers[AHB1] >> 25 & 0b1111)
        super().reset(cause)

    def reset_values(self):
        """RM0433 8.7."""
        zeros = (CFGR, D1CFGR, D2CFGR, D3CFGR, D1CCIPR, D2CCIP1R, D2CCIP2R, D3CCIPR, CIER, CIFR, CICR, BDCR, CSR, CRRCR)
        values = dict.fromkeys((*zeros, *FRACTIONS, *range(0x7C, 0xA0, 4), *range(0xD4, 0xF8, 4)), 0)
        values |= {CR: HSION, PLLCKSELR: 0x02020200, PLLCFGR: 0x01FF0000, ICSCR: 0x40000000}
        # Which clocks go on while the core sleeps: kept, not modelled; those of the firmware's peripherals do.
        return values | dict.fromkeys(DIVIDERS, 0x01010280) | {AHB1LPENR: 0x1E03C023}

    def reset_flags(self, cause):
        """RCC_RSR (8.7.36): PINRSTF (22), BORRSTF (21), PORRSTF (23), SFTRSTF (24), IWDG1RSTF (26), CPURSTF (17)."""
        flags = {"power": 0b1111 << 20 | 0b101 << 17, "brown-out": 0b11 << 21, "pin": 1 << 22}
        return {RSR: (flags | {"software": 0b101 << 22 | 1 << 17, "watchdog": 0b10001 << 22})[cause]}

    def read(self, offset):
        if offset == CR:
            # The divider is in force at once; both domains have their clock.
            return super().read(CR) | 1 << 5 | 0b11 << 14
        if offset == CFGR:
            return self.registers[CFGR] & ~0b111000 | self.source() << 3
        if offset == CIFR:
            return FAILED if self.is_failed else 0
        if offset in (BDCR, CSR):
            return self.registers[offset] | (self.registers[offset] & 1) << 1
        return super().read(offset)

    def write(self, offset, value):
        if offset == PLLCKSELR:
            kept = self.kept_selection()
            value = self.registers[offset] & kept | value & ~kept
        if offset == RSR and value & CLEAR_RESET_FLAGS:
            value = 0
        if offset == CICR:
            if value & FAILED:
                self.is_failed = False
            value = 0
        super().write(offset, value)

    def source(self):
        """What drives the system clock."""
        chosen = self.registers[CFGR] & 7
        self.check_source({HSI: HSION, CSI: CSION, HSE: HSEON, PLL1: PLLONS[0]}[chosen])
        return chosen

    def hsi_hz(self):
        return HSI_HZ / (1 << (self.registers[CR] >> 3 & 3))

    def pll(self, number):
        """VCO input, VCO, and the outputs P, Q, R (0 while they are off) of PLL 1 to 3."""
        selection, configuration = self.registers[PLLCKSELR], self.registers[PLLCFGR]
        dividers = self.registers[DIVIDERS[number - 1]]
        source = (self.hsi_hz(), CSI_HZ, self.hse_hz(), 0.0)[selection & 3]
        divider = selection >> 4 + 8 * (number - 1) & 63
        step = source / divider if divider else 0.0
        has_fraction = configuration >> 4 * (number - 1) & 1
        fraction = (self.registers[FRACTIONS[number - 1]] >> 3) / 8192 if has_fraction else 0.0
        vco = step * ((dividers & 511) + 1 + fraction)
        outputs = [
            vco / ((dividers >> shift & 127) + 1) if configuration >> 16 + 3 * (number - 1) + i & 1 else 0.0
            for i, shift in enumerate((9, 16, 24))
        ]
        return step, vco, outputs

    def tree(self):
        domain1 = self.registers[D1CFGR]
        source = {HSI: self.hsi_hz(), CSI: CSI_HZ, HSE: self.hse_hz(), PLL1: self.pll(1)[2][0]}[self.source()]
        core = source / AHB_DIVIDERS.get(domain1 >> 8 & 15, 1)
        ahb = core / AHB_DIVIDERS.get(domain1 & 15, 1)
        fields = {1: D2CFGR, 2: D2CFGR, 3: D1CFGR, 4: D3CFGR}
        shifts = {1: 4, 2: 8, 3: 4, 4: 4}
        apb, timers = self.buses(ahb, {bus: self.registers[register] >> shifts[bus] for bus, register in fields.items()})
        if self.registers[CFGR] >> 15 & 1:
            # TIMPRE (RM0433 8.7.6): AHB's clock up to a divider of 4, else four times the bus's.
            timers = {bus: min(ahb, 4 * hz) for bus, hz in apb.items()}
        usb = (0.0, self.pll(1)[2][1], self.pll(3)[2][1], HSI48_HZ)[self.registers[D2CCIP2R] >> 20 & 3]
        return Tree(core, ahb, apb, timers, usb)

    def adc_hz(self):
        """What the ADCs get (D3CCIPR.ADCSEL); the clock of the peripherals is not modelled."""
        return (self.pll(2)[2][0], self.pll(3)[2][2])[self.registers[D3CCIPR] >> 16 & 3]

    def limits(self):
        tree = self.frequencies
        # What counts the clock from outside stands still without it.
        is_fed = self.has_crystal or self.registers[PLLCKSELR] & 3 != HSE
        for number, on in enumerate(PLLONS, 1):
            if self.registers[CR] & on and is_fed:
                self.pll_limits(number)
        core, ahb, apb = SCALES[self.board.power.scale()]
        # The internal oscillator undivided is how the chip starts, at scale 3.
        is_start = self.source() == HSI
        assert is_start or (tree.core <= core and tree.ahb <= ahb and max(tree.apb.values()) <= apb), tree
        access = self.board.flash.access
        most = WAIT_STATES.get((access & 15, access >> 4 & 3), 225e6 if access & 15 > 3 else 0)
        assert tree.ahb <= most, f"the flash's bus has {tree.ahb / 1e6} MHz, FLASH_ACR is {access:#x}"
        if self.is_clocked(0x40080000) and is_fed:
            assert abs(tree.usb - 48e6) <= 0.0025 * 48e6, f"USB has {tree.usb / 1e6} MHz"

    def pll_limits(self, number):
        """DS12110, PLL characteristics: wide and medium VCO range."""
        step, vco, _ = self.pll(number)
        configuration = self.registers[PLLCFGR] >> 4 * (number - 1)
        low, high = INPUTS[configuration >> 2 & 3]
        assert low <= step <= high, f"PLL{number}'s input is {step / 1e6} MHz, PLL{number}RGE is {configuration >> 2 & 3}"
        is_medium = configuration >> 1 & 1
        assert not is_medium or step <= 2e6, f"PLL{number}'s medium range is for inputs of 1 to 2 MHz"
        low, high = (150e6, 420e6) if is_medium else (192e6, 836e6)
        assert low <= vco <= high, f"PLL{number}'s VCO runs at {vco / 1e6} MHz"

    def running(self):
        """The numbers of the PLLs that are on."""
        return [number for number, on in enumerate(PLLONS, 1) if self.registers[CR] & on]

    def kept_selection(self):
        """The bits of PLLCKSELR that the chip itself keeps (RM0433 8.7.12): a running PLL's divider and the PLLs' source.

        embassy-stm32 0.6 relies on it: where it switches an unused PLL off it writes zeros over the others'."""
        return sum(63 << 4 + 8 * (number - 1) for number in self.running()) | (3 if self.running() else 0)

    def check_write(self, offset, old, value):
        for number in self.running():
            is_divider = offset == DIVIDERS[number - 1]
            assert not is_divider or old == value, f"the dividers are written while PLL{number} runs (RM0433 8.7.14)"
        if offset == CR and self.registers[CFGR] & 7 == PLL1:
            assert value & PLLONS[0] or self.is_failed, "the PLL cannot be stopped while it is the system clock"

    def fall_back(self):
        control, configuration = self.registers[CR], self.registers[CFGR]
        control = control & ~HSEON | HSION
        if self.registers[PLLCKSELR] & 3 == HSE:
            control &= ~sum(PLLONS)
        chosen = configuration & 7
        uses_crystal = chosen == HSE or (chosen == PLL1 and not control & PLLONS[0])
        return {CR: control, CFGR: configuration & ~7 if uses_crystal else configuration}
