"""After hours and months: every counter of the device passes its end, and nothing happens.

The image begins with its counters near their ends: what the start has put into the renderer's own memory is changed before its
first turn, or a counter is set while the device runs.
"""
import struct

import pytest

from boards import RENDERER_IRQ
from host import BLOCK, RATE_HZ, drive
from rig import LIMIT_PERIOD, MILLISECOND, Rig

# The index's lower half wraps every 3 h; the 242nd time after 30 days.
WRAP, MONTH = 1 << 32, 242 << 32
# Connected and armed before the wrap, in the same period of the thermal limit.
BEFORE = 128 * MILLISECOND


def is_rendering(board):
    return any(exception == RENDERER_IRQ + 16 for _, exception in board.active)


def words_after_a_block(rig, start, end):
    """The words of the renderer's memory just after its next turn, when nothing is about to change them."""
    board = rig.board
    board.run_until(lambda: is_rendering(board), 0.001, step=2e-6)
    board.run_until(lambda: not board.active, 0.001, step=1e-6)
    memory = bytes(rig.board.cpu.mem_read(start, end - start))
    return [int.from_bytes(memory[i : i + 8], "little") for i in range(0, len(memory) - 8, 4)]


def renderers_counters(rig):
    """Where the renderer keeps its index and the index of the next change of the limit; `rig` has played for a while."""
    (start,) = (address for name, address in rig.board.symbols.items() if "RENDERER" in name and "EXECUTOR" not in name)
    end = min(address for address in rig.board.symbols.values() if address > start)
    # In the first period the limit's index is the period's length, too.
    rig.board.is_hasty = True
    rig.host.live(LIMIT_PERIOD / RATE_HZ)
    rig.board.is_hasty = False
    now = rig.host.status()["now"]
    due = -(-now // LIMIT_PERIOD) * LIMIT_PERIOD
    seen = words_after_a_block(rig, start, end)
    rig.board.run(9.5 * BLOCK / RATE_HZ)
    later = words_after_a_block(rig, start, end)
    moved = [i for i, (a, b) in enumerate(zip(seen, later)) if now <= a < b == a + 10 * BLOCK and a - now < 4 * MILLISECOND]
    limits = [i for i, (a, b) in enumerate(zip(seen, later)) if a == b == due]
    assert len(moved) == len(limits) == 1, (moved, limits)
    return start + 4 * moved[0], start + 4 * limits[0]


@pytest.mark.every_image
@pytest.mark.parametrize("wrap", [WRAP, pytest.param(MONTH, marks=pytest.mark.nightly)])
def test_the_lower_half_of_the_sample_index_wraps_and_every_code_matches_the_mirror(sounding, image, mirror, wrap):
    begin = (wrap - BEFORE) // BLOCK * BLOCK
    assert (begin // LIMIT_PERIOD + 1) * LIMIT_PERIOD > wrap + 60 * MILLISECOND, "one period of the limit"
    index, limit_due = renderers_counters(sounding)
    initial = {
        index: struct.pack("<Q", begin),
        limit_due: struct.pack("<Q", (begin // LIMIT_PERIOD + 1) * LIMIT_PERIOD),
    }
    rig = Rig(sounding.facts, image, initial)
    host = rig.host
    host.connect()
    host.upload()
    host.arm()
    status = host.status()
    assert begin < status["now"] < wrap - 10 * MILLISECOND
    # Begins exactly at the wrap, and glides over it.
    first = host.accept("Drive", drive([(0, 0.3, 0.6), (1, 0.9, 0.2)], 5 * MILLISECOND, wrap - 8 * MILLISECOND))
    host.live((wrap - 4 * MILLISECOND - host.status()["now"]) / RATE_HZ)
    host.accept("Drive", drive([(0, 0.8, 0.4), (2, 0.1, 0.2)], 8 * MILLISECOND))
    host.live(0.008)
    assert host.status()["now"] > wrap
    host.accept("Stop")
    host.live(0.04)
    until = begin + rig.played()
    codes = rig.codes(first - begin, until - begin)
    expected = mirror(host.accepted, first, until, status["foldback_per_mille"], begin)
    wrong = [i for i, (a, b) in enumerate(zip(codes, expected, strict=True)) if a != b]
    assert not wrong, f"{len(wrong)} codes of {len(codes)} differ, the first at {first + wrong[0] - wrap} from the wrap"
    assert max(codes) - min(codes) > 500, "it sounds"
    status = host.status()
    assert (status["state"], status["underruns"]) == ("armed", 0)


@pytest.mark.nightly
def test_the_tasks_counts_of_turns_wrap_and_the_watchdog_is_fed_on(sounding):
    """The renderer's after 16 days."""
    board = sounding.board
    board.cpu.mem_write(sounding.pulses(), struct.pack("<III", *[0xFFFFFFFF - turns for turns in (300, 100, 30)]))
    sounding.host.live(0.02)
    assert sounding.leaves_the_mirror() == sounding.played()
    board.is_hasty = True
    sounding.host.live(0.7)
    status = sounding.host.status()
    assert (status["state"], status["faults"], board.resets) == ("driving", set(), [])
    assert board.pin(sounding.facts.unmute) == 1


@pytest.mark.every_image
def test_the_cycle_counter_wraps_and_no_block_counts_as_long(sounding):
    """Every 25 s; here in the sixth block from now, while the renderer counts."""
    board = sounding.board
    before = sounding.host.status()["max_cycles"]
    # The beginning of a turn.
    board.run_until(lambda: not is_rendering(board), 0.001, step=1e-6)
    board.run_until(lambda: is_rendering(board), 0.001, step=1e-6)
    wrap = board.now + 6 * BLOCK / RATE_HZ * board.core_hz + before / 4
    board.run_until(lambda: not board.active, 0.001, step=1e-6)
    board.counted_cycles += (1 << 32) - board.core_cycles() % (1 << 32) - int(wrap - board.now)
    sounding.host.live(0.005)
    assert board.core_cycles() % (1 << 32) < 0.01 * board.core_hz, "it has wrapped"
    assert 0 < sounding.host.status()["max_cycles"] < 2 * before
    assert sounding.leaves_the_mirror() == sounding.played()


@pytest.mark.nightly
def test_the_hosts_beat_counts_to_its_end_and_a_host_that_begins_again_there_is_a_silent_one(armed):
    """R-20: after 27 years. Only a higher beat shows that the host lives."""
    host, board = armed.host, armed.board
    host.keep_alives = 0xFFFFFFFF - 6
    host.accept("Drive", drive([(0, 0.4, 0.5)], 5 * MILLISECOND))
    board.is_hasty = True
    began = board.seconds
    while host.keep_alives < 0xFFFFFFFF:
        host.live(0.05)
    assert board.seconds - began > 1.05 and host.status()["state"] == "driving"
    host.keep_alives = -1
    host.live(1.3)
    assert host.status()["first_fault"] == "host lost"
    host.hello()
    host.accept("ClearFaults")
    host.arm()
    assert host.status()["state"] == "armed", "a new session counts from the start"
