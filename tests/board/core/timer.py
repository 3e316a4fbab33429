"""A timer: counts up, updates, compares, triggers others (RM0090 chapters 17 to 20, RM0440 chapters 28 to 31, RM0433
chapters 38 to 43; the three chips have the same counter).

What the counter does to pins, and the break, is in `outputs` (a second break input, which no image enables, is not modelled); what pins do to
flags in `inputs`. Of the slave modes there is one: another timer's trigger
output as the clock. Switching on an unmodelled mode (counting down, the other slave modes) is a failure.
"""
from typing import NamedTuple

from .inputs import Inputs
from .outputs import Outputs

CR1, CR2, SMCR, DIER, SR, EGR, CNT, PSC, ARR, RCR, CCR1 = (
    0x00, 0x04, 0x08, 0x0C, 0x10, 0x14, 0x24, 0x28, 0x2C, 0x30, 0x34,
)  # fmt: skip
ENABLED, NO_UPDATES, UPDATE_FROM_OVERFLOW_ONLY, ONE_PULSE, PRELOADS_RELOAD = 1 << 0, 1 << 1, 1 << 2, 1 << 3, 1 << 7
DIRECTION_AND_CENTRE = 0b111 << 4
UPDATED, BROKEN, UPDATE_REQUESTS_DMA = 1 << 0, 1 << 7, 1 << 8
# SR.SBIF: a break by the chip's own sources, on the chips whose break pin has a gate (RM0440 and RM0433, TIMx_SR).
SYSTEM_BROKEN = 1 << 13
COMPARED = 0b1111 << 1
TRGO_ON_UPDATE = 0b010
# SMCR: a slave's mode, and where it gets its clock.
EXTERNAL_CLOCK, SLAVE_MODE, SOURCE = 0b111, 0b111, 0b111 << 4


class Facts(NamedTuple):
    """A timer of a chip. `irqs` are the interrupts of update, compare and break; most timers have one for all."""

    base: int
    irqs: tuple
    bits: int = 16
    # The bus that clocks it.
    bus: int = 1
    channels: int = 4
    # Channels with a complementary output; a timer with one has the break, too.
    complementary: int = 0
    # Whether the break input's pin passes a gate (TIMx_AF1.BKINE).
    gated: bool = False
    # Internal triggers: SMCR.TS -> the timer whose trigger output it is.
    masters: dict = {}


