"""The H743's ADC1 and ADC2, of revision Y (RM0433, DS12110 Rev 10, ADC characteristics). ADC3, which only converts VREFINT, is
another one of the same, without its second."""
from core.fast_adc import CFGR, FastAdc

BASE, BASE_3 = 0x40022000, 0x58026000
PCSEL = 0x1C
# EXTSEL of ADC1 to ADC3: the timer whose TRGO it is (adc_ext_trg). The others are compare events.
TRIGGERS = {4: 3, 7: 8, 9: 1, 11: 2, 12: 4, 13: 6, 14: 15}
# DS12110 table 9.
CHANNELS = ({10: "PC0", 11: "PC1", 14: "PA2", 15: "PA3", 18: "PA4"},) * 2
# PRESC: what it divides the kernel clock by.
DIVIDERS = dict(enumerate((1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256)))
BOOST, LINEAR, TWELVE_BITS, OVERWRITE, CIRCULAR = 1 << 8, 1 << 16, 0b010 << 2, 1 << 12, 0b11
FASTEST_HZ, BOOST_FROM_HZ = 36e6, 20e6
OFFSET_CYCLES, LINEAR_CYCLES = 1280, 165_010


class H743Adc(FastAdc):
    OWN, SELECT = {PCSEL: 0, CFGR: 1 << 31}, (5, 31)
    # Without the bus's clock.
    INTERNAL, INTERNAL_SECONDS, FULL_SCALE = 19, 4.3e-6, 65535
    LATENCY, SAMPLING, CONVERSION = 3, (1.5, 2.5, 8.5, 16.5, 32.5, 64.5, 387.5, 810.5), 6.5

    def __init__(self, board):
        super().__init__(board, TRIGGERS, CHANNELS)

    def hz(self):
        assert not self.common >> 16 & 3, "only the kernel clock is modelled"
        hz = self.board.clocks.adc_hz() / DIVIDERS[self.common >> 18 & 15]
        assert 0 < hz <= FASTEST_HZ, f"the ADCs run at {hz / 1e6} MHz"
        return hz

    def calibration_cycles(self, control):
        return LINEAR_CYCLES if control & LINEAR else OFFSET_CYCLES

    def is_paired(self):
        """DAMDF = 10, and the master's DMNGT = 11."""
        return self.common >> 14 & 3 == 0b10 and self.registers[0, CFGR] & 3 == CIRCULAR

    def check_mode(self, adc):
        configuration = self.registers[adc, CFGR]
        assert configuration & 0b111 << 2 == TWELVE_BITS, "12 bits"
        assert configuration & OVERWRITE, "the slave's codes may be shifted without OVRMOD (ES0392)"
        assert self.registers[adc, 0x08] & BOOST or self.hz() <= BOOST_FROM_HZ, "more than 20 MHz needs BOOST"
        assert self.registers[adc, PCSEL] >> self.channel(adc) & 1, "the channel is not preselected"
