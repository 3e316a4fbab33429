"""The STM32H743's flash (RM0433 chapter 4): two banks of sectors of 128 KiB, words of 32 bytes with error correction.

The bank that is not erased or written can be read meanwhile. A word that a power cut has torn has a double error:
reading it sets DBECCERR of its bank, and the bus answers with an error.
"""
from core.flash import KEYS, EccFlash

BASE, START, SIZE, BANK, SECTOR = 0x52002000, 0x08000000, 1 << 21, 1 << 20, 1 << 17
ACR, KEYR, OPTKEYR, CR, SR, CCR, OPTCR, OPTSR_CUR, OPTSR_PRG, OPTCCR = 0x00, 0x04, 0x08, 0x0C, 0x10, 0x14, 0x18, 0x1C, 0x20, 0x24
SECOND = 0x100
LOCK, PROGRAM, ERASE, BEGIN = 1 << 0, 1 << 1, 1 << 2, 1 << 7
BUSY, WAITS_FOR_MORE, QUEUED, FINISHED = 1 << 0, 1 << 1, 1 << 2, 1 << 16
DOUBLE_ERROR = 1 << 26
ERRORS = 0b1111011 << 17 | DOUBLE_ERROR
# OPTCR; a flag of OPTSR_CUR; and how long a change of the option bytes takes here: no data sheet has a time.
OPTIONS_LOCK, OPTIONS_BEGIN, OPTIONS_BUSY, OPTION_SECONDS = 1 << 0, 1 << 1, 1 << 0, 20e-3
# Two banks, not swapped, brown-out level 3.
OPTIONS = 0x1BC6AAF0 | 0b11 << 2
# The longest, by PSIZE (8, 16, 32, 64 bits at a time; DS12110 Rev 10, table 53).
ERASE_SECONDS, PROGRAM_SECONDS = (4.0, 3.6, 2.2, 2.0), (580e-6, 360e-6, 260e-6, 200e-6)
WORD = 32


class Flash(EccFlash):
    WORD, START, SIZE, SECTOR = WORD, START, SIZE, SECTOR
    BROWN_OUT, RDP = 0b11 << 2, 8
    # The option bytes, which outlive every reset.
    options = OPTIONS

    def reset(self):
        super().reset()
        # FLASH_ACR and FLASH_CRx after a reset (RM0433 4.9.1, 4.9.4): seven wait states; locked, PSIZE = 11.
        self.access = 0x37
        self.controls, self.statuses, self.all_keys = [LOCK | 0b11 << 4] * 2, [0, 0], [[], []]
        self.first, self.words = None, []
        # OPTSR_PRG.
        self.ordered = self.options

    def programmed(self, address, size, value):
        """The processor stores into the flash; called before the memory changes."""
        self.check_idle()
        bank = (address - START) // BANK
        control = self.controls[bank]
        assert control & PROGRAM and not control & LOCK, f"a store into locked flash at {address:#x}"
        assert size == 4, "words of 32 bytes are written as eight words of four"
        if self.first is None:
            assert address % WORD == 0, "a flash word begins at a multiple of its size"
            self.first, self.words = address, []
        assert address == self.first + 4 * len(self.words), "the words of a flash word follow each other (INCERR)"
        self.words.append(value.to_bytes(4, "little"))
        if len(self.words) < WORD // 4:
            self.keep(address, 4)
            return
        first, self.first = self.first, None
        self.program(first, b"".join(self.words), PROGRAM_SECONDS[control >> 4 & 3])

    def erased_first(self):
        raise AssertionError("a flash word is programmed twice: its error correction would not fit (RM0433 4.3.9)")

    def read(self, offset):
        self.settle()
        bank, register = divmod(offset, SECOND)
        if register == SR:
            busy = BUSY | QUEUED if self.is_busy() else 0
            return self.statuses[bank] | busy | (WAITS_FOR_MORE if self.first is not None else 0)
        known = {CR: self.controls[bank]}
        if bank == 0:
            busy = OPTIONS_BUSY if register == OPTSR_CUR and self.is_busy() else 0
            lock = OPTIONS_LOCK if self.are_options_locked else 0
            known |= {ACR: self.access, OPTCR: lock, OPTSR_CUR: self.loaded | busy, OPTSR_PRG: self.ordered}
        assert register in known, f"FLASH has no modelled register {offset:#x} that can be read"
        return known[register]

    def write(self, offset, value):
        self.settle()
        bank, register = divmod(offset, SECOND)
        if offset == ACR:
            self.access = value
            self.board.clocks.limits()
        elif offset in (OPTKEYR, OPTCR, OPTSR_PRG, OPTCCR):
            self.write_options(offset, value)
        elif register == KEYR:
            self.all_keys[bank] = (self.all_keys[bank] + [value])[-2:]
            if tuple(self.all_keys[bank]) == KEYS:
                self.controls[bank] &= ~LOCK
        elif register == CCR:
            self.statuses[bank] &= ~value
        elif register == SR:
            # Read only (RM0433 4.9.5); embassy-stm32 0.6 writes it, and nothing happens.
            pass
        elif register == CR:
            self.write_control(bank, value)
        else:
            raise AssertionError(f"FLASH has no modelled register {offset:#x} that can be written")

    def write_options(self, offset, value):
        """A reset or a power cut inside the change keeps the old ones (RM0433 4.4.3)."""
        if offset == OPTKEYR:
            self.write_option_key(value)
        elif offset == OPTSR_PRG:
            assert not self.are_options_locked, "the option bytes are locked"
            self.ordered = value
        elif offset == OPTCR:
            assert not self.are_options_locked, "the option bytes are locked"
            assert not value & ~(OPTIONS_LOCK | OPTIONS_BEGIN), f"FLASH_OPTCR is written with {value:#x}"
            if value & OPTIONS_BEGIN:
                self.program_options(self.ordered, torn=self.options)
                self.loaded = self.options
                self.busy_until = self.board.now + OPTION_SECONDS * self.board.CORE_HZ
            self.are_options_locked = bool(value & OPTIONS_LOCK)

    def write_control(self, bank, value):
        self.check_idle()
        assert not self.controls[bank] & LOCK or value & LOCK, "the flash's control is locked"
        self.controls[bank] = value & ~BEGIN
        if value & ERASE and value & BEGIN:
            assert not self.statuses[bank] & ERRORS, "errors are cleared first (RM0433 4.3.10)"
            self.erase(START + bank * BANK + (value >> 8 & 7) * SECTOR, SECTOR, ERASE_SECONDS[value >> 4 & 3])

    def read_torn(self, address):
        self.statuses[(address - START) // BANK] |= DOUBLE_ERROR
        self.board.bus_fault(address)
