"""Timers: up-counting, update event, TRGO on update, compare interrupts (RM0090 chapters 17 to 20)."""

CR1, CR2, DIER, SR, EGR, CNT, PSC, ARR, CCR1 = 0x00, 0x04, 0x0C, 0x10, 0x14, 0x24, 0x28, 0x2C, 0x34
ENABLED, UPDATE_FROM_OVERFLOW_ONLY = 1 << 0, 1 << 2
TRGO_ON_UPDATE = 0b010
APB2 = 0x40010000

# number: (base address, interrupt, bits)
TIMERS = {
    2: (0x40000000, 28, 32), 3: (0x40000400, 29, 16), 4: (0x40000800, 30, 16), 5: (0x40000C00, 50, 32),
    6: (0x40001000, 54, 16), 7: (0x40001400, 55, 16), 12: (0x40001800, 43, 16), 14: (0x40002000, 45, 16),
}  # fmt: skip


class Timer:
    def __init__(self, board, number):
        self.board, self.number = board, number
        self.base, self.irq, bits = TIMERS[number]
        self.max = (1 << bits) - 1
        self.other = {}
        self.generation = 0
        # Update events that the next planned one stands for.
        self.periods = 1
        self.counted, self.since = 0, 0.0
        self.reload, self.prescaler = self.max, 0
        self.status = self.interrupts = self.control1 = self.control2 = 0
        self.compare = [0] * 4

    def cycles_per_count(self):
        clock = self.board.APB2_TIMER_HZ if self.base >= APB2 else self.board.APB1_TIMER_HZ
        return (self.prescaler + 1) * self.board.CORE_HZ / clock

    def position(self):
        """The counter now, with its fraction."""
        if not self.control1 & ENABLED:
            return self.counted
        return (self.counted + (self.board.now - self.since) / self.cycles_per_count()) % (self.reload + 1)

    def hold(self):
        self.counted, self.since = self.position(), self.board.now

    def schedule(self):
        """Plans the next update and compares; earlier plans lapse."""
        self.generation += 1
        self.periods = 1
        if not self.control1 & ENABLED or self.reload == 0:
            return
        position, tick = self.position(), self.cycles_per_count()
        self.board.at(self.board.now + (self.reload + 1 - position) * tick, self.update, self.generation)
        for channel in range(4):
            if self.interrupts & (2 << channel):
                ahead = (self.compare[channel] - position) % (self.reload + 1)
                self.board.at(self.board.now + max(ahead * tick, 1), self.match, self.generation, channel)

    def update(self, generation):
        if generation != self.generation:
            return
        self.status |= 1
        periods, self.periods = self.periods, 1
        if (self.control2 >> 4) & 7 == TRGO_ON_UPDATE:
            for _ in range(periods):
                self.board.dac.trigger(self.number)
            if self.board.is_hasty:
                self.periods = self.board.dac.triggers_until_flag()
        when = self.board.now + self.periods * (self.reload + 1) * self.cycles_per_count()
        self.board.at(when, self.update, generation)
        self.raise_interrupt()

    def match(self, generation, channel):
        if generation != self.generation:
            return
        self.status |= 2 << channel
        self.raise_interrupt()
        self.board.at(self.board.now + (self.reload + 1) * self.cycles_per_count(), self.match, generation, channel)

    def is_pending(self):
        return bool(self.status & self.interrupts & 0x5F)

    def raise_interrupt(self):
        if self.is_pending():
            self.board.pend(self.irq)

    def read(self, offset):
        known = {
            CR1: self.control1, CR2: self.control2, DIER: self.interrupts, SR: self.status, CNT: int(self.position()),
            PSC: self.prescaler, ARR: self.reload,
        }  # fmt: skip
        if CCR1 <= offset < CCR1 + 16:
            return self.compare[(offset - CCR1) // 4]
        return known.get(offset, self.other.get(offset, 0))

    def write(self, offset, value):
        self.other[offset] = value
        if offset == CR1:
            self.hold()
            self.control1 = value
        elif offset == CR2:
            self.control2 = value
            return
        elif offset == DIER:
            self.hold()
            self.interrupts = value
        elif offset == SR:
            self.status &= value
            return
        elif offset == EGR:
            if value & 1:
                self.counted, self.since = 0, self.board.now
                self.status |= 0 if self.control1 & UPDATE_FROM_OVERFLOW_ONLY else 1
            self.status |= value & 0x1E
        elif offset == CNT:
            self.counted, self.since = value, self.board.now
        elif offset == PSC:
            self.hold()
            self.prescaler = value & 0xFFFF
        elif offset == ARR:
            self.hold()
            self.reload = value & self.max
        elif CCR1 <= offset < CCR1 + 16:
            self.hold()
            self.compare[(offset - CCR1) // 4] = value & self.max
        else:
            return
        self.schedule()
        self.raise_interrupt()
