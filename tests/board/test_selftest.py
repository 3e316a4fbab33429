"""The program's self-test of the boards: green where the board is whole, each planted fault caught by its own step, and whatever ends the
test leaves the board muted."""
import random
from collections import deque
from typing import Callable, NamedTuple

import pytest

from boards import on_f407
from copies import in_copy
from core.load import Wiring
from desk import Desk
from rig import MID, NOISE, noisy

WIRES = "dac=sensor", "trigger=trigger-in"
# A person is not asked in what must take three seconds.
PERSON = ["store", "buttons"]
BY_WIRE = ["DAC to ADC", "delay", "noise", "trigger", "stall"]
DRIVEN = ["DAC to ADC", "delay", "noise", "load", "codes", "trigger", "stall"]
STEPS = ["clocks", "supply", "mute", "mute time", "DAC to ADC", "delay", "noise", "load", "codes", "trigger", "link", "store", "stall", "buttons"]
# Seconds of the board's time.
SHORT = 3.0


def others(*named):
    """The steps without these."""
    return [step for step in STEPS if step not in named]


def highs(rig):
    """When the mute pin went high, so far."""
    return [entry[0] for entry in rig.board.log if entry[1:] == (rig.facts.unmute, 1)]


def test_a_board_with_both_wires_is_green_and_its_mute_pin_stays_low(rig):
    rig.wire(*WIRES)
    desk = Desk(rig, *WIRES)
    desk.test()
    print(f"\n{rig.facts.name}: {desk.seconds:.2f} s of the board's time")
    skipped = ["mute time", *PERSON]
    assert desk.verdicts() == {"green": others(*skipped), "skipped": skipped}, desk.report
    assert not highs(rig)
    assert desk.seconds < SHORT


@pytest.mark.nightly
def test_without_wires_their_steps_are_skipped_and_nothing_else(rig):
    """With the amplifier unplugged the mute pin is timed: it is high in that step alone, twice."""
    desk = Desk(rig, "unplugged")
    desk.test()
    skipped = [step for step in STEPS if step in (*BY_WIRE, *PERSON)]
    assert desk.verdicts() == {"green": others(*skipped), "skipped": skipped}, desk.report
    assert len(highs(rig)) == 2
    assert rig.board.pin(rig.facts.unmute) == 0
    assert desk.seconds < SHORT


class Fault(NamedTuple):
    """A fault that is planted before the start (`plant`) or in a board that is connected (`then`), and what the test says of it."""

    name: str
    red: list
    skipped: list = []
    plant: Callable = lambda rig: None
    then: Callable = lambda rig: None
    clock: float = 1.0
    words: tuple = WIRES


def reads(at_pins, noise=NOISE):
    """The ADCs read this at their pins, by the DAC's code."""

    def plant(rig):
        draw = random.Random(7)
        rig.board.adc.at_pins = lambda: tuple(noisy(code, noise, draw) for code in at_pins(rig.board.dac.output))

    return plant


def late(samples):
    """Codes arrive so many samples later."""
    waiting = deque([MID] * samples)

    def at_pins(code):
        waiting.append(code)
        return waiting.popleft(), MID

    return at_pins


def without_trigger_wire(rig):
    rig.board.pins.wires.clear()


def lost_after_a_stall(rig):
    """As on an F407 whose stall is not mended: the trigger output does not rise any more."""
    dac = rig.board.dac
    underrun = dac.underrun

    def and_lost():
        underrun()
        rig.board.pins.wires.clear()

    dac.underrun = and_lost


def reference(volts):
    def plant(rig):
        # The H743 measures it by a converter of its own.
        for converter in (rig.board.adc, getattr(rig.board, "adc3", rig.board.adc)):
            converter.reference_volts = volts

    return plant


def without_resistor(rig):
    rig.board.pins.wire(rig.facts.unmute, Wiring())


def stuck_high(rig):
    rig.board.pins.shorts[rig.facts.unmute] = 1


def dead_break(rig):
    """The mute timer ignores the break that the program orders."""
    timer = rig.board.timers[rig.facts.mute_timer]
    timer.break_in = lambda by_program=False, by_system=False: None


def stuck_button(rig):
    """After the start, at which the program takes the button's level for that at rest."""
    rig.board.run(0.05)
    rig.board.pins.drive(rig.facts.button, 1)


def wrong_sine(rig):
    """A bit of the sine's table has changed: few codes differ, each by one."""
    (table,) = (address for name, address in rig.board.symbols.items() if "sine" in name and "TABLE" in name)
    address, cpu = table + 8 * SPOILED_BIN + 2, rig.board.cpu
    cpu.mem_write(address, bytes([cpu.mem_read(address, 1)[0] ^ 1 << 4]))


