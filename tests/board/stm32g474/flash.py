"""The STM32G474's flash (RM0440 chapter 3): two banks of pages of 2 KiB, double words with error correction.

The bank that is not erased or written can be read meanwhile, so the processor goes on and asks whether the flash is busy.
A double word that a power cut has torn has a double error: reading it sets ECCD and raises the NMI (3.3.2).
"""
from core.flash import CACHES_DATA, LOCK, EccFlash

BASE, START, SIZE, BANK, PAGE = 0x40022000, 0x08000000, 1 << 19, 1 << 18, 1 << 11
ACR, KEYR, OPTKEYR, SR, CR, ECCR, OPTR = 0x00, 0x08, 0x0C, 0x10, 0x14, 0x18, 0x20
PROGRAM, ERASE, SECOND_BANK, BEGIN = 1 << 0, 1 << 1, 1 << 11, 1 << 16
OPTIONS_BEGIN, OPTIONS_LOAD, OPTIONS_LOCK = 1 << 17, 1 << 27, 1 << 30
FINISHED, PROGRAM_ERROR, SIZE_ERROR, SEQUENCE_ERROR, BUSY = 1 << 0, 1 << 3, 1 << 6, 1 << 7, 1 << 16
CORRECTED, DOUBLE_ERROR = 1 << 30, 1 << 31
# As delivered (two banks), with brown-out level 4.
OPTIONS = 0xFFEFF8AA & ~0x700 | 0x400
# What erased option bytes are loaded as, since they do not match their complements (3.4.1): read protection level 1, BOR_LEV = 000, all
# other bits set. That the write erases them first is not in the manual in so many words.
ERASED_OPTIONS = 0xFFFFFFFF & ~0x700
# The longest (DS12288 Rev 6, table 47).
ERASE_SECONDS, PROGRAM_SECONDS = 24.5e-3, 100e-6
WORD = 8


class Flash(EccFlash):
    WORD, START, SIZE, SECTOR = WORD, START, SIZE, PAGE
    BROWN_OUT, RDP = 0x700, 0
    # The option bytes, which outlive every reset.
    options = OPTIONS

    def reset(self):
        super().reset()
        self.access, self.status, self.ecc = 0x00040600, 0, 0
        self.half = None

    def loads_options(self, cause):
        """Not a system reset (RM0440 3.4.2)."""
        return cause in ("power", "brown-out", "options")

    def programmed(self, address, size, value):
        """The processor stores into the flash; called before the memory changes."""
        self.check_idle()
        assert self.control & PROGRAM and not self.control & LOCK, f"a store into locked flash at {address:#x}"
        assert size == 4, "a double word is written as two words (RM0440 3.3.7)"
        assert not self.is_cache_stale, "the data cache holds what was erased (RM0440 3.3.6)"
        if self.half is None:
            assert address % WORD == 0, "the first word of a double word comes first"
            self.half = address, value
            self.keep(address, 4)
            return
        first, low = self.half
        assert address == first + 4, "the second word of a double word follows the first"
        self.half = None
        self.program(first, low.to_bytes(4, "little") + value.to_bytes(4, "little"), PROGRAM_SECONDS)

    def erased_first(self):
        """A double word that is not erased can only be overwritten with zeros (RM0440 3.3.7)."""
        self.status |= PROGRAM_ERROR

    def read(self, offset):
        self.settle()
        if offset == SR:
            return self.status | (BUSY if self.is_busy() else 0)
        control = self.control | (OPTIONS_LOCK if self.are_options_locked else 0)
        known = {ACR: self.access, CR: control, ECCR: self.ecc, OPTR: self.loaded}
        assert offset in known, f"FLASH has no modelled register {offset:#x} that can be read"
        return known[offset]

    def write(self, offset, value):
        self.settle()
        if offset == ACR:
            self.write_access(value)
        elif offset == KEYR:
            self.write_key(value)
        elif offset == SR:
            self.status &= ~value
        elif offset == ECCR:
            self.ecc &= ~(value & (CORRECTED | DOUBLE_ERROR))
        elif offset == CR:
            self.check_idle()
            assert not self.control & LOCK or value & LOCK, "the flash's control is locked"
            self.control = value & ~(BEGIN | OPTIONS_BEGIN | OPTIONS_LOAD | OPTIONS_LOCK)
            if value & ERASE and value & BEGIN:
                self.erase_page(value >> 3 & 127, bool(value & SECOND_BANK))
            self.control_options(value)
        elif offset == OPTKEYR:
            assert not self.control & LOCK, "the flash's control is locked"
            self.write_option_key(value)
        elif offset == OPTR:
            assert not self.are_options_locked, "the option bytes are locked"
            self.loaded = value
        else:
            raise AssertionError(f"FLASH has no modelled register {offset:#x} that can be written")

    def control_options(self, value):
        """OPTSTRT, OBL_LAUNCH and OPTLOCK (RM0440 3.4.2, 3.7.5)."""
        if value & OPTIONS_BEGIN:
            assert not self.status & (PROGRAM_ERROR | SIZE_ERROR | SEQUENCE_ERROR), "errors are cleared first"
            self.program_options(self.loaded, ERASED_OPTIONS)
            self.busy_until = self.board.now + ERASE_SECONDS * self.board.CORE_HZ
        if value & OPTIONS_LOAD:
            assert not self.are_options_locked, "the option bytes are locked"
            self.board.reset("options")
            return
        self.are_options_locked |= bool(value & OPTIONS_LOCK) or bool(value & LOCK)

    def erase_page(self, page, is_second):
        assert not self.status & (PROGRAM_ERROR | SIZE_ERROR | SEQUENCE_ERROR), "errors are cleared first (RM0440 3.3.6)"
        self.is_cache_stale = bool(self.access & CACHES_DATA)
        self.erase(START + is_second * BANK + page * PAGE, PAGE, ERASE_SECONDS)

    def read_torn(self, address):
        """ECCD rises only while no other error stands (RM0440 3.7.7); the NMI comes with it."""
        if not self.ecc & (CORRECTED | DOUBLE_ERROR):
            self.ecc = DOUBLE_ERROR | (address - START) % BANK // WORD | (1 << 21 if address >= START + BANK else 0)
        self.board.nvic.nmi_due = True

    def is_nmi_held(self):
        return bool(self.ecc & DOUBLE_ERROR)
