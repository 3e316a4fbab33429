"""The processor: Unicorn's core, its exceptions, and the time that its instructions take."""
import struct

from unicorn import (
    UC_ARCH_ARM, UC_HOOK_BLOCK, UC_HOOK_CODE, UC_HOOK_MEM_INVALID, UC_MODE_MCLASS, UC_MODE_THUMB, Uc, UcError,
)  # fmt: skip
from unicorn.arm_const import (
    UC_ARM_REG_BASEPRI, UC_ARM_REG_FAULTMASK, UC_ARM_REG_LR, UC_ARM_REG_PC, UC_ARM_REG_PRIMASK, UC_ARM_REG_R0,
    UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, UC_ARM_REG_R4, UC_ARM_REG_R12, UC_ARM_REG_SP, UC_ARM_REG_XPSR,
)  # fmt: skip

from m4_timing import REFILL, Timing

from .agenda import Agenda
from .countdown import counted, rounds_to_leave_out
from .faults import DATA_ERROR, Faults
from .memory import Memory
from .mpu import Mpu
from .nvic import CFSR, HARD_FAULT, HARD_FAULT_PRIORITY
from .stack import StackWatch, Trace

# The bits of xPSR with the state of an IT block (ARMv7-M B1.4.2).
IT_STATE = 0b11 << 25 | 0b111111 << 10
# A page nothing else uses: a handler's return address points here.
RETURN = 0x0FFF0000
FRAME_REGISTERS = (
    UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR,
)  # fmt: skip
REGISTERS = (
    UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, *range(UC_ARM_REG_R4, UC_ARM_REG_R4 + 8),
    UC_ARM_REG_R12, UC_ARM_REG_SP, UC_ARM_REG_LR,
)  # fmt: skip


class PowerCut(Exception):
    """The supply is gone; only the flash keeps what it had. Begin again with `Board.reset("power")`."""


