"""The F407's ADC1 and ADC2 in dual regular simultaneous mode (RM0090 chapter 13, DS8626 Rev 12 table 67), and a conversion of
VREFINT by the program before that. ADC3 is not modelled, and no other mode is: to use one is a failure."""
from core.adc import DualAdc

BASE = 0x40012000
SR, CR1, CR2, SMPR1, SMPR2, SQR1, SQR2, SQR3, DR = 0x00, 0x04, 0x08, 0x0C, 0x10, 0x2C, 0x30, 0x34, 0x4C
SECOND, CSR, CCR, CDR = 0x100, 0x300, 0x304, 0x308
ON, CONTINUOUS, OWN_DMA, LEFT, SOFTWARE_START, EDGE, RISING = 1 << 0, 1 << 1, 1 << 8, 1 << 11, 1 << 30, 3 << 28, 1 << 28
SIMULTANEOUS, PAIRS, GOES_ON = 0b00110, 0b10, 1 << 13
OVERRUN = 1 << 5
DIVIDERS, SAMPLING = (2, 4, 6, 8), (3, 15, 28, 56, 84, 112, 144, 480)
LATENCY, CONVERSION, STABLE_SECONDS, FASTEST_HZ = 2, 12, 3e-6, 36e6
# EXTSEL: the timer whose TRGO it is (13.13.3). The others are compare events.
TRIGGERS = {0b0110: 2, 0b1000: 3, 0b1110: 8}
# Channels 0 to 9 are the same pins for both (DS8626 table 7).
CHANNELS = {**{channel: f"PA{channel}" for channel in range(8)}, 8: "PB0", 9: "PB1"}
# VREFINT is ADC1's channel 17, sampled for 10 us or more (DS8626 table 75).
INTERNAL, CONNECTED, END, INTERNAL_SECONDS = 17, 1 << 23, 1 << 1, 10e-6
# ADC2's clock: APB2ENR (RM0090 7.3.14).
APB2ENR, SECOND_CLOCK = 0x44, 1 << 9


class F407Adc(DualAdc):
    def __init__(self, board):
        super().__init__(board, TRIGGERS, (CHANNELS, CHANNELS))

    def reset(self):
        super().reset()
        self.registers = {(adc, register): 0 for adc in (0, SECOND) for register in (CR1, CR2, SMPR1, SMPR2, SQR1, SQR2, SQR3)}
        self.common = 0
        self.stable_at = [0.0, 0.0]
        self.master = None

    def timer(self):
        return self.master

    def requests(self):
        return self.common >> 14 & 3 == PAIRS

    def cycles(self):
        return self.duration

    def start_by_program(self):
        """SWSTART of ADC1: VREFINT alone, in independent mode."""
        control = self.registers[0, CR2]
        assert control & ON and self.stable_at[0] <= self.board.now, "the ADC is not stable yet (tSTAB)"
        assert self.common & CONNECTED and not self.common & 0b11111 and not control & EDGE, "only the simultaneous mode, and VREFINT alone, are modelled"
        assert self.registers[0, SQR3] & 31 == INTERNAL and not self.registers[0, SQR1], "one conversion of VREFINT"
        hz = self.board.clocks.frequencies.apb[2] / DIVIDERS[self.common >> 16 & 3]
        assert hz <= FASTEST_HZ, f"the ADCs run at {hz / 1e6} MHz"
        sampling = SAMPLING[self.registers[0, SMPR1] >> 3 * (INTERNAL - 10) & 7]
        self.convert_internal((sampling, CONVERSION), hz, INTERNAL_SECONDS)

    def prepare(self):
        """Works out what the registers mean; fails if they do not mean the mode that is modelled."""
        self.master = None
        first, second = self.registers[0, CR2], self.registers[SECOND, CR2]
        assert not (first | second) & (CONTINUOUS | OWN_DMA | LEFT | SOFTWARE_START), "this use of the ADCs is not modelled"
        assert not second & EDGE, "the slave has a trigger of its own (RM0090 13.9)"
        if not first & EDGE:
            return
        assert first & EDGE == RISING and self.common & 0b11111 == SIMULTANEOUS, "only the simultaneous mode is modelled"
        assert self.common & GOES_ON or not self.requests(), "without DDS the requests end with the ring's first round"
        assert first & second & ON and max(self.stable_at) <= self.board.now, "an ADC is not stable yet (tSTAB)"
        assert not any(self.registers[adc, register] for adc in (0, SECOND) for register in (CR1, SQR1)), "one channel, 12 bits"
        number = first >> 24 & 15
        assert number in self.triggers, f"EXTSEL {number} is not in the model's table"
        hz = self.board.clocks.frequencies.apb[2] / DIVIDERS[self.common >> 16 & 3]
        assert hz <= FASTEST_HZ, f"the ADCs run at {hz / 1e6} MHz"
        channels = [self.registers[adc, SQR3] & 31 for adc in (0, SECOND)]
        self.check_pins(channels)
        sampling = [SAMPLING[self.registers[adc, SMPR2] >> 3 * channel & 7] for adc, channel in zip((0, SECOND), channels)]
        assert sampling[0] == sampling[1], "both must sample for the same time (RM0090 13.9.2)"
        self.duration = (LATENCY + sampling[0] + CONVERSION) / hz * self.board.CORE_HZ
        self.master = self.triggers[number]

    def read(self, offset):
        self.settle()
        if offset == CSR:
            return (OVERRUN | OVERRUN << 8) if self.is_overrun else 0
        if offset in (CCR, CDR):
            return self.common if offset == CCR else self.data
        if offset in (SR, DR):
            return (END if self.has_internal() else 0) if offset == SR else self.take_internal(4095)
        key = offset & SECOND, offset & 0xFF
        assert key in self.registers, f"the ADCs have no modelled register {offset:#x} that can be read"
        return self.registers[key]

    def write(self, offset, value):
        self.settle()
        adc, register = offset & SECOND, offset & 0xFF
        if offset == CCR:
            if not value >> 14 & 3:
                self.waits = False
            self.common = value
        elif offset in (SR, SECOND):
            # Cleared by 0.
            self.is_overrun &= bool(value & OVERRUN)
        else:
            assert (adc, register) in self.registers, f"the ADCs have no modelled register {offset:#x} that can be written"
            is_clocked = not adc or self.board.clocks.registers[APB2ENR] & SECOND_CLOCK
            assert is_clocked, "a write to ADC2, whose clock is off"
            if register == CR2 and value & ON and not self.registers[adc, CR2] & ON:
                self.stable_at[bool(adc)] = self.board.now + STABLE_SECONDS * self.board.CORE_HZ
            self.registers[adc, register] = value & ~(SOFTWARE_START if register == CR2 else 0)
            if register == CR2 and value & SOFTWARE_START:
                assert not adc, "ADC2 is started by the program"
                self.start_by_program()
        self.prepare()
