"""From the reset on: what is muted and when, who interrupts whom, and the way into the ROM bootloader and back."""
import struct

import pytest

from boards import DAC_IRQ, H743, RENDERER_IRQ, TIME_IRQ, on, on_f407
from core.usb import UsbHost
from host import RATE_HZ
from messages import ArmLease
from rig import MID, is_silent


@pytest.mark.every_image
def test_the_board_boots_muted_and_the_dac_is_at_mid_scale_long_before_anything_could_unmute(rig):
    # The look for the resistor takes 5 ms, and the H743's converters calibrate themselves for 14 ms.
    rig.board.run(0.03)
    unmute = rig.facts.unmute
    pins = [entry for entry in rig.board.log if entry[1] == unmute]
    driven = [entry for entry in rig.board.log if entry[1] == "dac drives"]
    assert [entry[2] for entry in pins] == [0], "the mute pin goes low and stays"
    assert [entry[2] for entry in driven] == [MID], "the first voltage is mid-scale"
    rig.host.connect()
    rig.host.upload()
    rig.host.arm()
    unmuted = next(entry for entry in rig.board.log if entry[1] == unmute and entry[2] == 1)
    assert unmuted[0] > driven[0][0]
    assert is_silent(rig.board.dac.codes)


@pytest.mark.every_image
def test_the_board_plays_400_000_codes_a_second(rig):
    # As above, before the DAC's first code.
    rig.board.run(0.03)
    before = len(rig.board.dac.codes)
    rig.board.run(0.05)
    assert abs(len(rig.board.dac.codes) - before - 20_000) <= 1
    assert rig.board.dac.underruns == 0


def test_the_board_enumerates_as_the_documentation_says(rig):
    identity = rig.host.connect()
    unique_id = b"SLIPLINE-VB1"
    if isinstance(rig.cable, UsbHost):
        vendor, product = struct.unpack_from("<HH", rig.cable.descriptor, 8)
        assert (vendor, product) == (0x1209, 0x0001)
        assert rig.cable.strings == {1: "Slipline", 2: "Slipline tactile display", 3: unique_id.hex().upper()}
    assert identity["board"] == rig.facts.name
    assert identity["unit"] == unique_id
    assert (identity["sample_rate_hz"], identity["block"], identity["dac_bits"], identity["tones"]) == (RATE_HZ, 128, 12, 16)
    assert (identity["reset"], identity["stored"], identity["crash"]) == ("power on", "empty", "")
    assert not identity["simulated"]


def test_the_renderer_ranks_above_the_link_and_the_dac_above_both(rig):
    rig.board.run(0.03)
    irqs = {"dma": rig.facts.dma_irq, "dac": DAC_IRQ, "renderer": RENDERER_IRQ, "time": TIME_IRQ}
    level = {name: rig.board.priorities[irq] for name, irq in irqs.items()}
    assert level["dma"] == level["dac"] < level["renderer"] < level["time"]
    for irq in rig.facts.waking_link_irqs:
        assert level["renderer"] < rig.board.priorities[irq], "the host waits, or a DMA moves the bytes"
    # A damaged byte cannot wait for a block (`test_a_stop_right_behind_a_bad_byte_is_obeyed`).
    for irq in rig.facts.urgent_link_irqs:
        assert level["dma"] < rig.board.priorities[irq] < level["renderer"]


def enter_bootloader(rig):
    identity = rig.host.connect()
    rig.board.resets.clear()
    rig.host.exchange("BootloaderEnter", rig.host.ask("BootloaderToken"))
    rig.board.run(0.1)
    assert rig.board.resets == ["software"]
    return identity


def test_the_rom_bootloader_is_entered_in_two_steps(rig):
    """R-63."""
    enter_bootloader(rig)
    assert rig.board.pc & ~1 == rig.facts.rom + 0x100
    assert rig.board.vectors == rig.facts.rom, "the ROM's interrupts are the ROM's"
    if rig.facts.rom_map:
        register, mode = rig.facts.rom_map
        assert rig.board.bus_read(register, 4) & 7 == mode, "system memory at address 0, as after a boot from ROM"
    rig.board.reset("pin")
    rig.host.forget()
    assert rig.host.connect()["reset"] == "pin"


