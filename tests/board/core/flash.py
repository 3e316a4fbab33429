"""Flash: what the chips' have in common, the option bytes, and error correction over whole words, as the G4 and the H7 have it.

A word is programmed once, as a whole; the power may go before any operation or in the middle of it, and what is torn then
cannot be corrected when it is read. `operations` counts erasures and words; `cut_at` orders the cut in one, `is_cut_clean`
has it come just before.

Of the option bytes (`options`) a program may change the level of the brown-out reset and nothing else: a wrong word may lock a
chip for ever. Their register (`loaded`) has what was loaded last (`in_force`), or what a program has ordered since.
"""
from unicorn import UC_HOOK_CODE, UC_HOOK_MEM_READ

KEYS, OPTION_KEYS = (0x45670123, 0xCDEF89AB), (0x08192A3B, 0x4C5D6E7F)
UNPROTECTED = 0xAA
# The longest erasure of any chip's flash takes 4 s; the watchdog must wait for as long as the firmware's table of it says.
PATIENT_SECONDS = 1.0

LOCK = 1 << 31
# ACR of the chips that have a data cache (RM0090 3.9.1, RM0440 3.7.1).
CACHES_DATA, RESETS_DATA_CACHE = 1 << 10, 1 << 12


class Flash:
    # The bits of the option bytes that hold the level of the brown-out reset, and where the byte of read protection begins.
    BROWN_OUT = RDP = None

    def __init__(self, board):
        self.board = board
        self.operations = 0
        self.cut_at = None
        self.is_cut_clean = False
        # The bits that a torn word has not got yet.
        self.missing = 0xA5A5A5A5
        self.reset()

    def reset(self):
        self.control, self.keys = LOCK, []
        self.is_cache_stale = False
        self.are_options_locked, self.option_keys = True, []
        if self.loads_options(self.board.resets[-1] if self.board.resets else "power"):
            self.in_force = self.options
        self.loaded = self.in_force

    # --- option bytes

    def loads_options(self, _):
        """Whether a reset of this cause loads the option bytes."""
        return True

    def set_brown_out_bits(self, bits):
        """A chip that was delivered, or set up, like this."""
        self.options = self.loaded = self.in_force = self.options & ~self.BROWN_OUT | bits

    def write_option_key(self, value):
        """OPTKEYR: two keys in a row unlock the option bytes."""
        assert self.are_options_locked, "a key to an open lock closes it until the next reset"
        self.option_keys = (self.option_keys + [value])[-2:]
        self.are_options_locked = tuple(self.option_keys) != OPTION_KEYS

    def program_options(self, wanted, torn):
        """Puts the option bytes into the flash; a power cut inside leaves `torn`. Returns whether the power is gone."""
        assert not self.are_options_locked, "the option bytes are locked"
        changed = wanted ^ self.options
        assert not changed & ~self.BROWN_OUT, f"option bits {changed:#x} are changed; only the level of the brown-out reset may be"
        assert self.options >> self.RDP & 0xFF == UNPROTECTED, "the option bytes of a protected chip are written"
        watchdog = self.board.watchdog
        assert not watchdog.is_running or watchdog.period() > PATIENT_SECONDS, "the watchdog may end the write in its middle"
        is_cut = self.cut()
        self.board.note("options", wanted)
        self.options = wanted if not is_cut else self.options if self.is_cut_clean else torn
        if is_cut:
            self.board.cut_power()
        return is_cut

    def cut(self):
        """Whether the power fails during this operation."""
        self.operations += 1
        return self.cut_at is not None and self.operations > self.cut_at

    def write_access(self, value):
        """ACR: wait states and caches."""
        self.access = value
        if value & RESETS_DATA_CACHE:
            assert not value & CACHES_DATA, "the data cache is reset while it is off"
            self.is_cache_stale = False
        self.board.clocks.limits()

    def write_key(self, value):
        """KEYR: two keys in a row unlock the control register."""
        self.keys = (self.keys + [value])[-2:]
        if tuple(self.keys) == KEYS:
            self.control &= ~LOCK

    def is_nmi_held(self):
        """Whether the flash holds the NMI up."""
        return False


