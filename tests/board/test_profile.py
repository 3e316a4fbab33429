"""The actuator's profile in the images: written with the button only, whole after a power cut at any operation, in force."""
import pytest

from copies import on_copy
from core.processor import PowerCut
from host import RATE_HZ, drive, profile
from leaps import leap
from rig import MILLISECOND, start

# The longest that the device may take: a sector of 128 KiB of the F407's takes 2 s.
PATIENCE = 5
OLD, NEW = profile("old", 400), profile("new", 600)


def write(rig, body):
    # The button's level at rest is known.
    rig.host.live(0.005)
    rig.board.pins.drive(rig.facts.button, 1)
    rig.host.live(0.002)
    rig.host.accept("WriteProfile", body, patience=PATIENCE)
    rig.board.pins.drive(rig.facts.button, 0)


def press(rig):
    rig.board.pins.drive(rig.facts.button, 0)
    rig.host.live(0.002)
    rig.board.pins.drive(rig.facts.button, 1)
    rig.host.live(0.002)


def restart(rig, cause):
    rig.board.reset(cause)
    rig.host.forget()
    rig.host.connect()
    rig.host.live(0.005)


def refused_without_a_hand(rig, body):
    return rig.host.exchange("WriteProfile", body).refuses("HoldButton")


@pytest.mark.every_image
def test_a_profile_is_written_with_the_button_only_and_in_force_for_every_session(rig):
    """R-79."""
    rig.host.connect()
    rig.host.live(0.01)
    assert rig.host.profile() == (None, "empty")
    assert refused_without_a_hand(rig, OLD)
    write(rig, OLD)
    assert rig.host.profile() == ("old", "loaded") and rig.host.wear() == (1, 20_000, 16)
    kept = rig.keep(33)
    assert rig.host.wear() == (1, 20_000, 15)
    rig.board.reset("power")
    rig.host.forget()
    rig.host.connect()
    assert (rig.host.profile(), rig.stored_crc()) == (("old", "loaded"), kept)
    rig.host.arm()
    assert is_limited_to_old(rig)


def is_limited_to_old(rig):
    reply = rig.host.exchange("Drive", drive([(0, 1, 0.41)], 2000))
    rig.host.accept("Drive", drive([(0, 1, 0.39)], 2000))
    return reply.refuses("Headroom")


@pytest.mark.nightly
@pytest.mark.every_image
def test_forget_leaves_the_profile(rig):
    """R-79."""
    rig.host.connect()
    write(rig, OLD)
    rig.keep(33)
    rig.host.accept("Forget", patience=PATIENCE)
    rig.board.reset("power")
    rig.host.forget()
    rig.host.connect()
    assert (rig.host.profile(), rig.stored_crc()) == (("old", "loaded"), None)


@pytest.mark.parametrize("is_cut_clean", [False, pytest.param(True, marks=pytest.mark.nightly)], ids=["torn", "clean"])
def test_a_power_cut_at_any_operation_leaves_the_old_or_the_new_profile(rig, is_cut_clean):
    """R-79: the profile is whole, or the device reports that it may be lost, and cannot be armed."""
    rig.host.connect()
    write(rig, OLD)
    rig.board.pins.drive(rig.facts.button, 1)
    flash = rig.board.flash

    def operations(rig):
        before = flash.operations
        rig.host.accept("WriteProfile", NEW, patience=PATIENCE)
        return flash.operations - before

    def case(rig, operation):
        flash.cut_at, flash.is_cut_clean = flash.operations + operation, is_cut_clean
        with pytest.raises(PowerCut):
            rig.host.accept("WriteProfile", NEW, patience=PATIENCE)
        rig.board.reset("power")
        rig.host.forget()
        rig.host.connect()
        name, stored = rig.host.profile()
        assert name in ("old", "new") and stored in ("loaded", "fell back"), (operation, name, stored)

    for operation in range(on_copy(rig, operations)):
        on_copy(rig, lambda copy: case(copy, operation))


# What follows is the application's matter, not the chip's: the other images have it at night.


def newest(rig):
    """Where the record of the profile `NEW` begins to differ from every other one."""
    memory = bytes(rig.board.cpu.mem_read(rig.board.FLASH_START, rig.board.MEMORIES[rig.board.FLASH_START]))
    assert memory.count(b"\x03new") == 1
    return rig.board.FLASH_START + memory.index(b"\x03new") + 1


def test_of_a_damaged_profile_the_older_one_limits_until_a_hand_on_the_board_accepts_it(rig):
    """R-79."""
    host, board = rig.host, rig.board
    host.connect()
    write(rig, OLD)
    write(rig, NEW)
    assert host.wear()[0] == 2
    board.cpu.mem_write(newest(rig), b"l")
    restart(rig, "power")
    assert host.profile() == ("old", "fell back")
    host.upload()
    host.accept("ClearFaults")
    assert host.status()["faults"] == {"profile fell back"} and host.exchange("Arm").name == "Refused"
    press(rig)
    host.accept("ClearFaults")
    board.pins.drive(rig.facts.button, 0)
    assert host.status()["faults"] == set()
    host.live(0.002)
    host.arm()
    assert is_limited_to_old(rig)


def test_a_button_that_is_held_through_the_start_is_a_hand_for_thirty_seconds_after_its_release(rig):
    """R-79: its level at the start counts as that at rest, so its release is an edge like a press, and nothing can distinguish the two."""
    rig.board.pins.drive(rig.facts.button, 1)
    rig.host.connect()
    rig.host.live(0.01)
    assert rig.host.board_report()[2] == "released" and refused_without_a_hand(rig, OLD)
    rig.board.pins.drive(rig.facts.button, 0)
    rig.host.live(0.002)
    assert rig.host.board_report()[2] == "pressed"
    leap(rig, 29.9)
    rig.host.accept("WriteProfile", OLD, patience=PATIENCE)
    leap(rig, 0.1)
    assert rig.host.board_report()[2] == "pressed" and refused_without_a_hand(rig, NEW), "it reads so for ever"


def test_where_a_profile_is_kept_the_rom_bootloader_needs_the_button(rig):
    """R-63 and R-79: another program knows nothing of it."""
    host = rig.host
    host.connect()
    write(rig, OLD)
    host.live(0.002)
    token = host.ask("BootloaderToken")
    reply = host.exchange("BootloaderEnter", token)
    assert reply.refuses("HoldButton")
    press(rig)
    assert rig.board.resets == []
    assert host.exchange("BootloaderEnter", token).name == "Accepted"
    rig.board.run_until(lambda: rig.board.resets, 0.1, step=0.001)
    rig.board.run(0.02)
    assert rig.board.resets == ["software"] and rig.board.pc & ~1 == rig.facts.rom + 0x100


@pytest.mark.nightly
def test_a_drive_that_begins_later_does_not_extend_the_longest_drive_time(rig):
    """R-79."""
    host, board = rig.host, rig.board
    host.connect()
    write(rig, profile("short", drive_ms=1000))
    host.upload()
    host.arm()
    at = start(rig)
    host.accept("Drive", drive([(0, 0.4, 0.3)], 2000, at + 3 * RATE_HZ))
    board.is_hasty = True
    host.live(0.95)
    assert host.status()["state"] == "driving"
    # The ramp of 30 ms, and the blocks of mid-scale behind it.
    board.run_until(lambda: not board.pin(rig.facts.unmute), 0.2, step=0.001)
    status = host.status()
    assert (status["first_fault"], status["now"] - at < 1060 * MILLISECOND) == ("drive time", True)
