"""Cycles of the bank's code on a Cortex-M4, by a model of its instruction timings: deterministic, so they are asserted."""
import re

import pytest

import m4_cycles
from conftest import ROOT, TARGET, cargo

TONES, BLOCK = 16, 128
BLOCK_PERIOD_CYCLES = 168_000_000 * BLOCK // 400_000
# Cycles per tone and sample, everything included: phases, seeds, mix, conversion to codes, store.
GOALS = {"bench_steady": 3.5, "bench_glide": 10.0, "bench_retune": 10.0}
ROWS = {"bench_steady": "steady", "bench_glide": "all tones glide", "bench_retune": "all tones re-tuned at once"}


@pytest.fixture(scope="session")
def bench_image():
    return cargo("--release", "-p", "slipline-qemu", "--target", TARGET, "--bin", "slipline-bench")


def worst_cycles(image, call):
    board = m4_cycles.Board(image)
    board.call("bench_setup", [TONES], trace=False)
    return max(board.cycles(board.call(call, [], trace=True))[0] for _ in range(4))


@pytest.mark.parametrize("call", GOALS)
def test_a_block_takes_no_more_cycles_than_its_goal_and_what_the_readme_says(bench_image, call):
    cycles = worst_cycles(bench_image, call)
    each = cycles / (TONES * BLOCK)
    share = 100 * cycles / BLOCK_PERIOD_CYCLES
    print(f"\n{ROWS[call]}: {each:.2f} cycles per tone and sample (goal {GOALS[call]}), {share:.1f} % of a block's time")
    assert each <= GOALS[call]
    assert share < 50
    row = re.search(rf"^\| {ROWS[call]} \| ([\d.]+) \|.*\| ([\d.]+) % \|$", (ROOT / "README.md").read_text(), re.M)
    assert row, "the README's performance table has this row"
    # A later compiler may save or cost a few instructions.
    assert [float(figure) for figure in row.groups()] == pytest.approx([each, share], rel=0.03)