class EccFlash(Flash):
    # The chip's facts: bytes that one code protects, where the flash is, and its sectors (or pages), all of one size.
    WORD = START = SIZE = SECTOR = None

    def __init__(self, board):
        # Addresses of words that cannot be corrected. Watching reads costs time, so it begins with the first.
        self.torn = set()
        self.is_watched = False
        self.changed = []
        super().__init__(board)

    def reset(self):
        super().reset()
        self.busy_until = 0.0

    def sector_at(self, address):
        """Start address and size of the sector in which an address lies."""
        return address // self.SECTOR * self.SECTOR, self.SECTOR

    # --- operations

    def is_busy(self):
        """Asked in a loop: the time until the next event, or until the end, passes at once."""
        board = self.board
        if board.now < self.busy_until:
            board.now = min(self.busy_until, max(board.now, board.events[0][0] if board.events else self.busy_until))
        return board.now < self.busy_until

    def check_idle(self):
        assert self.board.now >= self.busy_until, "the flash is busy"

    def keep(self, address, size):
        """Keeps what a store of the processor is about to overwrite: only a whole word changes the memory."""
        self.changed.append((address, bytes(self.board.cpu.mem_read(address, size))))

    def program(self, address, data, seconds):
        """A whole word; called before the processor's last store into it."""
        old = bytearray(self.board.cpu.mem_read(address, self.WORD))
        for start, kept in self.changed:
            if address <= start < address + self.WORD:
                old[start - address : start - address + len(kept)] = kept
        self.changed.clear()
        is_cut = self.cut()
        if any(byte != 0xFF for byte in old) and any(data):
            self.erased_first()
            data = bytes(old)
        elif is_cut and self.is_cut_clean:
            data = bytes(old)
        elif is_cut:
            missing = self.missing.to_bytes(4, "little") * (self.WORD // 4)
            data = bytes(a & (b | m) for a, b, m in zip(old, data, missing))
            self.tear(address)
        self.changed.append((address, data))
        self.busy_until = self.board.now + seconds * self.board.CORE_HZ
        if is_cut:
            self.board.cut_power()

    def erase(self, start, size, seconds):
        is_cut = self.cut()
        self.board.note("erase", start)
        cpu = self.board.cpu
        if is_cut:
            if not self.is_cut_clean:
                # Half of the words are erased, and those in the middle of it are neither.
                cpu.mem_write(start, b"\xff" * (size // 2))
                for address in range(start, start + size // 2, 8 * self.WORD):
                    self.tear(address)
            self.board.cut_power()
        else:
            cpu.mem_write(start, b"\xff" * size)
            self.torn -= set(range(start, start + size, self.WORD))
        self.busy_until = self.board.now + seconds * self.board.CORE_HZ

    def settle(self):
        """Puts what stores have left in place; the processor's own store has overwritten it."""
        for address, data in self.changed:
            self.board.cpu.mem_write(address, data)
        self.changed.clear()

    def erased_first(self):
        """A word was programmed that was not erased."""
        raise NotImplementedError

    # --- torn words

    def tear(self, address):
        self.torn.add(address)
        if not self.is_watched:
            self.is_watched = True
            cpu = self.board.cpu
            self.board.watch_memory(UC_HOOK_MEM_READ, self.on_read, self.START, self.START + self.SIZE - 1)
            for barrier in self.board.barriers:
                cpu.hook_add(UC_HOOK_CODE, self.board.on_barrier, begin=barrier, end=barrier + 1)
            cpu.ctl_flush_tb()

    def on_read(self, _, __, address, size, *___):
        word = address // self.WORD * self.WORD
        if word in self.torn:
            self.read_torn(word)

    def read_torn(self, address):
        """The chip's own reaction to a double error."""
        raise NotImplementedError
