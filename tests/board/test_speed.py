"""Cycles on a Cortex-M4, by a model of its instruction timings: deterministic, so they are asserted.

The bank's by the bench image, block by block; those of the renderer's whole interrupt by the very image that is
flashed, on the board: without wait states, and with those of the flash of both chips with this core.
"""
import re

import pytest

import m4_cycles
import wait_states
from boards import G474, RENDERER_IRQ, on, on_f407
from host import RATE_HZ, drive, framed
from images import ROOT, bench
from instruction_trace import Recorder
from measuring import EVERY_SLOT, listen, listened
from messages import Capture, DigestStart, KeepAlive
from test_latency import check_blocks, full_line, measure, sweep

TONES, BLOCK = 16, 128
BLOCK_PERIOD_CYCLES = 168_000_000 * BLOCK // RATE_HZ
PAGE = (ROOT / "firmware/PERFORMANCE.md").read_text()
RING = (ROOT / "firmware/stm32/src/ring.rs").read_text()
PRIORITIES = (ROOT / "firmware/stm32/src/priority.rs").read_text()
# A later compiler may save or cost a few instructions.
TOLERANCE = 0.03
# Cycles per tone and sample, everything included: phases, seeds, mix, conversion to codes, store.
GOALS = {
    "bench_steady": 3.5, "bench_glide": 10.0, "bench_retune": 10.0, "bench_lock_in_steady": 5.0, "bench_lock_in_glide": 5.0,
}  # fmt: skip
ROWS = {
    "bench_steady": "steady", "bench_glide": "all tones glide", "bench_retune": "all tones re-tuned at once",
    "bench_lock_in_steady": "lock-ins of steady tones", "bench_lock_in_glide": "lock-ins of tones that glide",
}  # fmt: skip
LOCK_IN = (ROOT / "firmware/dds/src/lock_in.rs").read_text().replace("\n//!", "")
LOCK_INS = {"bench_lock_in_steady": "steady", "bench_lock_in_glide": "glides"}
RENDERER, DMA = 16 + 53, 16 + 16
# Flash and clock. The G474's image has the same application and is placed likewise, so the F407's trace stands for it:
# with its own RAMs, for it runs at the F407's addresses.
CHIPS = (
    (wait_states.F407, 168e6),
    (wait_states.F407_REVISION_A, 168e6),
    (wait_states.G474._replace(rams=wait_states.F407.rams), 170e6),
)
MILLISECOND = 400
# Per cent of a block's time that the interrupt may take, without wait states and with them: while nobody listens to the
# inputs, and while one is measured.
DEAF = 52, 60
LISTENING = 70, 80
# The refusal of a command whose number is not the next one.
# One is measured while the other is captured.
CAPTURING = 75, 80


def worst_cycles(image, call):
    board = m4_cycles.Board(image)
    board.call("bench_setup", [TONES], trace=False)
    # A lock-in's first block makes every basis.
    board.call(call, [], trace=False)
    return max(board.cycles(board.call(call, [], trace=True))[0] for _ in range(4))


@pytest.mark.parametrize("call", GOALS)
def test_a_block_takes_no_more_cycles_than_its_goal_and_what_the_readme_says(call):
    cycles = worst_cycles(bench(), call)
    each = cycles / (TONES * BLOCK)
    share = 100 * cycles / BLOCK_PERIOD_CYCLES
    print(f"\n{ROWS[call]}: {each:.2f} cycles per tone and sample (goal {GOALS[call]}), {share:.1f} % of a block's time")
    assert each <= GOALS[call]
    assert share < 50
    row = re.search(rf"^\| {ROWS[call]} \| ([\d.]+) \|.*\| ([\d.]+) % \|$", PAGE, re.M)
    assert row, "the performance page has this row"
    assert [float(figure) for figure in row.groups()] == pytest.approx([each, share], rel=TOLERANCE)


@pytest.mark.parametrize("call", LOCK_INS)
def test_the_lock_ins_take_the_cycles_that_their_module_says(call):
    """Sixteen tones, one input."""
    cycles = worst_cycles(bench(), call)
    each, share = cycles / (TONES * BLOCK), 100 * cycles / BLOCK_PERIOD_CYCLES
    stated = re.search(rf"([\d.]+)(?: cycles per tone and sample)? while every tone (?:is )?{LOCK_INS[call]} \((\d+) %", LOCK_IN)
    assert stated, "the module's documentation has this figure"
    assert [float(figure) for figure in stated.groups()] == pytest.approx([each, share], rel=TOLERANCE)


def documented(row):
    """Cycles and shares in a row of the page's table of interrupts."""
    cycles, *shares = re.search(rf"^\| {row} \| ([\d ]+) \| ([\d.]+) % \| ([\d.]+) % \| ([\d.]+) % \|$", PAGE, re.M).groups()
    return int(cycles.replace(" ", "")), *map(float, shares)


