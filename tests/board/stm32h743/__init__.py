"""A register-level STM32H743 that runs the flashed image itself; see `core` and `stm32f407` for what a model is.

Modelled from RM0433: RCC with its three PLLs and voltage scales, flash with two banks and error correction, DMA streams
behind the DMAMUX, DAC, timers with outputs and break, and the USB OTG core at its own address.

The Cortex-M7 is charged what a Cortex-M4 takes for each instruction, which is more than it needs.
"""
from core.processor import PowerCut
from core.usb import UsbHost

from .board import Board

__all__ = ["Board", "PowerCut", "UsbHost"]
