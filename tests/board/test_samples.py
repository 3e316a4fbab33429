"""Every code is the mirror's, whatever else happens; and where a code is missing, a line to silence takes its place."""
from boards import RENDERER_IRQ
from copies import on_copy
from core.usb import UsbHost
from host import BLOCK, RATE_HZ, drive, framed
from messages import KeepAlive
from rig import MID, MILLISECOND, is_silent, start


def sixteen(shift=0.0):
    return [(slot, (slot + shift) / 17, 0.06) for slot in range(16)]


def test_sixteen_gliding_tones_match_the_mirror_bit_for_bit(cool, mirror):
    armed = cool
    first = armed.host.status()["now"] + 5 * MILLISECOND
    first = armed.host.accept("Drive", drive(sixteen(), 10 * MILLISECOND, first))
    armed.host.live(0.03)
    drag = armed.host.accept("Drive", drive(sixteen(0.9), 40 * MILLISECOND))
    armed.host.live(0.08)
    stop = armed.host.accept("Stop")
    armed.host.live(0.04)
    until = armed.played()
    assert first < drag < stop and until - first > 100 * MILLISECOND
    codes = armed.codes(first, until)
    expected = mirror(armed.host.accepted, first, until)
    wrong = [i for i, (a, b) in enumerate(zip(codes, expected, strict=True)) if a != b]
    assert not wrong, f"{len(wrong)} codes differ, the first at {wrong[0]}, drive {first}, drag {drag}, stop {stop}"
    assert max(codes) - min(codes) > 2000, "it sounds"
    assert is_silent(codes[-MILLISECOND:]), "and stops"
    status = armed.host.status()
    assert (status["state"], status["underruns"], armed.board.dac.underruns) == ("armed", 0, 0)
    # The deadline is a block, and the link wants the other half.
    print(f"worst block: {status['max_cycles']} cycles of {armed.board.CORE_HZ * 128 / RATE_HZ:.0f}")
    assert 0 < status["max_cycles"] < 0.5 * 128 / RATE_HZ * armed.board.CORE_HZ


def test_a_stop_begins_in_the_block_that_waits_and_matches_the_mirror_bit_for_bit(cool, mirror):
    """R-69: sent at eight phases of a block, while all tones glide. The other stops begin with a block."""

    def stopped(rig, message, phase):
        rig.board.run_until(lambda: rig.played() % BLOCK == 0, 0.001, step=1e-6)
        rig.board.run(phase / 8 * BLOCK / RATE_HZ)
        before = rig.played()
        stop = rig.host.accept(message)
        rig.host.live(0.003 if message == "EmergencyStop" else 0.035)
        until = rig.played()
        codes, expected = rig.codes(first, until), mirror(rig.host.accepted, first, until)
        wrong = [first + i for i, (a, b) in enumerate(zip(codes, expected, strict=True)) if a != b]
        assert not wrong, f"{len(wrong)} codes differ, the first at {wrong[0]}, stop {stop}"
        assert max(codes) - min(codes) > 2000 and is_silent(codes[-100:])
        assert rig.host.status()["underruns"] == 0
        return stop, stop - before

    host = cool.host
    first = host.accept("Drive", drive(sixteen(), 5 * MILLISECOND))
    host.live(0.01)
    host.accept("Drive", drive(sixteen(0.9), 100 * MILLISECOND))
    host.live(0.01)
    for message, phases in (("EmergencyStop", range(8)), ("Stop", (1, 7))):
        seen = [on_copy(cool, lambda rig, phase=phase: stopped(rig, message, phase)) for phase in phases]
        print(f"stop {message}: {[f'{index % BLOCK} of {index}, {soon / BLOCK:.2f} blocks' for index, soon in seen]}")
        assert {index % BLOCK for index, _ in seen} <= {0, 1} and sum(index % BLOCK for index, _ in seen) >= len(phases) / 2


def test_a_host_that_stops_reading_does_not_touch_the_samples(cool, mirror):
    """R-11."""
    armed = cool
    at = start(armed)
    armed.cable.reads = False
    for count in range(100, 112):
        armed.cable.send(framed(armed.host.session, armed.host.sequence, "KeepAlive", KeepAlive(count)))
        armed.board.run(0.01)
    until = armed.played()
    assert armed.codes(at, until) == mirror(armed.host.accepted, at, until)
    armed.cable.reads = True
    armed.board.run(0.05)
    # What was cut off in the middle is over with the next delimiter.
    armed.host.forget()
    armed.cable.receive()
    armed.host.keep_alives = 200
    status = armed.host.status()
    armed.host.accept("Stop")
    # USB waits for the host, so what does not fit is dropped; a serial line cannot wait, and what is sent there is lost.
    assert (status["dropped"] > 0) == (armed.facts.cable is UsbHost)
    assert (status["state"], status["underruns"]) == ("driving", 0)


def test_a_dma_that_does_not_deliver_is_counted_and_fades_out(armed):
    """R-43: the DAC's own underrun flag."""
    start(armed)
    controller, stream = armed.facts.dma
    armed.board.dma[controller].blocked.add(stream)
    armed.board.run(0.00002)
    armed.board.dma[controller].blocked.clear()
    before = len(armed.board.dac.codes)
    armed.board.run(0.1)
    codes = armed.board.dac.codes[before:]
    assert armed.board.dac.underruns >= 1
    assert len(codes) > 35_000 and is_silent(codes[-MILLISECOND:]), "the stream runs again"
    assert max(abs(a - b) for a, b in zip(codes, codes[1:])) < 700, "and nothing jumps"
    status = armed.host.status()
    assert status["first_fault"] == "underrun"
    assert status["underruns"] == 1, "one event, counted once"
    assert armed.board.pin(armed.facts.unmute) == 0


def line(code, length):
    """The codes from `code`, which is not one of them, to mid-scale: four codes a sample (firmware/app/src/safety/fade.rs)."""
    codes = []
    for _ in range(length):
        code = max(code - 4, MID) if code > MID else min(code + 4, MID)
        codes.append(code)
    return codes


def test_a_renderer_that_is_late_leaves_the_tone_by_one_line_and_never_comes_back_to_it(sounding):
    """R-43. The delay is held at each of the 128 phases by a model of the ring (firmware/stm32/src/ring/tests.rs)."""

    def late(rig, samples):
        board = rig.board
        board.enabled.discard(RENDERER_IRQ)
        board.run(samples / RATE_HZ)
        board.enabled.add(RENDERER_IRQ)
        board.run(0.004)
        left = rig.leaves_the_mirror()
        after = rig.codes(left, rig.played())
        is_late = bool(after)
        if is_late:
            assert len(after) > 1000 and after == line(rig.codes(left - 1, left)[0], len(after)), f"left at {left - rig.at}"
            assert (left - rig.at) % 128 == 0, "a block is played whole or not at all"
            assert board.pin(rig.facts.unmute) == 0, "no ramp comes after the fault"
            assert board.dac.underruns == 0, "the DMA itself was on time"
        status = rig.host.status()
        assert (status["first_fault"] == "underrun") == is_late == (status["underruns"] > 0)
        return is_late

    held = [10, *range(100, 230, 13), 400]
    were_late = [on_copy(sounding, lambda rig, samples=samples: late(rig, samples)) for samples in held]
    assert were_late == sorted(were_late) and not were_late[0] and were_late[-1], dict(zip(held, were_late))