def with_wait_states(board, run, exception):
    """Cycles of a handler's run with the wait states of each of `CHIPS`."""
    vector = wait_states.FLASH.start + 4 * exception
    entry_and_exit = board.ENTRY_CYCLES + board.EXIT_CYCLES
    return [wait_states.cycles(run, board.timing, chip, vector)[1] + entry_and_exit for chip, _ in CHIPS]


def compare(row, board, cycles, runs, exception, limits=DEAF):
    """Compares the worst of a handler's runs with a row of the page's table, and with what may be."""
    share = 100 * cycles / BLOCK_PERIOD_CYCLES
    worst = map(max, zip(*(with_wait_states(board, run, exception) for run in runs)))
    f407, revision_a, g474 = (100 * most / (hz * BLOCK / RATE_HZ) for most, (_, hz) in zip(worst, CHIPS))
    print(f"{row}: {cycles:.0f} cycles, {share:.1f} % of a block's time; with wait states {f407:.1f} % on the F407 "
          f"(revision A: {revision_a:.1f} %), {g474:.1f} % on the G474")  # fmt: skip
    assert share < limits[0]
    assert max(f407, revision_a, g474) < limits[1]
    assert documented(row) == pytest.approx((cycles, share, max(f407, revision_a), g474), rel=TOLERANCE)


@on_f407
def test_a_block_of_the_renderer_takes_little_enough_of_its_time_whatever_comes_together(armed):
    """R-44 and R-68: the interrupt as a whole, with the executor and the copy to the ring."""
    board, host = armed.board, armed.host

    def worst(row, recorder):
        compare(row, board, board.worst_cycles[recorder.exception], recorder.runs, recorder.exception)

    # A drag, all tones from one place of the table to another.
    glide(host, 0, 10)
    host.live(0.02)
    board.worst_cycles.clear()
    with Recorder(board, RENDERER) as recorder:
        glide(host, 0.9, 40)
        host.live(0.003)
    worst("and a new program begins", recorder)
    board.worst_cycles.clear()
    with Recorder(board, RENDERER) as recorder:
        host.live(0.004)
    worst("16 tones glide", recorder)
    with Recorder(board, DMA) as recorder:
        host.live(0.004)
    worst("the DMA's interrupt beside it", recorder)
    host.live(0.012)
    blend(host, 40)
    board.worst_cycles.clear()
    with Recorder(board, RENDERER) as recorder:
        glide(host, 0.9, 40)
        host.live(0.003)
    worst("and another table is blended in, and a digest made", recorder)
    # What the device itself counts is the same without the executor and the copy.
    assert host.status()["max_cycles"] < DEAF[0] / 100 * BLOCK_PERIOD_CYCLES


def glide(host, shift, milliseconds):
    tones = [(slot, (slot + shift) / 17, 0.06) for slot in range(TONES)]
    host.accept("Drive", drive(tones, milliseconds * MILLISECOND))


def blend(host, knots):
    """In the middle of a glide another table comes into force and so another program. When a third drive comes, the settings of
    the first table have still to be left behind, and a digest is made."""
    host.stage(knots)
    glide(host, 0.0, 200)
    host.live(0.003)
    host.accept("TableCommit")
    now = host.status()["now"]
    host.accept("DigestStart", DigestStart(now + 10 * MILLISECOND, 100 * MILLISECOND))
    host.live(0.012)


@on_f407
def test_a_block_is_rendered_and_measured_in_little_enough_of_its_time(armed):
    """R-68: all the lock-ins that the device states, with everything that may come together; what drains the inputs is part of
    it. Windows begin and end meanwhile."""
    board, host = armed.board, armed.host
    board.adc.at_pins = lambda: (board.dac.output, 4095 - board.dac.output)

    def worst(row, limits=LISTENING, captures=False, **window):
        listen(host, 1000, hann=True, **window)
        if captures:
            host.capture(1, 4096)
        host.live(0.002)
        board.worst_cycles.clear()
        with Recorder(board, RENDERER) as recorder:
            glide(host, 0.9, 40)
            host.live(0.003)
            for _ in range(2):
                listen(host, 3, hann=True, **window)
                host.live(0.002)
        reported = listened(host, 0)
        assert reported.progress == "finished" and reported.followed == window.get("slots", EVERY_SLOT)
        compare(row, board, board.worst_cycles[RENDERER], recorder.runs, RENDERER, limits)

    glide(host, 0, 10)
    host.live(0.02)
    worst("16 tones glide, and 16 lock-ins measure one input")
    glide(host, 0, 10)
    host.live(0.02)
    worst("16 tones glide, and 8 lock-ins measure both inputs", slots=0xFF, input=None)
    blend(host, 40)
    worst("16 lock-ins measure while another table is blended in, and a digest made")
    assert host.status()["max_cycles"] < LISTENING[0] / 100 * BLOCK_PERIOD_CYCLES
    host.live(0.1)
    blend(host, 33)
    worst("and the other input is captured", CAPTURING, captures=True)


