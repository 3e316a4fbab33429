"""The GPIO ports: modes, levels, alternate functions, lock (RM0090 chapter 8, RM0440 chapter 9, RM0433 chapter 11).

`Pins.level` is the level that the chip itself drives. It is None for a pin that it does not drive: there the wiring decides. The program
reads the level that drives the pin from outside (`drive`), else the level to which a resistor on the board pulls it (`resistors`), else
that of the chip's own resistor; or, where a test has wired one (`wire`), what a resistor and a capacitor make of that. A wire from one pin
to another (`connect`) drives the second from outside; a pin with a short (`shorts`) reads the same whatever drives it.
"""

from .load import Load

MODER, OTYPER, OSPEEDR, PUPDR, IDR, ODR, BSRR, LCKR, AFRL, AFRH, BRR = range(0x00, 0x2C, 4)
INPUT, OUTPUT, ALTERNATE, ANALOGUE = range(4)
LOCK_KEY, PULLED_UP = 1 << 16, 0b01
# What the lock freezes, by the bits that a pin has in the register.
LOCKED = {MODER: 2, OTYPER: 1, OSPEEDR: 2, PUPDR: 2, AFRL: 4, AFRH: 4}


class Port:
    def __init__(self, pins, letter, reset):
        self.pins, self.letter = pins, letter
        self.reset_values = {MODER: 0, OSPEEDR: 0, PUPDR: 0} | reset
        self.reset()

    def reset(self):
        self.registers = {offset: 0 for offset in (OTYPER, ODR, AFRL, AFRH)} | self.reset_values
        self.locked, self.key = 0, []
        self.pins.show(self.letter)

    def read(self, offset):
        if offset == IDR:
            return sum(self.pins.read(f"P{self.letter}{number}") << number for number in range(16))
        if offset == LCKR:
            self.lock_read()
            return self.locked | (LOCK_KEY if self.locked else 0)
        assert offset in self.registers, f"GPIO{self.letter} has no register {offset:#x} that can be read"
        return self.registers[offset]

    def write(self, offset, value):
        if offset in (BSRR, BRR):
            output = self.registers[ODR]
            value = output & ~(value >> 16) | value & 0xFFFF if offset == BSRR else output & ~value
            offset = ODR
        if offset == LCKR:
            self.lock_write(value)
            return
        assert offset in self.registers, f"GPIO{self.letter} has no register {offset:#x} that can be written"
        frozen = self.frozen(offset)
        value = self.registers[offset] & frozen | value & ~frozen
        if value != self.registers[offset]:
            self.registers[offset] = value
            self.pins.show(self.letter)

    def frozen(self, offset):
        """The bits of a register that the lock keeps."""
        if not self.locked or offset not in LOCKED:
            return 0
        width, first = LOCKED[offset], 8 if offset == AFRH else 0
        pins = range(8 if width == 4 else 16)
        return sum(((1 << width) - 1) << width * pin for pin in pins if self.locked >> first + pin & 1)

    # The sequence (RM0090 8.4.8): write 1 + pins, 0 + pins, 1 + pins with the same pins, then read.

    def lock_write(self, value):
        if self.locked:
            return
        self.key = (self.key + [value & 0x1FFFF])[-3:]

    def lock_read(self):
        if len(self.key) == 3:
            pins = self.key[0] & 0xFFFF
            if self.key == [LOCK_KEY | pins, pins, LOCK_KEY | pins]:
                self.locked = pins
        self.key = []


