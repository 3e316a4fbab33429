"""What register-level models of STM32 chips share: processor, exceptions, timers, pins, DMA, DAC, USB, watchdog.

A model is as strict as the chip is silent: a register that is not modelled, a peripheral whose clock is off, a clock
beyond its limit, a sequence that the reference manual forbids are failures of the test, not surprises on the bench.
"""
