"""USART with FIFOs (RM0440 chapter 37), and the host's end of the line: on the Nucleo the ST-LINK's serial port.

Bytes take their time on the line, in both directions; a receiver at another rate than the sender's reads noise.

With DMAR it asks the DMA for a transfer while there is a received byte, with DMAT while the transmit FIFO has room (continuous communication using DMA). What the
manual leaves open is the worst here: while an overrun's flag stands nothing is received. What becomes of a byte with an error is one
of `READINGS`, which a test chooses.
"""

# By the manual (USART_CR3.DDRE = 0) such a byte never gets to the DMA, and the next one does.
LEFT_OUT, TAKEN = "the DMA leaves it out", "the DMA takes it"
# Linux' driver (stm32-usart.c): "the DMA request line has been masked by HW", until the program has cleared the flags or read the byte.
MASKED_UNTIL_CLEARED, MASKED_UNTIL_READ = "masked until ICR is written", "masked until RDR is read"
READINGS = LEFT_OUT, TAKEN, MASKED_UNTIL_CLEARED, MASKED_UNTIL_READ

CR1, CR2, CR3, BRR, RQR, ISR, ICR, RDR, TDR, PRESC = 0x00, 0x04, 0x08, 0x0C, 0x18, 0x1C, 0x20, 0x24, 0x28, 0x2C
ENABLED, RECEIVES, TRANSMITS, MATCH_INTERRUPT, FIFOS = 1 << 0, 1 << 2, 1 << 3, 1 << 14, 1 << 29
# CR3. DDRE stays 0 and OVRDIS, which bypasses the receive FIFO, too.
ERROR_INTERRUPT, ASKS_TO_RECEIVE, ASKS_TO_SEND, ONE_BIT, NO_OVERRUN, STOPS_AT_ERRORS = (
    1 << 0, 1 << 6, 1 << 7, 1 << 11, 1 << 12, 1 << 13,
)  # fmt: skip
FRAMING, NOISE, OVERRUN, IDLE, NOT_EMPTY, COMPLETE, NOT_FULL, ACKNOWLEDGED = (
    1 << 1, 1 << 2, 1 << 3, 1 << 4, 1 << 5, 1 << 6, 1 << 7, 0b11 << 21,
)  # fmt: skip
# A received byte was CR2.ADD.
MATCH = 1 << 17
# Flags whose interrupt is enabled by the same bit of CR1.
OWN_ENABLES = IDLE | NOT_EMPTY | COMPLETE | NOT_FULL
# A start bit, eight data bits, a stop bit.
FRAME_BITS, DEPTH = 10, 8
# A receiver samples a frame's last bit in time if the rates differ by no more (RM0440 37.5.7, with some for the sender).
TOLERANCE = 0.02


