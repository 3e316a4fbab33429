"""The DAC's channel 1: trigger, DMA request, underrun (RM0090 chapter 14)."""

CR, SWTRIGR, DHR12R1, DHR12L1, DHR8R1, DOR1, SR = 0x00, 0x04, 0x08, 0x0C, 0x10, 0x2C, 0x34
MCR = 0x3C
ENABLED, DMA_ENABLED, UNDERRUN_INTERRUPT, UNDERRUN = 1 << 0, 1 << 12, 1 << 13, 1 << 13
REQUEST = "DAC1"


class Dac:
    """The F4's, with both limitations of its DMA requests (ES0182, "DMA underrun flag management" and "DMA request not
    automatically cleared by DMAEN=0"): an underrun stops nothing, and a request that stands when DMAEN is cleared is served
    as soon as the stream can. `triggers` says which timer a value of TSEL1 means."""

    # TEN1, and where TSEL1 stands.
    TRIGGERED, SELECT_SHIFT, SELECT_MASK = 1 << 2, 3, 7

    def __init__(self, board, irq, triggers):
        self.board, self.irq, self.triggers = board, irq, triggers
        board.add_line(irq, self.is_pending)
        self.reset()

    def reset(self):
        self.control = self.status = self.holding = self.output = 0
        # What it has played since, and how often the DMA was late.
        self.codes = []
        self.underruns = 0
        self.is_driven = False
        # A request of the DMA stands.
        self.waits = False

    def trigger_timer(self):
        return self.triggers.get(self.control >> self.SELECT_SHIFT & self.SELECT_MASK)

    def trigger(self, timer):
        if not (self.control & ENABLED and self.control & self.TRIGGERED and self.trigger_timer() == timer):
            return
        self.settle()
        self.set_output(self.holding)
        self.codes.append(self.output)
        if self.control & DMA_ENABLED:
            self.ask()

    def ask(self):
        """Asks the DMA for the next code."""
        if self.waits:
            self.underrun()
        self.waits = True
        self.settle()

    def settle(self):
        """The DMA serves the request that stands, if it can by now. Called before anyone looks."""
        self.waits = self.waits and not self.board.request_dma(REQUEST)

    def underrun(self):
        self.status |= UNDERRUN
        self.underruns += 1
        self.raise_interrupt()

    def triggers_until_flag(self):
        """Triggers until the DMA has played half of its ring or all of it."""
        stream = self.board.serving(REQUEST)
        if stream is None:
            return 1
        half = stream.count // 2
        return max(1, stream.left - half if stream.left > half else stream.left)

    def set_output(self, code):
        self.output = code
        if not self.is_driven:
            self.is_driven = True
            self.board.note("dac drives", code)

    def raise_interrupt(self):
        if self.is_pending():
            self.board.pend(self.irq)

    def is_pending(self):
        return bool(self.status & UNDERRUN and self.control & UNDERRUN_INTERRUPT)

    def hold(self, code):
        self.holding = code & 0xFFF
        if self.control & ENABLED and not self.control & self.TRIGGERED:
            self.set_output(self.holding)

    def read(self, offset):
        known = {CR: self.control, SR: self.status, DOR1: self.output, DHR12R1: self.holding}
        assert offset in known, f"the DAC has no modelled register {offset:#x} that can be read"
        return known[offset]

    def write(self, offset, value):
        if offset == CR:
            self.control = value
            if value & ENABLED and not value & self.TRIGGERED:
                self.set_output(self.holding)
            self.raise_interrupt()
        elif offset == DHR12R1:
            self.hold(value)
        elif offset == DHR12L1:
            self.hold(value >> 4)
        elif offset == DHR8R1:
            self.hold(value << 4)
        elif offset == SR:
            self.status &= ~value
        else:
            raise AssertionError(f"the DAC has no modelled register {offset:#x} that can be written")


class DacWithMode(Dac):
    """The G4's and the H7's (RM0440 chapter 22, RM0433 chapter 26): another place for the trigger, and a mode register. An
    underrun stops the requests until the flag is cleared and DMAEN has been set again.

    `speed` is the required DAC_MCR.HFSEL at a bus clock, or None if the chip has no such bits."""

    TRIGGERED, SELECT_SHIFT, SELECT_MASK = 1 << 1, 2, 15

    def __init__(self, board, irq, triggers, bus_hz=None, speed=None):
        self.bus_hz, self.speed = bus_hz, speed
        super().__init__(board, irq, triggers)

    def reset(self):
        super().reset()
        self.mode = 0
        self.may_request = True

    def ask(self):
        if self.may_request and not self.board.request_dma(REQUEST):
            self.may_request = False
            self.underrun()

    def read(self, offset):
        return self.mode if offset == MCR else super().read(offset)

    def write(self, offset, value):
        if offset == MCR:
            assert not self.control & ENABLED, "the mode is written while the channel is on (RM0440 22.7.16)"
            assert not value & 0b111, "only the external pin with its buffer is modelled"
            self.mode = value
            return
        if offset == CR:
            select = self.SELECT_MASK << self.SELECT_SHIFT
            is_same = (value ^ self.control) & select == 0
            assert is_same or not self.control & ENABLED, "TSEL1 is changed while the channel is on (RM0440 22.4.7)"
            if self.speed and value & ENABLED:
                wanted = self.speed(self.bus_hz())
                assert self.mode >> 14 & 3 >= wanted, f"HFSEL must be {wanted} at {self.bus_hz() / 1e6} MHz"
            if value & DMA_ENABLED and not self.control & DMA_ENABLED and not self.status & UNDERRUN:
                self.may_request = True
        super().write(offset, value)
