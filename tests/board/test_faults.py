"""The end of the drive when host, program or supply fail, and its report (RELIABILITY, sections B and E)."""
import pytest
from unicorn import arm_const

from boards import RENDERER_IRQ
from host import BLOCK, RATE_HZ
from messages import FaultOrder
from records import Choice
from rig import MID, MILLISECOND, is_silent, start


# The mute timer's time, and a block that was taken at the fault.
MUTED_IN = 0.0045
# The handler's time, from the fault to the reset.
HANDLED_IN = 0.0001


def at_each_reset(rig):
    """A list that gets the mute pin's level and the DAC's code at each reset, as they are just before it: a reset lets the
    pin float, so its level is lost afterwards."""
    seen, reset = [], rig.board.reset
    rig.board.reset = lambda cause: (seen.append((rig.board.pin(rig.facts.unmute), rig.board.dac.output)), reset(cause))
    return seen


@pytest.mark.every_image
def test_a_silent_host_is_noticed_by_the_device_itself(armed):
    """R-20: USB gives no sign of it, the cable stays in and the port open."""
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
    armed.host.forget()
    armed.host.connect()
    status = armed.host.status()
    assert (status["state"], status["first_fault"]) == ("fault", "host lost")
    assert armed.board.resets == [], "no watchdog, no crash"


def test_a_panic_mutes_first_and_is_reported_at_the_next_hello(armed):
    """R-51."""
    start(armed)
    armed.facts.break_program(armed)
    armed.board.run_until(lambda: armed.board.resets, 0.01, step=0.0001)
    assert armed.board.resets == ["software"]
    low = max(entry[0] for entry in armed.board.log if entry[1] == armed.facts.unmute and entry[2] == 0)
    assert low <= armed.board.seconds
    armed.host.forget()
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
    armed.board.run_until(lambda: seen, HANDLED_IN, step=10e-6)
    assert seen == [(0, MID)]


def test_a_wild_jump_is_a_hard_fault_that_is_reported(armed):
    start(armed)
    armed.board.pc = 0x60000001
    armed.board.run_until(lambda: armed.board.resets, 0.01, step=0.0001)
    identity = armed.host.connect()
    assert identity["reset"] == "hard fault"
    assert identity["crash"].startswith("fault at 0x6000000"), identity["crash"]


def run_code(rig, code, **registers):
    """The thread goes on with this code, which is put where nothing else is, and with these registers."""
    board = rig.board
    board.run_until(lambda: not board.active, 0.001, step=1e-6)
    ram = board.RAMS[-1]
    at = ram + board.MEMORIES[ram] - 64
    # An endless loop follows.
    board.cpu.mem_write(at, code + b"\xfe\xe7")
    board.pc = at | 1
    for name, value in registers.items():
        board.cpu.reg_write(getattr(arm_const, f"UC_ARM_REG_{name}"), value)
    return at


def muted_crash(rig, begins_in=0.0):
    """Waits for the reset after a fault that begins within `begins_in` seconds, for as long as its handler may take. Returns the
    message in the next hello."""
    seen = at_each_reset(rig)
    rig.board.run_until(lambda: seen, begins_in + HANDLED_IN, step=10e-6)
    assert seen == [(0, MID)], "muted before the reset"
    rig.host.forget()
    identity = rig.host.connect()
    assert identity["reset"] == "hard fault"
    return identity["crash"]


# push {r4-r7, lr}; str r1, [r0]; ldr r1, [r0]
PUSH, STORE, LOAD = b"\xf0\xb5", b"\x01\x60", b"\x01\x68"
LOST, KNOWN = "stack overflow, stack pointer {below:#010x}, CFSR ", "stack overflow at {at:#010x}, CFSR "
# The code; the stack pointer and the variable's address, from the stack's lower end; and the message.
OVERFLOWS = [
    pytest.param(b"", 8, 0, LOST + "0x00000010", id="an interrupt's frame", marks=pytest.mark.every_image),
    pytest.param(PUSH, 8, 0, LOST + "0x00000092", id="a push"),
    pytest.param(STORE, 256, -4, KNOWN + "0x00000082", id="a variable", marks=pytest.mark.every_image),
    pytest.param(STORE, 256, -(32 << 10), KNOWN + "0x00000082", id="a large variable"),
]


@pytest.mark.parametrize("code, above, variable, message", OVERFLOWS)
def test_a_stack_that_overflows_is_caught_and_reported(armed, code, above, variable, message):
    """The guard refuses the first write below the stack, and would if there were memory; nothing is written there."""
    start(armed)
    board, bottom = armed.board, armed.board.STACK[0]
    guard, noise = bottom - (32 << 10), bytes(range(256)) * 128
    board.cpu.mem_map(guard, len(noise))
    board.cpu.mem_write(guard, noise)
    board.mpu.apply()
    at = run_code(armed, code, SP=bottom + above, R0=bottom + variable)
    # Without code of its own the fault comes with the next interrupt: a block later at most.
    crash = muted_crash(armed, 0.0 if code else BLOCK / RATE_HZ)
    assert board.cpu.mem_read(guard, len(noise)) == noise
    assert crash == message.format(at=at, below=bottom + above - board.FRAME & ~7)