class Uart:
    """`transmit` and `receive` are its pins; `name` begins those of its requests to the DMA."""

    reading = LEFT_OUT

    def __init__(self, board, name, irq, bus, transmit, receive, function):
        self.board, self.name, self.irq, self.bus = board, name, irq, bus
        self.transmit, self.receive, self.function = transmit, receive, function
        self.peer = None
        board.add_line(irq, self.is_pending)
        self.generation = 0
        self.reset()

    def reset(self):
        self.generation += 1
        self.registers = dict.fromkeys((CR1, CR2, CR3, BRR, PRESC), 0)
        self.flags = COMPLETE
        self.incoming, self.outgoing = [], []
        self.is_sending = self.is_masked = False
        # When the last byte came: the line is idle one frame later, once.
        self.last = None

    def is_on(self, bit, pin):
        return self.registers[CR1] & (ENABLED | bit) == ENABLED | bit and self.board.pins.alternate(pin) == self.function[pin]

    def baud(self):
        divider = self.registers[BRR]
        return self.board.clocks.frequencies.apb[self.bus] / divider if divider else 0.0

    def depth(self):
        return DEPTH if self.registers[CR1] & FIFOS else 1

    # --- the line

    def hear(self, byte, baud):
        """Receives a byte that was sent at `baud`."""
        if self.baud() and abs(self.baud() / baud - 1) > TOLERANCE:
            self.take(byte * 0x55 + 0x2A & 0xFF, FRAMING)
        else:
            self.take(byte)

    def take(self, byte, flags=0):
        """A frame has been sampled; its errors come with it."""
        if not self.is_on(RECEIVES, self.receive) or not self.baud():
            return
        control = self.registers[CR3]
        if control & ONE_BIT:
            flags &= ~NOISE
        if self.flags & OVERRUN or len(self.incoming) >= self.depth():
            flags |= OVERRUN
        elif not (flags and control & ASKS_TO_RECEIVE and self.reading == LEFT_OUT):
            self.incoming.append(byte)
            if byte == self.registers[CR2] >> 24:
                self.flags |= MATCH
        self.flags |= flags
        self.is_masked |= bool(flags and self.reading in (MASKED_UNTIL_CLEARED, MASKED_UNTIL_READ))
        self.ask()
        self.last = self.board.now
        self.board.at(self.board.now + self.frame(), self.rest, self.generation, self.last)
        self.raise_interrupt()

    def ask(self):
        """Asks the DMA, as long as there is something to be moved and it answers."""
        control = self.registers[CR3] if self.registers[CR1] & ENABLED else 0
        while control & ASKS_TO_RECEIVE and self.incoming and not self.is_masked and self.board.request_dma(f"{self.name}_RX"):
            pass
        while control & ASKS_TO_SEND and len(self.outgoing) < self.depth() and self.board.request_dma(f"{self.name}_TX"):
            pass

    def frame(self):
        return FRAME_BITS / self.baud() * self.board.CORE_HZ

    def rest(self, generation, last):
        # A byte whose start bit has come is not idleness.
        if generation == self.generation and last == self.last and not (self.peer and self.peer.is_sending):
            self.flags |= IDLE
            self.raise_interrupt()

    def send_next(self):
        if self.outgoing and not self.is_sending and self.is_on(TRANSMITS, self.transmit):
            self.is_sending = True
            byte = self.outgoing.pop(0)
            self.board.at(self.board.now + self.frame(), self.sent, self.generation, byte, self.baud())

    def sent(self, generation, byte, baud):
        if generation != self.generation:
            return
        self.is_sending = False
        if self.peer:
            self.peer.hear(byte, baud)
        if not self.outgoing:
            self.flags |= COMPLETE
        self.send_next()
        self.ask()
        self.raise_interrupt()

    # --- registers

    def status(self):
        value = self.flags | (NOT_EMPTY if self.incoming else 0)
        value |= NOT_FULL if len(self.outgoing) < self.depth() else 0
        return value | (ACKNOWLEDGED if self.registers[CR1] & ENABLED else 0)

    def is_pending(self):
        status, control = self.status(), self.registers[CR1]
        errors = status & (FRAMING | NOISE | OVERRUN) and self.registers[CR3] & ERROR_INTERRUPT
        overrun = status & OVERRUN and control & NOT_EMPTY
        match = status & MATCH and control & MATCH_INTERRUPT
        return bool(control & ENABLED and (status & control & OWN_ENABLES or match or errors or overrun))

    def raise_interrupt(self):
        if self.is_pending():
            self.board.pend(self.irq)

    def read(self, offset):
        if offset == ISR:
            return self.status()
        if offset == RDR:
            # A DMA that is masked reads nothing.
            self.is_masked &= self.reading != MASKED_UNTIL_READ
            return self.incoming.pop(0) if self.incoming else 0
        if offset in (TDR, RQR, ICR):
            return 0
        assert offset in self.registers, f"the USART has no modelled register {offset:#x}"
        return self.registers[offset]

    def write(self, offset, value):
        if offset == TDR:
            assert len(self.outgoing) < self.depth(), "a byte is written into a full transmit FIFO"
            self.flags &= ~COMPLETE
            self.outgoing.append(value & 0xFF)
            self.send_next()
        elif offset == ICR:
            self.flags &= ~value
            has_errors = self.flags & (FRAMING | NOISE | OVERRUN)
            self.is_masked &= bool(has_errors) or self.reading != MASKED_UNTIL_CLEARED
            self.ask()
        elif offset == RQR:
            assert not value & ~0b1000, "only flushing what was received is modelled"
            self.incoming.clear()
        else:
            assert offset in self.registers, f"the USART has no modelled register {offset:#x}"
            is_running = self.registers[CR1] & ENABLED
            changed = value ^ self.registers[offset]
            if offset == CR3:
                assert not value & (NO_OVERRUN | STOPS_AT_ERRORS), "these are not modelled"
                changed &= ~(ASKS_TO_RECEIVE | ASKS_TO_SEND | ERROR_INTERRUPT)
            if offset == CR1:
                changed &= FIFOS if value & ENABLED else 0
            assert not is_running or not changed, "the format is changed while the USART runs (RM0440 37.8)"
            self.registers[offset] = value
            if offset == CR1:
                self.send_next()
            self.ask()
        self.raise_interrupt()