@on(G474)
@pytest.mark.every_image
def test_the_worst_block_with_the_link_full_both_ways_matches_the_page(armed):
    """R-68: of the link's interrupts those count that lie above the renderer's (R-44). Their cycles do not depend on the block's."""
    board, cable = armed.board, armed.cable
    above = [irq for irq in (*G474.urgent_link_irqs, *G474.waking_link_irqs) if board.priorities[irq] <= board.priorities[RENDERER_IRQ]]
    cable.send(full_line(armed) * 40)
    board.run(0.002)
    cable.receive()
    began, taken = board.seconds, 0
    for irq in above or [RENDERER_IRQ]:
        with Recorder(board, 16 + irq) as recorder:
            board.run(0.004)
        vector = wait_states.FLASH.start + 4 * (16 + irq)
        runs = recorder.runs if above else []
        taken += sum(wait_states.cycles(run, board.timing, wait_states.G474, vector)[1] + board.ENTRY_CYCLES + board.EXIT_CYCLES for run in runs)
    assert cable.to_device and len(cable.receive()) > 0.9 * 921_600 / 10 * (board.seconds - began), "the line was full both ways"
    link = 100 * taken / (170e6 * (board.seconds - began)) * max(len(above), 1)
    dma = documented("the DMA's interrupt beside it")
    rows = {"only plays": ("and another table is blended in, and a digest made", DEAF), "measures": ("and the other input is captured", CAPTURING)}
    sums = {"of it the link": (0, link)}
    for what, (row, limits) in rows.items():
        f407, g474 = (block + beside for block, beside in zip(documented(row)[2:], dma[2:]))
        sums[f"while it {what}"] = f407, g474 + link
        assert max(f407, g474 + link) <= limits[1], sums
    print(sums)
    for what, (f407, g474) in sums.items():
        stated = re.search(rf"^\| {what} \| ([\d.]+) % \| ([\d.]+) % \|$", PAGE, re.M)
        assert [float(share) for share in stated.groups()] == pytest.approx((f407, g474), abs=0.06), what


@on(G474)
@pytest.mark.every_image
@pytest.mark.parametrize("seconds", [0.4, pytest.param(10, marks=pytest.mark.nightly)])
def test_a_line_that_is_full_both_ways_costs_no_block_and_no_lock_in_while_all_comes_together(armed, seconds):
    """R-68: glides, tables and digests, while sixteen lock-ins measure one input and the other is captured."""
    board, host, cable = armed.board, armed.host, armed.cable
    glide(host, 0, 10)
    host.live(0.012)
    measure(armed)
    flood, sent, received, drives, turn = full_line(armed), 0, 0, 0, 0
    until = board.seconds + seconds

    def follow(reply):
        """A numbered command that was dropped leaves its number to the next."""
        if reply.refuses("BadSequence"):
            host.sequence = reply.value.expected - 1 & 0xFFFF
        return reply.is_accepted

    def numbered(message, body):
        host.sequence = host.sequence + 1 & 0xFFFF
        return framed(host.session, host.sequence, message, body)

    while board.seconds < until:
        data = framed(host.session, 9, "KeepAlive", KeepAlive(500 + turn)) + numbered("Drive", sweep(turn, 40))
        if turn % 8 == 0:
            data += numbered("Capture", Capture(None, 1, 0, 4096))
        data += flood * 100
        cable.send(data)
        turn += 1
        board.run_until(lambda: len(cable.to_device) < len(flood), 0.2, step=2e-4)
        sent += len(data)
        received += len(cable.from_device)
        drives += sum(map(follow, host.replies()))
    print(f"{sent} bytes to the device and {received} from it in {seconds} s, {drives} commands of {turn * 9 // 8} accepted")
    assert min(sent, received) > 0.85 * 92_160 * seconds, "the line was full both ways"
    assert drives > turn / 2
    # Until all is answered: what is left of a cut frame would be the next one's.
    for _ in range(40):
        board.run(0.005)
        if not cable.receive():
            break
    host.forget()
    follow(host.exchange("Inputs"))
    check_blocks(host)
    status, reading = host.status(), listened(host, 0)
    assert reading.progress == "running"
    assert (status["state"], status["faults"], board.resets) == ("driving", set(), [])
    # The thread has a fifth of the time: commands that find no room are dropped, and counted.
    assert (status["crc_errors"], status["overlong"]) == (0, 0), "no byte was lost"
    assert status["max_cycles"] < CAPTURING[1] / 100 * 170e6 * BLOCK / RATE_HZ


