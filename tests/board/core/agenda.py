"""The chip's time, and what is planned for later.

Time is counted in cycles of the core at full speed (`CORE_HZ`); while the core runs slower, each of its cycles takes
`cycle` of them.
"""
import heapq


class Agenda:
    def __init__(self):
        self.now = 0.0
        self.events, self.planned = [], 0

    def set_core_hz(self, core_hz):
        """The core's clock has changed; 0 is a core that stands still."""
        self.core_hz = core_hz
        self.must_stop |= not core_hz
        self.cycle = self.CORE_HZ / core_hz if core_hz else float("inf")

    def core_cycles(self):
        """Cycles that the core's clock has made since the reset."""
        return int(self.counted_cycles + (self.now - self.counted_at) / self.cycle)

    def hold_cycles(self):
        """Before the core's clock changes."""
        self.counted_cycles, self.counted_at = self.core_cycles(), self.now

    def at(self, when, call, *arguments):
        self.planned += 1
        heapq.heappush(self.events, (when, self.planned, call, arguments))

    def run_events(self):
        while self.events and self.events[0][0] <= self.now:
            when, _, call, arguments = heapq.heappop(self.events)
            now, self.now = self.now, when
            call(*arguments)
            self.now = max(now, self.now)

    def stall(self, seconds):
        """The processor waits, the rest of the chip goes on."""
        self.now += seconds * self.CORE_HZ

    @property
    def seconds(self):
        return self.now / self.CORE_HZ
