"""The stop on the desk: the user button and the stop input; and the resistor at the mute pin."""
import zlib

import pytest
from unicorn.arm_const import UC_ARM_REG_PRIMASK

from copies import on_copy
from core.outputs import BDTR
from host import BLOCK, RATE_HZ, drive, profile
from leaps import leap
from messages import ArmLease, DigestStart
from rig import MID, MILLISECOND, start


@pytest.mark.every_image
@pytest.mark.parametrize("late", [0.0, 0.00011, 0.00023], ids=lambda late: f"{late * 1e6:.0f} us")
def test_the_button_silences_and_mutes_without_a_host(armed, late):
    """R-80: two equal samples at the blocks' rate, a ramp of 2 ms, and the blocks of mid-scale behind it."""
    start(armed)
    armed.board.run(late)
    pressed, at = armed.played(), armed.board.seconds
    armed.board.pins.drive(armed.facts.button, 1)
    armed.board.run(0.01)
    (low,) = [when for when, name, level in pin_log(armed) if level == 0 and when > at]
    assert low < at + 0.01
    armed.board.run(0.005)
    codes = armed.codes(pressed, armed.played())
    assert any(code != MID for code in codes[: 2 * MILLISECOND])
    assert all(code == MID for code in codes[5 * MILLISECOND :])
    status = armed.host.status()
    assert (status["state"], status["first_fault"]) == ("fault", "desk stop")
    assert abs(status["first_fault_at"] - pressed) < 5 * 128
    # Held, it keeps the device from being driven.
    armed.host.accept("ClearFaults")
    assert armed.host.exchange("Arm").name == "Refused"
    assert armed.host.status()["faults"] == {"desk stop"}
    # Released, it does so for 2 s: the next test.
    armed.board.pins.drive(armed.facts.button, 0)
    armed.host.accept("ClearFaults")
    assert armed.host.exchange("Arm").name == "Refused"


# The application's matter, not the chip's: the other images have it at night.
def test_for_two_seconds_after_its_release_no_host_clears_the_stop(armed):
    """R-80: a host that clears, arms and drives at once has the plate moving again before the hand is away."""
    host, board = armed.host, armed.board
    start(armed)
    board.pins.drive(armed.facts.button, 1)
    host.live(0.01)
    board.pins.drive(armed.facts.button, 0)
    released = host.status()["now"]
    for seconds, is_cleared in ((1.98, False), (0.04, True)):
        leap(armed, seconds)
        host.accept("ClearFaults")
        status = host.status()
        assert status["faults"] == (set() if is_cleared else {"desk stop"}), status["now"] - released
        assert (status["now"] - released > 2 * RATE_HZ) == is_cleared
    host.arm()
    start(armed)
    assert board.pin(armed.facts.unmute) == 1


@pytest.mark.every_image
@pytest.mark.parametrize("rest", [0, 1])
def test_a_press_is_the_level_that_the_button_did_not_have_at_the_start(rig, rest):
    """R-80: the boards' sources do not agree on the level. One that is held at the start reads as pressed when it is released."""
    board, host = rig.board, rig.host
    board.pins.resistors[rig.facts.button] = rest
    host.connect()
    host.live(0.005)
    assert host.board_report()[2] == "released"
    host.upload()
    host.arm()
    board.pins.drive(rig.facts.button, 1 - rest)
    assert host.board_report()[2] == "pressed"
    host.live(0.01)
    assert host.status()["first_fault"] == "desk stop" and board.pin(rig.facts.unmute) == 0
    # Held at the start.
    board.reset("pin")
    host.forget()
    host.connect()
    host.live(0.005)
    assert host.board_report()[2] == "released"
    board.pins.drive(rig.facts.button, None)
    assert host.board_report()[2] == "pressed" and host.exchange("Arm").name == "Refused"
    assert board.pin(rig.facts.unmute) == 0


def test_a_press_shorter_than_a_block_does_nothing(armed):
    """R-80."""
    start(armed)
    for _ in range(8):
        armed.board.pins.drive(armed.facts.button, 1)
        armed.board.run(0.0003)
        armed.board.pins.drive(armed.facts.button, 0)
        armed.board.run(0.00055)
    assert armed.host.status()["state"] == "driving"


@pytest.mark.every_image
def test_without_the_resistor_the_mute_pin_never_rises(rig):
    """R-82: the pin is looked at before anything drives it; everything else works."""
    rig.board.pins.resistors.clear()
    rig.host.connect()
    assert rig.host.board_report() == (rig.board.CORE_HZ, "missing", "released", "unused")
    rig.host.upload()
    rig.host.arm()
    at = rig.host.accept("Drive", drive([(0, 0.4, 0.5)], 5 * MILLISECOND))
    first, count = at + 10 * BLOCK, 20 * MILLISECOND
    rig.host.accept("DigestStart", DigestStart(first, count))
    rig.host.live(0.05)
    assert rig.host.status()["state"] == "driving" and max(rig.board.dac.codes) > MID + 300
    # The device reports the codes that its pin has played.
    digest = rig.host.ask("DigestRead", answer="Digest")
    codes = b"".join(code.to_bytes(2, "little") for code in rig.codes(first, first + count))
    assert (digest.from_, digest.count, digest.crc) == (first, count, zlib.crc32(codes))
    assert not any(level for _, _, level in pin_log(rig))
    # Until a reset finds it.
    rig.board.pins.resistors[rig.facts.unmute] = 0
    rig.board.reset("pin")
    rig.host.forget()
    rig.host.connect()
    assert rig.host.board_report()[1] == "present"
    rig.host.upload()
    rig.host.arm()
    assert rig.board.pin(rig.facts.unmute) == 1


