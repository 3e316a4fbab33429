"""DMA with channels behind a DMAMUX: single and circular, half, whole and error flags (RM0440 chapter 12)."""
from core.dma import STREAMS, Dma

WHOLE, HALF, ERROR = 1 << 1, 1 << 2, 1 << 3
ENABLED, FLAG_INTERRUPTS, FROM_MEMORY, CIRCULAR, PERIPHERAL_INCREMENT, MEMORY_INCREMENT, MEMORY_TO_MEMORY = (
    1 << 0, 0b1110, 1 << 4, 1 << 5, 1 << 6, 1 << 7, 1 << 14,
)  # fmt: skip
FIRST, STRIDE = 0x08, 0x14


class Channel:
    def __init__(self):
        self.control = self.count = self.left = self.position = self.peripheral = self.memory = 0


class Channels(Dma):
    NEW = Channel

    # Called when a channel has been enabled: a peripheral may be asking already.
    on_enabled = staticmethod(lambda: None)

    def reset(self):
        super().reset()
        self.flags = [0] * STREAMS

    def is_pending(self, channel):
        # The enable bits stand where the flags stand.
        return bool(self.flags[channel] & self.streams[channel].control & FLAG_INTERRUPTS)

    def set_flag(self, channel, flag):
        self.flags[channel] |= flag
        self.pend(channel)

    def request(self, channel):
        """A peripheral asks for a transfer; returns whether the channel made it."""
        c = self.streams[channel]
        if channel in self.blocked or not c.control & ENABLED or c.left == 0:
            return False
        assert not c.control & (PERIPHERAL_INCREMENT | MEMORY_TO_MEMORY), "these transfers are not modelled"
        size, memory_size = 1 << (c.control >> 8 & 3), 1 << (c.control >> 10 & 3)
        assert size == memory_size, "both sides have the same width"
        self.transfer(c, size, bool(c.control & MEMORY_INCREMENT), bool(c.control & FROM_MEMORY))
        if c.left == c.count // 2:
            self.set_flag(channel, HALF)
        if c.left == 0:
            if c.control & CIRCULAR:
                c.left, c.position = c.count, 0
            self.set_flag(channel, WHOLE)
        return True

    def read(self, offset):
        self.settle()
        if offset < FIRST:
            assert offset == 0, "the flags are cleared in IFCR and read in ISR"
            return sum((flags | bool(flags)) << 4 * channel for channel, flags in enumerate(self.flags))
        number, register = divmod(offset - FIRST, STRIDE)
        c = self.streams[number]
        return (c.control, c.left, c.peripheral, c.memory)[register // 4]

    def write(self, offset, value):
        self.settle()
        if offset < FIRST:
            for channel in range(STREAMS):
                # The global flag's bit clears them all.
                bits = value >> 4 * channel & 15
                self.flags[channel] &= ~(0b1111 if bits & 1 else bits)
            return
        number, register = divmod(offset - FIRST, STRIDE)
        c = self.streams[number]
        register //= 4
        if register == 0:
            begins = value & ENABLED and not c.control & ENABLED
            if begins:
                assert not self.flags[number], "a channel is enabled with old flags"
                c.position = c.count - c.left
                self.find_memory(c, 1 << (value >> 8 & 3))
            c.control = value
            self.pend(number)
            if begins:
                self.on_enabled()
            return
        assert not c.control & ENABLED, "a channel's registers are locked while it is enabled (RM0440 12.6.3)"
        if register == 1:
            c.count = c.left = value & 0xFFFF
        else:
            setattr(c, ("control", "count", "peripheral", "memory")[register], value)
