"""The actuator's profile in the images: written with the button only, whole after a power cut at any operation, in force."""
import pytest

from copies import on_copy
from core.processor import PowerCut
from host import DRIVE, FORGET, HOLD_BUTTON, REFUSED, WRITE_PROFILE, drive, profile

HEADROOM = 0x0A
# The longest that the device may take: a sector of 128 KiB of the F407's takes 2 s.
PATIENCE = 5
OLD, NEW = profile("old", 400), profile("new", 600)


def write(rig, body):
    # The button's level at rest is known.
    rig.host.live(0.005)
    rig.board.pins.drive(rig.facts.button, 1)
    rig.host.live(0.002)
    rig.host.accept(WRITE_PROFILE, body, patience=PATIENCE)
    rig.board.pins.drive(rig.facts.button, 0)


@pytest.mark.every_image
def test_it_is_written_with_the_button_only_and_in_force_for_every_session(rig):
    """R-79."""
    rig.host.connect()
    rig.host.live(0.01)
    assert rig.host.profile() == (None, "empty")
    _, reply, body = rig.host.exchange(WRITE_PROFILE, OLD)
    assert (reply, body) == (REFUSED, HOLD_BUTTON)
    write(rig, OLD)
    assert rig.host.profile() == ("old", "loaded")
    kept = rig.keep(33)
    rig.board.reset("power")
    rig.host.inbox.clear()
    rig.host.connect()
    assert (rig.host.profile(), rig.stored_crc()) == (("old", "loaded"), kept)
    rig.host.arm()
    for level, is_taken in ((0.39, True), (0.41, False)):
        _, reply, body = rig.host.exchange(DRIVE, drive([(0, 1, level)], 2000))
        assert is_taken or (reply == REFUSED and body[0] == HEADROOM), (level, reply, body)


@pytest.mark.nightly
@pytest.mark.every_image
def test_forget_leaves_it(rig):
    """R-79."""
    rig.host.connect()
    write(rig, OLD)
    rig.keep(33)
    rig.host.accept(FORGET, patience=PATIENCE)
    rig.board.reset("power")
    rig.host.inbox.clear()
    rig.host.connect()
    assert (rig.host.profile(), rig.stored_crc()) == (("old", "loaded"), None)


@pytest.mark.parametrize("is_cut_clean", [False, pytest.param(True, marks=pytest.mark.nightly)], ids=["torn", "clean"])
def test_a_power_cut_at_any_operation_leaves_the_old_or_the_new_profile(rig, is_cut_clean):
    """R-79: whole, or the device says that it may have been lost and cannot be armed."""
    rig.host.connect()
    write(rig, OLD)
    rig.board.pins.drive(rig.facts.button, 1)
    flash = rig.board.flash

    def operations(rig):
        before = flash.operations
        rig.host.accept(WRITE_PROFILE, NEW, patience=PATIENCE)
        return flash.operations - before

    def case(rig, operation):
        flash.cut_at, flash.is_cut_clean = flash.operations + operation, is_cut_clean
        with pytest.raises(PowerCut):
            rig.host.accept(WRITE_PROFILE, NEW, patience=PATIENCE)
        rig.board.reset("power")
        rig.host.inbox.clear()
        rig.host.connect()
        name, stored = rig.host.profile()
        assert name in ("old", "new") and stored in ("loaded", "fell back"), (operation, name, stored)

    for operation in range(on_copy(rig, operations)):
        on_copy(rig, lambda copy: case(copy, operation))
