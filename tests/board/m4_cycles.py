#!/usr/bin/env python3
"""Cortex-M4 instruction and cycle counts of one function in a compiled thumbv7em ELF.

    python m4_cycles.py ELF --call bench_steady --setup bench_setup --args 16 --per 2048 [--repeat 3] [--profile 12]

Runs the real machine code in the Unicorn CPU emulator, from the symbol --call until it returns, and charges every
executed instruction by the Cortex-M4 technical reference manual with zero wait states, as `m4_timing.py` says.
--setup is called once before, with the same --args (u32, at most four). --per divides the result: for a bank of
16 tones and 128 samples give 2048 to read cycles per tone and sample. Deterministic: same ELF, same figure.

The functions must be `#[unsafe(no_mangle)] extern "C"`, kept by the linker, and must touch no peripheral.
"""
import argparse
import sys

from elftools.elf.elffile import ELFFile
from unicorn import UC_ARCH_ARM, UC_HOOK_CODE, UC_HOOK_MEM_UNMAPPED, UC_MODE_THUMB, Uc, UcError
from unicorn.arm_const import (UC_ARM_REG_C1_C0_2, UC_ARM_REG_FPEXC, UC_ARM_REG_LR, UC_ARM_REG_PC, UC_ARM_REG_R0,
                               UC_ARM_REG_SP, UC_CPU_ARM_MAX)

from m4_timing import REFILL, Timing

STACK_TOP = 0x7010_0000 - 64
RETURN_TO = 0x7020_0000


class Board:
    """Memory, code and symbols of one ELF, ready to call into."""

    def __init__(self, path):
        with open(path, "rb") as f:
            elf = ELFFile(f)
            if elf["e_machine"] != "EM_ARM":
                sys.exit(f"{path}: not an ARM ELF")
            self.symbols = {s.name: s["st_value"] for sec in elf.iter_sections() if sec["sh_type"] == "SHT_SYMTAB"
                            for s in sec.iter_symbols() if s["st_value"]}
            segments = [(s["p_vaddr"], s["p_paddr"], s["p_memsz"], s.data()) for s in elf.iter_segments()
                        if s["p_type"] == "PT_LOAD" and s["p_memsz"]]
        self.cpu = Uc(UC_ARCH_ARM, UC_MODE_THUMB)
        self.cpu.ctl_set_cpu_model(UC_CPU_ARM_MAX)
        self.mapped = set()
        for vaddr, paddr, size, data in segments:
            for base in {vaddr, paddr}:
                self.map(base, size)
                self.cpu.mem_write(base, data)
        self.map(STACK_TOP - 0x10_0000 + 64, 0x10_0000)
        self.map(RETURN_TO, 0x1000)
        access = self.cpu.reg_read(UC_ARM_REG_C1_C0_2)
        self.cpu.reg_write(UC_ARM_REG_C1_C0_2, access | (0xF << 20))
        self.cpu.reg_write(UC_ARM_REG_FPEXC, 0x4000_0000)
        self.cpu.hook_add(UC_HOOK_CODE, self._trace)
        self.cpu.hook_add(UC_HOOK_MEM_UNMAPPED, self._unmapped)
        self.trace = None
        self.timing = Timing(self.cpu.mem_read)

    def map(self, base, size):
        for page in range(base >> 16, (base + max(size, 1) - 1 >> 16) + 1):
            if page not in self.mapped:
                self.cpu.mem_map(page << 16, 0x1_0000)
                self.mapped.add(page)

    def _trace(self, cpu, address, size, _):
        if self.trace is not None:
            self.trace.append(address)

    def _unmapped(self, cpu, access, address, size, value, _):
        if 0x2000_0000 <= address < 0x2100_0000 or 0x1000_0000 <= address < 0x1100_0000:
            self.map(address, size)  # RAM outside the ELF's segments
            return True
        print(f"touches {address:#x} at pc {cpu.reg_read(UC_ARM_REG_PC):#x}: not memory of this ELF", file=sys.stderr)
        return False

    def call(self, name, args, trace):
        if name not in self.symbols:
            sys.exit(f"no symbol {name}; is it no_mangle and kept by the linker?")
        self.cpu.reg_write(UC_ARM_REG_SP, STACK_TOP)
        self.cpu.reg_write(UC_ARM_REG_LR, RETURN_TO | 1)
        for i, value in enumerate(args):
            self.cpu.reg_write(UC_ARM_REG_R0 + i, value & 0xFFFF_FFFF)
        self.trace = [] if trace else None
        try:
            self.cpu.emu_start(self.symbols[name] | 1, RETURN_TO)
        except UcError as error:
            sys.exit(f"{name}: stopped at pc {self.cpu.reg_read(UC_ARM_REG_PC):#x}: {error}")
        return self.trace

    def cycles(self, trace):
        total, by_address, previous = 0, {}, None
        for n, address in enumerate(trace):
            instruction = self.timing.decode(address)
            cost = self.timing.cost(instruction, previous)
            if instruction.jumps and n + 1 < len(trace) and trace[n + 1] != address + instruction.size:
                cost += REFILL
            total += cost
            count, sum_ = by_address.get(address, (0, 0))
            by_address[address] = count + 1, sum_ + cost
            previous = instruction
        return total, by_address


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("elf")
    parser.add_argument("--call", required=True)
    parser.add_argument("--setup")
    parser.add_argument("--args", nargs="*", type=lambda s: int(s, 0), default=[])
    parser.add_argument("--per", type=float, default=1.0)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--profile", type=int, default=0, help="print the N most costly addresses")
    a = parser.parse_args()
    board = Board(a.elf)
    if a.setup:
        board.call(a.setup, a.args, trace=False)
    runs = []
    for _ in range(a.repeat):
        trace = board.call(a.call, a.args, trace=True)
        total, by_address = board.cycles(trace)
        runs.append((len(trace) / a.per, total / a.per))
    instructions, cycles = max(runs, key=lambda r: r[1])  # the worst call counts
    print(f"{a.call}: {instructions:.3f} instructions, {cycles:.3f} cycles" + (f" per 1/{a.per:g}" if a.per != 1 else ""))
    for address, (count, sum_) in sorted(by_address.items(), key=lambda kv: -kv[1][1])[: a.profile]:
        print(f"  {address:#010x} {count:8d} x {sum_:8d} cycles  {board.timing.decode(address).text}")


if __name__ == "__main__":
    main()
