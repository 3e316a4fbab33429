"""A chip on its board: processor, bus, peripherals, reset, and what a test may do to it.

A chip's own class gives the facts (addresses, sizes, interrupts) and makes its peripherals (`make_peripherals`).
"""
import random
import struct

from unicorn import UC_HOOK_MEM_WRITE
from unicorn.arm_const import UC_ARM_REG_PC, UC_ARM_REG_PRIMASK

from .adc import INTERNAL_VOLTS
from .image import Idle, Image
from .nvic import Nvic
from .processor import PowerCut, Processor

PAGE = 0x3FF
SUPPLY_LINE = 16

__all__ = ["Board", "PowerCut"]


class Board(Processor):
    # The chip's facts, for its own class to give.
    CPU_MODEL = CORE_HZ = FLASH_START = STACK = SYSTEM_MEMORY = UNIQUE_ID = None
    # Address: size, of everything that is memory; which of it is RAM; and the address ranges of the peripherals.
    MEMORIES, RAMS, PERIPHERALS = {}, (), ()
    # Where the factory has written VREFINT's code, its full scale, and VREF+ then.
    INTERNAL_REFERENCE = None
    # The core's registers that differ from chip to chip after a reset.
    CORE_REGISTERS = {}
    # The registers of the memory protection unit.
    MPU_REGIONS = None
    SUPPLY_IRQ = 1
    # A register of SYSCFG and its bits that connect the supply detector and the core's lock-up with the timers' breaks.
    BREAK_SOURCES = None
    # The USB core, which is larger than a page.
    USB = None
    # An interrupt by which the ROM bootloader listens.
    ROM_IRQ = None
    # Plays half a ring of codes at once, when it is due: many times faster, but the DAC is not watched code by code.
    is_hasty = False

    def __init__(self, image=None):
        loaded = Image(image) if image else Idle(self.FLASH_START, sum(self.STACK))
        super().__init__(loaded)
        self.cpu.mem_write(self.UNIQUE_ID, b"SLIPLINE-VB1")
        address, full_scale, volts = self.INTERNAL_REFERENCE
        self.cpu.mem_write(address, struct.pack("<H", round(full_scale * INTERNAL_VOLTS / volts)))
        # The ROM bootloader: a vector table and an endless loop.
        self.cpu.mem_write(self.SYSTEM_MEMORY, struct.pack("<II", self.RAMS[-1] + 0x1000, self.SYSTEM_MEMORY + 0x101))
        self.cpu.mem_write(self.SYSTEM_MEMORY + 0x100, b"\xfe\xe7")
        for start in self.PERIPHERALS:
            self.cpu.mmio_map(
                start, 0x100000,
                lambda _, offset, size, __, start=start: self.bus_read(start + offset, size), None,
                lambda _, offset, size, value, __, start=start: self.bus_write(start + offset, size, value), None,
            )  # fmt: skip
        flash_end = self.FLASH_START + self.MEMORIES[self.FLASH_START] - 1
        self.watch_memory(UC_HOOK_MEM_WRITE, self.on_flash_store, self.FLASH_START, flash_end)
        # The USB core with its host, or the host at the other end of a serial line.
        self.usb = self.cable = None
        self.log, self.resets = [], []
        self.nvic = Nvic(self, self.CORE_REGISTERS)
        self.pages, self.timers, self.dma = {}, {}, {}
        # What else is reset with the chip.
        self.others = ()
        self.make_peripherals()
        self.reset("power")
        self.resets.clear()
        self.log.clear()

    def make_peripherals(self):
        """Makes `flash`, `clocks`, `power`, `exti`, `pins`, `timers`, `dac`, `adc`, `dma`, `watchdog`, `debug` and `pages`."""
        raise NotImplementedError

    # --- reset and power

    def reset(self, cause):
        """Everything but flash and RAM restarts; power-on leaves noise in the RAM as well."""
        self.resets.append(cause)
        if cause == "power":
            noise = random.Random(len(self.resets))
            for start in self.RAMS:
                content = noise.randbytes(self.MEMORIES[start])
                self.cpu.mem_write(start, content)
                if start == self.STACK[0]:
                    self.stack.noise = content[: self.STACK[1]]
            self.flash.cut_at, self.flash.is_cut_clean = None, False
            self.debug.power_on()
        self.flash.settle()
        lines = self.nvic.lines
        self.reset_processor(Nvic(self, self.CORE_REGISTERS))
        self.nvic.lines = lines
        self.is_halted = False
        self.clocks.reset(cause)
        self.set_core_hz(self.clocks.frequencies.core)
        for peripheral in (self.flash, self.power, self.exti, self.pins, self.watchdog, self.dac, self.adc, *self.dma.values(), *self.others):
            peripheral.reset()
        for timer in self.timers.values():
            timer.is_frozen = False
            timer.reset()
        if self.usb:
            self.usb.reset()
        if self.cable:
            self.cable.reset()

    def leave_bootloader(self):
        """The ROM jumps to the program: nothing is reset, its own vectors are in force, its interrupts may wait."""
        self.start_program()
        self.vectors = self.SYSTEM_MEMORY
        self.enabled.add(self.ROM_IRQ)
        self.pend(self.ROM_IRQ)
        self.cpu.reg_write(UC_ARM_REG_PRIMASK, 1)

    def cut_power(self):
        self.cut = self.must_stop = True
        self.cpu.emu_stop()

    def note(self, *what):
        self.log.append((self.seconds, *what))

    # --- the bus

    def bus_read(self, address, size):
        word = self.read_word(address & ~3)
        return (word >> 8 * (address & 3)) & ((1 << 8 * size) - 1)

    def read_word(self, a):
        if a >= 0xE0000000 and a & ~PAGE not in self.pages:
            return self.nvic.read(a - 0xE0000000)
        start, peripheral = self.peripheral(a)
        # What has no clock reads as 0 (RM0090 7.3.12, note). The USB driver does so before it starts the core.
        return peripheral.read(a - start) & 0xFFFFFFFF if self.clocks.is_clocked(start) else 0

    def bus_write(self, a, size, value):
        if a >= 0xE0000000 and a & ~PAGE not in self.pages:
            self.nvic.write(a - 0xE0000000, size, value)
            return
        if size < 4:
            shift, word = 8 * (a & 3), a & ~3
            mask = ((1 << 8 * size) - 1) << shift
            a, value = word, self.read_word(word) & ~mask | value << shift & mask
        start, peripheral = self.peripheral(a)
        assert self.clocks.is_clocked(start), f"a write to {a:#x}, whose clock is off"
        peripheral.write(a - start, value)

    def peripheral(self, a):
        """Start and peripheral of the page, or of the USB core, in which an address lies."""
        page = a & ~PAGE
        if page in self.pages:
            return page, self.pages[page]
        if self.USB is not None and self.USB <= a < self.USB + 0x40000:
            return self.USB, self.usb or Nobody()
        raise AssertionError(f"nothing is modelled at {a:#x} (pc {self.cpu.reg_read(UC_ARM_REG_PC):#x})")

    def add_line(self, irq, is_high):
        self.nvic.add_line(irq, is_high)

    def request_dma(self, name):
        """A peripheral's request; returns whether a stream answers it."""
        raise NotImplementedError

    def pin(self, name):
        """The level the chip drives: 0, 1, or None while it drives nothing."""
        return self.pins.level(name)

    def on_flash_store(self, _, __, address, size, value, ___):
        self.flash.programmed(address, size, value & ((1 << 8 * size) - 1))

    # --- what a test does to it

    def is_break_source(self, bit):
        """Whether a bit of SYSCFG connects what it stands for with the timers' breaks."""
        offset = self.BREAK_SOURCES[0]
        return bool(self.system.values[offset] & bit)

    def break_timers(self):
        for timer in self.timers.values():
            timer.break_in(by_system=True)

    def lock_up(self):
        """The core stops for good (ARMv7-M B1.5.15)."""
        super().lock_up()
        if self.BREAK_SOURCES and self.is_break_source(self.BREAK_SOURCES[2]):
            self.break_timers()

    def dip_supply(self):
        """The supply falls below the detector's threshold; False if nobody watches."""
        if self.BREAK_SOURCES and self.power.is_supply_watched() and self.is_break_source(self.BREAK_SOURCES[1]):
            self.break_timers()
        if self.power.is_supply_watched() and self.exti.rise(SUPPLY_LINE):
            self.pend(self.SUPPLY_IRQ)
            return True
        return False

    def stop_crystal(self):
        """The crystal, or what feeds the clock instead, stops; see `Clocks.stop_crystal`."""
        self.clocks.stop_crystal()

    def start_crystal(self):
        self.clocks.start_crystal()

    def halt(self):
        """A debugger halts the core: what the debug unit freezes with it stands still, the rest of the chip goes on."""
        self.is_halted = self.must_stop = True
        self.cpu.emu_stop()
        self.debug.show()

    def resume(self):
        self.is_halted = False
        self.debug.show()

    def is_nmi_held(self):
        return self.clocks.is_failed or self.flash.is_nmi_held()

    @property
    def watches_stacks(self):
        return self.stack.is_on

    @watches_stacks.setter
    def watches_stacks(self, is_on):
        self.stack.is_on = is_on

    def thread_depth(self):
        """Bytes of stack that the program needs in thread mode; see `StackWatch.thread_depth`."""
        return self.stack.thread_depth(self.traces)


class Nobody:
    """A USB core whose cable nobody has plugged in."""

    def read(self, _):
        return 0

    def write(self, _, __):
        pass
