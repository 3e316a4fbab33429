"""Records the instructions that an exception's handler executes on the board, with the data that they access."""
from typing import NamedTuple

import unicorn.arm_const
from capstone import CS_ARCH_ARM, CS_MODE_MCLASS, CS_MODE_THUMB, Cs
from capstone.arm import ARM_OP_MEM
from unicorn import UC_HOOK_CODE

REGISTERS = {f"r{n}": getattr(unicorn.arm_const, f"UC_ARM_REG_R{n}") for n in range(13)}
# Capstone's names for the others.
REGISTERS |= {name: REGISTERS[f"r{n}"] for name, n in (("sb", 9), ("sl", 10), ("fp", 11), ("ip", 12))}
REGISTERS |= {"sp": unicorn.arm_const.UC_ARM_REG_SP, "lr": unicorn.arm_const.UC_ARM_REG_LR}
# Memory with code. The page that handlers return to lies between the two, and has a hook of its own.
CODE = ((0x00000002, 0x0FFEFFFF), (0x10000000, 0x2FFFFFFF))


class Step(NamedTuple):
    """An instruction that was executed, and the addresses of the words that it read or wrote."""

    address: int
    accesses: list


class Operand(NamedTuple):
    """Where an instruction accesses memory: `words` from base + (index << shift) + offset."""

    base: str
    index: str
    shift: int
    offset: int
    words: int


class Recorder:
    """While it is entered, `runs` gets a list of steps for each run of an exception's handler. What interrupts the
    handler is left out. Registers give the addresses, because Unicorn's hooks on reads disturb the program."""

    def __init__(self, board, exception):
        self.board, self.exception = board, exception
        self.decoder = Cs(CS_ARCH_ARM, CS_MODE_THUMB | CS_MODE_MCLASS)
        self.decoder.detail = True
        self.operands = {}
        self.runs, self.run = [], None

    def __enter__(self):
        cpu = self.board.cpu
        self.hooks = [cpu.hook_add(UC_HOOK_CODE, self.on_code, begin=begin, end=end) for begin, end in CODE]
        cpu.ctl_flush_tb()
        return self

    def __exit__(self, *_):
        for hook in self.hooks:
            self.board.cpu.hook_del(hook)
        self.board.cpu.ctl_flush_tb()

    def on_code(self, _, address, *__):
        board = self.board
        if not board.active or board.active[-1][1] != self.exception:
            return
        if board.traces[-1] is not self.run:
            self.run = board.traces[-1]
            self.runs.append([])
        self.runs[-1].append(Step(address, self.accesses(address)))

    def accesses(self, address):
        if address not in self.operands:
            self.operands[address] = self.operand(address)
        operand = self.operands[address]
        if operand is None:
            return []
        read = self.board.cpu.reg_read
        start = address + 4 & ~3 if operand.base == "pc" else read(REGISTERS[operand.base])
        if operand.index:
            start += read(REGISTERS[operand.index]) << operand.shift
        return [start + operand.offset + 4 * n & 0xFFFFFFFF for n in range(operand.words)]

    def operand(self, address):
        """The memory operand of the instruction at an address, or None."""
        code = bytes(self.board.cpu.mem_read(address, 4))
        instruction = next(self.decoder.disasm(code, address, 1), None)
        if instruction is None:
            return None
        name, operands = instruction.mnemonic, instruction.operands
        register = instruction.reg_name
        if name.startswith(("push", "pop", "vpush", "vpop")):
            return Operand("sp", None, 0, 0, len(operands))
        if name.startswith(("ldm", "stm", "vldm", "vstm")):
            return Operand(register(operands[0].reg), None, 0, 0, len(operands) - 1)
        for operand in operands:
            if operand.type == ARM_OP_MEM:
                # The offset of a post-indexed access is added after it.
                offset = 0 if instruction.post_index else operand.mem.disp
                index = register(operand.mem.index) if operand.mem.index else None
                words = 2 if name.startswith(("ldrd", "strd")) else 1
                return Operand(register(operand.mem.base), index, operand.shift.value, offset, words)
        return None
