"""The debug unit (DBGMCU): the chip's identity, and what stands still while a debugger has halted the core.

Its registers survive every reset but power-on (RM0090 38.16.3, RM0440 47.16.3, RM0433 60.5.8).
"""

CR = 0x04
WATCHDOG = "watchdog"


class Debug:
    """`freezes`: timer's number or `WATCHDOG` -> the register's offset and the bit that freezes it."""

    def __init__(self, board, identity, freezes):
        self.board, self.identity, self.freezes = board, identity, freezes
        self.power_on()

    def power_on(self):
        self.registers = {register: 0 for register, _ in self.freezes.values()} | {CR: 0, 0: self.identity}

    def is_frozen(self, what):
        register, bit = self.freezes.get(what, (CR, 31))
        return self.board.is_halted and bool(self.registers[register] >> bit & 1)

    def show(self):
        """The core has been halted or goes on, or a freeze bit has changed."""
        for number, timer in self.board.timers.items():
            timer.freeze(self.is_frozen(number))
        self.board.watchdog.freeze(self.is_frozen(WATCHDOG))

    def read(self, offset):
        assert offset in self.registers, f"DBGMCU has no modelled register {offset:#x}"
        return self.registers[offset]

    def write(self, offset, value):
        assert offset in self.registers and offset, f"DBGMCU has no modelled register {offset:#x}"
        self.registers[offset] = value
        self.show()
