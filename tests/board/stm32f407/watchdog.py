"""The independent watchdog (RM0090 chapter 21) on a 32 kHz oscillator."""

BASE = 0x40003000
KR, PR, RLR = 0x00, 0x04, 0x08
RELOAD_KEY, UNLOCK_KEY, START_KEY = 0xAAAA, 0x5555, 0xCCCC
OSCILLATOR_HZ = 32_000


class Watchdog:
    def __init__(self, board):
        self.board = board
        self.prescaler, self.reload, self.is_running, self.is_open = 0, 0xFFF, False, False
        self.generation = self.fed = 0

    def period(self):
        return (self.reload + 1) * (4 << self.prescaler) / OSCILLATOR_HZ

    def read(self, offset):
        return {PR: self.prescaler, RLR: self.reload}.get(offset, 0)

    def write(self, offset, value):
        if offset == KR:
            self.is_open = value == UNLOCK_KEY
            if value == START_KEY:
                self.is_running = True
            if value in (RELOAD_KEY, START_KEY) and self.is_running:
                self.fed += 1
                self.generation += 1
                self.board.at(self.board.now + self.period() * self.board.CORE_HZ, self.bite, self.generation)
        elif offset == PR and self.is_open:
            self.prescaler = value & 7
        elif offset == RLR and self.is_open:
            self.reload = value & 0xFFF

    def bite(self, generation):
        if generation == self.generation:
            self.board.reset("watchdog")
