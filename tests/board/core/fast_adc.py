"""The fast ADCs of G4 and H7 in dual regular simultaneous mode (RM0440 chapter 21, RM0433's ADC chapter). No other mode is
modelled: to use one is a failure, and so is an order of writes that the manuals forbid.
"""
from core.adc import DualAdc

ISR, CR, CFGR, SMPR1, SMPR2, SQR1, DR, CSR, CCR, CDR = 0x00, 0x08, 0x0C, 0x14, 0x18, 0x30, 0x40, 0x300, 0x308, 0x30C
CONNECTED = 1 << 22
SECOND = 0x100
READY, EOC, EOS, OVERRUN = 1 << 0, 1 << 2, 1 << 3, 1 << 4
ON, START, STOP, REGULATOR, ASLEEP, CALIBRATE = 1 << 0, 1 << 2, 1 << 4, 1 << 28, 1 << 29, 1 << 31
EDGE, RISING, SIMULTANEOUS = 3 << 10, 1 << 10, 0b00110
# How long the regulator takes at most (DS12288 table 66; DS12110 has 10 us), and what follows the calibration.
REGULATOR_SECONDS, READY_SECONDS, CYCLES_AFTER_CALIBRATION = 20e-6, 1e-6, 4


class FastAdc(DualAdc):
    # What a chip has besides: registers and their values after a reset; EXTSEL's place in CFGR; cycles of the ADC of the
    # latency, the sampling times and the conversion.
    OWN, SELECT, LATENCY, SAMPLING, CONVERSION = {}, (0, 0), 0, (), 0
    # The channel of VREFINT, how long it is to be sampled, and the full scale of its codes.
    INTERNAL, INTERNAL_SECONDS, FULL_SCALE = None, 0.0, 4095

    def reset(self):
        super().reset()
        registers = {CR: ASLEEP, CFGR: 0, SMPR1: 0, SMPR2: 0, SQR1: 0} | self.OWN
        self.registers = {(adc, register): value for adc in (0, SECOND) for register, value in registers.items()}
        self.common = 0
        # When the regulator is up, the calibration over, and the ADC ready.
        self.times = {(adc, what): None for adc in (0, SECOND) for what in (REGULATOR, CALIBRATE, ON)}
        self.master = None

    # --- a chip's own

    def hz(self):
        """The ADCs' clock; fails if it is beyond the data sheet's limit."""
        raise NotImplementedError

    def calibration_cycles(self, control):
        raise NotImplementedError

    def is_paired(self):
        """Whether both codes come as one word, and the requests go on when the DMA begins its ring again."""
        raise NotImplementedError

    def check_mode(self, adc):
        """Fails for what the chip's own registers must not say."""

    # --- conversions

    def timer(self):
        return self.master

    def cycles(self):
        return self.duration

    def requests(self):
        return self.is_paired()

    def start_by_program(self):
        """One conversion of VREFINT by the first of the ADCs, in independent mode."""
        assert self.common & CONNECTED and not self.registers[0, CFGR] & EDGE, "only the simultaneous mode, and VREFINT alone, are modelled"
        assert self.is_ready(0), "an ADC is started before it is ready"
        assert self.channel(0) == self.INTERNAL and self.registers[0, SQR1] & 0b1111 == 0, "one conversion of VREFINT"
        sampling = self.SAMPLING[self.registers[0, SMPR2] >> 3 * (self.INTERNAL - 10) & 7]
        self.convert_internal((sampling, self.CONVERSION), self.hz(), self.INTERNAL_SECONDS)

    def start(self):
        """Both wait for the trigger."""
        assert self.common & 0b11111 == SIMULTANEOUS and self.is_paired(), "only the simultaneous mode is modelled"
        assert self.registers[0, CFGR] & EDGE == RISING and not self.registers[SECOND, CFGR] & EDGE, "the master has the trigger"
        samplings = []
        for adc in (0, SECOND):
            assert self.is_ready(adc), "an ADC is started before it is ready"
            assert self.registers[adc, SQR1] & 0b1111 == 0, "one conversion each"
            self.check_mode(adc)
            channel = self.channel(adc)
            register = self.registers[adc, SMPR1 if channel < 10 else SMPR2]
            samplings.append(self.SAMPLING[register >> 3 * (channel % 10) & 7])
        self.check_pins([self.channel(0), self.channel(SECOND)])
        assert samplings[0] == samplings[1], "both must sample for the same time"
        self.duration = (self.LATENCY + samplings[0] + self.CONVERSION) / self.hz() * self.board.CORE_HZ
        shift, mask = self.SELECT
        number = self.registers[0, CFGR] >> shift & mask
        assert number in self.triggers, f"EXTSEL {number} is not in the model's table"
        self.master = self.triggers[number]

    def channel(self, adc):
        return self.registers[adc, SQR1] >> 6 & 31

    def is_over(self, adc, what):
        """Whether what takes its time has begun, and is over."""
        end = self.times[adc, what]
        return end is not None and end <= self.board.now

    def is_ready(self, adc):
        return bool(self.registers[adc, CR] & ON) and self.is_over(adc, ON)

    def begin(self, adc, what, seconds):
        self.times[adc, what] = self.board.now + seconds * self.board.CORE_HZ

    # --- registers

    def read(self, offset):
        self.settle()
        adc, register = offset & SECOND, offset & 0xFF
        if offset == CSR:
            return (OVERRUN | OVERRUN << 16) if self.is_overrun else 0
        if offset == CCR:
            return self.common
        if offset == CDR:
            self.waits = False
            return self.data
        if register == ISR:
            end = EOC if not adc and self.has_internal() else 0
            return (READY if self.is_ready(adc) else 0) | (OVERRUN if self.is_overrun else 0) | end
        if offset == DR:
            return self.take_internal(self.FULL_SCALE)
        assert (adc, register) in self.registers, f"the ADCs have no modelled register {offset:#x} that can be read"
        if register == CR and self.registers[adc, CR] & CALIBRATE:
            self.wait_for_calibration(adc)
        return self.registers[adc, register]

    def wait_for_calibration(self, adc):
        """The program looks for the end of the calibration and does nothing else: the time passes at once."""
        self.board.stall(max(0.0, self.times[adc, CALIBRATE] - self.board.now) / self.board.CORE_HZ)
        self.registers[adc, CR] &= ~CALIBRATE

    def write(self, offset, value):
        self.settle()
        adc, register = offset & SECOND, offset & 0xFF
        if offset == CCR:
            assert not any(self.registers[each, CR] & ON for each in (0, SECOND)), "CCR is written while an ADC is on"
            self.common = value
        elif register == ISR and offset < CSR:
            if value & OVERRUN:
                self.is_overrun = False
            if value & (EOC | OVERRUN):
                self.waits = False
        elif register == CR and offset < CSR:
            self.control(adc, value)
        else:
            assert (adc, register) in self.registers, f"the ADCs have no modelled register {offset:#x} that can be written"
            assert self.is_over(adc, REGULATOR) or register == CFGR, "an ADC is set up while its regulator is off"
            assert self.master is None, "an ADC is set up while it waits for triggers"
            self.registers[adc, register] = value

    def control(self, adc, value):
        """CR: its bits are set by the program and cleared by the ADC."""
        was = self.registers[adc, CR]
        asked = value & ~was
        if asked & REGULATOR:
            assert not value & ASLEEP, "the regulator is started in deep power-down"
            self.begin(adc, REGULATOR, REGULATOR_SECONDS)
        else:
            is_settable = self.is_over(adc, REGULATOR) or value & ~ASLEEP == was & ~ASLEEP
            assert is_settable, "an ADC is used before its regulator is up"
        if asked & CALIBRATE:
            assert not value & ON, "an ADC is calibrated while it is on"
            self.begin(adc, CALIBRATE, self.calibration_cycles(value) / self.hz())
        if asked & ON:
            after = self.times[adc, CALIBRATE]
            assert after is not None and not was & CALIBRATE, "an ADC is switched on before it is calibrated"
            wait = CYCLES_AFTER_CALIBRATION / self.hz() * self.board.CORE_HZ
            assert self.board.now >= after + wait, "an ADC is switched on too soon after its calibration"
            self.begin(adc, ON, READY_SECONDS)
        value |= was & (ON | START | CALIBRATE)
        if asked & START:
            assert adc == 0, "the master starts both"
            if self.common & 0b11111:
                self.start()
            else:
                self.start_by_program()
                value &= ~START
        if asked & STOP:
            assert was & START, "nothing is to be stopped"
            self.master = self.ready_at = None
            value &= ~(START | STOP)
        self.registers[adc, CR] = value
