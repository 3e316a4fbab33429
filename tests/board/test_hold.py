"""The level hold on the very image that is flashed: what is sent while one of its turns plans new levels is at the pin as soon as without it.

A turn takes the amplitudes of a window, plans the levels of all tones, and publishes them; meanwhile only a stop is looked at,
no other command. A first copy of the board finds out when the next turn begins and ends; further ones send at moments between.
"""
import re

import pytest
from unicorn import UC_HOOK_CODE
from unicorn.arm_const import UC_ARM_REG_LR

from copies import on_copy
from host import BLOCK, RATE_HZ
from messages import KeepAlive
from rig import MID, MILLISECOND, Rig, is_silent
from test_latency import (
    DRIVE_BLOCKS_LISTENING, MOST_KNOTS, STOP_BLOCKS, STOPS_SEQUENCE, TRAVEL_LIMIT, accepted, check_blocks, send, sweep,
)  # fmt: skip

TONES = 16
# A window, and the pause after it: the shortest, so that turns come as often as they may.
WINDOW_BLOCKS, PAUSE_BLOCKS = 20, 12
PERIOD = (WINDOW_BLOCKS + PAUSE_BLOCKS) * BLOCK / RATE_HZ
# Codes of amplitude to hold: less than a fifth of the drive's amplitude at the sensor, so that every turn has new levels.
HELD_CODES = 8
# From a ramp's first sample until silence (firmware/SAFETY.md), and the dead-man's time.
RAMPS = {"EmergencyStop": 2 * MILLISECOND, "Stop": 30 * MILLISECOND}
DEAD_MAN, HOST_LOST_RAMP = RATE_HZ, 50 * MILLISECOND


@pytest.fixture(scope="module")
def holding(facts, image):
    """All tones sound, of the largest table and with a travel that is judged, and are held; the first window is over. The sensor
    receives half of the drive."""
    rig = Rig(facts, image)
    host, board = rig.host, rig.board
    host.connect()
    assert host.exchange("SetTravelLimit", TRAVEL_LIMIT).name == "TravelLimit"
    host.upload(MOST_KNOTS)
    host.arm()
    host.accept("Drive", sweep(0))
    host.live(0.02)
    board.adc.at_pins = lambda: (MID + (board.dac.output - MID) // 2, MID)
    host.hold([(slot, HELD_CODES) for slot in range(TONES)], WINDOW_BLOCKS)
    host.live(1.5 * PERIOD)
    progress, windows, held = host.held()
    assert (progress, windows, len(held)) == ("on", 1, TONES)
    return rig


def address(board, name):
    """Of the function of the turn that has this name."""
    (found,) = {place & ~1 for symbol, place in board.symbols.items() if re.match(rf"_ZN.*hold4turn.*{len(name)}{name}17h", symbol)}
    return found


def next_turn(rig):
    """When the next turn that has new levels looks at its window, and when it has handed them over, in the board's time."""
    board, looks, calls, ends = rig.board, [], [], []

    def watch(place, hook):
        board.cpu.hook_add(UC_HOOK_CODE, lambda *_: hook(), begin=place, end=place + 1)
        board.cpu.ctl_flush_tb()

    watch(address(board, "take_window"), lambda: looks.append(board.now))
    # Not of the turn that may be under way.
    watch(address(board, "publish_levels"), lambda: looks and calls.append(board.cpu.reg_read(UC_ARM_REG_LR) & ~1))
    board.run_until(lambda: calls, 2 * PERIOD, step=1e-6)
    begin = looks[-1]
    watch(calls[0], lambda: ends.append(board.now))
    board.run_until(lambda: ends, PERIOD, step=1e-6)
    return begin, ends[0]


def in_a_turn(holding, case, moments=8, after=0):
    """Calls the case in copies of the board, at moments from a block before a turn to some blocks after its end; returns the
    results, and how many blocks lie between two of them."""
    begin, end = on_copy(holding, next_turn)
    block = holding.board.CORE_HZ * BLOCK / RATE_HZ
    print(f"\n{holding.facts.name}: a turn of {(end - begin) / block:.2f} blocks")
    begin, end = begin - block, end + after * block
    step = (end - begin) / moments

    def at(moment):
        def later(rig):
            rig.board.run((moment - rig.board.now) / rig.board.CORE_HZ)
            return case(rig)

        return on_copy(holding, later)

    return [at(begin + n * step) for n in range(moments)], step / block


@pytest.mark.parametrize("message", ["EmergencyStop", "Stop"], ids=["an emergency stop", "a stop"])
def test_a_stop_while_a_hold_plans_its_levels_is_at_the_pin_at_once(holding, message):
    """R-77: and nothing of the hold starts after it."""

    def case(rig):
        numbered, rig.host.sequence = rig.host.sequence, STOPS_SEQUENCE
        sequence, played = send(rig, message)
        at = accepted(rig, sequence)
        rig.host.sequence = numbered
        silent = at + RAMPS[message] + BLOCK
        rig.host.live((silent - rig.played()) / RATE_HZ + 1.5 * PERIOD)
        assert is_silent(rig.codes(silent, rig.played()))
        assert rig.host.held()[0] == "ended"
        check_blocks(rig.host)
        return (at - played) / BLOCK

    seen, step = in_a_turn(holding, case)
    print(f"stop {message} while levels are planned: {min(seen):.2f} to {max(seen):.2f} blocks from the last byte to the pin")
    assert max(seen) + step <= STOP_BLOCKS


def test_a_drive_ends_a_hold_at_once(holding):
    """R-77: before a turn, while it plans its levels, and until these have begun."""

    def case(rig):
        sequence, played = send(rig, "Drive", sweep(1, 20))
        at = accepted(rig, sequence)
        assert rig.host.held()[0] == "ended"
        check_blocks(rig.host)
        return (at - played) / BLOCK

    seen, step = in_a_turn(holding, case, moments=14, after=6)
    print([round(each, 1) for each in seen])
    print(f"drive while levels are planned: {min(seen):.2f} to {max(seen):.2f} blocks from the last byte to the pin")
    assert max(seen) + step <= DRIVE_BLOCKS_LISTENING


def test_a_lost_host_ends_a_hold_in_silence_in_time(holding):
    """R-20: the hold's own levels are no sign of life."""

    def case(rig):
        host, board = rig.host, rig.board
        host.exchange("KeepAlive", KeepAlive(host.keep_alives + 1))
        last, board.is_hasty = rig.played(), True
        board.run(1.1)
        silent = last + DEAD_MAN + HOST_LOST_RAMP + 2 * BLOCK
        assert not is_silent(rig.codes(last + DEAD_MAN - 4 * BLOCK, last + DEAD_MAN - 2 * BLOCK)), "not before its time"
        assert is_silent(rig.codes(silent, rig.played())) and board.pin(rig.facts.unmute) == 0
        return host.status()["first_fault"], host.held()

    fault, (progress, windows, _) = on_copy(holding, case)
    assert (fault, progress) == ("host lost", "ended")
    assert windows > 0.9 / PERIOD, "it went on until then"
