"""A timer's outputs: compare modes, polarity, complementary outputs, main output enable, break, lock.

RM0090 17.3.10 to 17.3.13 and table 72 (output control bits), RM0440 28.3.17 to 28.3.21 and table 290, RM0433 38.3.15 to
38.3.19: the same on the three chips. Dead time is not modelled: an output that waits for it changes at once.
"""

from .inputs import FALLING, Inputs

CCMR1, CCMR2, CCER, BDTR, AF1 = 0x18, 0x1C, 0x20, 0x44, 0x60
# AF1.BKINE. A reset leaves it at 1 (RM0440 and RM0433, TIMx_AF1); here at 0, so that a program must not build on that.
BREAK_PIN = 1 << 0
FROZEN, ACTIVE_ON_MATCH, INACTIVE_ON_MATCH, TOGGLE, FORCED_INACTIVE, FORCED_ACTIVE, PWM1, PWM2 = range(8)
DEAD_TIME, LOCK, OFF_STATE_IDLE, OFF_STATE_RUN, BREAK_ENABLED, BREAK_ACTIVE_HIGH, AUTOMATIC, MAIN = (
    0xFF, 3 << 8, 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15,
)  # fmt: skip
# What the lock freezes (RM0090 17.4.18): from level 1 the break's set-up and CR2's idle levels, from level 2 CCER's
# polarities, at level 3 CCMR's modes.
BREAK_SET_UP = DEAD_TIME | BREAK_ENABLED | BREAK_ACTIVE_HIGH | AUTOMATIC
IDLE_LEVELS, POLARITIES = 0xFF00, 0xAAAA
# A channel's byte of CCMR: its selection and preload; modes (with their fourth bits, 16 higher) and preloads of both.
SELECTION, PRELOAD, MODES_AND_PRELOADS = 0b11, 1 << 3, 0x0101_7878


