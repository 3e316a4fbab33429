"""Processor, memory, exceptions, time, and what else stands on the bus."""
import heapq
import random
import struct

from elftools.elf.elffile import ELFFile
from unicorn import (
    UC_ARCH_ARM, UC_HOOK_BLOCK, UC_HOOK_CODE, UC_HOOK_MEM_WRITE, UC_MODE_MCLASS, UC_MODE_THUMB, Uc, UcError,
)  # fmt: skip
from unicorn.arm_const import (
    UC_ARM_REG_BASEPRI, UC_ARM_REG_LR, UC_ARM_REG_PC, UC_ARM_REG_PRIMASK, UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2,
    UC_ARM_REG_R3, UC_ARM_REG_R4, UC_ARM_REG_R12, UC_ARM_REG_SP, UC_ARM_REG_XPSR, UC_CPU_ARM_CORTEX_M4,
)  # fmt: skip

from m4_timing import REFILL, Timing

from . import dac, dma, flash, watchdog
from .timer import TIMERS, Timer

CODE, CCM, SRAM, SYSTEM_MEMORY, UNIQUE_ID = 0x08000000, 0x10000000, 0x20000000, 0x1FFF0000, 0x1FFF7A10
CCM_SIZE, SRAM_SIZE, SYSTEM_SIZE = 1 << 16, 1 << 17, 1 << 16
# A page nothing else uses: a handler's return address points here.
RETURN = 0x0FFF0000
USB = 0x50000000
HARD_FAULT, PENDSV, SYSTICK = 3, 14, 15
USB_IRQ, SUPPLY_IRQ = 67, 1
# USART3: one of those by which the ROM bootloader listens (AN2606).
ROM_IRQ = 39
RCC, GPIO, EXTI, PWR, SYSTICK_CONTROL, DEBUG_ID = 0x40023800, 0x40020000, 0x40013C00, 0x40007000, 0xE000E010, 0xE0042000
RESET_FLAGS = RCC + 0x74
# The trace unit, with the lock that it has on a Cortex-M7 (the same code runs there), and what switches it on.
DWT, DWT_LAR, DWT_KEY, DEMCR = 0xE0001000, 0xE0001FB0, 0xC5ACCE55, 0xE000EDFC
# RCC_CSR (7.3.21): every reset sets PINRSTF (bit 26) too; power-on sets BORRSTF (25) and PORRSTF (27).
CAUSES = {"power": 0b111 << 25, "brown-out": 0b11 << 25, "pin": 1 << 26, "software": 0b101 << 26, "watchdog": 0b1001 << 26}


REGISTERS = (
    UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, *range(UC_ARM_REG_R4, UC_ARM_REG_R4 + 8),
    UC_ARM_REG_R12, UC_ARM_REG_SP, UC_ARM_REG_LR,
)  # fmt: skip


class PowerCut(Exception):
    """The supply is gone; only the flash keeps what it had. Begin again with `Board.reset("power")`."""


class Trace:
    """An exception under way: when it was entered, where the stack stood, what lay below, and for how long others
    have interrupted it."""

    def __init__(self, entered, above, below):
        self.entered, self.above, self.below, self.interrupted = entered, above, below, 0


def first_difference(memory, other):
    """Index of the first byte in which `memory` differs from the beginning of `other`, or its length."""
    for start in range(0, len(memory), 256):
        end = min(start + 256, len(memory))
        if memory[start:end] != other[start:end]:
            return next(i for i in range(start, end) if memory[i] != other[i])
    return len(memory)


