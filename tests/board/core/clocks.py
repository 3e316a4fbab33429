"""What the three chips' RCC share: oscillators that take their time, enable and reset bits, the clock security system,
and a clock tree that is computed from the registers and held against the chip's limits.

A chip's own file says where the bits are (`ENABLES`, `RESETS`), and computes the tree (`tree`).
"""
from typing import NamedTuple

# How long a crystal takes to start and a PLL to lock (DS8626 Rev 12, tables 31 and 36: 2 ms, 300 us); an internal
# oscillator is ready in some microseconds.
CRYSTAL_SECONDS, PLL_SECONDS, INTERNAL_SECONDS = 2e-3, 300e-6, 4e-6
HSEON, CSSON = 1 << 16, 1 << 19
# What the dividers' fields of the registers mean; the other values do not divide.
AHB_DIVIDERS = dict(zip(range(8, 16), (2, 4, 8, 16, 64, 128, 256, 512)))
APB_DIVIDERS = {4: 2, 5: 4, 6: 8, 7: 16}


class Tree(NamedTuple):
    """Frequencies in hertz; 0 is a clock that stands still."""

    core: float
    # The bus of core and memories.
    ahb: float
    # The clocks of the peripheral buses, by number, and of their timers.
    apb: dict
    timers: dict
    # What the USB core gets.
    usb: float = 0.0


class Clocks:
    # Page: the register's offset and bit that enable its clock, and those that reset it.
    ENABLES, RESETS = {}, {}
    CR = 0x00
    # Start bit -> (ready bit, seconds until it is ready) in CR.
    OSCILLATORS = {}
    # The crystal's, or what comes in its place.
    HSE_HZ = None

    def __init__(self, board):
        self.board = board
        self.has_crystal = True
        self.reset()

    def reset(self, cause="power"):
        self.registers = self.reset_values() | self.reset_flags(cause)
        self.ready_at = {}
        self.is_failed = False
        self.frequencies = self.tree()

    def timer_hz(self, bus):
        return self.frequencies.timers[bus]

    def is_clocked(self, page):
        """Whether a page's peripheral has its clock; one that is not in the table always has."""
        enable = self.ENABLES.get(page)
        return enable is None or bool(self.registers.get(enable[0], 0) >> enable[1] & 1)

    def hse_hz(self):
        return self.HSE_HZ if self.has_crystal else 0.0

    def check_source(self, start):
        """A switch of the system clock waits until its source is ready; `start` is the bit that switches that on."""
        is_ready = self.is_ready(self.registers[self.CR], start)
        assert is_ready or not self.has_crystal, "the system clock is switched to a source that is not ready"

    def buses(self, ahb, fields):
        """The peripherals' buses and their timers, by number, from their dividers' fields.

        Timers run at the bus's clock if it is not divided, else at twice that (RM0090 7.2, RM0440 7.2.17).
        """
        dividers = {bus: APB_DIVIDERS.get(field & 7, 1) for bus, field in fields.items()}
        apb = {bus: ahb / divider for bus, divider in dividers.items()}
        return apb, {bus: apb[bus] * min(divider, 2) for bus, divider in dividers.items()}

    # --- registers

    def read(self, offset):
        if offset == self.CR:
            return self.with_ready_bits(self.registers[offset])
        assert offset in self.registers, f"RCC's register {offset:#x} is not in the model's table"
        return self.registers[offset]

    def with_ready_bits(self, control):
        for start, (ready, _) in self.OSCILLATORS.items():
            control = control & ~ready | (ready if self.is_ready(control, start) else 0)
        return control

    def is_ready(self, control, start):
        return bool(control & start) and self.ready_at.get(start, 0) <= self.board.now

    def write(self, offset, value):
        assert offset in self.registers, f"RCC's register {offset:#x} is not in the model's table"
        old = self.registers[offset]
        if offset == self.CR:
            self.start_oscillators(old, value)
        self.check_write(offset, old, value)
        self.change({offset: value})
        for page, (register, bit) in self.RESETS.items():
            if register == offset and value >> bit & 1 and page in self.board.pages:
                self.board.pages[page].reset()
        self.limits()

    def start_oscillators(self, old, value):
        for start, (_, seconds) in self.OSCILLATORS.items():
            if value & start and not old & start:
                is_dead = start == HSEON and not self.has_crystal
                self.ready_at[start] = float("inf") if is_dead else self.board.now + seconds * self.board.CORE_HZ

    def change(self, registers):
        """Puts registers in force; what counts goes on at the new pace from here."""
        timers = self.board.timers.values()
        self.registers |= registers
        tree = self.tree()
        if tree != self.frequencies:
            for timer in timers:
                timer.hold()
            self.board.hold_cycles()
            self.frequencies = tree
            self.board.set_core_hz(tree.core)
            for timer in timers:
                timer.schedule()

    # --- clock security (RM0090 7.2.7, RM0440 7.2.10, RM0433 8.5.3)

    def stop_crystal(self):
        """The crystal breaks. With the clock security system on, the internal oscillator takes over, every timer with a
        break gets one, and the NMI comes and stays until the program clears the flag; without, the clock just stops."""
        self.has_crystal = False
        control = self.registers[self.CR]
        if control & CSSON and self.is_ready(control, HSEON):
            self.is_failed = self.board.nvic.nmi_due = True
            self.change(self.fall_back())
            for timer in self.board.timers.values():
                timer.break_in(by_system=True)
        else:
            self.change({})

    def start_crystal(self):
        """The crystal is well again: an oscillator that is on starts, one that is off does when it is switched on."""
        self.has_crystal = True
        if self.registers[self.CR] & HSEON:
            self.ready_at[HSEON] = self.board.now + CRYSTAL_SECONDS * self.board.CORE_HZ

    # --- a chip's own

    def reset_values(self):
        raise NotImplementedError

    def reset_flags(self, cause):
        """The register with the cause of the reset."""
        raise NotImplementedError

    def tree(self):
        raise NotImplementedError

    def limits(self):
        """Fails if the clocks as they are now are beyond what the data sheet allows."""

    def check_write(self, offset, old, value):
        """Fails for a write that the reference manual forbids in this state."""

    def fall_back(self):
        """The registers as the clock security system leaves them."""
        raise NotImplementedError