def fitted(rig):
    """A board whose profile says that a stop input is fitted; the input is closed."""
    rig.board.pins.drive(rig.facts.stop_input, 0)
    rig.host.connect()
    # The button's level at rest is known.
    rig.host.live(0.005)
    rig.board.pins.drive(rig.facts.button, 1)
    rig.host.live(0.01)
    rig.host.accept("WriteProfile", profile("coil", stop_input=True), patience=rig.facts.store_seconds)
    rig.board.pins.drive(rig.facts.button, 0)
    assert rig.host.board_report()[3] == "closed"
    # A start forgets that the button was pressed, for which a stop could not be cleared for 2 s.
    rig.board.reset("pin")
    rig.host.forget()
    rig.host.connect()


def hang(rig):
    rig.board.is_thread_frozen = True


def mask(rig):
    rig.board.run_until(lambda: not rig.board.active, 0.001, step=1e-6)
    rig.board.cpu.reg_write(UC_ARM_REG_PRIMASK, 1)
    rig.board.pc = rig.facts.rom + 0x101


DEAD = {"alive": lambda _: None, "thread hung": hang, "interrupts masked": mask, "halted": lambda rig: rig.board.halt(), "locked up": lambda rig: rig.board.lock_up()}


@pytest.mark.every_image
def test_the_stop_input_mutes_by_hardware_whatever_the_core_does(rig):
    """R-80."""
    fitted(rig)
    rig.host.upload()
    rig.host.arm()
    start(rig)

    def case(rig, state):
        DEAD[state](rig)
        rig.board.run(0.001)
        if state == "locked up" and rig.board.BREAK_SOURCES:
            return
        assert rig.board.pin(rig.facts.unmute) == 1
        # A wire that is cut: the chip's own resistor pulls up.
        rig.board.pins.drive(rig.facts.stop_input, None)
        rig.board.run(20e-6)
        assert rig.board.pin(rig.facts.unmute) == 0
        if state != "alive":
            return
        rig.host.live(0.005)
        status = rig.host.status()
        assert (status["first_fault"], status["underruns"]) == ("desk stop", 0)
        rig.host.accept("ClearFaults")
        assert rig.host.exchange("Arm").name == "Refused"
        rig.board.pins.drive(rig.facts.stop_input, 0)
        rig.host.accept("ClearFaults")
        rig.host.arm()
        start(rig)
        assert rig.board.pin(rig.facts.unmute) == 1

    for state in DEAD:
        on_copy(rig, lambda copy: case(copy, state))


def test_the_stop_input_ends_a_drive_on_the_bench(rig):
    """The timer's output is off all the time: only the break's flag shows it. An input that was open before does not count."""
    fitted(rig)
    rig.host.upload()
    rig.board.pins.drive(rig.facts.stop_input, None)
    rig.host.live(0.005)
    rig.board.pins.drive(rig.facts.stop_input, 0)
    rig.host.accept("Bench", ArmLease(60_000))
    rig.host.live(0.005)
    start(rig)
    assert rig.host.status()["state"] == "driving"
    rig.board.pins.drive(rig.facts.stop_input, None)
    rig.board.run(20e-6)
    rig.board.pins.drive(rig.facts.stop_input, 0)
    rig.host.live(0.005)
    status = rig.host.status()
    assert (status["state"], status["first_fault"], status["underruns"]) == ("fault", "desk stop", 0)
    assert not any(entry[1] == rig.facts.unmute and entry[2] == 1 for entry in rig.board.log)


def test_a_spike_on_the_stop_wire_is_reported_as_the_stop_that_it_is(rig):
    """R-80: it is over when the renderer looks; the break's flag stays."""
    fitted(rig)
    rig.host.upload()
    rig.host.arm()
    start(rig)

    def case(rig, seconds, late):
        rig.board.run(late)
        rig.board.pins.drive(rig.facts.stop_input, None)
        rig.board.run(seconds)
        rig.board.pins.drive(rig.facts.stop_input, 0)
        assert rig.board.pin(rig.facts.unmute) == 0
        rig.host.live(0.005)
        status = rig.host.status()
        assert (status["state"], status["first_fault"], status["underruns"]) == ("fault", "desk stop", 0)
        rig.host.accept("ClearFaults")
        rig.host.arm()
        start(rig)
        # What the flag of before says counts no more: an amplifier that goes off now has no blocks.
        assert rig.host.status()["faults"] == set() and rig.board.pin(rig.facts.unmute) == 1
        rig.board.timers[rig.facts.mute_timer].write(BDTR, 0)
        rig.host.live(0.005)
        assert rig.host.status()["first_fault"] == "underrun"

    for seconds, late in ((1e-6, 0), (1e-6, 0.00017), (100e-6, 0)):
        on_copy(rig, lambda copy: case(copy, seconds, late))


@pytest.mark.every_image
def test_a_stop_input_that_is_open_from_the_start_keeps_it_from_being_armed(rig):
    """R-80."""
    fitted(rig)
    rig.board.pins.drive(rig.facts.stop_input, None)
    rig.board.reset("power")
    rig.board.log.clear()
    rig.host.forget()
    rig.host.connect()
    assert rig.host.board_report()[3] == "open"
    rig.host.upload()
    assert rig.host.exchange("Arm").name == "Refused"
    rig.host.live(0.02)
    assert not any(level for _, _, level in pin_log(rig))


def pin_log(rig):
    """When the mute pin has changed, and what it is from then on."""
    return [entry for entry in rig.board.log if entry[1] == rig.facts.unmute]
