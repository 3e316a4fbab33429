"""Two ADCs that convert together at a timer's trigger, and give both codes to the DMA as one word: what the chips' have in
common. A chip's own file has the registers.

What is at the pins is `at_pins()`: it is asked once a conversion, after the DAC has taken the same trigger, and gives the
codes of the sensor and of the shunt. Both stay in the period of that trigger from the sampling to the conversion's end, so
that nothing happens between the two which another conversion could see: a conversion is planned with its trigger, and made
when anyone looks (`settle`).
"""
MID = 2048
REQUEST = "ADC1"
# VREFINT: 1.18 to 1.24 V on the three chips.
INTERNAL_VOLTS = 1.21


class DualAdc:
    """`triggers` says which timer a value of EXTSEL means, `channels` which pin each of the ADCs' channels is."""

    def __init__(self, board, triggers, channels):
        self.board, self.triggers, self.channels = board, triggers, channels
        self.at_pins = lambda: (MID, MID)
        # A fault: triggers have no effect.
        self.is_stuck = False
        # VREF+.
        self.reference_volts = 3.3
        self.reset()

    def reset(self):
        self.ready_at, self.held = None, (0, 0)
        # When a conversion of VREFINT is over that the program has started; None without one.
        self.internal_at = None
        self.data = 0
        # The DMA has not taken the last word yet; it has been overwritten.
        self.waits = self.is_overrun = False
        # Words that the DMA has taken, since the reset.
        self.taken = 0

    # --- a chip's own

    def timer(self):
        """The timer by whose trigger output both convert; None while they do not."""
        raise NotImplementedError

    def cycles(self):
        """Cycles of the core at full speed from a trigger until both codes are ready."""
        raise NotImplementedError

    def requests(self):
        """Whether the DMA is asked to take the words."""
        raise NotImplementedError

    # --- conversions

    def trigger(self, timer, is_one_of_many=False):
        """A timer's trigger. One of many at one moment, as in haste, is converted at once."""
        if self.ready_at is not None:
            assert self.ready_at <= self.board.now, "a trigger while the ADCs convert"
            self.finish()
        if not self.is_stuck and timer == self.timer():
            self.ready_at = self.board.now + (0 if is_one_of_many else self.cycles())
            self.held = self.at_pins()

    def settle(self):
        """Ends the conversion that should be over."""
        if self.ready_at is not None and self.ready_at <= self.board.now:
            self.finish()

    def finish(self):
        self.ready_at = None
        if not self.requests() or self.is_overrun:
            return
        if self.waits:
            self.is_overrun = True
            return
        sensor, shunt = self.held
        assert 0 <= sensor < 4096 and 0 <= shunt < 4096, "12 bits"
        self.data = sensor | shunt << 16
        self.waits = not self.board.request_dma(REQUEST)
        self.taken += not self.waits

    def forget(self):
        """The program clears overrun and request."""
        self.waits = self.is_overrun = False

    # --- the internal reference

    def convert_internal(self, cycles, hz, sampling_seconds):
        """One conversion of VREFINT, by the program: `cycles` of sampling and the rest of the conversion."""
        sampling, rest = cycles
        assert sampling / hz >= sampling_seconds, "VREFINT is sampled for too short a time"
        self.internal_at = self.board.now + (sampling + rest) / hz * self.board.CORE_HZ

    def has_internal(self):
        return self.internal_at is not None and self.internal_at <= self.board.now

    def take_internal(self, full_scale):
        """DR: its code, which clears EOC."""
        assert self.has_internal(), "DR is read before the end of a conversion"
        self.internal_at = None
        return round(full_scale * INTERNAL_VOLTS / self.reference_volts)

    def check_pins(self, channels):
        """The channels that both convert: two different pins, and no digital input on them."""
        pins = [self.channels[number].get(channel) for number, channel in enumerate(channels)]
        assert None not in pins, f"channels {channels} are not in the model's table"
        assert pins[0] != pins[1], "both ADCs convert the same pin"
        assert all(self.board.pins.mode(pin) == 0b11 for pin in pins), f"{pins} are not analogue"
