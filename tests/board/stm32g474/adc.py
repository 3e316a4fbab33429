"""The G474's ADC1 and ADC2 (RM0440 chapter 21, DS12288 Rev 6 table 66)."""
from core.fast_adc import FastAdc

BASE = 0x50000000
# EXTSEL of ADC1 and ADC2: the timer whose TRGO it is (adc_ext_trg). The others are compare events and timers without DAC.
TRIGGERS = {4: 3, 7: 8, 9: 1, 11: 2, 12: 4, 13: 6, 14: 15, 30: 7}
# DS12288 table 12.
CHANNELS = (
    {1: "PA0", 2: "PA1", 3: "PA2", 4: "PA3", 6: "PC0", 7: "PC1", 8: "PC2", 9: "PC3"},
    {1: "PA0", 2: "PA1", 3: "PA6", 4: "PA7", 6: "PC0", 7: "PC1", 8: "PC2", 9: "PC3", 17: "PA4"},
)
CFGR_AFTER_RESET = 1 << 31
DIVIDERS = {0b01: 1, 0b10: 2, 0b11: 4}
# With several ADCs in use, single-ended, VDDA of 2.7 V or more.
FASTEST_HZ, CALIBRATION_CYCLES = 52e6, 116


class G474Adc(FastAdc):
    OWN, SELECT = {0x0C: CFGR_AFTER_RESET}, (5, 31)
    # Of CKMODE = 11.
    INTERNAL, INTERNAL_SECONDS = 18, 4e-6
    LATENCY, SAMPLING, CONVERSION = 2.125, (2.5, 6.5, 12.5, 24.5, 47.5, 92.5, 247.5, 640.5), 12.5

    def __init__(self, board):
        super().__init__(board, TRIGGERS, CHANNELS)

    def hz(self):
        mode = self.common >> 16 & 3
        assert mode in DIVIDERS, "only the clocks of the bus are modelled"
        hz = self.board.clocks.frequencies.ahb / DIVIDERS[mode]
        assert hz <= FASTEST_HZ, f"the ADCs run at {hz / 1e6} MHz"
        return hz

    def calibration_cycles(self, _):
        return CALIBRATION_CYCLES

    def is_paired(self):
        """MDMA = 10 and DMACFG."""
        return self.common >> 14 & 3 == 0b10 and bool(self.common & 1 << 13)

    def check_mode(self, adc):
        other = self.registers[adc, 0x0C] & ~(CFGR_AFTER_RESET | 3 << 10 | 31 << 5)
        assert not other, f"CFGR says {other:#x} besides"
