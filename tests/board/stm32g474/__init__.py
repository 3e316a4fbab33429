"""A register-level STM32G474 that runs the flashed image itself; see `core` and `stm32f407` for what a model is.

Modelled from RM0440 (Rev 9): RCC with voltage ranges and boost, flash with two banks and error correction, DMA channels
behind the DMAMUX, DAC with its mode register, timers with outputs and break, USART2 with FIFOs.
"""
from core.processor import PowerCut
from core.uart import SerialHost

from .board import Board

__all__ = ["Board", "PowerCut", "SerialHost"]