# One of the table's 1024 bins of two words, sine and cosine in units of 2^-31.
SPOILED_BIN = 100
FAULTS = (
    Fault("DMA late by a block", ["delay"], plant=reads(late(128))),
    Fault("mute stuck high", ["mute", "mute time"], then=stuck_high, words=(*WIRES, "unplugged")),
    Fault("one wrong code", ["codes"], then=wrong_sine),
    Fault("clock 2 % off", ["clocks"], clock=1.02),
    Fault("VREF+ 2.7 V", ["supply"], plant=reference(2.7)),
    Fault("resistor missing", ["mute"], ["mute time"], plant=without_resistor, words=(*WIRES, "unplugged")),
    Fault("break dead", ["mute time"], then=dead_break, words=(*WIRES, "unplugged")),
    Fault("dead ADC", ["DAC to ADC"], ["delay", "noise"], plant=reads(lambda code: (0, MID))),
    Fault("wire at the shunt's pin", ["DAC to ADC"], ["delay", "noise"], plant=reads(lambda code: (MID, code))),
    Fault("noisy reference", ["noise"], plant=reads(lambda code: (code, MID), noise=4)),
    Fault("lost trigger edge", ["trigger"], ["stall"], plant=without_trigger_wire),
    Fault("trigger lost after a stall", ["stall"], plant=lost_after_a_stall),
    Fault("stuck button", ["buttons"], DRIVEN, then=stuck_button),
)
# Those that the gate plants in the F407, all at once; the night plants all in all boards, one by one.
GATE = FAULTS[:3]


def verdicts_with(rig, faults):
    """The verdicts of a board with these faults, and those that it should have."""
    rig.wire(*WIRES)
    words = sorted({word for fault in faults for word in fault.words})
    for fault in faults:
        fault.plant(rig)
    desk = Desk(rig, *words, clock=max(fault.clock for fault in faults))
    for fault in faults:
        fault.then(rig)
    desk.test()
    red = {step for fault in faults for step in fault.red}
    skipped = {step for fault in faults for step in fault.skipped} | {*PERSON} | ({"mute time"} if "unplugged" not in words else set())
    wanted = {"red": red, "skipped": skipped - red, "green": {*STEPS} - red - skipped}
    return desk.verdicts(), {verdict: [step for step in STEPS if step in steps] for verdict, steps in wanted.items() if steps}


@on_f407
def test_of_three_planted_faults_each_is_caught_by_its_own_step_and_no_other_verdict_is_wrong(rig):
    found, wanted = verdicts_with(rig, GATE)
    assert found == wanted


@pytest.mark.nightly
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_planted_fault_is_caught_by_its_own_step_and_no_other_verdict_is_wrong(rig, fault):
    found, wanted = verdicts_with(rig, [fault])
    assert found == wanted


def muted_and_disarmed(rig):
    """The next hello is normal."""
    assert rig.board.pin(rig.facts.unmute) == 0
    rig.host.connect()
    status = rig.host.status()
    assert status["state"] == "idle" or status["faults"], status
    if status["faults"]:
        # The drive of a host that has gone ends with a fault, which is cleared.
        assert status["faults"] == {"host lost"}, status
        rig.host.accept("ClearFaults")
    assert rig.host.status()["state"] == "idle"


def left(rig, is_pulled):
    """The host is killed, or the cable pulled and plugged in again: nothing comes for longer than the dead-man waits."""
    if is_pulled:
        rig.cable.unplug()
    rig.board.is_hasty = True
    rig.board.run(1.2)
    rig.board.is_hasty = False
    assert rig.board.pin(rig.facts.unmute) == 0
    if is_pulled:
        rig.cable.plug()
        rig.board.run(0.1)
        # Where it was pulled within a frame, the rest of that spoils the next frame, which a host sends again. Here a delimiter
        # alone ends it.
        rig.cable.send(b"\0")
    muted_and_disarmed(rig)


@pytest.mark.nightly
def test_a_killed_host_a_pulled_cable_and_a_stop_leave_the_board_muted_at_random_moments(rig):
    """Each is a copy of the same test at another moment of it; the last one, the stop, ends the test itself."""
    rig.wire(*WIRES)
    desk = Desk(rig, *WIRES, "unplugged")
    draw = random.Random(11)
    # One in each fifth of the test.
    moments = [0.4 * (part + draw.random()) for part in range(5)]
    for number, moment in enumerate(moments[:-1]):
        while desk.seconds < moment:
            assert not desk.look()
        print(f"\n{moment:.3f} s: {('killed', 'pulled')[number % 2]}", flush=True)
        in_copy(lambda: left(rig, is_pulled=number % 2 == 1))
    while desk.seconds < moments[-1]:
        assert not desk.look()
    desk.look("stop")
    desk.test()
    assert desk.report == {"error": "cancelled"}
    rig.board.run(0.1)
    muted_and_disarmed(rig)
