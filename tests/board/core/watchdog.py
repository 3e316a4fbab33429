"""The independent watchdog (RM0090 chapter 21, RM0440 chapter 42, RM0433 chapter 45), on an oscillator of its own."""

KR, PR, RLR, SR, WINR = 0x00, 0x04, 0x08, 0x0C, 0x10
RELOAD_KEY, UNLOCK_KEY, START_KEY = 0xAAAA, 0x5555, 0xCCCC
NO_WINDOW = 0xFFF


class Watchdog:
    # Nominal; the data sheets' limits are wide (17 to 47 kHz on the F407).
    oscillator_hz = 32_000

    def __init__(self, board):
        self.board = board
        self.generation = 0
        self.reset()

    def reset(self):
        self.generation += 1
        self.prescaler, self.reload, self.is_running, self.is_open = 0, 0xFFF, False, False
        self.fed = 0
        # When it bites, and while it is frozen: in how many seconds it will.
        self.due = self.left = None

    def period(self):
        return (self.reload + 1) * (4 << min(self.prescaler, 6)) / self.oscillator_hz

    def freeze(self, is_frozen):
        """A debugger has halted the core, and the debug unit stops the watchdog with it, or lets it go on."""
        if is_frozen and self.left is None and self.due is not None:
            self.left = self.due - self.board.seconds
            self.generation += 1
        elif not is_frozen and self.left is not None:
            self.plan(self.left)
            self.left = None

    def plan(self, seconds):
        self.generation += 1
        self.due = self.board.seconds + seconds
        self.board.at(self.due * self.board.CORE_HZ, self.bite, self.generation)

    def read(self, offset):
        known = {KR: 0, PR: self.prescaler, RLR: self.reload, SR: 0, WINR: NO_WINDOW}
        assert offset in known, f"the watchdog has no register {offset:#x}"
        return known[offset]

    def write(self, offset, value):
        if offset == KR:
            self.is_open = value == UNLOCK_KEY
            if value == START_KEY:
                self.is_running = True
            if value in (RELOAD_KEY, START_KEY) and self.is_running:
                self.fed += 1
                self.plan(self.period())
        elif offset == PR and self.is_open:
            self.prescaler = value & 7
        elif offset == RLR and self.is_open:
            self.reload = value & 0xFFF
        else:
            assert offset == WINR and value == NO_WINDOW, f"the watchdog's register {offset:#x} is locked"

    def bite(self, generation):
        if generation == self.generation:
            self.board.reset("watchdog")
