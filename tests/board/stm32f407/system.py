"""SYSCFG, and what it maps to address 0 as well: the flash, or the SRAM, which the instruction bus reaches there
(RM0090 9.2.1, 2.3.1, 2.4)."""
from unicorn import UC_PROT_EXEC, UC_PROT_READ, UC_PROT_ALL

from core import registers

SRAM, SRAM_SIZE, SRAM1_SIZE = 0x20000000, 1 << 17, 112 << 10
# MEMRMP.MEM_MODE. The tests' chips boot from the flash; what the ROM bootloader maps is not shown.
MEMRMP, MODE, FLASH_AT_ZERO, SRAM1_AT_ZERO = 0x00, 0b11, 0b00, 0b11


class SystemConfiguration(registers.Registers):
    def __init__(self, board):
        self.board = board
        flash = board.memories[board.FLASH_START]
        # By mode: memory, bytes of it, and what may be done to it there.
        self.shown = {
            FLASH_AT_ZERO: (flash, flash.size, UC_PROT_READ | UC_PROT_EXEC),
            SRAM1_AT_ZERO: (board.memories[SRAM], SRAM1_SIZE, UC_PROT_ALL),
        }
        self.at_zero = None
        super().__init__("SYSCFG", dict.fromkeys((MEMRMP, 0x04, 0x08, 0x0C, 0x10, 0x14, 0x20), 0))

    def reset(self):
        super().reset()
        self.remap()

    def write(self, offset, value):
        super().write(offset, value)
        self.remap()

    def remap(self):
        mode = self.values[MEMRMP] & MODE
        wanted = mode if mode in self.shown else None
        if wanted == self.at_zero:
            return
        self.board.mpu.lift()
        if self.at_zero is not None:
            self.board.cpu.mem_unmap(0, self.shown[self.at_zero][1])
        if wanted is not None:
            memory, size, rights = self.shown[wanted]
            memory.map(0, size, rights)
        self.at_zero = wanted
        self.board.mpu.apply()
