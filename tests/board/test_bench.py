"""The bench, the trials of the mute pin, and what the device reports of its supply and its clocks."""
import pytest

from boards import H743
from core.usb import UsbHost
from host import RATE_HZ, drive
from messages import AT_TRIGGER, ArmLease, MuteStep
from records import Choice
from rig import MID

BENCH = ArmLease(60_000)


def mute_pin(rig, trial="Read"):
    report = rig.host.ask("MutePin", MuteStep(Choice(trial)))
    return report.level.name, report.is_on_bench, report.fall


def highs(rig):
    """When the mute pin went high, so far."""
    return [entry[0] for entry in rig.board.log if entry[1] == rig.facts.unmute and entry[2] == 1]


@pytest.mark.every_image
def test_the_device_reports_its_reference_voltage_and_its_brown_out_level(rig):
    rig.host.connect()
    report = rig.host.ask("Analogue")
    # A code of VREFINT is 0.07 % of it at 12 bits.
    assert report.reference_mv == pytest.approx(1000 * rig.board.adc.reference_volts, rel=0.002)
    assert report.linear_per_mille == {"STM32F4DISCOVERY": 870}.get(rig.facts.name, 880)
    assert report.brown_out_level is not None
    if rig.facts is H743:
        assert report.ram_errors == 0
        rig.board.ram_ecc.values[0x64] = 0b10
        assert rig.host.ask("Analogue").ram_errors == 2
        rig.board.reset("pin")
        rig.host.forget()
        rig.host.connect()
        assert rig.host.ask("Analogue").ram_errors == 0, "it counts from the start on"
    else:
        assert report.ram_errors is None
    assert (report.revision, report.chip) == (rig.board.debug.identity >> 16, rig.board.debug.identity & 0xFFF)


@pytest.mark.every_image
def test_on_the_bench_a_board_drives_and_its_mute_pin_stays_low(rig):
    rig.host.connect()
    rig.host.upload()
    rig.host.accept("Bench", BENCH)
    rig.host.live(0.01)
    rig.host.accept("Drive", drive([(0, 0.3, 0.6)], 2000))
    rig.host.live(0.03)
    assert rig.host.status()["state"] == "driving"
    assert max(rig.board.dac.codes[-400:]) > MID + 200
    assert mute_pin(rig) == ("Low", True, None)
    rig.host.accept("Disarm")
    rig.host.live(0.06)
    assert not highs(rig)
    assert mute_pin(rig) == ("Low", False, None)
    # Then it is armed as ever.
    rig.host.arm()
    assert len(highs(rig)) == 1
    assert mute_pin(rig) == ("High", False, None)


@pytest.mark.every_image
def test_the_mute_pin_falls_4_ms_after_the_last_block_and_at_once_by_a_break(rig):
    rig.host.connect()
    for trial, least, most in (("Lapse", 3990, 4010), ("Break", 0, 5)):
        rig.host.arm()
        level, _, fall = mute_pin(rig, trial)
        assert level == "High"
        assert fall.low_after_us - fall.within_us <= most and fall.low_after_us >= least, fall
        # A block may have come between, and no more.
        assert fall.within_us < 320
        rig.host.live(0.02)
        status = rig.host.status()
        assert (status["state"], status["faults"]) == ("idle", set())
    rig.host.arm()
    assert mute_pin(rig)[0] == "High"


@pytest.mark.every_image
def test_the_clocks_agree(rig):
    rig.host.connect()
    first = rig.host.ask("Clock")
    rig.host.live(0.1)
    second = rig.host.ask("Clock")
    samples, cycles = second.at - first.at, (second.cycles - first.cycles) % (1 << 32)
    # The end of the renderer's turn differs by some cycles from block to block.
    assert cycles == pytest.approx(samples * rig.board.CORE_HZ / RATE_HZ, abs=20_000)
    assert samples > 0.09 * RATE_HZ
    if isinstance(rig.cable, UsbHost):
        frames = (second.usb.number - first.usb.number) % 2048
        cycles = (second.usb.cycles - first.usb.cycles) % (1 << 32)
        assert cycles == pytest.approx(frames * rig.board.CORE_HZ / 1000, abs=2000)
    else:
        assert first.usb is None


@pytest.mark.every_image
def test_a_dma_that_is_stopped_on_the_bench_is_noticed_and_the_trigger_rises_as_before(rig):
    """R-76, by the device's own order, as the self-test gives it."""
    rig.wire("trigger=trigger-in")
    host = rig.host
    host.connect()
    assert host.exchange("Stall").refuses("NotArmed")
    host.upload()
    began = []
    for is_stalled in (False, True):
        host.accept("Bench", BENCH)
        host.live(0.01)
        if is_stalled:
            before = host.status()["underruns"]
            host.accept("Stall")
            host.live(0.02)
            status = host.status()
            assert (status["faults"], status["underruns"] > before) == (set(), True)
        waits = host.accept("Drive", drive([(0, 0.3, 0.6)], 2000, AT_TRIGGER))
        host.live(0.02)
        began.append(host.trigger()[1] - waits)
        host.accept("Disarm")
        host.live(0.06)
    assert began[0] == began[1] and 0 < began[0] <= 256, began
    assert not highs(rig)
