"""A timer's inputs: channels that capture (RM0090 18.3.5 and 18.4, RM0440 chapter 29, RM0433 chapter 39; the same on the three
chips).

The model has the effect of an edge on the channel's flag: its own pin's rise, filtered, without a prescaler. What it lacks (falling
edges, the other channel's pin, the captured count) is a failure when it is asked for.
"""

# A channel's byte of CCMR: its own pin's input, no prescaler; the filter.
SELECTION, OWN_PIN, PRESCALER, FILTER = 0b11, 0b01, 0b11 << 2, 0b1111 << 4
# ICxF -> clock periods between samples, samples that must agree (CKD = 00; RM0090 18.4.7).
FILTERS = {0: (1, 1), 1: (1, 2), 2: (1, 4), 3: (1, 8)} | {
    4 + 2 * step + late: (divider, (6, 8)[late]) for step, divider in enumerate((2, 4, 8, 16)) for late in range(2)
} | {12: (16, 8), 13: (32, 5), 14: (32, 6), 15: (32, 8)}  # fmt: skip
FILTERS |= {10: (16, 5), 11: (16, 6)}
ENABLED, FALLING = 0b0001, 0b1010


class Inputs:
    def __init__(self, timer):
        self.timer = timer
        self.levels = [0] * timer.facts.channels
        # The filters' outputs, and changes on their way through them.
        self.filtered = [0] * timer.facts.channels
        self.changes = [0] * timer.facts.channels

    def drive(self, channel, level):
        """The pin's level from outside."""
        if level == self.levels[channel]:
            return
        self.levels[channel] = level
        self.changes[channel] += 1
        divider, agreeing = FILTERS[(self.timer.outputs.byte(channel) & FILTER) >> 4]
        board = self.timer.board
        delay = divider * agreeing * board.CORE_HZ / board.clocks.timer_hz(self.timer.facts.bus)
        board.at(board.now + delay, self.arrive, channel, level, self.changes[channel])

    def arrive(self, channel, level, change):
        """The level has stood for the filter's time, unless it has changed meanwhile."""
        if change != self.changes[channel] or level == self.filtered[channel]:
            return
        self.filtered[channel] = level
        enables = self.timer.outputs.enables >> 4 * channel & 15
        if self.timer.outputs.is_input(channel) and enables & ENABLED and level:
            self.timer.status |= 2 << channel

    @staticmethod
    def check(byte, name):
        """A channel's byte of CCMR, which makes it an input."""
        assert byte & SELECTION == OWN_PIN and not byte & PRESCALER, f"{name}: this capture is not modelled"
