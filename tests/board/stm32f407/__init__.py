"""A register-level STM32F407 that runs the flashed image itself.

The Cortex-M4 is Unicorn's; the peripherals are modelled here and in `core` from the reference manual RM0090 (Rev 21):
RCC with the clock tree and its security system, PWR, FLASH (unlock, sector erase, programming), GPIO with alternate
functions and lock, timers with outputs and break, DMA streams (circular, half and whole flags), DAC (trigger, DMA
request, underrun), SysTick, NVIC with priorities and preemption, cycle counter, independent watchdog, debug unit, reset
causes, unique id, and the USB OTG_FS core with a host on the other end of the cable.

It is deterministic and some 25 to 100 times slower than the chip. WFE and WFI jump to the next event.

It is a model: what it does not model (bus contention, FIFO thresholds, analogue parts, exact instruction timing) it does
not prove, and where it and RM0090 differ, RM0090 is right.
"""
from core.processor import PowerCut
from core.usb import UsbHost

from .board import Board

__all__ = ["Board", "PowerCut", "UsbHost"]
