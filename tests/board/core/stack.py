"""How deep the stack gets: in thread mode and in each priority's handlers, frames included, one by one.

Whenever they meet, the stack needs at most their sum. From power-on, or the program's start escapes it.
"""


class Trace:
    """An exception under way: when it was entered, where the stack stood, what lay below, and for how long others
    have interrupted it."""

    def __init__(self, entered, above, below):
        self.entered, self.above, self.below, self.interrupted = entered, above, below, 0


def first_difference(memory, other):
    """Index of the first byte in which `memory` differs from the beginning of `other`, or its length."""
    for start in range(0, len(memory), 256):
        end = min(start + 256, len(memory))
        if memory[start:end] != other[start:end]:
            return next(i for i in range(start, end) if memory[i] != other[i])
    return len(memory)


class StackWatch:
    """A board's memory at `start`, which the stack has to itself; `noise` is its content after power-on."""

    def __init__(self, cpu, start, size):
        self.cpu, self.start, self.size = cpu, start, size
        self.noise = b""
        self.is_on = False

    def thread_depth(self, traces):
        """Bytes from the top that have been written since power-on.

        While the stacks are watched this is the program's exact need without interrupts, to the word."""
        now = bytes(self.cpu.mem_read(self.start, self.size))
        if traces:
            # An interrupt is under way.
            now = traces[0].below + now[len(traces[0].below) :]
        return self.size - first_difference(now, self.noise)

    def paint_below(self, above):
        """Keeps what lies below the stack pointer and writes noise there instead, if the stacks are watched."""
        if not self.is_on or not self.start < above <= self.start + self.size:
            return b""
        below = bytes(self.cpu.mem_read(self.start, above - self.start))
        self.cpu.mem_write(self.start, self.noise[: len(below)])
        return below

    def restore_below(self, trace):
        """Undoes that: the interrupt leaves no trace. Returns the lowest address that it has written."""
        lowest = self.start + first_difference(self.cpu.mem_read(self.start, len(trace.below)), self.noise)
        self.cpu.mem_write(self.start, trace.below)
        return lowest
