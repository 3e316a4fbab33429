"""The memory protection unit (ARMv7-M B3.5), as far as a guard needs it: regions without access for anybody.

Unicorn's own memory refuses the accesses, so that all others cost no time. `Processor.enter` and `Processor.leave` call
`apply`, because without HFNMIENA the unit is off in the handlers of NMI and hard fault. What FAULTMASK switches off is not
modelled: code under it that touches a guard is locked up. Nor is an access that is not aligned and reaches over an edge.
"""
from unicorn import UC_PROT_NONE

# Offsets from 0xE0000000.
TYPE, CTRL, RNR, RBAR, RASR = 0xED90, 0xED94, 0xED98, 0xED9C, 0xEDA0
REGISTERS = (TYPE, CTRL, RNR, RBAR, RASR)
ENABLE, HFNMIENA, PRIVDEFENA = 1 << 0, 1 << 1, 1 << 2
# RBAR.VALID: the region is that of RBAR.REGION, not RNR's.
VALID = 1 << 4
# RASR: who may read and write, the subregions that are off.
PERMISSIONS, SUBREGIONS_OFF = 0b111 << 24, 0xFF << 8


class Mpu:
    def __init__(self, board, count):
        self.board, self.count = board, count
        # The ranges of Unicorn's memory that are closed now, and what may be done to them otherwise.
        self.closed = []
        self.reset()

    def reset(self):
        self.control = self.number = 0
        # By number: base address and attributes.
        self.regions = [(0, 0)] * self.count
        self.apply()

    def is_on(self):
        """Whether the unit checks what runs now."""
        runs_unchecked = any(priority < 0 for priority, _ in self.board.active)
        return bool(self.control & ENABLE) and (not runs_unchecked or bool(self.control & HFNMIENA))

    def guards(self):
        """Start and end of every region that is enabled."""
        found = []
        for base, attributes in self.regions:
            if attributes & ENABLE:
                size = 2 << (attributes >> 1 & 0x1F)
                assert size >= 32 and base % size == 0, "a region begins at a multiple of its size (ARMv7-M B3.5.8)"
                assert not attributes & (PERMISSIONS | SUBREGIONS_OFF), "only regions without any access are modelled"
                found.append((base, base + size))
        return found

    def refuses(self, address, size=1):
        """Whether an access now ends in a MemManage fault."""
        return self.is_on() and any(start < address + size and address < end for start, end in self.guards())

    def lift(self):
        """Opens all of Unicorn's memory, before it is mapped again."""
        for start, size, rights in self.closed:
            self.board.cpu.mem_protect(start, size, rights)
        self.closed = []

    def apply(self):
        """Closes what is refused now. What is no memory is refused anyway."""
        self.lift()
        if not self.is_on():
            return
        assert self.control & PRIVDEFENA, "without it the program has no memory at all"
        cpu = self.board.cpu
        for start, end in self.guards():
            for first, last, rights in list(cpu.mem_regions()):
                low, high = max(start, first), min(end, last + 1)
                if low < high:
                    assert low % 1024 == 0 and high % 1024 == 0, "Unicorn closes whole pages of 1 KiB"
                    cpu.mem_protect(low, high - low, UC_PROT_NONE)
                    self.closed.append((low, high - low, rights))

    # --- registers

    def read(self, offset):
        base, attributes = self.regions[self.number]
        return {TYPE: self.count << 8, CTRL: self.control, RNR: self.number, RBAR: base | self.number, RASR: attributes}[offset]

    def write(self, offset, value):
        base, attributes = self.regions[self.number]
        if offset == CTRL:
            self.control = value
        elif offset == RNR:
            assert value < self.count, "there is no such region"
            self.number = value
        elif offset == RBAR:
            assert not value & VALID, "regions are chosen by RNR"
            self.regions[self.number] = value & ~0x1F, attributes
        elif offset == RASR:
            self.regions[self.number] = base, value
        self.apply()