class Processor(Faults, Agenda):
    # Entering an exception and leaving it: twelve and ten cycles (Cortex-M4 TRM), and seventeen for the floating-point
    # registers that are saved when the handler uses them first. Every exception is taken as one that does, after code
    # that did: nothing is cheaper or shallower than it may be.
    ENTRY_CYCLES, EXIT_CYCLES = 12 + 17, 10
    # The frame of an exception with floating point (ARMv7-M B1.5): eight registers, S0 to S15, FPSCR, one reserved.
    FRAME = 4 * (8 + 18)

    def __init__(self, image):
        self.cpu = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self.cpu.ctl_set_cpu_model(self.CPU_MODEL)
        self.memories = {start: Memory(self.cpu, start, size) for start, size in (*self.MEMORIES.items(), (RETURN, 4096))}
        self.cpu.mem_write(RETURN, b"\xfe\xe7" * 64)
        self.cpu.mem_write(self.FLASH_START, b"\xff" * self.MEMORIES[self.FLASH_START])
        for address, data in image.segments:
            self.cpu.mem_write(address, data)
        self.symbols, self.barriers = image.symbols, image.barriers
        self.stack = StackWatch(self.cpu, *self.STACK)
        self.timing, self.costs = Timing(self.cpu.mem_read), {}
        # What comes next in memory after a block of code that may jump.
        self.follows = None
        self.block_hook = self.cpu.hook_add(UC_HOOK_BLOCK, self.on_block)
        self.cpu.hook_add(UC_HOOK_CODE, self.on_return, begin=RETURN, end=RETURN + 64)
        self.cpu.hook_add(UC_HOOK_MEM_INVALID, self.on_invalid_access)
        for addresses, hook in (
            (image.event_waits, self.on_event_wait), (image.interrupt_waits, self.on_interrupt_wait),
            (image.signals, self.on_signal), (image.masks, self.on_mask), (image.unmasks, self.on_unmask),
        ):  # fmt: skip
            for address in addresses:
                self.cpu.hook_add(UC_HOOK_CODE, hook, begin=address, end=address + 1)
        # What has happened ends the emulation of the present block: a reset, a halt, a lost clock.
        self.must_stop = False
        Agenda.__init__(self)
        # Priority and exception of the handlers under way, the outermost first.
        self.active = []
        self.mpu = Mpu(self, self.MPU_REGIONS)
        # The access that Unicorn's memory has refused: its kind, address and size.
        self.invalid_access = None
        # The most cycles for which all interrupts were masked, and who called the function that ended it.
        self.masked_since, self.worst_masked = None, (0, 0)
        # By exception: the most cycles it has taken, without those that interrupted it. By priority: the deepest stack.
        self.worst_cycles, self.worst_depth = {}, {}
        self.cut = False
        # For tests: the thread's code stands still, or a debugger has halted the whole core.
        self.is_thread_frozen = self.is_halted = False

    def reset_processor(self, nvic):
        self.nvic = nvic
        self.enabled, self.pending, self.priorities = nvic.enabled, nvic.pending, nvic.priorities
        self.events.clear()
        self.active, self.saved, self.traces = [], [], []
        self.mpu.reset()
        self.is_thread_frozen = self.is_locked_up = False
        self.faults = []
        self.slept = self.returned = self.fresh = self.is_event_latched = False
        self.masked_since = self.bus_error = None
        self.counted_cycles, self.counted_at = 0, self.now
        self.cpu.reg_write(UC_ARM_REG_PRIMASK, 0)
        self.cpu.reg_write(UC_ARM_REG_FAULTMASK, 0)
        self.start_program()
        self.was_reset = self.must_stop = True
        self.cpu.emu_stop()

    def start_program(self):
        """Stack and entry from the vector table at the flash's beginning."""
        self.vectors = self.FLASH_START
        stack, entry = struct.unpack("<II", self.cpu.mem_read(self.FLASH_START, 8))
        self.cpu.reg_write(UC_ARM_REG_SP, stack)
        self.pc = entry | 1

    def memory_at(self, address):
        """The bytes of the memory at an address, and the address in it. Code that runs must be written through the core."""
        start = max(start for start in self.memories if start <= address)
        return self.memories[start].memory, address - start

    # --- hooks

    def watch_memory(self, kind, hook, begin, end):
        """Calls the hook at every access of the kind.

        Unicorn 2.1 shows a hook the IT block in which the access stands, by putting its state back into xPSR, and forgets it
        there: what the program does after the block would go by its condition. The state of code that runs is in its
        translation, and what stops within a block writes it again."""

        def on_access(*access):
            hook(*access)
            state = self.cpu.reg_read(UC_ARM_REG_XPSR)
            if state & IT_STATE:
                self.cpu.reg_write(UC_ARM_REG_XPSR, state & ~IT_STATE)

        self.cpu.hook_add(kind, on_access, begin=begin, end=end)

    def on_block(self, _, address, size, ___):
        if not self.fresh:
            events = self.events
            if events and events[0][0] <= self.now:
                self.run_events()
            if self.must_stop or self.now >= self.limit or (self.nvic.is_due() and self.next_exception()):
                # The block is entered again, and paid for, afterwards.
                self.cpu.emu_stop()
                return
        # Make progress even if an event is due.
        self.fresh = False
        block = (address, size)
        known = self.costs.get(block)
        if known is None:
            known = self.costs[block] = *self.timing.straight(address, size), counted(self.cpu.mem_read(address, size))
        # A jump is known for one when the next block of code begins elsewhere.
        self.now += (known[0] + (REFILL if self.follows not in (None, address) else 0)) * self.cycle
        self.follows = address + size if known[1] else None
        self.block_end = address + size
        if known[2] is not None:
            self.leave_rounds_out(known[2], (known[0] + REFILL) * self.cycle)

    def leave_rounds_out(self, register, cycles):
        """The round of a wait that was paid for is its last one before something happens."""
        left = self.cpu.reg_read(register) or 1 << 32
        until = min(self.limit, self.events[0][0]) if self.events else self.limit
        out = rounds_to_leave_out(left, cycles, until - self.now)
        self.cpu.reg_write(register, left - out & 0xFFFFFFFF)
        self.now += out * cycles

    def on_event_wait(self, *_):
        """WFE sleeps only while no event is latched (ARMv7-M B1.5.18)."""
        self.on_interrupt_wait()
        self.must_sleep, self.is_event_latched = not self.is_event_latched, False

    def on_interrupt_wait(self, *_):
        self.slept = self.must_sleep = True
        self.cpu.emu_stop()

    def on_signal(self, *_):
        """SEV."""
        self.is_event_latched = True

    def instant(self, address):
        """The time at an instruction of the block of code under way, which has been paid for as a whole."""
        return self.now - self.timing.straight(address, self.block_end - address)[0] * self.cycle

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

    def on_barrier(self, *_):
        """What waits at a barrier, an NMI of the flash above all, comes before it."""
        if self.nvic.is_due() and self.next_exception():
            self.cpu.emu_stop()

    def on_return(self, *_):
        self.returned = True
        self.cpu.emu_stop()

    # --- exceptions

    def pend(self, irq):
        self.pending.add(irq)

    def next_exception(self):
        """Priority and number of the exception to enter now, or None."""
        running = min((priority for priority, _ in self.active), default=256)
        # Masks only hold back. Reading the core's registers takes much longer than looking for what may wait.
        if not self.nvic.next(running, False):
            return None
        is_masked = self.cpu.reg_read(UC_ARM_REG_PRIMASK) & 1 or self.cpu.reg_read(UC_ARM_REG_FAULTMASK) & 1
        return self.nvic.next(min(running, self.cpu.reg_read(UC_ARM_REG_BASEPRI) or 256), is_masked)

    def enter(self, priority, exception):
        self.now += self.ENTRY_CYCLES * self.cycle
        cpu = self.cpu
        stack = cpu.reg_read(UC_ARM_REG_SP) - self.FRAME & ~7
        refusal = self.refusal_of_frame(stack)
        if refusal:
            # The fault comes before the exception, which waits on; while a hard fault or an NMI is entered it is only noted.
            self.nvic.registers[CFSR] |= refusal
            priority, exception = min((priority, exception), (HARD_FAULT_PRIORITY, HARD_FAULT))
        self.nvic.enter(exception)
        self.saved.append((cpu.context_save(), self.pc))
        self.active.append((priority, exception))
        above = cpu.reg_read(UC_ARM_REG_SP)
        self.traces.append(Trace(self.now - self.ENTRY_CYCLES * self.cycle, above, self.stack.paint_below(above)))
        frame = [cpu.reg_read(register) for register in FRAME_REGISTERS] + [self.pc & ~1, cpu.reg_read(UC_ARM_REG_XPSR)]
        if not refusal:
            cpu.mem_write(stack, struct.pack("<8I", *frame))
        cpu.reg_write(UC_ARM_REG_SP, stack)
        # Unicorn may stop inside an IT block, where a page ends; the handler begins outside of it (ARMv7-M B1.5.6).
        cpu.reg_write(UC_ARM_REG_XPSR, cpu.reg_read(UC_ARM_REG_XPSR) & ~IT_STATE)
        cpu.reg_write(UC_ARM_REG_LR, RETURN | 1)
        self.pc = struct.unpack("<I", cpu.mem_read(self.vectors + 4 * exception, 4))[0] | 1
        if priority < 0:
            self.mpu.apply()

    def leave(self):
        self.now += self.EXIT_CYCLES * self.cycle
        context, self.pc = self.saved.pop()
        priority, exception = self.active.pop()
        if priority < 0:
            self.mpu.apply()
        self.cpu.context_restore(context)
        # The return of an exception is an event.
        self.is_event_latched = True
        trace = self.traces.pop()
        cycles = self.now - trace.entered
        self.worst_cycles[exception] = max(self.worst_cycles.get(exception, 0), cycles - trace.interrupted)
        if self.traces:
            self.traces[-1].interrupted += cycles
        if trace.below:
            depth = trace.above - self.stack.restore_below(trace)
            self.worst_depth[priority] = max(self.worst_depth.get(priority, 0), depth)
        if exception >= 16 and self.nvic.is_level_high(exception - 16):
            self.pend(exception - 16)
        self.nvic.nmi_due |= self.is_nmi_held()

    def is_nmi_held(self):
        """Whether the NMI's source is still there."""
        return False

    # --- run

    def is_standing(self):
        """Whether the core executes nothing now, whatever waits for it."""
        return self.is_locked_up or self.is_halted or not self.core_hz or (self.is_thread_frozen and not self.active)

    def run(self, seconds):
        """Lets time pass. Raises `PowerCut` if the power was ordered to go."""
        end = self.limit = self.now + seconds * self.CORE_HZ
        while self.now < end:
            self.run_events()
            exception = None if self.is_halted or self.is_locked_up or not self.core_hz else self.next_exception()
            if exception:
                self.enter(*exception)
            if self.is_standing():
                self.now = min(max(self.now, self.events[0][0] if self.events else end), end)
                continue
            self.slept = self.returned = self.was_reset = self.must_stop = False
            self.fresh, self.follows = True, None
            try:
                self.cpu.emu_start(self.pc, 0xFFFFFFFF)
            except UcError as error:
                self.fault(error, self.status_of_refusal())
                continue
            if self.cut:
                self.cut = False
                raise PowerCut
            if self.was_reset:
                continue
            if self.bus_error is not None:
                error, self.bus_error = f"bus error at {self.bus_error:#x}", None
                self.fault(error, DATA_ERROR)
                continue
            self.pc = self.cpu.reg_read(UC_ARM_REG_PC) | 1
            if self.returned:
                self.leave()
            elif self.slept:
                self.pc += 2
                if self.must_sleep:
                    self.sleep(end)

    def sleep(self, end):
        """Lets time pass, from event to event, until something wakes the core, at most until `end`."""
        while self.now < end and not self.must_stop and not self.nvic.wakes():
            self.now = min(max(self.now, self.events[0][0] if self.events else end), end)
            self.run_events()

    def run_until(self, is_so, seconds, step=0.002):
        """Lets time pass until `is_so()`; fails after `seconds`."""
        for _ in range(int(seconds / step) + 1):
            if is_so():
                return
            self.run(step)
        assert is_so(), f"not within {seconds} s"