@pytest.mark.every_image
@pytest.mark.parametrize("code, offset", [(LOAD, 0), (STORE, 0xFFC)], ids=["read", "write"])
def test_an_access_through_a_null_pointer_is_caught_and_reported(armed, code, offset):
    """Nothing is read or written there, though there is memory at address 0 on every chip."""
    start(armed)
    board = armed.board
    before = board.cpu.mem_read(0, 0x1000)
    at = run_code(armed, code, R0=offset, R1=0x600DF00D)
    assert muted_crash(armed) == f"null pointer at {at:#010x}, CFSR 0x00000082"
    assert board.cpu.mem_read(0, 0x1000) == before


def test_an_interrupt_without_a_handler_mutes_and_is_reported(armed):
    """The window watchdog's: nothing of the firmware enables it."""
    start(armed)
    seen = at_each_reset(armed)
    armed.board.enabled.add(0)
    armed.board.pend(0)
    armed.board.run_until(lambda: seen, 0.01, step=0.0001)
    assert seen == [(0, MID)], "muted before the reset"
    identity = armed.host.connect()
    assert (identity["reset"], identity["crash"]) == ("hard fault", "unexpected exception 16")


# The reset, what the next hello names, the latched fault, and until when the pin is low: by the page of safety, and the watchdog's
# oscillator as the model has it.
ORDERED = {
    "Hang": ("watchdog", "watchdog", "watchdog", 0.35),
    "MaskedInterrupts": ("watchdog", "watchdog", "watchdog", MUTED_IN),
    "StackOverflow": ("software", "hard fault", "crash", HANDLED_IN),
}


def fail_on_purpose(rig, faults):
    """Orders each of these faults with the mute pin high, as the self-test does."""
    host, board = rig.host, rig.board
    host.connect()
    for fault in faults:
        reset, cause, latched, muted_in = ORDERED[fault]
        host.upload()
        host.arm()
        host.live(0.01)
        assert board.pin(rig.facts.unmute) == 1
        board.resets.clear()
        host.accept("FaultOrder", FaultOrder(Choice(fault), host.ask("FaultToken", answer="FaultTrial").token))
        seen = at_each_reset(rig)
        board.is_hasty = True
        board.run_until(lambda: seen, 0.8, step=0.001)
        board.is_hasty = False
        assert board.resets == [reset] and seen[0][0] == (fault == "Hang"), (fault, seen)
        del board.reset
        host.forget()
        identity = host.connect()
        assert identity["reset"] == cause
        last = host.ask("FaultToken", answer="FaultTrial").last
        assert (last.fault.name, last.by_reset) == (fault, fault == "Hang")
        assert last.muted_after_us <= muted_in * 1e6, last
        assert fault != "MaskedInterrupts" or last.muted_after_us >= 3600, last
        assert fault != "Hang" or last.muted_after_us >= 150_000, last
        status = host.status()
        assert (status["state"], status["faults"]) == ("fault", {latched}), "no safe mode"
        host.accept("ClearFaults")
    # Another reset forgets it.
    board.reset("pin")
    host.forget()
    assert host.connect()["reset"] == "pin"
    assert host.ask("FaultToken", answer="FaultTrial").last is None


@pytest.mark.every_image
def test_an_ordered_fault_mutes_in_time_and_does_not_count(rig):
    """R-36: three resets in a row that nobody had ordered would be safe mode."""
    fail_on_purpose(rig, ORDERED)


def test_three_crashes_in_a_row_end_in_safe_mode(rig):
    for _ in range(3):
        rig.host.connect()
        rig.facts.break_program(rig)
        count = len(rig.board.resets)
        rig.board.run_until(lambda: len(rig.board.resets) > count, 0.01, step=0.0001)
        rig.host.forget()
    rig.host.connect()
    assert rig.host.status()["state"] == "safe mode"
    rig.board.reset("power")
    rig.host.forget()
    assert rig.host.connect()["reset"] == "power on"
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
    armed.host.forget()
    identity = armed.host.connect()
    assert identity["reset"] == "watchdog"
    assert "watchdog" in armed.host.status()["faults"]
    assert armed.board.pin(armed.facts.unmute) == 0


def test_a_dip_of_the_supply_mutes_and_is_reported(armed):
    """R-56: at the threshold that the board's file derives."""
    start(armed)
    register, shift, level = armed.facts.detector
    assert armed.board.power.values[register] >> shift & 0b111 == level
    seen = at_each_reset(armed)
    assert armed.board.dip_supply(), "the detector is watched"
    armed.board.run_until(lambda: seen, HANDLED_IN, step=10e-6)
    assert seen == [(0, MID)], "muted before the reset"
    identity = armed.host.connect()
    assert identity["reset"] == "brown out"
