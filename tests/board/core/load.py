"""What hangs at a pin that the chip does not drive: a resistor to ground and a capacitor, which the chip's own pull-up charges.

Voltages are shares of the supply. An input is certainly low below 0.3 and certainly high above 0.7 of it (the I/O characteristics of
DS8626, DS12288 and DS12110); the level at which one chip changes over is `threshold`.
"""
from math import exp, inf
from typing import NamedTuple

LOW, HIGH = 0.3, 0.7
# A pin and its track.
STRAY = 20e-12


class Wiring(NamedTuple):
    ohms: float = inf
    farads: float = STRAY
    # The chip's own pull-up.
    pull_up: float = 40e3
    threshold: float = 0.5


class Load:
    def __init__(self, board, wiring):
        self.board, self.wiring = board, wiring
        self.voltage, self.since, self.is_pulled_up, self.driven = 0.0, board.now, False, None
        # The highest voltage of the undriven pin; when a pull-up and a driver last took it over, in seconds.
        self.highest, self.pulled_at, self.driven_at = 0.0, None, None

    def change(self, is_pulled_up, driven):
        """What the chip does to the pin from now on."""
        self.settle()
        if is_pulled_up and not self.is_pulled_up:
            self.pulled_at = self.board.seconds
        if driven is not None and self.driven is None:
            self.driven_at = self.board.seconds
        self.is_pulled_up, self.driven = is_pulled_up, driven

    def settle(self):
        """The voltage now."""
        ohms, farads, pull_up, _ = self.wiring
        seconds = (self.board.now - self.since) / self.board.CORE_HZ
        self.since = self.board.now
        if self.driven is not None:
            self.voltage = float(self.driven)
            return
        conductance = 1 / ohms + (1 / pull_up if self.is_pulled_up else 0)
        goal = 1 / pull_up / conductance if self.is_pulled_up else 0.0
        if conductance:
            self.voltage = goal + (self.voltage - goal) * exp(-seconds * conductance / farads)
        self.highest = max(self.highest, self.voltage)

    def level(self):
        self.settle()
        return int(self.voltage > self.wiring.threshold)
