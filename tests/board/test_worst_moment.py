"""The device's worst moments: whatever fails while it sounds, the amplifier is off within 5 ms of the last good block.

Each case begins from the same state, armed and sounding, on a copy of its own, and takes at most 20 ms of the board's
time; the dead-man and the watchdog take longer. firmware/SAFETY.md lists what ends the drive in each.
"""
import pytest
from unicorn.arm_const import UC_ARM_REG_PRIMASK

from boards import G474, H743, RENDERER_IRQ, on
from copies import on_copy
from core.pins import BSRR, MODER
from core.usb import UsbHost
from host import RATE_HZ
from rig import MID
from test_faults import HANDLED_IN, MUTED_IN

DAC_PIN = "PA4"
BLOCK = 128 / RATE_HZ
# A slot's erasure and the writing.
STORE_PATIENCE = 6


def longest_watchdog(rig):
    return rig.facts.watchdog_seconds * 32e3 / rig.facts.watchdog_slowest_hz


def hang_thread(rig):
    """Outside of any critical section; `mask_interrupts` is the other case."""
    board = rig.board
    board.run_until(lambda: not board.cpu.reg_read(UC_ARM_REG_PRIMASK), 0.001, step=1e-6)
    board.is_thread_frozen = True


def lose_the_renderers_interrupt(rig):
    rig.board.enabled.discard(RENDERER_IRQ)


def lose_the_dmas_interrupt(rig):
    rig.board.enabled.discard(rig.facts.dma_irq)


def mask_interrupts(rig):
    """The thread's code waits for something in a critical section, for ever."""
    board = rig.board
    board.run_until(lambda: not board.active, 0.001, step=1e-6)
    board.cpu.reg_write(UC_ARM_REG_PRIMASK, 1)
    # The ROM bootloader's code is an endless loop in the model.
    board.pc = rig.facts.rom + 0x101


def jump_into_nothing(rig):
    rig.board.pc = 0x60000001


def stop_the_crystal(rig):
    rig.board.stop_crystal()


def halt(rig):
    """A debugger halts the core."""
    rig.board.halt()


def lock_up(rig):
    rig.board.lock_up()


FAULTS = [
    lose_the_renderers_interrupt, lose_the_dmas_interrupt, mask_interrupts, jump_into_nothing, stop_the_crystal, halt, lock_up,
]  # fmt: skip


def is_off(rig):
    """The pin is low, or nothing drives it: then its resistor does."""
    return rig.board.pin(rig.facts.unmute) in (0, None)


def seconds_until_off(rig, patience):
    """Lets time pass until the amplifier is off, and 3 ms more, in which it must stay off."""
    board = rig.board
    fault = board.seconds
    board.run_until(lambda: is_off(rig), patience, step=20e-6)
    off = board.seconds - fault
    board.log.clear()
    board.run(0.003)
    assert is_off(rig) and not any(entry[1:] == (rig.facts.unmute, 1) for entry in board.log), "it comes on again"
    return off


@pytest.mark.every_image
@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("phase", [0.0, 0.4])
def test_the_amplifier_is_off_within_5_ms_of_the_last_good_block(sounding, fault, phase):
    """R-20, R-23, R-50: up to the fault it plays what the mirror plays."""

    def case(rig):
        rig.board.run(phase * BLOCK)
        fault(rig)
        at = rig.played()
        off = seconds_until_off(rig, MUTED_IN)
        assert rig.leaves_the_mirror() >= min(at, rig.played())
        return off

    assert on_copy(sounding, case) <= (HANDLED_IN if fault is jump_into_nothing else MUTED_IN)


def test_a_thread_that_hangs_ends_in_silence_before_the_dead_mans_time(sounding):
    """R-20: the renderer goes on, with good blocks, until the watchdog's reset; the pin then floats."""

    def case(rig):
        board = rig.board
        hang_thread(rig)
        board.is_hasty = True
        return seconds_until_off(rig, 1.05), board.resets

    seconds, resets = on_copy(sounding, case)
    assert seconds < min(1.05, longest_watchdog(sounding)) and resets == ["watchdog"]


