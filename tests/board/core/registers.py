"""Registers that only keep what is written: a peripheral of which the firmware needs no more."""


class Registers:
    """`values` are the registers' values after a reset; another register than these is not modelled."""

    def __init__(self, name, values):
        self.name, self.reset_values = name, values
        self.reset()

    def reset(self):
        self.values = dict(self.reset_values)

    def read(self, offset):
        assert offset in self.values, f"{self.name} has no modelled register {offset:#x}"
        return self.values[offset]

    def write(self, offset, value):
        assert offset in self.values, f"{self.name} has no modelled register {offset:#x}"
        self.values[offset] = value


class Exti(Registers):
    """The lines' masks and edges; a line that rises is pending until 1 is written to it.

    `mask`, `rising` and `waiting` are the offsets of the registers of lines 0 to 31."""

    def __init__(self, mask, rising, falling, waiting, others=()):
        self.mask, self.rising, self.waiting = mask, rising, waiting
        super().__init__("EXTI", dict.fromkeys((mask, rising, falling, waiting, *others), 0))

    def rise(self, line):
        """A rising edge on a line; returns whether that is an interrupt."""
        if not self.values[self.mask] & self.values[self.rising] & 1 << line:
            return False
        self.values[self.waiting] |= 1 << line
        return True

    def write(self, offset, value):
        super().write(offset, self.values.get(offset, 0) & ~value if offset == self.waiting else value)