class Outputs:
    def __init__(self, timer):
        self.timer = timer
        self.modes = {CCMR1: 0, CCMR2: 0}
        self.enables = self.main = self.sources = 0
        self.is_lock_written = False
        # The references of the modes that keep them between matches.
        self.references = [False] * timer.facts.channels

    def mode(self, channel):
        register = self.modes[CCMR1 if channel < 2 else CCMR2]
        return register >> 8 * (channel & 1) + 4 & 7 | (register >> 8 * (channel & 1) + 16 & 1) << 3

    def byte(self, channel):
        """A channel's byte of CCMR."""
        return self.modes[CCMR1 if channel < 2 else CCMR2] >> 8 * (channel & 1) & 0xFF

    def is_input(self, channel):
        return bool(self.byte(channel) & SELECTION)

    def preloads(self, channel):
        return not self.is_input(channel) and bool(self.byte(channel) & PRELOAD)

    def is_used(self, channel):
        return not self.is_input(channel) and bool(self.enables >> 4 * channel & 0b101)

    def has_main(self):
        return self.timer.facts.complementary > 0

    # --- levels

    def reference(self, channel):
        """OCxREF."""
        mode, timer = self.mode(channel), self.timer
        if mode in (FORCED_INACTIVE, FORCED_ACTIVE):
            return mode == FORCED_ACTIVE
        if mode in (PWM1, PWM2):
            return (timer.count() < timer.compare[channel]) == (mode == PWM1)
        return self.references[channel]

    def match(self, channel):
        mode = self.mode(channel)
        if mode in (ACTIVE_ON_MATCH, INACTIVE_ON_MATCH):
            self.references[channel] = mode == ACTIVE_ON_MATCH
        elif mode == TOGGLE:
            self.references[channel] = not self.references[channel]

    def level(self, name):
        """What an output ("3", "3N") drives: 0, 1, or None while the timer leaves the pin to the GPIO (Hi-Z)."""
        channel, is_complement = int(name[0]) - 1, name.endswith("N")
        bits = self.enables >> 4 * channel & 15
        own, other = (bits & 4, bits & 1) if is_complement else (bits & 1, bits & 4)
        inverted = bool(bits & (8 if is_complement else 2))
        if not self.has_main():
            return int(self.reference(channel) != inverted) if own else None
        # A timer that the debug unit has stopped behaves as if MOE were 0 (RM0090 38.16.2, RM0440 47.16.2).
        if not self.main & MAIN or self.timer.is_frozen:
            if not self.main & OFF_STATE_IDLE or not (own or other):
                return None
            return self.timer.control2 >> 8 + 2 * channel + is_complement & 1
        if not own:
            return int(inverted) if other and self.main & OFF_STATE_RUN else None
        # With both outputs on, one is the complement of the other; alone, OCxN follows OCxREF itself (RM0090 17.3.11).
        is_opposite = is_complement and bool(other)
        return int((self.reference(channel) != is_opposite) != inverted)

    def show(self):
        self.timer.board.pins.show_timer(self.timer.number)

    # --- break

    def is_break_input_active(self):
        """Whether the break input has its active level, and the break is enabled."""
        is_admitted = not self.timer.facts.gated or self.sources & BREAK_PIN
        level = is_admitted and self.timer.board.pins.break_level(self.timer.number)
        return bool(self.main & BREAK_ENABLED) and bool(level) == bool(self.main & BREAK_ACTIVE_HIGH)

    def break_in(self, by_program):
        """Switches the main output off if the timer has a break and it is enabled; the program's own break (EGR.BG)
        needs no enabling. Returns whether it did."""
        if not self.has_main() or not (by_program or self.main & BREAK_ENABLED):
            return False
        self.main &= ~MAIN
        return True

    def update(self):
        """An update event."""
        if self.main & AUTOMATIC and not self.is_break_input_active():
            self.main |= MAIN

    # --- registers

    def lock(self):
        return (self.main & LOCK) >> 8

    def locked_control(self, old, value):
        """CR2 after a write of it: the idle levels may be locked."""
        return old & IDLE_LEVELS | value & ~IDLE_LEVELS if self.lock() >= 1 else value

    def read(self, offset):
        known = self.modes | {CCER: self.enables}
        if self.has_main():
            known[BDTR] = self.main
        if self.timer.facts.gated:
            known[AF1] = self.sources
        assert offset in known, f"TIM{self.timer.number} has no modelled register {offset:#x}"
        return known[offset]

    def write(self, offset, value):
        if offset in self.modes:
            channels = [channel for channel in range(2 * (offset == CCMR2), 2 * (offset == CCMR2) + 2)]
            for place, channel in enumerate(channels):
                byte, was = value >> 8 * place & 0xFF, self.byte(channel)
                if byte & SELECTION:
                    Inputs.check(byte, f"TIM{self.timer.number}")
                is_on = self.enables >> 4 * channel & 1
                assert not is_on or byte & SELECTION == was & SELECTION, "a channel that is on keeps its selection"
            held = {channel: self.reference(channel) for channel in channels if channel < self.timer.facts.channels}
            frozen = MODES_AND_PRELOADS if self.lock() == 3 else 0
            self.modes[offset] = self.modes[offset] & frozen | value & ~frozen
            for channel, reference in held.items():
                if self.is_input(channel):
                    continue
                assert self.mode(channel) < 8, "only the eight basic compare modes are modelled"
                self.references[channel] = reference
                if not self.preloads(channel):
                    self.timer.compare[channel] = self.timer.next_compare[channel]
        elif offset == CCER:
            frozen = POLARITIES if self.lock() >= 2 else 0
            self.enables = self.enables & frozen | value & ~frozen
            for channel in range(self.timer.facts.channels):
                is_falling = self.enables >> 4 * channel & FALLING
                assert not (self.is_input(channel) and is_falling), "only captures of rising edges are modelled"
        elif offset == BDTR and self.has_main():
            self.write_break(value)
        elif offset == AF1 and self.timer.facts.gated:
            assert not value & ~BREAK_PIN, "of the break's sources only its pin is modelled"
            if self.lock() == 0:
                self.sources = value
        else:
            raise AssertionError(f"TIM{self.timer.number} has no modelled register {offset:#x}")

    def write_break(self, value):
        """BDTR. The lock takes effect with the write that sets it, for the writes after it, and is set once."""
        frozen = BREAK_SET_UP if self.lock() >= 1 else 0
        frozen |= OFF_STATE_IDLE | OFF_STATE_RUN if self.lock() >= 2 else 0
        frozen |= LOCK if self.is_lock_written else 0
        self.main = self.main & frozen | value & ~frozen
        self.is_lock_written = True
        if self.is_break_input_active():
            self.timer.break_in()