# At a bus reset embassy's driver flushes all FIFOs, and then the one of each endpoint that it disables: it waits for each
# flush without a bound, for the second kind in a critical section. The number 16 stands for all.
@pytest.mark.parametrize("fifos, masks", [({16}, False), (set(range(16)), True)])
def test_a_usb_core_that_never_ends_a_flush_costs_the_deadline_and_not_the_finger(sounding, fifos, masks):
    if not isinstance(sounding.cable, UsbHost):
        pytest.skip("there is no such core behind a serial line")

    def case(rig):
        board, host = rig.board, rig.host
        rig.cable.stuck_fifos = fifos
        rig.cable.bus_reset()
        board.run_until(lambda: rig.cable.flushing, 0.003, step=5e-6)
        board.run(20e-6)
        assert bool(board.cpu.reg_read(UC_ARM_REG_PRIMASK) & 1) == masks
        # The loop that waits for the flush takes the model a minute a second: from here on it stands still instead.
        board.is_thread_frozen = board.is_hasty = True
        # Without the mask the renderer goes on with good blocks until the reset.
        off = seconds_until_off(rig, MUTED_IN if masks else longest_watchdog(sounding))
        board.run_until(lambda: board.resets, longest_watchdog(sounding), step=0.01)
        board.is_hasty = False
        rig.cable.stuck_fifos = set()
        host.forget()
        return off, board.resets, host.connect()["reset"], host.status()["faults"]

    off, resets, reported, faults = on_copy(sounding, case)
    assert off <= (MUTED_IN if masks else longest_watchdog(sounding))
    assert resets == ["watchdog"] and reported == "watchdog" and "watchdog" in faults


def test_a_crystal_that_stops_mutes_in_hardware_and_is_reported(sounding):
    """The break clears the main output enable before an instruction of the NMI has run."""

    def case(rig):
        board = rig.board
        board.stop_crystal()
        assert is_off(rig), "at once"
        board.run_until(lambda: board.resets, 0.005, step=1e-4)
        # The program waits for it: its oscillator starts again.
        board.run(0.001)
        board.start_crystal()
        rig.host.forget()
        identity = rig.host.connect()
        return board.resets, identity["reset"], identity["crash"]

    assert on_copy(sounding, case) == (["software"], "hard fault", "the crystal has stopped")


@pytest.mark.every_image
@on(G474, H743)
@pytest.mark.parametrize("event", ["a dip of the supply", "a lock-up"])
def test_the_supply_and_a_lock_up_mute_in_hardware(sounding, event):
    """The break clears the main output enable; the core does nothing any more. (The F407 has no such way to its timers.)"""

    def case(rig):
        board = rig.board
        if event == "a lock-up":
            board.lock_up()
        else:
            mask_interrupts(rig)
            assert not is_off(rig) and board.dip_supply()
        assert is_off(rig), "at once"
        return seconds_until_off(rig, 1e-4)

    assert on_copy(sounding, case) == pytest.approx(0, abs=1e-4)


def test_a_halted_core_holds_its_code_and_stays_muted_when_it_goes_on(sounding):
    """R-61. A debugger stops the sample timer, but not the mute timer."""

    def case(rig):
        board = rig.board
        board.halt()
        before = len(board.dac.codes)
        board.run(0.006)
        assert len(board.dac.codes) <= before + 1 and is_off(rig)
        board.resume()
        off = seconds_until_off(rig, 1e-4)
        board.run(0.005)
        assert set(rig.codes(rig.played() - 128, rig.played())) == {MID}
        return off, rig.host.status()["first_fault"]

    assert on_copy(sounding, case) == (pytest.approx(0, abs=1e-4), "underrun")


