"""The functions of an image, the stack that each needs for itself, and whom it calls: a bound of the stack without running it.

A function's own need is the sum of all that its instructions take off the stack pointer, so code that takes it on one of two ways
counts both. A jump out of a function counts as a call. Calls by a register are listed by hand (`INDIRECT`), with what they may
reach; one that is not listed is a failure, and so are a recursion and a stack pointer that moves by a register.
"""
import re
from bisect import bisect_right
from itertools import pairwise
from typing import NamedTuple

from capstone import CS_ARCH_ARM, CS_MODE_MCLASS, CS_MODE_THUMB, Cs
from elftools.elf.elffile import ELFFile

EXECUTABLE = 4
THUNK = "__Thumbv7ABSLongThunk_"
TAKES = re.compile(r"sub(?:w|\.w)? sp, (?:sp, )?#(\w+)$|(?:str|strd)(?:\.w)? .*\[sp, #-(\w+)\]!$")
PUSHES = re.compile(r"(v?)(?:push|stmdb sp!,)(?:\.w)? \{(.*)\}$")
JUMPS = re.compile(r"(?:bl|b|b\w\w|cbn?z)(?:\.w)? (?:\w+, )?#(0x\w+)$")
BY_REGISTER = re.compile(r"blx \w+$|bx (?!lr)\w+$|ldr(?:\.w)? pc, |mov pc, ")
# The stack pointer moves by a register, or comes from elsewhere. (`msr msp` begins a new stack: the hard fault's handler's, the ROM's.)
MOVES = re.compile(r"(?:sub\S*|mov|ldr\S*) sp, (?!sp, #|#)")
# Functions that never return. A panic mutes before it does anything else; should its message need more than there is, the guard
# below the stack ends it, by a handler that mutes and begins a new stack (firmware/stm32/src/crash.rs).
ENDS = re.compile(
    r"panicking|unwrap_failed|expect_failed|panic_already|len_mismatch_fail|slice_\w*fail|HardFault|DefaultHandler"
    r"|stm32.*crash\d*(end|reset_for_brown_out)"
)
# A function that calls itself, how often at most, and why.
REPEATS = {
    # What an older host gets in the place of a newer event or refusal: that one is of an older minor.
    r"(event5Event|refusal\.\.Refusal.*)7lowered": 2,
}

WAKERS = r"executor.*raw.*waker\d*(clone|wake|drop)"
LOOKS = r"(link.*Link.*run.*closure|session.*Session.*step).*closure|FnOnce.*vtable\.shim"
# Who calls by a register, whom that may reach, and why no one else. The first that fits counts.
INDIRECT = {
    # The jump into the ROM, which begins a new stack.
    r"cortex_m_rt_main": r"(?!)",
    # A look for a stop in a long command (`is_stopped`): the link's closure or the session's, and the command's own before them.
    r"execute.*closure": LOOKS,
    r"slipline_app.*(controller|upload|planning|hold)": rf"{LOOKS}|execute.*closure",
    # The count of codes, which the inputs are given at the start.
    r"stm32.*sense|Listener": r"dac7fetched",
    # The functions of the chip's flash, which the driver's common half is given.
    r"flash.*common": r"embassy_stm32.*flash.*(family|erase_sector|write_chunk)",
    # A waker's table has the executor's functions; no other waker is made.
    r"AtomicWaker|WakerRegistration|time_queue|yield_now|embassy_usb|embassy_stm32|OTG_FS|PollFn|TaskStorage|slipline_app|slipline_stm32": WAKERS,
}


class Function(NamedTuple):
    name: str
    takes: int
    calls: frozenset
    calls_by_register: bool


