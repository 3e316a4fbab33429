"""Chords: the device renders a period of them before it accepts them, in slices, and plays those very blocks."""
from host import BLOCK, RATE_HZ, chord, framed
from records import Choice
from rig import MID, MILLISECOND, is_silent
from test_latency import PHASES, STOPS_SEQUENCE, send, wait_phase

GLIDE = 5 * MILLISECOND
# Nothing sounds, so no block that waits is cut into: the stop holds from the next one on, which plays two blocks later at most,
# and its last packet takes a moment.
STOP_BLOCKS = 2.25


def sixteen(period_log2, level):
    """Tones from 23 to 53 kHz with Schroeder's phases: their amplitudes add up to eleven times the level, their peak is less
    than half of that."""
    scale = 2 ** (period_log2 - 12)
    return [((240 + 20 * n) * scale, level, -n * n / 32) for n in range(16)]


def refused(host, body):
    """The refusal."""
    reply = host.exchange("Chord", body)
    assert reply.name == "Refused", reply
    return reply.value


def test_a_chord_is_proven_and_matches_the_mirror_bit_for_bit(cool, mirror):
    host, board = cool.host, cool.board
    for period_log2 in (12, 14):
        period = 2**period_log2
        # In phase they meet.
        refusal = refused(host, chord(period_log2, [(m, 0.22, 0.25) for m, _, _ in sixteen(period_log2, 0)], GLIDE))
        assert refusal.name == "Peak" and 2000 < refusal.peak_per_mille < 3000
        body = chord(period_log2, sixteen(period_log2, 0.22), GLIDE)
        sequence, _ = send(cool, "Chord", body)
        asked, answer = board.seconds, []
        while not answer:
            board.run(1e-5)
            answer = [reply for reply in host.replies() if reply.sequence == sequence]
        took = board.seconds - asked
        assert answer[0].is_accepted, answer
        first = answer[0].value.at
        print(f"\n{cool.facts.name}: a chord of {period} samples is proven and answered in {1000 * took:.1f} ms")
        host.live(0.03)
        status = host.status()
        assert (status["state"], status["clips"], status["underruns"]) == ("driving", 0, 0)
        assert status["sum_per_mille"] > 2000, "more than a drive may have"
        assert status["max_cycles"] < 0.5 * BLOCK / RATE_HZ * board.CORE_HZ
        # The mirror gets the chord, too, whose answer the host has not seen.
        host.live(2 * period / RATE_HZ)
        stop = host.accept("Stop")
        host.live(0.04)
        until = cool.played()
        accepted_chord = first, framed(host.session, sequence, "Chord", body)
        accepted = sorted([*host.accepted, accepted_chord], key=lambda entry: entry[0])
        host.accepted = accepted
        codes, expected = cool.codes(first, until), mirror(accepted, first, until)
        wrong = [i for i, (a, b) in enumerate(zip(codes, expected, strict=True)) if a != b]
        assert not wrong, f"{len(wrong)} codes differ, the first at {wrong[0]} of {until - first}"
        steady = codes[GLIDE + BLOCK : stop - first]
        assert 1800 < max(abs(code - MID) for code in steady) <= 2047
        assert steady[:period] == steady[period : 2 * period], "it repeats"
        assert is_silent(codes[-MILLISECOND:])


# A block is rendered while the one before it plays; the time to handle the stop's packet comes on top.
IN_SILENCE_BLOCKS = 2.25


def test_a_stop_is_taken_while_a_chord_is_proven(rig):
    """R-69: within the time of any stop, and nothing sounds afterwards."""
    host, seen = rig.host, []
    host.connect()
    host.upload()
    for phase in range(PHASES):
        host.arm()
        wait_phase(rig, phase)
        before = rig.played()
        sequence, _ = send(rig, "Chord", chord(14, sixteen(14, 0.22), GLIDE))
        # The proof of 128 blocks is under way: it takes 6.7 ms on the F407 and a third of that on the H743.
        rig.board.run(0.0002 + 0.0002 * phase)
        host.sequence = STOPS_SEQUENCE
        stop, played = send(rig, "EmergencyStop")
        answers = {}
        for _ in range(100):
            rig.board.run(0.0005)
            answers |= {reply.sequence: reply for reply in host.replies()}
        assert answers[sequence].value == Choice("Busy", value=Choice("DriveActive"))
        seen.append((answers[stop].value.at - played) / BLOCK)
        assert set(rig.codes(before, rig.played())) == {MID}
        host.hello()
        host.accept("ClearFaults")
    print(f"emergency stop while a chord is proven: {min(seen):.2f} to {max(seen):.2f} blocks from the last byte")
    # Where nothing sounds no ramp begins in the block that waits: the answer names the next one.
    assert max(seen) <= IN_SILENCE_BLOCKS
