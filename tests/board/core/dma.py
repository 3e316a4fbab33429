"""What a DMA of channels and one of streams have in common: eight ways from memory to a peripheral or back."""

STREAMS = 8


class Dma:
    """One controller. `reaches` are the memories it can read and write, as (start, size)."""

    # What holds one way's registers: control, count, left, position, peripheral, memory; and that memory's bytes.
    NEW = None

    def __init__(self, board, base, irqs, reaches):
        self.board, self.base, self.irqs, self.reaches = board, base, irqs, reaches
        for stream, irq in enumerate(irqs):
            board.add_line(irq, lambda stream=stream: self.is_pending(stream))
        # Called before anyone looks: transfers that should have been asked for by now.
        self.settle = lambda: None
        # The streams that a test keeps from the bus.
        self.blocked = set()
        self.reset()

    def reset(self):
        self.streams = [self.NEW() for _ in range(STREAMS)]
        self.blocked.clear()

    def is_pending(self, stream):
        """Whether an interrupt of this one is due: a flag stands and its interrupt is enabled."""
        raise NotImplementedError

    def pend(self, stream):
        if self.is_pending(stream):
            self.board.pend(self.irqs[stream])

    def transfer(self, s, size, increments, from_memory):
        """Moves one item of `size` bytes and counts it."""
        start = s.offset + s.position * size if increments else s.offset
        if from_memory:
            self.board.bus_write(s.peripheral, size, int.from_bytes(s.bytes[start : start + size], "little"))
        else:
            value = self.board.bus_read(s.peripheral, size) & ((1 << 8 * size) - 1)
            s.bytes[start : start + size] = value.to_bytes(size, "little")
        s.position += 1
        s.left -= 1

    def find_memory(self, s, size):
        """The whole buffer lies in a memory that this DMA has a way to; which, and where in it."""
        end = s.memory + s.count * size
        is_reached = any(start <= s.memory and end <= start + length for start, length in self.reaches)
        assert is_reached, f"this DMA has no way to {s.memory:#x}"
        s.bytes, s.offset = self.board.memory_at(s.memory)