def levels(data):
    """The line's levels, one a bit, while bytes are sent without a pause."""
    return [level for byte in data for level in (0, *(byte >> bit & 1 for bit in range(8)), 1)]


def sampled(line, sent_baud, baud, one_bit=False):
    """What a receiver at `baud` makes of a line whose levels change at `sent_baud`, and which rests before and after: of
    each frame when it is over, in seconds, its byte and its errors.

    It begins at a falling edge and samples each bit three times around its middle (RM0440 37.5.6): if they differ, it is
    noise, and two of three count. With `one_bit` the one in the middle counts, and there is no noise."""

    def level(seconds):
        return line[int(seconds * sent_baud)] if 0 <= seconds * sent_baud < len(line) else 1

    frames, edge = [], 0
    while True:
        edge = next((i for i in range(edge, len(line)) if not line[i] and (i == 0 or line[i - 1])), None)
        if edge is None:
            return frames
        samples = [
            sum(level(edge / sent_baud + (bit + 0.5 + third / 16) / baud) for third in ((0, 0, 0) if one_bit else (-1, 0, 1)))
            for bit in range(FRAME_BITS)
        ]
        bits = [sample >= 2 for sample in samples]
        if bits[0]:
            # A spike, and no start bit.
            edge += 1
            continue
        noise = NOISE if any(sample in (1, 2) for sample in samples) else 0
        byte = sum(bit << i for i, bit in enumerate(bits[1:9]))
        frames.append((edge / sent_baud + FRAME_BITS / baud, byte, noise | (0 if bits[9] else FRAMING)))
        # The next edge after the stop bit's middle.
        edge = int(edge + (FRAME_BITS - 0.5) * sent_baud / baud) + 1


class SerialHost:
    """The host's end. It may be unplugged, it may stop reading, it may have the wrong rate, or noise on its line."""

    BAUD = 921_600

    def __init__(self, board):
        self.board, self.uart = board, board.uart
        self.uart.peer = board.cable = self
        self.is_plugged = self.reads = True
        self.baud = self.BAUD
        self.to_device, self.from_device = [], bytearray()
        self.is_sending = False

    @property
    def is_configured(self):
        """A serial port is always there; the device listens once its receiver is on."""
        return bool(self.uart.registers[CR1] & (ENABLED | RECEIVES) == ENABLED | RECEIVES)

    def unplug(self):
        self.is_plugged = False
        self.to_device.clear()

    def plug(self):
        self.is_plugged = True

    def send(self, data):
        if self.is_plugged:
            self.to_device += data
            self.send_next()

    def send_next(self):
        if self.to_device and not self.is_sending:
            self.is_sending = True
            byte = self.to_device.pop(0)
            self.board.at(self.board.now + FRAME_BITS / self.baud * self.board.CORE_HZ, self.sent, byte)

    def sent(self, byte):
        self.is_sending = False
        self.uart.hear(byte, self.baud)
        self.send_next()

    def move_line(self, line, baud):
        """Moves the line as it likes, a level a bit, instead of sending bytes."""
        one_bit = bool(self.uart.registers[CR3] & ONE_BIT)
        for seconds, byte, errors in sampled(line, baud, self.uart.baud(), one_bit):
            self.board.at(self.board.now + seconds * self.board.CORE_HZ, self.uart.take, byte, errors)

    def hear(self, byte, baud):
        """A byte of the device's: lost while nobody reads, for a UART cannot wait."""
        if self.is_plugged and self.reads:
            is_true = abs(baud / self.baud - 1) <= TOLERANCE
            self.from_device.append(byte if is_true else byte * 0x55 + 0x2A & 0xFF)

    def receive(self):
        data = bytes(self.from_device)
        self.from_device.clear()
        return data

    def reset(self):
        """The chip was reset: the events that moved the bytes are gone."""
        self.is_sending = False
        self.to_device.clear()
