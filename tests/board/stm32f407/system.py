"""SYSCFG, and the SRAM that it may map to address 0 as well, where the instruction bus reaches it (RM0090 9.2.1, 2.3.1)."""
import ctypes
import mmap

from unicorn import UC_PROT_ALL

from core import registers

SRAM, SRAM_SIZE, SRAM1_SIZE = 0x20000000, 1 << 17, 112 << 10
# MEMRMP.MEM_MODE.
MEMRMP, MODE, SRAM1_AT_ZERO = 0x00, 0b11, 0b11


class SystemConfiguration(registers.Registers):
    def __init__(self, cpu):
        # The same memory of this computer at both addresses; Unicorn wants whole pages. Private: a copy of the process
        # (`copies`) has its own.
        self.cpu, self.memory = cpu, mmap.mmap(-1, SRAM_SIZE, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
        self.start = ctypes.addressof(ctypes.c_char.from_buffer(self.memory))
        cpu.mem_unmap(SRAM, SRAM_SIZE)
        cpu.mem_map_ptr(SRAM, SRAM_SIZE, UC_PROT_ALL, self.start)
        self.is_mapped = False
        super().__init__("SYSCFG", dict.fromkeys((MEMRMP, 0x04, 0x08, 0x0C, 0x10, 0x14, 0x20), 0))

    def reset(self):
        super().reset()
        self.remap()

    def write(self, offset, value):
        super().write(offset, value)
        self.remap()

    def remap(self):
        wanted = self.values[MEMRMP] & MODE == SRAM1_AT_ZERO
        if wanted and not self.is_mapped:
            self.cpu.mem_map_ptr(0, SRAM1_SIZE, UC_PROT_ALL, self.start)
        elif self.is_mapped and not wanted:
            self.cpu.mem_unmap(0, SRAM1_SIZE)
        self.is_mapped = wanted
