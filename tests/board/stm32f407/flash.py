"""The flash's registers: unlock, sector erase, programming of words (RM0090 chapter 3).

The memory itself is Unicorn's; a store into it is checked and counted by `programmed`. Bits only fall: what is stored
is the old word AND the new one. A power cut may be ordered at any operation, and leaves the sector or the word torn.
"""
from core import flash
from core.flash import CACHES_DATA, LOCK

BASE, START, SIZE = 0x40023C00, 0x08000000, 1 << 20
ACR, KEYR, OPTKEYR, SR, CR, OPTCR = 0x00, 0x04, 0x08, 0x0C, 0x10, 0x14
PROGRAM, ERASE, BEGIN = 1 << 0, 1 << 1, 1 << 16
# OPTCR (3.9.9): lock and start, which are no option bits; and the option bits with brown-out level 3.
OPTIONS_LOCK, OPTIONS_BEGIN = 1 << 0, 1 << 1
BROWN_OUT_LEVEL_3 = 0x0FFFAAE0
# What erased option bytes say, with read protection level 1. Their sector takes as long as one of 16 KiB: no data sheet has a time.
ERASED_OPTIONS = 0x0FFFFFEC
# The longest that a sector takes, by its size and by PSIZE (CR bits 9 and 8: 8, 16, 32, 64 bits at a time; DS8626 Rev 12, table
# 40); a word in 16 us.
ERASE_SECONDS = {0x4000: (0.8, 0.6, 0.5, 0.5), 0x10000: (2.4, 1.4, 1.1, 1.1), 0x20000: (4.0, 2.6, 2.0, 2.0)}
PROGRAM_SECONDS = 16e-6


def sector(number):
    """Start address and size of a sector."""
    if number < 4:
        return START + number * 0x4000, 0x4000
    return (START + 0x10000, 0x10000) if number == 4 else (START + (number - 4) * 0x20000, 0x20000)


class Flash(flash.Flash):
    BROWN_OUT, RDP = 0b11 << 2, 8

    def __init__(self, board):
        self.torn = []
        # The option bytes outlive every reset.
        self.options = BROWN_OUT_LEVEL_3
        super().__init__(board)

    def reset(self):
        super().reset()
        self.access = 0

    def sector_at(self, address):
        return next((start, size) for start, size in map(sector, range(12)) if start <= address < start + size)

    def programmed(self, address, size, value):
        """The processor stores into the flash; called before the memory changes."""
        assert self.control & PROGRAM and not self.control & LOCK, f"a store into locked flash at {address:#x}"
        assert size == 4 == 1 << (self.control >> 8 & 3), "a store is as wide as PSIZE says (RM0090 3.6.4)"
        assert not self.is_cache_stale, "the data cache holds what was erased (RM0090 3.6.4)"
        old = int.from_bytes(self.board.cpu.mem_read(address, 4), "little")
        is_cut = self.cut()
        missing = 0xFFFFFFFF if self.is_cut_clean else self.missing
        self.torn.append((address, old & (value | missing) if is_cut else old & value))
        self.board.stall(PROGRAM_SECONDS)
        if is_cut:
            self.settle()
            self.board.cut_power()

    def settle(self):
        """Puts what stores have left in place; the processor's own store has overwritten it."""
        for address, word in self.torn:
            self.board.cpu.mem_write(address, word.to_bytes(4, "little"))
        self.torn.clear()

    def read(self, offset):
        self.settle()
        options = self.loaded | (OPTIONS_LOCK if self.are_options_locked else 0)
        known = {ACR: self.access, SR: 0, CR: self.control, OPTCR: options}
        assert offset in known, f"FLASH has no modelled register {offset:#x} that can be read"
        return known[offset]

    def write(self, offset, value):
        self.settle()
        if offset == ACR:
            self.write_access(value)
        elif offset == KEYR:
            self.write_key(value)
        elif offset == OPTKEYR:
            self.write_option_key(value)
        elif offset == OPTCR:
            self.write_options(value)
        elif offset == CR:
            assert not self.control & LOCK or value & LOCK, "the flash's control is locked"
            self.control = value & ~BEGIN
            if value & ERASE and value & BEGIN:
                self.erase(value >> 3 & 15)

    def write_options(self, value):
        """OPTCR holds what is to be programmed; its start erases the option bytes' sector and programs all of them (3.6.5)."""
        assert not self.are_options_locked, "the option bytes are locked"
        self.loaded = value & ~(OPTIONS_LOCK | OPTIONS_BEGIN)
        if value & OPTIONS_BEGIN:
            self.board.stall(ERASE_SECONDS[0x4000][self.control >> 8 & 3])
            self.program_options(self.loaded, ERASED_OPTIONS)
        self.are_options_locked = bool(value & OPTIONS_LOCK)

    def erase(self, number):
        start, size = sector(number)
        is_cut = self.cut()
        # A torn erasure leaves half of the sector as it was.
        erased = size if not is_cut else 0 if self.is_cut_clean else size // 2
        self.board.cpu.mem_write(start, b"\xff" * erased)
        self.board.note("erase", number)
        self.is_cache_stale = bool(self.access & CACHES_DATA)
        self.board.stall(ERASE_SECONDS[size][self.control >> 8 & 3])
        if is_cut:
            self.board.cut_power()
