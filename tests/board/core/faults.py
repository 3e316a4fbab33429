"""Faults of the processor: the bits of CFSR that state the cause, then a hard fault or a lock-up.

The faults that have handlers of their own are not enabled (SHCSR), so all escalate to the hard fault (ARMv7-M B1.5.14).
"""
from unicorn import UC_MEM_FETCH_PROT, UC_MEM_FETCH_UNMAPPED
from unicorn.arm_const import UC_ARM_REG_FAULTMASK, UC_ARM_REG_PC

from .nvic import BFAR, CCR, CFSR, HARD_FAULT, HARD_FAULT_PRIORITY, MMFAR

IGNORES_BUS_FAULTS = 1 << 8
# CFSR (ARMv7-M B3.2.15): what the memory protection unit has refused, and what the bus has answered with an error, each for a
# fetch, for data and for an exception's frame; whether MMFAR or BFAR holds the address; an instruction that is none.
REFUSED_FETCH, REFUSED_DATA, REFUSED_FRAME, MMFAR_VALID = 1 << 0, 1 << 1, 1 << 4, 1 << 7
FETCH_ERROR, DATA_ERROR, FRAME_ERROR, BFAR_VALID = 1 << 8, 1 << 9, 1 << 12, 1 << 15
UNDEFINED_INSTRUCTION = 1 << 16


class Faults:
    """A part of `Processor`."""

    def bus_fault(self, address):
        """A read was answered with an error: ignored with FAULTMASK and CCR.BFHFNMIGN set (ARMv7-M B3.2.8), else a fault."""
        if not (self.cpu.reg_read(UC_ARM_REG_FAULTMASK) and self.nvic.registers[CCR] & IGNORES_BUS_FAULTS):
            self.bus_error = address
            self.cpu.emu_stop()

    def on_invalid_access(self, _, kind, address, size, *__):
        self.invalid_access = kind, address, size
        return False

    def fault(self, error, status):
        """The processor cannot go on: hard fault, or lock-up if it happens in its handler (ARMv7-M B1.5.15)."""
        self.pc = self.cpu.reg_read(UC_ARM_REG_PC) | 1
        self.faults.append((self.pc & ~1, str(error)))
        if any(priority <= HARD_FAULT_PRIORITY for priority, _ in self.active) or self.cpu.reg_read(UC_ARM_REG_FAULTMASK):
            self.lock_up()
        else:
            self.nvic.registers[CFSR] |= status
            self.enter(HARD_FAULT_PRIORITY, HARD_FAULT)

    def lock_up(self):
        self.is_locked_up = True

    def status_of_refusal(self):
        """CFSR's bits for what has ended the emulation; MMFAR or BFAR gets the address."""
        if self.invalid_access is None:
            return UNDEFINED_INSTRUCTION
        (kind, address, size), self.invalid_access = self.invalid_access, None
        is_fetch, is_refused = kind in (UC_MEM_FETCH_PROT, UC_MEM_FETCH_UNMAPPED), self.mpu.refuses(address, size)
        if is_fetch:
            return REFUSED_FETCH if is_refused else FETCH_ERROR
        self.nvic.registers[MMFAR if is_refused else BFAR] = address
        return REFUSED_DATA | MMFAR_VALID if is_refused else DATA_ERROR | BFAR_VALID

    def refusal_of_frame(self, stack):
        """CFSR's bit if an exception's frame cannot be written to where the stack pointer will be, or 0."""
        if self.mpu.refuses(stack, self.FRAME):
            return REFUSED_FRAME
        is_memory = any(start <= stack <= start + self.MEMORIES[start] - 32 for start in self.RAMS)
        return 0 if is_memory else FRAME_ERROR
