"""What ends the drive when host, program or supply fail, and how that is told (RELIABILITY, sections B and E)."""
import pytest

from boards import RENDERER_IRQ
from rig import MID, MILLISECOND, is_silent, start


def at_each_reset(rig):
    """A list that gets the mute pin's level and the DAC's code at each reset, as they are just before it: a reset lets the
    pin float, so afterwards nobody can tell."""
    seen, reset = [], rig.board.reset
    rig.board.reset = lambda cause: (seen.append((rig.board.pin(rig.facts.unmute), rig.board.dac.output)), reset(cause))
    return seen


@pytest.mark.every_image
def test_a_silent_host_is_noticed_by_the_device_itself(armed):
    """R-20: nothing about USB tells it, the cable stays in and the port open."""
    start(armed)
    last = armed.played()
    armed.host.lives = False
    armed.board.is_hasty = True
    armed.board.run(0.95)
    assert not is_silent(armed.codes(armed.played() - MILLISECOND, armed.played())), "not before its time"
    armed.board.run(0.3)
    assert is_silent(armed.codes(last + 1060 * MILLISECOND, armed.played()))
    assert armed.board.pin(armed.facts.unmute) == 0
    status = armed.host.status()
    assert (status["state"], status["first_fault"]) == ("fault", "host lost")


def test_a_pulled_cable_ends_in_silence_and_a_new_session(armed):
    """R-20, R-21, R-22."""
    start(armed)
    armed.cable.unplug()
    armed.board.is_hasty = True
    armed.board.run(1.3)
    assert armed.board.pin(armed.facts.unmute) == 0
    assert is_silent(armed.codes(armed.played() - MILLISECOND, armed.played()))
    armed.cable.plug()
    armed.host.inbox.clear()
    armed.host.connect()
    status = armed.host.status()
    assert (status["state"], status["first_fault"]) == ("fault", "host lost")
    assert armed.board.resets == [], "no watchdog, no crash"


def test_a_panic_mutes_first_and_is_told_at_the_next_hello(armed):
    """R-51."""
    start(armed)
    armed.facts.break_program(armed)
    armed.board.run_until(lambda: armed.board.resets, 0.01, step=0.0001)
    assert armed.board.resets == ["software"]
    low = max(entry[0] for entry in armed.board.log if entry[1] == armed.facts.unmute and entry[2] == 0)
    assert low <= armed.board.seconds
    armed.host.inbox.clear()
    identity = armed.host.connect()
    assert identity["reset"] == "panic"
    assert armed.facts.crash in identity["crash"], identity["crash"]
    status = armed.host.status()
    assert "crash" in status["faults"] and status["state"] == "fault"
    assert armed.board.pin(armed.facts.unmute) == 0


def test_mute_and_mid_scale_come_before_the_reset(armed):
    start(armed)
    seen = at_each_reset(armed)
    armed.facts.break_program(armed)
    armed.board.run_until(lambda: seen, 0.01, step=0.0001)
    assert seen == [(0, MID)]


def test_a_wild_jump_is_a_hard_fault_that_is_told(armed):
    start(armed)
    armed.board.pc = 0x60000001
    armed.board.run_until(lambda: armed.board.resets, 0.01, step=0.0001)
    identity = armed.host.connect()
    assert identity["reset"] == "hard fault"
    assert identity["crash"].startswith("fault at 0x6000000"), identity["crash"]


def test_a_stack_that_overflows_is_caught_and_told(armed):
    """The stack's memory has nothing below it."""
    from unicorn.arm_const import UC_ARM_REG_SP

    start(armed)
    armed.board.cpu.reg_write(UC_ARM_REG_SP, armed.board.STACK[0] + 8)
    armed.board.run_until(lambda: armed.board.resets, 0.05, step=0.0001)
    identity = armed.host.connect()
    assert identity["reset"] == "hard fault" and "stack overflow" in identity["crash"], identity["crash"]


def test_an_interrupt_without_a_handler_mutes_and_is_told(armed):
    """The window watchdog's: nothing of the firmware enables it."""
    start(armed)
    seen = at_each_reset(armed)
    armed.board.enabled.add(0)
    armed.board.pend(0)
    armed.board.run_until(lambda: seen, 0.01, step=0.0001)
    assert seen == [(0, MID)], "muted before the reset"
    identity = armed.host.connect()
    assert (identity["reset"], identity["crash"]) == ("hard fault", "unexpected exception 16")


def test_three_crashes_in_a_row_end_in_safe_mode(rig):
    for _ in range(3):
        rig.host.connect()
        rig.facts.break_program(rig)
        count = len(rig.board.resets)
        rig.board.run_until(lambda: len(rig.board.resets) > count, 0.01, step=0.0001)
        rig.host.inbox.clear()
    rig.host.connect()
    assert rig.host.status()["state"] == "safe mode"
    rig.board.reset("power")
    rig.host.inbox.clear()
    assert rig.host.connect()["reset"] == "power-on"
    assert rig.host.status()["state"] == "idle"


@pytest.mark.parametrize("frozen", ["renderer", "thread"])
def test_a_frozen_task_is_reset_by_the_watchdog(armed, frozen):
    """R-50."""
    start(armed)
    armed.board.is_hasty = True
    if frozen == "renderer":
        armed.board.enabled.discard(RENDERER_IRQ)
    else:
        armed.board.is_thread_frozen = True
    at = armed.board.seconds
    armed.board.run_until(lambda: armed.board.resets, 2 * armed.facts.watchdog_seconds, step=0.05)
    assert armed.board.resets == ["watchdog"]
    assert armed.board.seconds - at < armed.facts.watchdog_seconds + 0.3
    armed.host.inbox.clear()
    identity = armed.host.connect()
    assert identity["reset"] == "watchdog"
    assert "watchdog" in armed.host.status()["faults"]
    assert armed.board.pin(armed.facts.unmute) == 0


def test_a_dip_of_the_supply_mutes_and_is_told(armed):
    """R-56: at the threshold that the board's file derives."""
    start(armed)
    register, shift, level = armed.facts.detector
    assert armed.board.power.values[register] >> shift & 0b111 == level
    seen = at_each_reset(armed)
    assert armed.board.dip_supply(), "the detector is watched"
    armed.board.run_until(lambda: seen, 0.01, step=0.0001)
    assert seen == [(0, MID)], "muted before the reset"
    identity = armed.host.connect()
    assert identity["reset"] == "brown-out"
