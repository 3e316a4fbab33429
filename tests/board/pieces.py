"""The tests of a night in pieces: one after the other, or one on each core."""
import pytest

# Seconds of a core that a test takes, and those of the tests that take much more. They need not be exact.
USUAL = 2
LONG = {
    "test_a_power_cut_at_any_operation_leaves_the_old_or_the_new_table": 40,
    "test_bus_resets_without_end_are_a_silent_host": 30,
    "test_stops_and_the_dead_man_drop_a_waiting_drive": 20,
    "test_a_silent_host_is_noticed_by_the_device_itself": 12,
    "test_the_hosts_beat_counts_to_its_end_and_a_host_that_begins_again_there_is_a_silent_one": 12,
    "test_an_emergency_stop_is_at_the_pin_soon_whatever_comes_before_it": 10,
    "test_sixteen_tones_on_the_largest_table_begin_soon": 10,
    "test_a_planted_fault_is_caught_by_its_own_step_and_no_other_verdict_is_wrong": 10,
}


def board(item):
    return str(item.callspec.params.get("facts")) if hasattr(item, "callspec") else ""


def piece(items, number):
    """Of N pieces that take about as long as each other, the one with the number "K/N". The tests on a board stay together,
    those of a module too: each process must bring a board into the state from which they begin."""
    count, pieces = map(int, number.split("/"))
    if not 1 <= count <= pieces:
        raise pytest.UsageError(f"--piece {number}: K of N, K from 1 to N")
    ordered = sorted(items, key=lambda item: (board(item), item.module.__name__))
    seconds = [LONG.get(item.originalname, USUAL) for item in ordered]
    before, chosen = 0, []
    for item, takes in zip(ordered, seconds):
        if (2 * before + takes) * pieces // (2 * sum(seconds)) == count - 1:
            chosen.append(item)
        before += takes
    return chosen
