"""A wait that counts a register down, as `cortex_m::asm::delay` has it, of which the model makes many rounds at once.

    subs rN, #1
    bne  .-2

A round changes rN and its flags, and time passes. So rounds that begin before anything else can happen are left out, and the last of
them is executed, at the same time and with the same register. A program that waits for the watchdog costs the model a tenth.
"""
import struct

from unicorn.arm_const import UC_ARM_REG_R0

# subs rN, #1 with N in bits 8 to 10, and bne to it (ARMv7-M A7.7.174, T2; A7.7.12, T1).
SUBTRACT_ONE, REGISTER_AT, BACK = 0x3801, 8, 0xD1FD


def counted(code):
    """The register that a block of code counts down, as Unicorn's number; None for any other code."""
    if len(code) != 4:
        return None
    subtract, back = struct.unpack("<HH", code)
    if back != BACK or subtract & ~(7 << REGISTER_AT) != SUBTRACT_ONE:
        return None
    return UC_ARM_REG_R0 + (subtract >> REGISTER_AT & 7)


def rounds_to_leave_out(left, cycles, time):
    """Of `left` rounds, the last one stays; each takes `cycles` and must begin before `time` has passed."""
    return max(0, min(left - 1, int(time / cycles)))
