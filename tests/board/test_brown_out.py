"""The level of the brown-out reset, which the firmware itself writes into the chip's option bytes."""
import pytest

from boards import BOARDS, F407, H743, name, on_f407
from core.flash import OPTION_KEYS
from core.processor import PowerCut
from messages import BrownOutOrder

# As for an erasure.
PATIENCE = 5
# After the answer, two time-outs of sending, and the start.
RESTART_SECONDS = 0.2


def order(rig, is_written=True):
    return rig.host.exchange("BrownOut", BrownOutOrder(is_written), PATIENCE)


def refused(rig):
    reply = order(rig)
    assert reply.name == "Refused", reply
    fields = reply.value.values
    return (reply.value.name, fields["field"].name, fields["got"]) if fields else (reply.value.name,)


def delivered(rig):
    """As the chip leaves the factory, connected; the button's level at rest is known."""
    rig.board.flash.set_brown_out_bits(rig.facts.delivered)
    rig.host.connect()
    rig.host.live(0.005)


def press(rig):
    rig.board.pins.drive(rig.facts.button, 1)
    rig.host.live(0.002)


def again(rig, cause=None):
    """The device after a reset, or after its own."""
    if cause:
        rig.board.reset(cause)
    else:
        rig.board.run_until(lambda: rig.board.resets, RESTART_SECONDS, step=0.001)
    rig.host.forget()
    return rig.host.connect()


def writes(rig):
    return [entry[2] for entry in rig.board.log if entry[1] == "options"]


@pytest.mark.every_image
def test_the_level_is_written_with_the_button_only_and_is_in_force_after_a_restart(rig):
    """R-56."""
    delivered(rig)
    flash = rig.board.flash
    before = flash.options
    assert rig.host.maintenance()[2] is False
    found = order(rig, is_written=False).value
    assert (found.level, found.needed > 0, found.restarts) == (0, True, False)
    assert refused(rig) == ("HoldButton",)
    press(rig)
    assert not writes(rig)
    rig.board.resets.clear()
    written = order(rig).value
    assert (written.level, written.restarts) == (written.needed, True)
    wanted = before & ~flash.BROWN_OUT | rig.facts.guarded
    assert writes(rig) == [wanted] and flash.options == wanted, "one write, and only BOR_LEV changes"
    rig.board.pins.drive(rig.facts.button, 0)
    identity = again(rig)
    assert rig.board.resets in (["software"], ["options"])
    assert (identity["reset"], identity["crash"]) == ("software", "")
    assert rig.host.maintenance()[2] is True
    compared = order(rig).value
    assert (compared.options, compared.level, compared.restarts) == (written.options, written.needed, False)
    assert writes(rig) == [wanted], "what is set is not written again, and needs no button"


@pytest.mark.parametrize("is_cut_clean", [True, False], ids=["before", "inside"])
@pytest.mark.every_image
def test_a_power_cut_leaves_the_old_level_or_what_the_manual_says(rig, is_cut_clean):
    """R-56: inside the write the F407 and the G474 have erased the option bytes, which is read protection level 1: the program runs on,
    and no more is written. The H743 keeps the old ones."""
    delivered(rig)
    flash = rig.board.flash
    before = flash.options
    press(rig)
    flash.cut_at, flash.is_cut_clean = flash.operations, is_cut_clean
    with pytest.raises(PowerCut):
        order(rig)
    rig.board.pins.drive(rig.facts.button, 0)
    again(rig, "power")
    rig.host.live(0.005)
    assert rig.host.maintenance()[2] is False
    found = order(rig, is_written=False).value
    press(rig)
    if is_cut_clean or rig.facts is H743:
        assert flash.options == before and found.read_protection == 0xAA
        rig.board.resets.clear()
        assert order(rig).value.restarts
        rig.board.pins.drive(rig.facts.button, 0)
        again(rig)
        assert rig.host.maintenance()[2] is True
    else:
        assert found.read_protection not in (0xAA, 0xCC), "level 1"
        assert refused(rig) == ("OutOfRange", "ReadProtection", found.read_protection)


@pytest.mark.every_image
def test_a_power_cut_behind_the_write_leaves_the_new_level(rig):
    """R-56: before the restart."""
    delivered(rig)
    press(rig)
    assert order(rig).value.restarts
    rig.board.pins.drive(rig.facts.button, 0)
    again(rig, "power")
    assert rig.host.maintenance()[2] is True


@on_f407
def test_the_level_is_not_written_while_armed_at_a_low_supply_or_on_a_protected_chip(rig):
    """R-56."""
    flash = rig.board.flash
    flash.options |= 0xFF << flash.RDP
    rig.board.adc.reference_volts = 2.85
    delivered(rig)
    rig.host.upload()
    rig.host.arm()
    assert refused(rig) == ("DisarmFirst",)
    rig.host.accept("Disarm")
    rig.host.live(0.06)
    press(rig)
    assert refused(rig) == ("OutOfRange", "ReadProtection", 0xFF)
    flash.options = flash.loaded = flash.options & ~(0xFF << flash.RDP) | 0xAA << flash.RDP
    assert refused(rig)[:2] == ("OutOfRange", "ReferenceVoltage")
    assert not writes(rig)


@on_f407
def test_a_new_session_does_not_keep_the_device_from_restarting(rig):
    delivered(rig)
    press(rig)
    rig.board.resets.clear()
    assert order(rig).value.restarts
    rig.host.connect()
    rig.board.run_until(lambda: rig.board.resets, RESTART_SECONDS, step=0.001)
    assert rig.board.resets == ["software"]


# FLASH_OPTKEYR, where the option bytes are ordered, and the register and bit of their start, without the flash's page.
REGISTERS = {"f4discovery": (0x08, 0x14, 0x14, 1 << 1), "g474re": (0x0C, 0x20, 0x14, 1 << 17), "h743zi2": (0x08, 0x20, 0x18, 1 << 1)}


@pytest.mark.every_image
@pytest.mark.parametrize("facts", BOARDS, ids=name)
def test_the_models_refuse_every_other_option_bit(facts):
    """A wrong byte of read protection would lock the chip for ever."""
    keys, ordered, begun, begin = REGISTERS[name(facts)]
    for bit in (facts.guarded & -facts.guarded, 1 << (facts.chip().flash.RDP + 1)):
        flash = facts.chip().flash
        flash.set_brown_out_bits(facts.delivered)
        if facts is not F407 and facts is not H743:
            for key in (0x45670123, 0xCDEF89AB):
                flash.write(0x08, key)
        for key in OPTION_KEYS:
            flash.write(keys, key)
        wanted = flash.options ^ bit
        flash.write(ordered, wanted)
        value = wanted | begin if begun == ordered else begin
        if bit & flash.BROWN_OUT:
            flash.write(begun, value)
            assert flash.options == wanted
        else:
            with pytest.raises(AssertionError, match="only the level of the brown-out reset may be"):
                flash.write(begun, value)


@pytest.mark.every_image
@pytest.mark.parametrize("facts", BOARDS, ids=name)
def test_the_models_option_bytes_are_locked(facts):
    _, ordered, _, _ = REGISTERS[name(facts)]
    with pytest.raises(AssertionError, match="locked"):
        facts.chip().flash.write(ordered, 0)
