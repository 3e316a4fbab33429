"""DMA streams in direct mode: single and circular, half, whole and error flags (RM0090 chapter 10)."""
from core.dma import Dma

FLAG_SHIFT = (0, 6, 16, 22, 32, 38, 48, 54)
ERROR, HALF, WHOLE = 1 << 3, 1 << 4, 1 << 5
# Stream control: enable, interrupt enables (each flag's bit over two), circular, increment of the memory's address.
ENABLED, ERROR_INTERRUPT, HALF_INTERRUPT, WHOLE_INTERRUPT = 1 << 0, 1 << 2, 1 << 3, 1 << 4
CIRCULAR, MEMORY_INCREMENT = 1 << 8, 1 << 10
TO_PERIPHERAL = 1


class Stream:
    def __init__(self):
        self.control = self.count = self.left = self.position = self.peripheral = self.memory = self.memory1 = 0
        self.fifo = 0x21


class Streams(Dma):
    NEW = Stream

    def reset(self):
        super().reset()
        self.flags = 0

    def is_pending(self, stream):
        flags, control = self.flags >> FLAG_SHIFT[stream] & 63, self.streams[stream].control
        return bool(
            (flags & WHOLE and control & WHOLE_INTERRUPT)
            or (flags & HALF and control & HALF_INTERRUPT)
            or (flags & ERROR and control & ERROR_INTERRUPT)
        )

    def set_flag(self, stream, flag):
        self.flags |= flag << FLAG_SHIFT[stream]
        self.pend(stream)

    def request(self, stream, channel=0):
        """A peripheral asks for a transfer; returns whether the stream made it. Behind a DMAMUX streams have no channel."""
        s = self.streams[stream]
        if stream in self.blocked or not s.control & ENABLED or s.control >> 25 & 7 != channel or s.left == 0:
            return False
        size = 1 << (s.control >> 11 & 3)
        self.transfer(s, size, bool(s.control & MEMORY_INCREMENT), s.control >> 6 & 3 == TO_PERIPHERAL)
        if s.left == s.count // 2:
            self.set_flag(stream, HALF)
        if s.left == 0:
            if s.control & CIRCULAR:
                s.left, s.position = s.count, 0
            else:
                s.control &= ~ENABLED
            self.set_flag(stream, WHOLE)
        return True

    def read(self, offset):
        self.settle()
        if offset < 0x10:
            return {0: self.flags & 0xFFFFFFFF, 4: self.flags >> 32}.get(offset, 0)
        number, register = divmod(offset - 0x10, 0x18)
        s = self.streams[number]
        return (s.control, s.left, s.peripheral, s.memory, s.memory1, s.fifo)[register // 4]

    def write(self, offset, value):
        self.settle()
        if offset < 0x10:
            self.flags &= ~{8: value, 12: value << 32}.get(offset, 0)
            return
        number, register = divmod(offset - 0x10, 0x18)
        s = self.streams[number]
        register //= 4
        if register == 0:
            was, s.control = s.control, value
            if value & ENABLED and not was & ENABLED:
                # Flags of an earlier transfer keep the stream from starting (RM0090 10.3.17).
                assert not self.flags >> FLAG_SHIFT[number] & 63, "a stream is enabled with old flags"
                s.left, s.position = s.count, 0
                self.find_memory(s, 1 << (value >> 11 & 3))
            if was & ENABLED and not value & ENABLED:
                self.set_flag(number, WHOLE)
            self.pend(number)
            # A request that stands is served at once.
            self.settle()
            return
        assert not s.control & ENABLED or register == 5, "a stream's registers are locked while it is enabled"
        if register == 1:
            s.count = s.left = value & 0xFFFF
        else:
            setattr(s, ("control", "count", "peripheral", "memory", "memory1", "fifo")[register], value)