class Board:
    CORE_HZ, APB1_TIMER_HZ, APB2_TIMER_HZ = 168e6, 84e6, 168e6
    # Entering an exception and leaving it: twelve and ten cycles (Cortex-M4 TRM), and seventeen for the floating-point
    # registers that are saved when the handler uses them first. Every exception is taken as one that does, after code
    # that did: nothing is cheaper or shallower than it may be.
    ENTRY_CYCLES, EXIT_CYCLES = 12 + 17, 10
    # The frame of an exception with floating point (ARMv7-M B1.5): eight registers, S0 to S15, FPSCR, one reserved.
    FRAME = 4 * (8 + 18)

    def __init__(self, image):
        self.cpu = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self.cpu.ctl_set_cpu_model(UC_CPU_ARM_CORTEX_M4)
        for start, size in (
            (CODE, flash.SIZE), (CCM, CCM_SIZE), (SRAM, SRAM_SIZE), (SYSTEM_MEMORY, SYSTEM_SIZE), (RETURN, 4096),
        ):  # fmt: skip
            self.cpu.mem_map(start, size)
        self.cpu.mem_write(CODE, b"\xff" * flash.SIZE)
        self.cpu.mem_write(RETURN, b"\xfe\xe7" * 64)
        self.cpu.mem_write(UNIQUE_ID, b"SLIPLINE-VB1")
        # The ROM bootloader: a vector table and an endless loop.
        self.cpu.mem_write(SYSTEM_MEMORY, struct.pack("<II", SRAM + 0x1000, SYSTEM_MEMORY + 0x101))
        self.cpu.mem_write(SYSTEM_MEMORY + 0x100, b"\xfe\xe7")
        self.symbols = {}
        # Where `cpsid i` stands, and where `cpsie i` or `msr primask, rN` does.
        self.masks, self.unmasks = [], []
        self.timing, self.costs = Timing(self.cpu.mem_read), {}
        # What comes next in memory after a block of code that may jump.
        self.follows = None
        self.load(image)
        for start in (0x40000000, 0x50000000, 0xE0000000):
            self.cpu.mmio_map(
                start, 0x100000,
                lambda _, offset, size, __, start=start: self.bus_read(start + offset, size), None,
                lambda _, offset, size, value, __, start=start: self.bus_write(start + offset, size, value), None,
            )  # fmt: skip
        self.block_hook = self.cpu.hook_add(UC_HOOK_BLOCK, self.on_block)
        self.cpu.hook_add(UC_HOOK_CODE, self.on_return, begin=RETURN, end=RETURN + 64)
        self.cpu.hook_add(UC_HOOK_MEM_WRITE, self.on_flash_store, begin=CODE, end=CODE + flash.SIZE - 1)
        for sleep in self.sleeps:
            self.cpu.hook_add(UC_HOOK_CODE, self.on_sleep, begin=sleep, end=sleep + 1)
        for address in self.masks:
            self.cpu.hook_add(UC_HOOK_CODE, self.on_mask, begin=address, end=address + 1)
        for address in self.unmasks:
            self.cpu.hook_add(UC_HOOK_CODE, self.on_unmask, begin=address, end=address + 1)
        self.usb = None
        self.now = 0.0
        # The most cycles for which all interrupts were masked, and who called the function that ended it.
        self.masked_since, self.worst_masked = None, (0, 0)
        # By exception: the most cycles it has taken, without those that interrupted it. By priority: the deepest stack.
        self.worst_cycles, self.worst_depth = {}, {}
        self.events, self.planned = [], 0
        self.log, self.resets = [], []
        self.flash = flash.Flash(self)
        self.reset("power")
        self.resets.clear()

    def load(self, image):
        with open(image, "rb") as file:
            elf = ELFFile(file)
            for segment in elf.iter_segments():
                if segment["p_type"] == "PT_LOAD" and segment["p_filesz"]:
                    self.cpu.mem_write(segment["p_paddr"], segment.data())
            for section in elf.iter_sections():
                if section["sh_type"] == "SHT_SYMTAB":
                    self.symbols |= {symbol.name: symbol["st_value"] for symbol in section.iter_symbols()}
            text = elf.get_section_by_name(".text")
            data, start = text.data(), text["sh_addr"]
        def places(*codes):
            return [start + i for i in range(0, len(data) - 1, 2) if data[i : i + 2] in codes]

        # WFE and WFI.
        self.sleeps = places(b"\x20\xbf", b"\x30\xbf")
        self.masks, self.unmasks = places(b"\x72\xb6"), places(b"\x62\xb6")
        self.unmasks += [
            start + i
            for i in range(0, len(data) - 3, 2)
            if data[i] >> 4 == 8 and data[i + 1 : i + 4] == b"\xf3\x10\x88"
        ]

    # --- reset and power

    def reset(self, cause):
        """Everything but flash and RAM begins anew; power-on leaves noise in the RAM as well."""
        self.resets.append(cause)
        if cause == "power":
            noise = random.Random(len(self.resets))
            self.noise = noise.randbytes(CCM_SIZE)
            self.cpu.mem_write(CCM, self.noise)
            self.cpu.mem_write(SRAM, noise.randbytes(SRAM_SIZE))
            self.flash.cut_at = None
        self.events.clear()
        self.flash.settle()
        self.flash.reset()
        self.dac, self.watchdog = dac.Dac(self), watchdog.Watchdog(self)
        self.dma = {number: dma.Dma(self, number) for number in dma.BASES}
        self.timers = {number: Timer(self, number) for number in TIMERS}
        self.pages = {timer.base: timer for timer in self.timers.values()}
        self.pages |= {dac.BASE: self.dac, watchdog.BASE: self.watchdog, flash.BASE: self.flash}
        self.pages |= {controller.base: controller for controller in self.dma.values()}
        # RCC_CR as after reset; GPIOA's mode leaves the debug pins; DBGMCU: a revision Y chip.
        self.registers = {RCC: 0x83, GPIO: 0xA8000000, DEBUG_ID: 0x100F6413, RESET_FLAGS: CAUSES[cause]}
        self.levels = {}
        self.enabled, self.pending, self.priorities = set(), set(), {}
        self.active, self.saved, self.traces = [], [], []
        self.systick, self.pendsv, self.systick_due = {"control": 0, "reload": 0}, False, False
        self.vectors = CODE
        self.is_thread_frozen = self.is_locked_up = False
        self.faults = []
        self.slept = self.returned = self.fresh = False
        self.masked_since = None
        self.cpu.reg_write(UC_ARM_REG_PRIMASK, 0)
        stack, entry = struct.unpack("<II", self.cpu.mem_read(CODE, 8))
        self.cpu.reg_write(UC_ARM_REG_SP, stack)
        self.pc = entry | 1
        self.was_reset = True
        self.cpu.emu_stop()
        if self.usb:
            self.usb.reset()

    def leave_bootloader(self):
        """The ROM jumps to the program: nothing is reset, its own vectors are in force, its interrupts may wait."""
        self.vectors = SYSTEM_MEMORY
        self.enabled.add(ROM_IRQ)
        self.pend(ROM_IRQ)
        self.cpu.reg_write(UC_ARM_REG_PRIMASK, 1)
        stack, entry = struct.unpack("<II", self.cpu.mem_read(CODE, 8))
        self.cpu.reg_write(UC_ARM_REG_SP, stack)
        self.pc = entry | 1

    def cut_power(self):
        self.cut = True
        self.cpu.emu_stop()

    def thread_depth(self):
        """Bytes of the core-coupled RAM, from its top, that have been written since power-on: the stack.

        While the stacks are watched this is what the program needs when no interrupt comes, to the word."""
        now = bytes(self.cpu.mem_read(CCM, CCM_SIZE))
        if self.traces:
            # An interrupt is under way.
            now = self.traces[0].below + now[len(self.traces[0].below) :]
        return CCM_SIZE - first_difference(now, self.noise)

    def paint_below(self, above):
        """Keeps what lies below the stack pointer and writes noise there instead, if the stacks are watched."""
        if not self.watches_stacks or not CCM < above <= CCM + CCM_SIZE:
            return b""
        below = bytes(self.cpu.mem_read(CCM, above - CCM))
        self.cpu.mem_write(CCM, self.noise[: len(below)])
        return below

    def restore_below(self, trace):
        """Undoes that: the interrupt leaves no trace. Returns the lowest address that it has written."""
        lowest = CCM + first_difference(self.cpu.mem_read(CCM, len(trace.below)), self.noise)
        self.cpu.mem_write(CCM, trace.below)
        return lowest

    cut = False
    # Measures how deep the stack gets in thread mode and in each priority's handlers, frames included, one by one:
    # whenever they meet, the stack needs at most their sum. From power-on, or the program's start escapes it.
    watches_stacks = False
    # Plays half a ring of codes at once, when it is due: many times faster, but the DAC is not watched code by code.
    is_hasty = False

    def dip_supply(self):
        """The supply falls below the detector's threshold; False if nobody watches."""
        line = 1 << 16
        watched = self.registers.get(PWR, 0) & 1 << 4 and self.registers.get(EXTI, 0) & line
        if watched and self.registers.get(EXTI + 8, 0) & line:
            self.registers[EXTI + 0x14] = line
            self.pend(SUPPLY_IRQ)
            return True
        return False

    # --- time

    def at(self, when, call, *arguments):
        self.planned += 1
        heapq.heappush(self.events, (when, self.planned, call, arguments))

    def run_events(self):
        while self.events and self.events[0][0] <= self.now:
            when, _, call, arguments = heapq.heappop(self.events)
            now, self.now = self.now, when
            call(*arguments)
            self.now = max(now, self.now)

    def stall(self, seconds):
        """The processor waits, the rest of the chip goes on."""
        self.now += seconds * self.CORE_HZ

    @property
    def seconds(self):
        return self.now / self.CORE_HZ

    def note(self, *what):
        self.log.append((self.seconds, *what))

    # --- hooks

    def on_block(self, _, address, size, ___):
        is_due = (
            (self.events and self.events[0][0] <= self.now)
            or self.now >= self.limit
            or ((self.pending or self.pendsv or self.systick_due) and self.next_exception())
        )
        if is_due and not self.fresh:
            # The block is entered anew, and paid for, afterwards.
            self.cpu.emu_stop()
            return
        # Whatever is due: always make progress.
        self.fresh = False
        block = (address, size)
        known = self.costs.get(block)
        if known is None:
            known = self.costs[block] = self.timing.straight(address, size)
        # A jump is known for one when the next block of code begins elsewhere.
        self.now += known[0] + (REFILL if self.follows not in (None, address) else 0)
        self.follows = address + size if known[1] else None
        self.block_end = address + size

    def on_sleep(self, *_):
        self.slept = True
        self.cpu.emu_stop()

    def instant(self, address):
        """The time at an instruction of the block of code under way, which has been paid for as a whole."""
        return self.now - self.timing.straight(address, self.block_end - address)[0]

    def on_mask(self, _, address, *__):
        if not self.cpu.reg_read(UC_ARM_REG_PRIMASK) & 1:
            self.masked_since = self.instant(address)

    def on_unmask(self, _, address, *__):
        # What restores the mask inside another masked section ends none: the outermost counts.
        register = self.cpu.mem_read(address, 2)
        still = register[1] == 0xF3 and self.cpu.reg_read(REGISTERS[register[0] & 15]) & 1
        if self.masked_since is not None and not still:
            caller = self.cpu.reg_read(UC_ARM_REG_LR) & ~1
            self.worst_masked = max(self.worst_masked, (self.instant(address) - self.masked_since, caller))
            self.masked_since = None

    def on_return(self, *_):
        self.returned = True
        self.cpu.emu_stop()

    def on_flash_store(self, _, __, address, size, value, ___):
        self.flash.programmed(address, size, value & 0xFFFFFFFF)

    # --- exceptions

    def pend(self, irq):
        self.pending.add(irq)

    def is_level_high(self, irq):
        """Whether a peripheral still holds its interrupt line."""
        if irq == dac.IRQ and self.dac.is_pending():
            return True
        if any(timer.irq == irq and timer.is_pending() for timer in self.timers.values()):
            return True
        for number, irqs in dma.INTERRUPTS.items():
            if irq in irqs:
                return self.dma[number].is_pending(irqs.index(irq))
        return irq == USB_IRQ and self.usb is not None and self.usb.is_line_high()

    def next_exception(self):
        """Priority and number of the exception to enter now, or None."""
        if self.cpu.reg_read(UC_ARM_REG_PRIMASK) & 1:
            return None
        running = min((priority for priority, _ in self.active), default=256)
        running = min(running, self.cpu.reg_read(UC_ARM_REG_BASEPRI) or 256)
        waiting = [(self.priorities.get(irq, 0), irq + 16) for irq in self.pending & self.enabled]
        system = self.registers.get(0xE000ED20, 0)
        if self.pendsv:
            waiting.append((system >> 16 & 0xFF, PENDSV))
        if self.systick_due:
            waiting.append((system >> 24, SYSTICK))
        return min((w for w in waiting if w[0] < running), default=None)

    def enter(self, priority, exception):
        self.now += self.ENTRY_CYCLES
        if exception == PENDSV:
            self.pendsv = False
        elif exception == SYSTICK:
            self.systick_due = False
        else:
            self.pending.discard(exception - 16)
        cpu = self.cpu
        self.saved.append((cpu.context_save(), self.pc))
        self.active.append((priority, exception))
        above = cpu.reg_read(UC_ARM_REG_SP)
        self.traces.append(Trace(self.now - self.ENTRY_CYCLES, above, self.paint_below(above)))
        stack = above - self.FRAME & ~7
        registers = (
            UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR,
        )  # fmt: skip
        frame = [cpu.reg_read(register) for register in registers] + [self.pc & ~1, cpu.reg_read(UC_ARM_REG_XPSR)]
        # Where there is no memory the stacking fails, and the fault's handler is entered all the same.
        if any(start <= stack <= start + size - 32 for start, size in ((CCM, CCM_SIZE), (SRAM, SRAM_SIZE))):
            cpu.mem_write(stack, struct.pack("<8I", *frame))
        cpu.reg_write(UC_ARM_REG_SP, stack)
        cpu.reg_write(UC_ARM_REG_LR, RETURN | 1)
        self.pc = struct.unpack("<I", cpu.mem_read(self.vectors + 4 * exception, 4))[0] | 1

    def leave(self):
        self.now += self.EXIT_CYCLES
        context, self.pc = self.saved.pop()
        priority, exception = self.active.pop()
        self.cpu.context_restore(context)
        trace = self.traces.pop()
        cycles = self.now - trace.entered
        self.worst_cycles[exception] = max(self.worst_cycles.get(exception, 0), cycles - trace.interrupted)
        if self.traces:
            self.traces[-1].interrupted += cycles
        if trace.below:
            depth = trace.above - self.restore_below(trace)
            self.worst_depth[priority] = max(self.worst_depth.get(priority, 0), depth)
        if exception >= 16 and self.is_level_high(exception - 16):
            self.pend(exception - 16)

    def fault(self, error):
        """The processor cannot go on: hard fault, or lock-up if it happens in its handler."""
        self.pc = self.cpu.reg_read(UC_ARM_REG_PC) | 1
        self.faults.append((self.pc & ~1, str(error)))
        if (-1, HARD_FAULT) in self.active:
            self.is_locked_up = True
        else:
            self.registers[0xE000ED28] = 1 << 8
            self.enter(-1, HARD_FAULT)

    # --- the bus

    def bus_read(self, address, size):
        word = self.read_word(address & ~3)
        return (word >> 8 * (address & 3)) & ((1 << 8 * size) - 1)

    def read_word(self, a):
        peripheral = self.pages.get(a & ~0x3FF)
        if peripheral:
            return peripheral.read(a & 0x3FF) & 0xFFFFFFFF
        if self.usb and USB <= a < USB + 0x40000:
            return self.usb.read(a - USB) & 0xFFFFFFFF
        value = self.registers.get(a, 0)
        if a == RCC:
            # The ready flags follow HSION, HSEON, PLLON and PLLI2SON.
            return value | 2 | (value & 1 << 16) << 1 | (value & 1 << 24) << 1 | (value & 1 << 26) << 1
        if a == RCC + 0x08:
            return value & ~0xC | (value & 3) << 2
        if a in (RCC + 0x70, RESET_FLAGS):
            return value | (value & 1) << 1
        if a == PWR + 4:
            return value | 1 << 14 | (value >> 16 & 3) << 16
        if a == DWT + 4:
            counts = self.registers.get(DEMCR, 0) & 1 << 24 and self.registers.get(DWT, 0) & 1
            return int(self.now) & 0xFFFFFFFF if counts else 0
        if a == 0xE000ED00:
            return 0x410FC241
        if a == 0xE000ED04:
            return self.active[-1][1] if self.active else 0
        if a == 0xE000ED08:
            return self.vectors
        if a == SYSTICK_CONTROL:
            control = self.systick["control"]
            self.systick["control"] &= ~(1 << 16)
            return control
        for start, irqs in ((0xE000E100, self.enabled), (0xE000E200, self.pending)):
            if start <= a < start + 0x100:
                first = (a & 0x1F) // 4 * 32
                return sum(1 << bit for bit in range(32) if first + bit in irqs)
        if 0xE000E400 <= a < 0xE000E4F0:
            return sum(self.priorities.get(a - 0xE000E400 + i, 0) << 8 * i for i in range(4))
        return value

    def bus_write(self, a, size, value):
        if 0xE000E400 <= a < 0xE000E4F0:
            for i in range(size):
                # Four priority bits.
                self.priorities[a - 0xE000E400 + i] = value >> 8 * i & 0xF0
            return
        if size < 4:
            shift, word = 8 * (a & 3), a & ~3
            mask = ((1 << 8 * size) - 1) << shift
            a, value = word, self.read_word(word) & ~mask | value << shift & mask
        peripheral = self.pages.get(a & ~0x3FF)
        if peripheral:
            peripheral.write(a & 0x3FF, value)
        elif self.usb and USB <= a < USB + 0x40000:
            self.usb.write(a - USB, value)
        elif 0xE000E100 <= a < 0xE000E300:
            first = (a & 0x1F) // 4 * 32
            irqs = {first + bit for bit in range(32) if value >> bit & 1}
            known = self.enabled if a < 0xE000E200 else self.pending
            # Set registers in the lower half of each range, clear registers in the upper.
            known.difference_update(irqs) if a & 0x80 else known.update(irqs)
        elif GPIO <= a < GPIO + 0x2400:
            self.write_gpio(a, value)
        elif a == 0xE000EF00:
            self.pend(value & 0x1FF)
        elif a == 0xE000ED04:
            self.pendsv |= bool(value & 1 << 28)
        elif a == 0xE000ED08:
            self.vectors = value or CODE
        elif a == 0xE000ED0C:
            if value >> 16 == 0x5FA and value & 4:
                self.reset("software")
        elif DWT <= a < DWT_LAR and self.registers.get(DWT_LAR) != DWT_KEY:
            pass
        elif a == SYSTICK_CONTROL:
            self.systick["control"] = value
            if value & 1:
                self.at(self.now + self.systick["reload"] + 1, self.on_systick)
        elif a == SYSTICK_CONTROL + 4:
            self.systick["reload"] = value
        elif a == RESET_FLAGS and value & 1 << 24:
            self.registers[a] = value & 1
        elif a == EXTI + 0x14:
            self.registers[a] = self.registers.get(a, 0) & ~value
        else:
            self.registers[a] = value

    def on_systick(self):
        if self.systick["control"] & 1:
            self.systick["control"] |= 1 << 16
            self.systick_due |= bool(self.systick["control"] & 2)
            self.at(self.now + self.systick["reload"] + 1, self.on_systick)

    # --- pins

    def write_gpio(self, a, value):
        port, offset = (a - GPIO) >> 10, a & 0x3FF
        if offset == 0x18:
            a, old = a - 4, self.registers.get(a - 4, 0)
            value = (old & ~(value >> 16)) | value & 0xFFFF
        if self.registers.get(a) == value:
            return
        self.registers[a] = value
        for number in range(16):
            name = f"P{'ABCDEFGHI'[port]}{number}"
            level = self.pin(name)
            if level != self.levels.get(name):
                self.levels[name] = level
                self.note(name, level)

    def pin(self, name):
        """The level the chip drives: 0, 1, or None while it drives nothing."""
        base, number = GPIO + 0x400 * "ABCDEFGHI".index(name[1]), int(name[2:])
        if self.registers.get(base, 0) >> 2 * number & 3 != 0b01:
            return None
        return self.registers.get(base + 0x14, 0) >> number & 1

    # --- run

    def run(self, seconds):
        """Lets time pass. Raises `PowerCut` if the power was ordered to go."""
        end = self.limit = self.now + seconds * self.CORE_HZ
        while self.now < end:
            self.run_events()
            exception = self.next_exception()
            if exception:
                self.enter(*exception)
            if self.is_locked_up or (self.is_thread_frozen and not self.active):
                self.now = min(max(self.now, self.events[0][0] if self.events else end), end)
                continue
            self.slept = self.returned = self.was_reset = False
            self.fresh, self.follows = True, None
            try:
                self.cpu.emu_start(self.pc, 0xFFFFFFFF)
            except UcError as error:
                self.fault(error)
                continue
            if self.cut:
                self.cut = False
                raise PowerCut
            if self.was_reset:
                continue
            self.pc = self.cpu.reg_read(UC_ARM_REG_PC) | 1
            if self.returned:
                self.leave()
            elif self.slept:
                self.pc += 2
                if not (self.pending & self.enabled or self.pendsv or self.systick_due):
                    self.now = min(max(self.now, self.events[0][0] if self.events else end), end)

    def run_until(self, is_so, seconds, step=0.002):
        """Lets time pass until `is_so()`; fails after so many seconds."""
        for _ in range(int(seconds / step) + 1):
            if is_so():
                return
            self.run(step)
        assert is_so(), f"not within {seconds} s"
