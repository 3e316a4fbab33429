"""A board without a program, whose registers a test writes: for the tests of the models themselves."""
from core.clocks import HSEON
from core.timer import ARR, CCR1, CR1, EGR, PSC, SR
from core.outputs import BDTR, CCER, CCMR2
from core.pins import AFRL, MODER
from stm32f407 import Board
from stm32f407.clocks import BASE as RCC

TIM1, TIM4, TIM6, TIM8 = 0x40010000, 0x40000800, 0x40001000, 0x40010400
GPIOB, FLASH_ACR, DBGMCU_APB1, DBGMCU_APB2 = 0x40020400, 0x40023C00, 0xE0042008, 0xE004200C
CFGR, PLLCFGR, CIR, AHB1ENR, APB1ENR, APB2ENR = RCC + 0x08, RCC + 0x04, RCC + 0x0C, RCC + 0x30, RCC + 0x40, RCC + 0x44
PLLON, PLL_IN_USE = 1 << 24, 0b10
# CCER: channel 3's outputs and their polarities. CCMR2: channel 3's modes, forced, and compare with the counter.
CC3E, CC3P, CC3NE, CC3NP = 1 << 8, 1 << 9, 1 << 10, 1 << 11
FORCED_LOW, FORCED_HIGH, PWM1, PWM2 = 4 << 4, 5 << 4, 6 << 4, 7 << 4
MOE, AOE, BKP, BKE, OSSR, OSSI = 1 << 15, 1 << 14, 1 << 13, 1 << 12, 1 << 11, 1 << 10
OIS3, OIS3N = 1 << 12, 1 << 13
CEN, OPM, ARPE = 1, 1 << 3, 1 << 7
CCR3 = CCR1 + 8
# TIM1 at 168 MHz, with the prescaler that makes a count a microsecond.
MICROSECOND, PRESCALER = 1e-6, 167


class Registers:
    """A board without a program, whose registers the test writes."""

    def __init__(self):
        self.board = Board()

    def write(self, address, value):
        self.board.bus_write(address, 4, value)

    def read(self, address):
        return self.board.bus_read(address, 4)

    def run_at_full_speed(self):
        """The clock tree of the F4DISCOVERY's file in firmware/stm32/src/board."""
        self.write(RCC, self.read(RCC) | HSEON)
        self.board.run(3e-3)
        self.write(PLLCFGR, 4 | 168 << 6 | 1 << 22 | 7 << 24)
        self.write(RCC, self.read(RCC) | PLLON)
        self.board.run(1e-3)
        self.write(FLASH_ACR, 5)
        self.write(CFGR, 0b101 << 10 | 0b100 << 13)
        self.write(CFGR, 0b101 << 10 | 0b100 << 13 | PLL_IN_USE)
        self.write(AHB1ENR, 0x1FF)
        self.write(APB2ENR, 1 | 1 << 14)
        self.write(APB1ENR, 1 << 4)

    def timer(self, control, compare, reload, mode=PWM2, enables=CC3NE, main=MOE | BKP):
        """TIM1's channel 3, set up as in the mute timer: one count a microsecond, its complementary output on PB1."""
        self.write(TIM1 + PSC, PRESCALER)
        self.write(TIM1 + ARR, reload)
        self.write(TIM1 + CCR3, compare)
        self.write(TIM1 + EGR, 1)
        self.write(TIM1 + SR, 0)
        self.write(TIM1 + CCMR2, mode)
        self.write(TIM1 + CCER, enables)
        self.write(TIM1 + BDTR, main)
        self.write(GPIOB + AFRL, 1 << 4)
        self.write(GPIOB + MODER, 0x280 | 2 << 2)
        self.write(TIM1 + CR1, control)

    def output(self, name="3N"):
        return self.board.timers[1].outputs.level(name)