def test_an_amplifier_that_has_muted_itself_comes_on_again_only_when_the_device_is_armed_again(sounding):
    def case(rig):
        board, host = rig.board, rig.host
        board.enabled.discard(RENDERER_IRQ)
        board.run(0.006)
        board.enabled.add(RENDERER_IRQ)
        off = seconds_until_off(rig, 1e-4)
        host.live(0.005)
        assert is_off(rig)
        status = host.status()
        host.accept("ClearFaults")
        host.arm()
        host.live(0.008)
        return off, status["state"], status["first_fault"], board.pin(rig.facts.unmute)

    assert on_copy(sounding, case) == (pytest.approx(0, abs=1e-4), "fault", "underrun", 1)


def test_the_supervisor_mutes_at_the_first_feed_that_it_misses(sounding):
    """The link's loop hangs, while interrupts and the executor go on: its count of turns stands still."""

    def case(rig):
        board = rig.board
        link = rig.pulses() + 4
        still = board.cpu.mem_read(link, 4)

        def hold():
            board.cpu.mem_write(link, bytes(still))
            # The supervisor may look right after the link's turn.
            board.at(board.now + 1e-6 * board.CORE_HZ, hold)

        hold()
        return seconds_until_off(rig, 0.25), board.resets

    seconds, resets = on_copy(sounding, case)
    assert seconds < 0.205 and resets == [], "two turns of the supervisor at most, and before the watchdog"


def test_the_configurations_of_dac_pin_and_mute_pin_are_locked(sounding):
    """R-61: a wild write cannot make the mute pin an output, or take the DAC's pin from the DAC."""

    def case(rig):
        board, host = rig.board, rig.host
        host.accept("Disarm")
        host.live(0.05)
        assert is_off(rig)
        for name in (rig.facts.unmute, DAC_PIN):
            port, pin = board.pins.ports[name[1]], int(name[2:])
            before = port.read(MODER)
            port.write(BSRR, 1 << pin)
            port.write(MODER, before & ~(3 << 2 * pin) | 1 << 2 * pin)
            assert port.read(MODER) == before
        return board.pin(rig.facts.unmute)

    assert on_copy(sounding, case) == 0


def test_the_watchdog_is_short_and_grows_for_an_erasure_only(sounding):
    """R-50, R-36."""

    def case(rig):
        board, host = rig.board, rig.host
        short = board.watchdog.period()
        host.accept("Disarm")
        host.live(0.1)
        periods = set()
        feed = board.watchdog.write
        board.watchdog.write = lambda offset, value: (feed(offset, value), periods.add(round(board.watchdog.period(), 3)))
        host.accept("Store", patience=STORE_PATIENCE)
        host.live(0.3)
        return short, sorted(periods), board.watchdog.period(), board.resets

    short, periods, after, resets = on_copy(sounding, case)
    expected = [sounding.facts.watchdog_seconds, sounding.facts.erasure_watchdog_seconds]
    assert short == after and periods == pytest.approx(expected, rel=0.05) and resets == []
    assert short == pytest.approx(expected[0])


@pytest.mark.every_image
def test_the_flash_is_written_only_with_the_amplifier_off_and_only_when_it_changes(sounding):
    """An armed device refuses to store: while the flash is erased it takes no stop."""

    def case(rig):
        board, host = rig.board, rig.host

        def erasures():
            return [entry for entry in board.log if entry[1] == "erase"]

        host.accept("Stop")
        host.live(0.1)
        assert host.status()["state"] == "armed" and not is_off(rig)
        board.log.clear()
        assert host.exchange("Store", patience=STORE_PATIENCE).refuses("DisarmFirst")
        assert not erasures() and not is_off(rig), "nothing has changed"

        host.accept("Disarm")
        host.live(0.05)
        assert is_off(rig)
        board.log.clear()
        host.accept("Store", patience=STORE_PATIENCE)
        assert erasures() and not [entry for entry in board.log if entry[1] == rig.facts.unmute]
        worn = host.maintenance()[0]

        board.log.clear()
        reply = host.exchange("Store", patience=STORE_PATIENCE)
        assert reply.name == "Unchanged" and not erasures(), "the same table is not written again"
        assert host.maintenance()[0] == worn == 1
        host.arm()
        return host.status()["state"], is_off(rig)

    assert on_copy(sounding, case) == ("armed", False)
