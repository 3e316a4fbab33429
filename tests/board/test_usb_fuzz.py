"""Hosts that follow no rule of USB: whatever they do, the device neither resets nor plays anything else, a drive ends in its
time, and the next proper host gets its answer."""
import random

import pytest

from boards import on_f407, on_usb
from copies import on_copy
from rig import MILLISECOND, is_silent
from usb_actions import play, sequence

# Sequences of a night, for each board.
NIGHT = 1500
# What found a fault once: each stays as it was found.
FOUND = {
    "unconfigured data": [
        ("control", (0x00, 9, 0, 0, 0), [], 0, 0, 1e-3), ("bulk", 2, [64, 64]), ("control", (0x00, 9, 2, 0, 0), [], 0, 0, 1e-3),
        ("control", (0x00, 9, 1, 0, 0), [], 0, 0, 1e-3),
    ],
    "status of an endpoint that does not exist": [("control", (0x82, 0, 0, 15, 2), [], 1, 0, 1e-3)],
    "halt of an endpoint that does not exist": [("control", (0x02, 3, 0, 0x8F, 0), [], 0, 0, 1e-3)],
    "more data than announced": [("control", (0x21, 0x20, 0, 0, 7), [64], 0, 0, 1e-3)],
    "data where none is announced": [("control", (0x00, 9, 0, 0, 0), [8], 0, 0, 1e-3)],
    "a reset in a suspension that is not reported yet": [
        ("setups", [(0x80, 6, 0xE03, 0, 64), (0x82, 0, 0, 0x82, 8)], 3e-4), ("unplug", 4e-3),
    ],
    "data where none belongs": [("control", (0x80, 6, 0x100, 0, 18), [], 1, 64, 1e-3)],
}  # fmt: skip


def survives(rig, actions):
    """Plays the actions on a device that sounds; then comes a proper host."""
    board, cable = rig.board, rig.cable
    play(rig, actions)
    assert (board.resets, board.faults, board.is_locked_up) == ([], [], False)
    codes = rig.codes(rig.at, min(rig.played(), rig.at + len(rig.expected)))
    assert codes == rig.expected[: len(codes)], "no host changes a sample"
    cable.unplug()
    board.run(1e-3)
    cable.enumerates = cable.reads = True
    cable.plug()
    rig.host.forget()
    board.run_until(lambda: cable.is_configured, 0.2)
    # Ends whatever has been begun on the link, as every host does.
    cable.send(b"\0")
    rig.host.hello()
    assert rig.host.status()["state"] in ("driving", "stopping", "fault")
    assert board.resets == []


def is_followed_by_silence(rig, actions):
    """The same, but nobody comes any more: R-20."""
    last = rig.played()
    play(rig, actions)
    rig.board.is_hasty = True
    rig.board.run(1.07 - (rig.played() - last) / MILLISECOND / 1000)
    assert is_silent(rig.codes(last + 1060 * MILLISECOND, rig.played()))
    assert rig.board.pin(rig.facts.unmute) == 0 and rig.board.resets == []


def failure(rig, case, actions):
    """What a case says of these actions on a copy of the rig, or None."""
    try:
        on_copy(rig, lambda rig: case(rig, actions))
    except AssertionError as error:
        return error
    return None


def shortest(rig, case, actions):
    """Leaves out what the failure does not need."""
    i = 0
    while i < len(actions):
        fewer = actions[:i] + actions[i + 1 :]
        if failure(rig, case, fewer):
            actions = fewer
        else:
            i += 1
    return actions


def holds(rig, case, seed):
    actions = sequence(random.Random(seed))
    if failure(rig, case, actions):
        actions = shortest(rig, case, actions)
        raise AssertionError(f"seed {seed}, cut down to {actions}") from failure(rig, case, actions)


@on_usb
@pytest.mark.every_image
@pytest.mark.parametrize("found", FOUND)
def test_inputs_that_once_found_a_fault_find_none(sounding, found):
    survives(sounding, FOUND[found])


@on_f407
@pytest.mark.parametrize("seed", range(4))
def test_a_host_that_follows_no_rule_is_survived(sounding, seed):
    survives(sounding, sequence(random.Random(seed)))


@on_usb
@pytest.mark.fuzz
def test_no_host_of_a_thousand_is_not_survived(sounding):
    for seed in range(1000, 1000 + NIGHT):
        holds(sounding, survives, seed)


@on_usb
@pytest.mark.fuzz
def test_a_drive_ends_after_each_of_a_hundred_hosts(sounding):
    for seed in range(NIGHT // 10):
        holds(sounding, is_followed_by_silence, seed)
