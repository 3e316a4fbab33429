"""The processor's own registers: interrupt controller, system control block, SysTick, cycle counter (ARMv7-M, part B3)."""

from . import mpu

BASE = 0xE000E000
SYSTICK_CONTROL, SYSTICK_RELOAD = 0xE010, 0xE014
CPUID, ICSR, VTOR, AIRCR, SCR, CCR, SHPR2, SHPR3, SHCSR, CFSR, MMFAR, BFAR, CPACR, STIR = (
    0xED00, 0xED04, 0xED08, 0xED0C, 0xED10, 0xED14, 0xED1C, 0xED20, 0xED24, 0xED28, 0xED34, 0xED38, 0xED88, 0xEF00,
)  # fmt: skip
FPCCR, DEMCR = 0xEF34, 0xEDFC
NMI, HARD_FAULT, PENDSV, SYSTICK = 2, 3, 14, 15
NMI_PRIORITY, HARD_FAULT_PRIORITY = -2, -1
KEY, RESET_REQUEST = 0x5FA, 1 << 2
# The trace unit, with the lock that it has on a Cortex-M7 (the same code runs there), and what switches it on.
DWT, DWT_COUNT, DWT_LAR, DWT_KEY, TRACE_ENABLED = 0x1000, 0x1004, 0x1FB0, 0xC5ACCE55, 1 << 24


class Nvic:
    """Everything from 0xE0000000 on that belongs to the core; offsets are from there."""

    def __init__(self, board, reset_values):
        self.board = board
        self.registers = {SCR: 0, CCR: 0x200, SHPR2: 0, SHPR3: 0, SHCSR: 0, CFSR: 0, MMFAR: 0, BFAR: 0, CPACR: 0, FPCCR: 0xC0000000}
        # Four priority bits, all of them for preemption.
        self.registers |= {AIRCR: 0xFA050000, DEMCR: 0, DWT: 0x40000000} | reset_values
        self.is_trace_unlocked = False
        self.enabled, self.pending, self.priorities = set(), set(), {}
        # Who holds a line up: called with no argument.
        self.lines = {}
        self.pendsv = self.systick_due = self.nmi_due = False
        self.systick = {"control": 0, "reload": 0}

    def add_line(self, irq, is_high):
        self.lines.setdefault(irq, []).append(is_high)

    def is_level_high(self, irq):
        """Whether a peripheral still holds its interrupt line."""
        return any(is_high() for is_high in self.lines.get(irq, ()))

    def is_due(self):
        return bool(self.pending or self.pendsv or self.systick_due or self.nmi_due)

    def wakes(self):
        """Whether WFE and WFI go on."""
        return bool(self.pending & self.enabled or self.pendsv or self.systick_due or self.nmi_due)

    def next(self, running, is_masked):
        """Priority and number of the exception to enter now, or None; `running` is the priority that runs."""
        if self.nmi_due and running > NMI_PRIORITY:
            return NMI_PRIORITY, NMI
        if is_masked:
            return None
        waiting = [(self.priorities.get(irq, 0), irq + 16) for irq in self.pending & self.enabled]
        if self.pendsv:
            waiting.append((self.registers[SHPR3] >> 16 & 0xFF, PENDSV))
        if self.systick_due:
            waiting.append((self.registers[SHPR3] >> 24, SYSTICK))
        return min((w for w in waiting if w[0] < running), default=None)

    def enter(self, exception):
        """The exception is active: it waits no more."""
        if exception == PENDSV:
            self.pendsv = False
        elif exception == SYSTICK:
            self.systick_due = False
        elif exception == NMI:
            self.nmi_due = False
        elif exception >= 16:
            self.pending.discard(exception - 16)

    # --- registers

    def read(self, offset):
        if offset in mpu.REGISTERS:
            return self.board.mpu.read(offset)
        if offset == DWT_COUNT:
            counts = self.registers[DEMCR] & TRACE_ENABLED and self.registers[DWT] & 1
            return self.board.core_cycles() & 0xFFFFFFFF if counts else 0
        if offset == ICSR:
            return self.board.active[-1][1] if self.board.active else 0
        if offset == VTOR:
            return self.board.vectors
        if offset == SYSTICK_CONTROL:
            control = self.systick["control"]
            self.systick["control"] &= ~(1 << 16)
            return control
        for start, irqs in ((0xE100, self.enabled), (0xE200, self.pending)):
            if start <= offset < start + 0x100:
                first = (offset & 0x1F) // 4 * 32
                return sum(1 << bit for bit in range(32) if first + bit in irqs)
        if 0xE400 <= offset < 0xE4F0:
            return sum(self.priorities.get(offset - 0xE400 + i, 0) << 8 * i for i in range(4))
        assert offset in self.registers, f"the core's register {0xE0000000 + offset:#x} is not in the model's table"
        return self.registers[offset]

    def write(self, offset, size, value):
        if offset in mpu.REGISTERS:
            self.board.mpu.write(offset, value)
            return
        if 0xE400 <= offset < 0xE4F0:
            for i in range(size):
                # Four priority bits.
                self.priorities[offset - 0xE400 + i] = value >> 8 * i & 0xF0
        elif 0xE100 <= offset < 0xE300:
            first = (offset & 0x1F) // 4 * 32
            irqs = {first + bit for bit in range(32) if value >> bit & 1}
            known = self.enabled if offset < 0xE200 else self.pending
            # Set registers in the lower half of each range, clear registers in the upper.
            known.difference_update(irqs) if offset & 0x80 else known.update(irqs)
        elif offset == STIR:
            self.pending.add(value & 0x1FF)
        elif offset == ICSR:
            self.pendsv |= bool(value & 1 << 28)
            self.nmi_due |= bool(value & 1 << 31)
        elif offset == VTOR:
            self.board.vectors = value or self.board.FLASH_START
        elif offset == AIRCR:
            if value >> 16 == KEY and value & RESET_REQUEST:
                self.board.reset("software")
        elif offset == DWT_LAR:
            self.is_trace_unlocked = value == DWT_KEY
        elif DWT <= offset < DWT_LAR:
            if self.is_trace_unlocked:
                self.registers[offset] = value
        elif offset == SYSTICK_CONTROL:
            self.systick["control"] = value
            if value & 1:
                self.plan_systick()
        elif offset == SYSTICK_RELOAD:
            self.systick["reload"] = value
        elif offset == CFSR:
            self.registers[CFSR] &= ~value
        else:
            self.registers[offset] = value

    def plan_systick(self):
        self.board.at(self.board.now + (self.systick["reload"] + 1) * self.board.cycle, self.on_systick)

    def on_systick(self):
        if self.systick["control"] & 1:
            self.systick["control"] |= 1 << 16
            self.systick_due |= bool(self.systick["control"] & 2)
            self.plan_systick()