@on_f407
def test_a_block_is_rendered_while_levels_are_held_in_little_enough_of_its_time(armed):
    """R-68: the lock-ins never rest, and with each window all levels begin to glide again."""
    board, host = armed.board, armed.host
    board.adc.at_pins = lambda: ((board.dac.output + 2048) // 2, 2048)
    glide(host, 0, 10)
    host.live(0.02)
    host.hold([(slot, 8) for slot in range(TONES)], 20)
    host.live(0.012)
    board.worst_cycles.clear()
    # A window and its pause are 10.24 ms: when a window is reported as over, its turn has just published new levels.
    windows = host.held()[1]
    board.run_until(lambda: host.held()[1] > windows, 0.02, step=0.0005)
    with Recorder(board, RENDERER) as recorder:
        host.live(0.0025)
    progress, _, tones = host.held()
    assert progress == "on" and all(correction < 0 for _, _, correction in tones)
    compare("16 levels are held at one input", board, board.worst_cycles[RENDERER], recorder.runs, RENDERER, LISTENING)


@on_f407
def test_a_block_that_waits_is_revised_in_the_time_that_the_ring_holds_back_for_it(armed):
    """R-69: for a stop, while tones glide and a digest is made."""
    board, host = armed.board, armed.host
    host.accept("Drive", drive([(slot, slot / 17, 0.06) for slot in range(TONES)], 200 * MILLISECOND))
    now = host.status()["now"]
    host.accept("DigestStart", DigestStart(now + 10 * MILLISECOND, 100 * MILLISECOND))
    host.live(0.02)
    board.run_until(lambda: armed.played() % BLOCK == 0, 0.001, step=1e-6)
    (revise,) = {address & ~1 for name, address in board.symbols.items() if re.match(r"_ZN.*revision.*6revise17h", name)}
    (ring,) = {address for name, address in board.symbols.items() if re.match(r"_ZN.*dac4RING", name)}
    with Recorder(board, RENDERER) as recorder:
        host.accept("EmergencyStop")
    (run,) = (run for run in recorder.runs if any(step.address == revise for step in run))
    cycles, _ = wait_states.cycles(run, board.timing, CHIPS[0][0], wait_states.FLASH.start)
    compare("a stop begins in the block that waits", board, cycles + board.ENTRY_CYCLES + board.EXIT_CYCLES, [run], RENDERER)
    # What follows the last code in the ring may take its time.
    last = max(i for i, step in enumerate(run) if any(0 <= word - ring < 8 * BLOCK for word in step.accesses))
    until_handed_over = with_wait_states(board, run[: last + 1], RENDERER)
    samples = [cycles * RATE_HZ / hz for cycles, (_, hz) in zip(until_handed_over, CHIPS)]
    revision, margin = (int(re.search(rf"const {name}: usize = (\d+);", RING)[1]) for name in ("REVISION", "MARGIN"))
    print(f"handed over after {max(samples):.1f} samples; the ring allows {revision - margin}")
    # The DMA's interrupt may come between, and a later compiler may cost a few instructions.
    assert max(samples) * 1.2 <= revision - margin
    stated = [int(re.search(rf"(\d+) cycles \({name}\)", RING)[1]) for name in ("F407", "G474")]
    assert stated == pytest.approx((max(until_handed_over[:2]), until_handed_over[2]), rel=0.05)


@on_f407
def test_interrupts_are_never_masked_for_longer_than_the_priorities_file_says(armed):
    """Nothing long is copied under the mask: not the motion that a drive publishes, not the one that a status reads."""
    board, host = armed.board, armed.host
    tones = [(slot, slot / 17, 0.06) for slot in range(TONES)]
    board.worst_masked = 0, 0
    host.accept("Drive", drive(tones, 200 * MILLISECOND))
    host.live(0.003)
    host.stage(40)
    host.accept("TableCommit")
    host.accept("DigestStart", DigestStart(host.status()["now"] + 10 * MILLISECOND, 20 * MILLISECOND))
    host.live(0.012)
    host.accept("Stop")
    # The supervisor sets its alarm every 100 ms.
    board.is_hasty = True
    host.live(0.15)
    cycles, _ = board.worst_masked
    stated = int(re.search(r"at most (\d+) cycles", PRIORITIES).group(1))
    print(f"interrupts masked: at most {cycles:.0f} cycles, {cycles / board.CORE_HZ * 1e6:.2f} us")
    assert 0 < cycles < 2e-6 * board.CORE_HZ
    assert stated == pytest.approx(cycles, rel=0.1)