class Timer:
    def __init__(self, board, number, facts):
        self.board, self.number, self.facts, self.base = board, number, facts, facts.base
        self.max = (1 << facts.bits) - 1
        self.generation = 0
        # Timers that count this one's trigger outputs, and the one whose outputs this one counts.
        self.slaves, self.master = [], None
        self.is_frozen = False
        update, compare, break_ = (facts.irqs * 3)[:3] if len(facts.irqs) == 1 else facts.irqs
        self.interrupts = {update: 0, compare: 0, break_: 0}
        for irq, flags in ((update, UPDATED), (compare, COMPARED), (break_, BROKEN | SYSTEM_BROKEN)):
            self.interrupts[irq] |= flags
        for irq, flags in self.interrupts.items():
            board.add_line(irq, lambda flags=flags: bool(self.status & self.enabled & flags))
        self.reset()

    def reset(self):
        """As the chip's reset leaves it, or the timer's own reset bit."""
        self.generation += 1
        self.obey(0)
        # Update events that the next planned one stands for.
        self.periods = 1
        self.counted, self.since = 0, self.board.now
        # What the counter uses, and what an update event will load.
        self.reload, self.prescaler, self.repetitions = self.max, 0, 0
        self.next_reload, self.next_prescaler, self.next_repetitions = self.max, 0, 0
        self.status = self.enabled = self.control1 = self.control2 = 0
        self.compare, self.next_compare = [0] * self.facts.channels, [0] * self.facts.channels
        self.outputs, self.inputs = Outputs(self), Inputs(self)
        self.outputs.show()

    # --- counting

    def cycles_per_count(self):
        return (self.prescaler + 1) * self.board.CORE_HZ / self.board.clocks.timer_hz(self.facts.bus)

    def is_counting(self):
        """Whether it counts time."""
        is_running = self.control1 & ENABLED and not self.is_frozen and self.master is None
        return bool(is_running) and self.board.clocks.timer_hz(self.facts.bus) > 0

    def position(self):
        """The counter now, with its fraction."""
        if not self.is_counting():
            return self.counted
        return (self.counted + (self.board.now - self.since) / self.cycles_per_count()) % (self.reload + 1)

    def count(self):
        """The counter's register; the sum of an event's time is rounded, the count is not."""
        return int(self.position() + 1e-6) % (self.reload + 1)

    def hold(self):
        """Before anything changes by which it counts."""
        self.counted, self.since = self.position(), self.board.now

    def schedule(self):
        """Plans the next update and compares; earlier plans lapse."""
        self.generation += 1
        self.periods = 1
        if self.is_counting() and self.reload:
            position, tick = self.position(), self.cycles_per_count()
            self.board.at(self.board.now + (self.reload + 1 - position) * tick, self.overflow, self.generation)
            for channel in range(self.facts.channels):
                if self.enabled & (2 << channel) or self.outputs.is_used(channel):
                    ahead = (self.compare[channel] - position) % (self.reload + 1)
                    self.board.at(self.board.now + max(ahead * tick, 1), self.match, self.generation, channel)

    def freeze(self, is_frozen):
        """A debugger has halted the core, and the debug unit stops this timer with it, or lets it go on."""
        if is_frozen != self.is_frozen:
            self.hold()
            self.is_frozen = is_frozen
            self.schedule()
            self.outputs.show()

    def overflow(self, generation):
        if generation != self.generation:
            return
        if self.repetitions:
            self.repetitions -= 1
            self.plan_overflow()
        elif self.control1 & NO_UPDATES:
            self.plan_overflow()
        else:
            periods, self.periods = self.periods, 1
            self.status |= UPDATED
            loaded = self.load()
            self.update(periods)
            if self.control1 & ONE_PULSE:
                self.control1 &= ~ENABLED
                loaded = True
            if loaded:
                self.counted, self.since = 0, self.board.now
                self.schedule()
            else:
                self.plan_overflow()
        self.outputs.show()
        self.raise_interrupt()

    def plan_overflow(self):
        when = self.board.now + self.periods * (self.reload + 1) * self.cycles_per_count()
        self.board.at(when, self.overflow, self.generation)

    def load(self):
        """An update event puts in force what is buffered; returns whether anything has changed."""
        self.repetitions = self.next_repetitions
        is_same = (
            self.reload == self.next_reload
            and self.prescaler == self.next_prescaler
            and self.compare == self.next_compare
        )
        if not is_same:
            self.reload, self.prescaler = self.next_reload, self.next_prescaler
            self.compare = list(self.next_compare)
        return not is_same

    def update(self, periods=1):
        """What an update event does elsewhere."""
        self.outputs.update()
        if self.enabled & UPDATE_REQUESTS_DMA:
            assert periods == 1 and not self.board.is_hasty, "each update event requests a transfer"
            self.board.request_dma(f"TIM{self.number}_UP")
        if (self.control2 >> 4) & 7 == TRGO_ON_UPDATE:
            for _ in range(periods):
                self.board.dac.trigger(self.number)
                # After the DAC: it samples the DAC's present level.
                self.board.adc.trigger(self.number, periods > 1)
            for slave in self.slaves:
                slave.clock(periods)
            if self.board.is_hasty:
                self.periods = self.board.dac.triggers_until_flag()

    def obey(self, control):
        """SMCR: counts another timer's trigger outputs, or time again."""
        assert control & ~(SLAVE_MODE | SOURCE) == 0, "only the internal triggers 0 to 3 are modelled"
        assert control & SLAVE_MODE in (0, EXTERNAL_CLOCK), "this slave mode is not modelled"
        if self.master:
            self.master.slaves.remove(self)
        self.slave_control, self.master = control, None
        if control & SLAVE_MODE:
            number = self.facts.masters.get((control & SOURCE) >> 4)
            assert number, f"TIM{self.number}'s internal trigger {(control & SOURCE) >> 4} is not in the model's table"
            self.master = self.board.timers[number]
            self.master.slaves.append(self)

    def clock(self, edges):
        """Clocks the counter by `edges` trigger outputs of the master."""
        if not self.control1 & ENABLED or self.is_frozen:
            return
        assert not self.prescaler and not self.enabled, "neither prescaler nor interrupts of a slave are modelled"
        for _ in range(edges):
            self.counted += 1
            if self.counted > self.reload:
                self.status |= UPDATED
                self.load()
                self.counted = 0
                self.update()
            if self.counted == 0 or self.counted in self.compare:
                self.outputs.show()

    def match(self, generation, channel):
        if generation != self.generation:
            return
        self.status |= 2 << channel
        self.outputs.match(channel)
        self.outputs.show()
        self.raise_interrupt()
        self.board.at(self.board.now + (self.reload + 1) * self.cycles_per_count(), self.match, generation, channel)

    def break_in(self, by_program=False, by_system=False):
        """A break: the break input, one of the chip's own sources (a clock failure, the supply, a lock-up), or the program."""
        if self.outputs.break_in(by_program):
            self.status |= SYSTEM_BROKEN if by_system and self.facts.gated else BROKEN
            self.outputs.show()
            self.raise_interrupt()

    def look_at_break(self):
        """The level at the break input has changed."""
        if self.outputs.has_main() and self.outputs.is_break_input_active():
            self.break_in()

    def raise_interrupt(self):
        if self.status & self.enabled:
            for irq, flags in self.interrupts.items():
                if self.status & self.enabled & flags:
                    self.board.pend(irq)

    # --- registers

    def read(self, offset):
        known = {
            CR1: self.control1, CR2: self.control2, SMCR: self.slave_control, DIER: self.enabled, SR: self.status, EGR: 0, CNT: self.count(),
            PSC: self.next_prescaler, ARR: self.next_reload, RCR: self.next_repetitions,
        }  # fmt: skip
        if CCR1 <= offset < CCR1 + 4 * self.facts.channels:
            channel = (offset - CCR1) // 4
            assert not self.outputs.is_input(channel), "a captured count is not modelled"
            return self.next_compare[channel]
        return known[offset] if offset in known else self.outputs.read(offset)

    def write(self, offset, value):
        if offset == SR:
            # The break's flag can be cleared only while the input is not active.
            self.status &= value | (BROKEN if self.outputs.has_main() and self.outputs.is_break_input_active() else 0)
            return
        self.hold()
        if offset == CR1:
            assert not value & DIRECTION_AND_CENTRE, "only counting up is modelled"
            if value & ENABLED and not self.control1 & ENABLED and self.next_prescaler != self.prescaler:
                self.board.note(f"TIM{self.number} starts with an old prescaler")
            self.control1 = value
        elif offset == CR2:
            self.control2 = self.outputs.locked_control(self.control2, value)
        elif offset == SMCR:
            self.obey(value)
        elif offset == DIER:
            self.enabled = value
        elif offset == EGR:
            self.generate(value)
        elif offset == CNT:
            self.counted = value & self.max
        elif offset == PSC:
            # It is always buffered.
            self.next_prescaler = value & 0xFFFF
        elif offset == ARR:
            self.next_reload = value & self.max
            if not self.control1 & PRELOADS_RELOAD:
                self.reload = self.next_reload
        elif offset == RCR:
            self.next_repetitions = value & 0xFFFF
        elif CCR1 <= offset < CCR1 + 4 * self.facts.channels:
            channel = (offset - CCR1) // 4
            assert not self.outputs.is_input(channel), "an input's captured count is read-only"
            self.next_compare[channel] = value & self.max
            if not self.outputs.preloads(channel):
                self.compare[channel] = self.next_compare[channel]
        else:
            self.outputs.write(offset, value)
        self.schedule()
        self.outputs.show()
        self.raise_interrupt()

    def generate(self, value):
        """Events by the program (EGR)."""
        if value & 1 and not self.control1 & NO_UPDATES:
            self.status |= 0 if self.control1 & UPDATE_FROM_OVERFLOW_ONLY else UPDATED
            self.load()
            self.update()
        if value & 1:
            self.counted = 0
        self.status |= value & COMPARED
        if value & BROKEN:
            self.break_in(by_program=True)
