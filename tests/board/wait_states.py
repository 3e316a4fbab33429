"""What the flash's wait states add to a run of instructions, behind the accelerator of an STM32F407 or an STM32G474.

Facts (RM0090 Rev 21, 3.5.1 and 3.5.2; RM0440 Rev 8, 3.3.3 to 3.3.5):
- The flash is read a word at a time: 128 bits, or 64 on the G474 with its flash in two banks. That takes one cycle and
  the wait states: 5 on the F407 at 168 MHz and 3 V, 4 on the G474 at 170 MHz in boost mode.
- Instructions are taken from the current word. The word after it is read in advance into a buffer ("prefetch").
- A miss is an instruction that is neither there nor in the instruction cache. What a miss reads is copied into the
  cache, where it replaces what has not been used for longest: 64 lines of 16 bytes, or 32 lines of 32 bytes on the
  G474. Literals and tables have a cache of their own with eight such lines.

Where the manuals say nothing, the worst is assumed:
- A word from the prefetch buffer is no miss, so it is not copied into the cache. The next round of a loop reads it again.
- The flash reads one word at a time, and a prefetch that has begun is finished first, even after a jump.
- The caches are empty when an interrupt begins, and its vector is read from the flash.

RAM has no wait states, but each RAM serves one access at a time. So code in RAM loses a cycle for each access to data in
the same RAM. Code at 0x20000000 and above loses one cycle more for each four bytes: the system bus registers the address
of a fetch (Cortex-M4 TRM r0p1, 2.3.1).
"""
from collections import OrderedDict
from typing import NamedTuple

from m4_timing import REFILL

FLASH = range(0x08000000, 0x08100000)
SYSTEM_BUS = 0x20000000


class Chip(NamedTuple):
    """A chip's flash, sizes in bytes, and its RAMs: by name, all address ranges at which one appears."""

    word: int
    wait_states: int
    has_prefetch: bool
    line: int
    instruction_lines: int
    data_lines: int
    rams: dict

    def ram(self, address):
        """The name of the RAM at an address, or None."""
        return next((name for name, ranges in self.rams.items() if any(address in part for part in ranges)), None)


F407 = Chip(
    word=16, wait_states=5, has_prefetch=True, line=16, instruction_lines=64, data_lines=8,
    rams={
        "CCM": [range(0x10000000, 0x10010000)],
        "SRAM1": [range(0x00000000, 0x0001C000), range(0x20000000, 0x2001C000)],
        "SRAM2": [range(0x2001C000, 0x20020000)],
    },
)  # fmt: skip
# Its prefetch is faulty and stays off (errata sheet ES0182).
F407_REVISION_A = F407._replace(has_prefetch=False)
G474 = Chip(
    word=8, wait_states=4, has_prefetch=True, line=32, instruction_lines=32, data_lines=8,
    rams={
        "SRAM1": [range(0x20000000, 0x20014000)],
        "SRAM2": [range(0x20014000, 0x20018000)],
        "CCM": [range(0x10000000, 0x10008000), range(0x20018000, 0x20020000)],
    },
)  # fmt: skip


class Cache:
    """Lines of some words each. A line is taken word by word, and is dropped as a whole."""

    def __init__(self, lines, words):
        self.lines, self.words, self.held = lines, words, OrderedDict()

    def holds(self, word):
        return word in self.held.get(word // self.words, ())

    def use(self, word):
        self.held.move_to_end(word // self.words)

    def take(self, word):
        line = word // self.words
        self.held.setdefault(line, set()).add(word)
        self.held.move_to_end(line)
        if len(self.held) > self.lines:
            self.held.popitem(last=False)


class Accelerator:
    """The reading side of the flash. `now` is the time in cycles."""

    def __init__(self, chip):
        self.chip, self.now = chip, 0
        self.instructions = Cache(chip.instruction_lines, chip.line // chip.word)
        self.data = Cache(chip.data_lines, chip.line // chip.word)
        self.current = self.prefetched = None
        self.prefetch_ends = self.flash_is_free = 0

    def read(self):
        """Waits for the flash; the last cycle is the instruction's own."""
        self.now = self.flash_is_free = max(self.now, self.flash_is_free) + self.chip.wait_states

    def fetch(self, address):
        """Waits for the instruction at an address."""
        word = address // self.chip.word
        if word == self.current:
            return
        if word == self.prefetched:
            self.now = max(self.now, self.prefetch_ends)
        elif self.instructions.holds(word):
            self.instructions.use(word)
        else:
            self.read()
            self.instructions.take(word)
        self.current = word
        if self.chip.has_prefetch and word + 1 != self.prefetched and not self.instructions.holds(word + 1):
            self.prefetched = word + 1
            self.prefetch_ends = max(self.now, self.flash_is_free) + 1 + self.chip.wait_states
            self.flash_is_free = self.prefetch_ends

    def load(self, address):
        """Waits for the data at an address."""
        word = address // self.chip.word
        if self.data.holds(word):
            self.data.use(word)
        else:
            self.read()
            self.data.take(word)


def cycles(steps, timing, chip, vector):
    """Cycles of the `Step`s of a handler whose vector is at an address: without wait states and with them. Entry and
    exit of the exception are not counted."""
    ideal, flash = 0, Accelerator(chip)
    flash.load(vector)
    previous = fetched = None
    for number, (address, accesses) in enumerate(steps):
        instruction = timing.decode(address)
        ram = chip.ram(address)
        for halfword in range(address, address + instruction.size, 2):
            if halfword in FLASH:
                flash.fetch(halfword)
            elif halfword >= SYSTEM_BUS and halfword // 4 != fetched:
                flash.now += 1
                fetched = halfword // 4
        for access in accesses:
            if access in FLASH:
                flash.load(access)
            elif ram and chip.ram(access) == ram:
                flash.now += 1
        cost = timing.cost(instruction, previous)
        if instruction.jumps and number + 1 < len(steps) and steps[number + 1].address != address + instruction.size:
            cost += REFILL
        ideal += cost
        flash.now += cost
        previous = instruction
    return ideal, flash.now