class Pins:
    """All ports. `alternates` says what a pin's alternate function is: (pin, number) -> (timer, output), (timer, "IN" and
    the input's channel), (timer, "BKIN"), or a text."""

    def __init__(self, board, alternates, resets, resistors):
        self.board, self.alternates = board, alternates
        self.levels = {}
        # By pin: what drives it from outside, and the level to which a resistor on the board pulls it.
        self.outside, self.resistors = {}, dict(resistors)
        # By pin: what a test has wired there; the pin at the other end of a wire; the level of a short.
        self.loads, self.wires, self.shorts = {}, {}, {}
        # By pin that has been asked for: the timer's output that drives it, and whether as an open drain. Until a port changes.
        self.drivers = {}
        self.by_timer = {}
        for (name, _), use in alternates.items():
            if isinstance(use, tuple):
                self.by_timer.setdefault(use[0], []).append(name)
        self.ports = {}
        self.ports = {letter: Port(self, letter, reset) for letter, reset in resets.items()}

    def reset(self):
        """The chip's reset: nothing is driven, and nobody watches that."""
        self.levels.clear()
        for port in self.ports.values():
            port.reset()

    def mode(self, name):
        return self.ports[name[1]].registers[MODER] >> 2 * int(name[2:]) & 3

    def alternate(self, name):
        """What the pin is given to: (timer, output), a text, or None if it is no alternate function."""
        number = int(name[2:])
        if self.mode(name) != ALTERNATE:
            return None
        registers = self.ports[name[1]].registers
        function = registers[AFRL if number < 8 else AFRH] >> 4 * (number % 8) & 15
        known = (name, function) in self.alternates
        assert known, f"alternate function {function} of {name} is not in the model's table"
        return self.alternates[name, function]

    def level(self, name):
        """0, 1, or None while the chip drives nothing."""
        if name not in self.drivers:
            self.drivers[name] = self.driver(name)
        drive, is_open = self.drivers[name]
        level = drive()
        # An open drain drives its low level only.
        return None if is_open and level == 1 else level

    def read(self, name):
        """What the program reads: the level at the pin."""
        if name in self.shorts:
            return self.shorts[name]
        if name in self.loads:
            return self.loads[name].level()
        levels = self.level(name), self.outside.get(name), self.resistors.get(name), int(self.is_pulled_up(name))
        return next(level for level in levels if level is not None)

    def is_pulled_up(self, name):
        return self.ports[name[1]].registers[PUPDR] >> 2 * int(name[2:]) & 3 == PULLED_UP

    def wire(self, name, wiring):
        """From now on this hangs at the pin."""
        self.loads[name] = Load(self.board, wiring)

    def connect(self, output, input):
        """A wire from a pin that the chip drives to one that it reads."""
        self.wires[output] = input
        self.drive(input, self.level(output) or 0)

    def driver(self, name):
        """What gives the level that drives a pin, and whether it is an open drain."""
        registers, number = self.ports[name[1]].registers, int(name[2:])
        mode, drive = self.mode(name), lambda: None
        if mode == OUTPUT:
            level = registers[ODR] >> number & 1
            drive = lambda: level
        elif mode == ALTERNATE and isinstance(self.alternate(name), tuple):
            timer, output = self.alternate(name)
            if not output.startswith(("IN", "BKIN")):
                drive = lambda: self.board.timers[timer].outputs.level(output)
        return drive, registers[OTYPER] >> number & 1

    def drive(self, name, level):
        """Something outside drives a pin."""
        self.outside[name] = level
        use = self.alternate(name) if self.mode(name) == ALTERNATE else None
        if isinstance(use, tuple) and use[1].startswith("IN"):
            self.board.timers[use[0]].inputs.drive(int(use[1][2:]) - 1, level)
        elif isinstance(use, tuple) and use[1] == "BKIN":
            self.board.timers[use[0]].look_at_break()

    def break_level(self, timer):
        """The level at a timer's break input: 0 where no pin is mapped to it (RM0090 17.3.12)."""
        names = [name for name in self.by_timer.get(timer, ()) if self.mode(name) == ALTERNATE and self.alternate(name) == (timer, "BKIN")]
        return self.read(names[0]) if names else 0

    def show(self, letter):
        """Notes what has changed on a port."""
        self.drivers.clear()
        if letter in self.ports:
            for number in range(16):
                self.show_pin(f"P{letter}{number}")
            for (name, _), use in self.alternates.items():
                if name[1] == letter and isinstance(use, tuple) and use[1] == "BKIN" and use[0] in self.board.timers:
                    self.board.timers[use[0]].look_at_break()

    def show_timer(self, timer):
        if timer in self.by_timer:
            for name in self.by_timer[timer]:
                self.show_pin(name)

    def show_pin(self, name):
        level = self.level(name)
        if name in self.loads:
            self.loads[name].change(self.is_pulled_up(name), level)
        if level != self.levels.get(name):
            self.levels[name] = level
            self.board.note(name, level)
            if name in self.wires:
                self.drive(self.wires[name], level or 0)
