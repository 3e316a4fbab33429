"""The DAC's channel 1: trigger, DMA request, underrun (RM0090 chapter 14)."""

BASE, IRQ = 0x40007400, 54
CR, SWTRIGR, DHR12R1, DHR12L1, DHR8R1, DOR1, SR = 0x00, 0x04, 0x08, 0x0C, 0x10, 0x2C, 0x34
ENABLED, TRIGGERED, DMA_ENABLED, UNDERRUN_INTERRUPT, UNDERRUN = 1 << 0, 1 << 2, 1 << 12, 1 << 13, 1 << 13
# TSEL1: timer
TRIGGER = {0: 6, 1: 8, 2: 7, 3: 5, 4: 2, 5: 4}
# DMA1, stream 5, channel 7 (table 43)
STREAM, CHANNEL = 5, 7


class Dac:
    def __init__(self, board):
        self.board = board
        self.control = self.status = self.holding = self.output = 0
        self.codes = []
        self.underruns = 0
        self.is_driven = False
        self.may_request = True

    def trigger(self, timer):
        if not (self.control & ENABLED and self.control & TRIGGERED and TRIGGER.get(self.control >> 3 & 7) == timer):
            return
        self.set_output(self.holding)
        self.codes.append(self.output)
        if not self.control & DMA_ENABLED:
            return
        # After an underrun no request is treated until the flag is cleared and DMAEN has been set anew.
        if self.may_request and not self.board.dma[1].request(STREAM, CHANNEL):
            self.may_request = False
            self.status |= UNDERRUN
            self.underruns += 1
            self.raise_interrupt()

    def triggers_until_flag(self):
        """Triggers until the DMA has played half of its ring or all of it."""
        stream = self.board.dma[1].streams[STREAM]
        half = stream.count // 2
        return max(1, stream.left - half if stream.left > half else stream.left)

    def set_output(self, code):
        self.output = code
        if not self.is_driven:
            self.is_driven = True
            self.board.note("dac drives", code)

    def raise_interrupt(self):
        if self.is_pending():
            self.board.pend(IRQ)

    def is_pending(self):
        return bool(self.status & UNDERRUN and self.control & UNDERRUN_INTERRUPT)

    def hold(self, code):
        self.holding = code & 0xFFF
        if self.control & ENABLED and not self.control & TRIGGERED:
            self.set_output(self.holding)

    def read(self, offset):
        return {CR: self.control, SR: self.status, DOR1: self.output, DHR12R1: self.holding}.get(offset, 0)

    def write(self, offset, value):
        if offset == CR:
            was, self.control = self.control, value
            if value & DMA_ENABLED and not was & DMA_ENABLED and not self.status & UNDERRUN:
                self.may_request = True
            if value & ENABLED and not value & TRIGGERED:
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