@pytest.mark.every_image
@on(H743)
def test_the_usb_clocks_are_off_at_the_reset_into_the_rom(rig):
    """R-94: else the ROM's DFU never appears."""
    enter_bootloader(rig)
    assert not rig.board.clocks.was_usb_on_at_reset


@pytest.mark.nightly
@on_f407
def test_each_time_the_rom_misses_the_crystal_the_program_is_back_and_can_be_asked_again(rig):
    """R-94: the ROM resets then. The request is used up, so that neither that reset nor DFU's leave ends in the ROM; and five
    such resets are no crashes in a row."""
    for _ in range(5):
        enter_bootloader(rig)
        rig.board.reset("software")
        rig.host.forget()
    identity = enter_bootloader(rig)
    assert (identity["reset"], identity["crash"]) == ("software", "")
    assert rig.board.pc & ~1 == rig.facts.rom + 0x100
    rig.board.leave_bootloader()
    rig.host.forget()
    rig.host.connect()
    rig.host.upload()
    rig.host.arm()


def test_the_program_runs_when_the_rom_bootloader_starts_it_by_a_jump(rig):
    """`dfu-util -s 0x08000000:leave` resets nothing."""
    enter_bootloader(rig)
    rig.board.leave_bootloader()
    rig.host.forget()
    identity = rig.host.connect()
    assert (identity["reset"], identity["crash"]) == ("software", "")
    assert rig.board.resets == ["software"], "the one that led into the ROM"
    rig.host.upload()
    rig.host.arm()


def test_the_lamp_shows_whether_the_device_is_muted(armed):
    def flashes(seconds):
        armed.board.log.clear()
        armed.host.live(seconds)
        return sum(1 for entry in armed.board.log if entry[1] == armed.facts.lamp and entry[2] == 1)

    armed.board.is_hasty = True
    armed.host.live(0.2)
    assert flashes(0.9) == 0 and armed.board.pin(armed.facts.lamp) == 1, "steady while the amplifier is on"
    armed.host.accept("Disarm")
    armed.host.live(0.9)
    assert flashes(1.6) == 2, "a flash every 0.8 s while it is muted"


def test_the_lamp_reports_that_the_brown_out_level_is_not_set(rig):
    """R-56: as chips leave the factory. Only the lamp shows it."""
    rig.board.flash.set_brown_out_bits(rig.facts.delivered)
    rig.board.is_hasty = True
    rig.board.run(0.15)
    rig.board.log.clear()
    rig.board.run(0.8)
    assert sum(1 for entry in rig.board.log if entry[1:] == (rig.facts.lamp, 1)) == 2, "muted alone is one flash in 0.8 s"


@pytest.mark.every_image
@on(H743)
def test_without_the_st_links_clock_it_answers_muted_and_cannot_be_armed(rig):
    """Nobody has powered CN1. The internal oscillators, some per cent off, keep the link; a reset with the clock is as ever."""
    rig.board.stop_crystal()
    # The start waits for the clock for 100 ms, by a loop that takes up to five times as long.
    rig.board.run(0.5)
    rig.host.connect()
    assert rig.board.crs.trims_by_otg_fs(), "USB full speed needs 0.25 %"
    assert rig.host.ask("Board").sample_clock.name == "Internal"
    rig.host.upload()
    for command, body in (("Arm", None), ("ArmFor", ArmLease(60_000)), ("Bench", ArmLease(60_000))):
        assert rig.host.exchange(command, body).refuses("NoClock")
    rig.board.log.clear()
    rig.board.is_hasty = True
    rig.host.live(0.8)
    levels = [entry[1:] for entry in rig.board.log]
    assert (rig.facts.unmute, 1) not in levels
    lit = [entry[0] for entry in rig.board.log if entry[1:] == (rig.facts.lamp, 1)]
    dark = [entry[0] for entry in rig.board.log if entry[1:] == (rig.facts.lamp, 0)]
    assert len(lit) == 1 and any(0.38 < (end - lit[0]) % 0.8 < 0.42 for end in dark), "one long flash"
    rig.board.is_hasty = False
    rig.board.start_crystal()
    rig.board.reset("pin")
    rig.host.forget()
    rig.host.connect()
    assert rig.host.ask("Board").sample_clock.name == "Exact"
    rig.host.upload()
    rig.host.arm()