class CallGraph:
    def __init__(self, path):
        with open(path, "rb") as file:
            elf = ELFFile(file)
            symbols = list(elf.get_section_by_name(".symtab").iter_symbols())
            sections = [(s["sh_addr"], s.data()) for s in elf.iter_sections() if s["sh_flags"] & EXECUTABLE and s["sh_size"]]
            self.vectors = elf.get_section_by_name(".vector_table").data()
        named = {s.name: s["st_value"] for s in symbols}
        # What the memory map sets aside.
        self.stack = named["_stack_start"] - named["_stack_end"]
        marks = sorted((s["st_value"], s.name[1]) for s in symbols if re.match(r"\$[td]", s.name))
        self.by_name = {s.name: s["st_value"] & ~1 for s in symbols if s["st_info"]["type"] == "STT_FUNC"}
        sizes = {s["st_value"] & ~1: s["st_size"] for s in symbols if s["st_info"]["type"] == "STT_FUNC"}
        # The linker folds functions of the same instructions into one, with all their names.
        names = {start: " ".join(name for name, at in self.by_name.items() if at == start) for start in sizes}
        decoder = Cs(CS_ARCH_ARM, CS_MODE_THUMB | CS_MODE_MCLASS)
        self.functions = {}
        starts = sorted(sizes)
        for start, after in pairwise([*starts, starts[-1] + 2]):
            size, name = sizes[start], names[start]
            found = [data[start - first :] for first, data in sections if first <= start < first + len(data)]
            if found:
                code = found[0][: size or after - start]
                lines = [line for piece in instructions(start, code, marks) for line in decoded(decoder, *piece)]
                self.functions[start] = self.function(name, start, len(code), lines)

    def function(self, name, start, size, lines):
        if name.startswith(THUNK):
            return Function(name, 0, frozenset([self.by_name[name.removeprefix(THUNK)]]), False)
        takes, calls, by_register = 0, set(), False
        for line in lines:
            assert not MOVES.match(line) or ENDS.search(name), f"{name}: {line}"
            if taken := TAKES.match(line):
                takes += int(taken[1] or taken[2], 0)
            elif pushed := PUSHES.match(line):
                takes += (8 if pushed[1] else 4) * (pushed[2].count(",") + 1)
            elif jump := JUMPS.match(line):
                target = int(jump[1], 0)
                if line.startswith("bl ") or not start <= target < start + size:
                    calls.add(target)
            by_register |= bool(BY_REGISTER.match(line))
        return Function(name, takes, frozenset(calls), by_register)

    def handler(self, vector):
        """The function of an exception, by its number."""
        return int.from_bytes(self.vectors[4 * vector : 4 * vector + 4], "little") & ~1

    def called(self, address, indirect):
        """The functions that a function may call, but for those that never return."""
        function = self.functions[address]
        targets = set(function.calls)
        if function.calls_by_register:
            reached = [pattern for caller, pattern in indirect.items() if re.search(caller, function.name)]
            assert reached, f"{function.name} calls by a register: INDIRECT does not say whom"
            targets |= {at for at, each in self.functions.items() if re.search(reached[0], each.name)}
        return {at for at in targets if not ENDS.search(self.functions[at].name)}

    def deepest(self, root, indirect):
        """Bytes of the stack that a function needs at most, with all that it calls; and the names on that way."""
        known, under_way = {}, []

        def visit(address):
            name, takes = self.functions[address].name, self.functions[address].takes
            assert address not in under_way, f"{name} may call itself: {[self.functions[at].name for at in under_way]}"
            if address not in known:
                under_way.append(address)
                targets = self.called(address, indirect)
                times = [times for repeats, times in REPEATS.items() if re.search(repeats, name) and address in targets]
                below = max((visit(at) for at in targets - ({address} if times else set())), default=(0, ()))
                known[address] = takes * max(times, default=1) + below[0], (name, *below[1])
                under_way.pop()
            return known[address]

        return visit(root)


def instructions(start, code, marks):
    """The pieces of a function that are instructions, not tables: address and bytes."""
    at, end = start, start + len(code)
    while at < end:
        index = bisect_right(marks, (at, "~")) - 1
        until = min(end, marks[index + 1][0] if index + 1 < len(marks) else end)
        if index < 0 or marks[index][1] == "t":
            yield at, code[at - start : until - start]
        at = until


def decoded(decoder, address, code):
    lines = [f"{mnemonic} {operands}" for _, _, mnemonic, operands in decoder.disasm_lite(code, address)]
    return [line.replace(", lsl #2", "") for line in lines]
