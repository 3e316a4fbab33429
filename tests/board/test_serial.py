"""A serial line at its worst: what comes at the wrong rate, and noise, changes no sample and gets no answer."""
import random

import pytest

from boards import on_serial
from copies import on_copy
from core import dma_channels
from core.uart import FRAMING, NOISE, OVERRUN, READINGS, TAKEN, SerialHost, levels, sampled
from host import BLOCK, RATE_HZ, framed
from rig import MILLISECOND, is_silent, start

# The link's two channels of DMA1, counted from 0: USART2's receiver and transmitter.
RECEIVES, SENDS = 2, 3
# A byte's time on the line.
BYTE = 10 / SerialHost.BAUD
BLOCK_SECONDS = BLOCK / RATE_HZ

# The rates that the gate tries, of those that a host's program may use.
SOME, OTHERS = [115_200, 1_000_000], [9_600, 57_600, 230_400, 460_800, 1_500_000, 1_843_200, 2_000_000, 3_000_000]
RATES = [pytest.param(rate, marks=pytest.mark.every_image) for rate in SOME] + OTHERS
TRIES = 0.012


def commands(host):
    """What would end the drive, or be answered, if it were understood."""
    return b"".join(
        framed(host.session, sequence, message)
        for sequence, message in ((host.sequence + 1, "Disarm"), (9, "Stop"), (9, "EmergencyStop"), (9, "Status"))
    )


def is_undisturbed(rig):
    """It has answered nothing, played what the mirror plays, and goes on doing so in the same session."""
    assert rig.cable.receive() == b""
    # Ends whatever has been begun on the link.
    rig.cable.send(b"\0")
    status = rig.host.status()
    assert rig.leaves_the_mirror() == rig.played()
    assert (status["state"], status["faults"], rig.board.resets) == ("driving", set(), [])
    return status


def test_a_receiver_at_the_senders_rate_receives_its_bytes():
    data = bytes(range(256))
    for rate in (0.98, 1.0, 1.02):
        heard = sampled(levels(data), 921_600, 921_600 * rate)
        assert bytes(byte for _, byte, _ in heard) == data
        assert not any(errors & FRAMING for *_, errors in heard)
    assert not any(errors for *_, errors in sampled(levels(data), 921_600, 921_600))


def test_a_receiver_at_another_rate_sees_errors_and_a_low_line_is_one_frame():
    # At twice the rate each bit counts twice: after the start bit 0, 1 1, 0 0, 1 1, 0, and the stop bit is low.
    (_, byte, errors), *_ = sampled(levels(b"\x55"), 921_600, 1_843_200)
    assert (byte, errors) == (0b0110_0110, FRAMING)
    # At half the rate the edges lie in the bits' middles.
    ((_, _, errors),) = sampled(levels(b"\xaa"), 921_600, 460_800)
    assert errors == NOISE
    ((seconds, byte, errors),) = sampled([0] * 500, 921_600, 921_600)
    assert (byte, errors) == (0, FRAMING) and seconds == pytest.approx(10 / 921_600), "a break"
    assert sampled([0], 921_600 * 4, 921_600) == [], "a spike is no start bit"


@pytest.mark.parametrize("spikes, byte", [((7,), 0), ((8,), 0), ((9,), 0), ((7, 9), 1 << 2), ((7, 8, 9), 1 << 2)])
def test_two_of_a_bits_three_samples_decide(spikes, byte):
    """Sixteen levels a bit, of which a receiver takes the three in the middle: here of bit 2, behind the start bit."""
    line = [level for level in levels(b"\0") for _ in range(16)]
    for place in spikes:
        line[3 * 16 + place] = 1
    ((_, heard, errors),) = sampled(line, 16 * 921_600, 921_600)
    assert (heard, errors) == (byte, NOISE if len(spikes) < 3 else 0)


@on_serial
@pytest.mark.parametrize("rate", RATES)
def test_a_host_at_the_wrong_rate_is_not_answered_and_does_not_touch_the_samples(sounding, rate):
    data = commands(sounding.host)
    repeated = data * (1 + int(TRIES * rate / 10 / len(data)))
    sounding.cable.move_line(levels(repeated)[: int(TRIES * rate)], rate)
    sounding.board.run(TRIES + 1e-3)
    is_undisturbed(sounding)


@on_serial
@pytest.mark.every_image
@pytest.mark.parametrize("kind", ["a break", "breaks", "spikes", "noise"])
def test_noise_on_the_line_is_not_answered_and_does_not_touch_the_samples(sounding, kind):
    chance, rate = random.Random(kind), 3_000_000
    count = int(TRIES * rate)
    line = {
        "a break": [0] * count,
        "breaks": ([0] * 100 + [1] * 20) * (count // 120),
        "spikes": [int(chance.random() > 0.02) for _ in range(count)],
        "noise": [chance.getrandbits(1) for _ in range(count)],
    }[kind]
    sounding.cable.move_line(line, rate)
    sounding.board.run(TRIES + 1e-3)
    is_undisturbed(sounding)


@on_serial
@pytest.mark.every_image
def test_a_byte_with_a_noisy_bit_counts_as_it_was_voted(sounding):
    """The frame's own CRC decides, not the flag."""
    uart, host = sounding.board.uart, sounding.host
    for i, byte in enumerate(framed(host.session, 9, "Status")):
        sounding.board.at(sounding.board.now + (i + 1) * 11e-6 * sounding.board.CORE_HZ, uart.take, byte, NOISE)
    sounding.board.run(5e-3)
    assert len(list(host.replies())) == 1
    is_undisturbed(sounding)


@on_serial
@pytest.mark.every_image
@pytest.mark.parametrize("place", ["at its begin", "within it", "at its end", "alone"])
@pytest.mark.parametrize("reading", READINGS)
def test_a_byte_without_its_stop_bit_costs_its_frame_and_is_counted(sounding, place, reading):
    """By the manual the DMA does not take it, and its frame is lost. If it does take it the frame's own CRC decides. Either way something is
    counted as damaged, and the next frame is answered."""
    uart, host = sounding.board.uart, sounding.host
    uart.reading = reading
    before = host.status()["crc_errors"]
    data = framed(host.session, 9, "Status")
    bad = {"at its begin": 0, "within it": 5, "at its end": len(data) - 1, "alone": len(data)}[place]
    for i, byte in enumerate(data + b"\x7f"):
        sounding.board.at(sounding.board.now + (i + 1) * BYTE * sounding.board.CORE_HZ, uart.take, byte, FRAMING if i == bad else 0)
    sounding.board.run(5e-3)
    answers = len(list(host.replies()))
    # The last byte belongs to what follows.
    assert answers <= (place == "alone" or reading == TAKEN)
    assert is_undisturbed(sounding)["crc_errors"] > before


@on_serial
@pytest.mark.every_image
@pytest.mark.parametrize("reading", READINGS)
def test_a_stop_right_behind_a_bad_byte_is_obeyed(sounding, reading):
    """The bad byte was the end of a frame, and nobody has looked since: what came before it must not spoil the stop. At any time of a
    block, so in the renderer's turn, too."""
    data = framed(sounding.host.session, 9, "Status") + framed(sounding.host.session, 9, "Stop")
    bad = data.index(0)

    def case(rig, late):
        board, uart = rig.board, rig.board.uart
        uart.reading = reading
        board.run(late * BLOCK_SECONDS / 8)
        for i, byte in enumerate(data):
            board.at(board.now + (i + 1) * BYTE * board.CORE_HZ, uart.take, byte, FRAMING if i == bad else 0)
        board.run(5e-3)
        rig.cable.receive()
        assert not uart.flags & FRAMING
        assert rig.host.status()["state"] in ("stopping", "armed"), f"late by {late}/8 of a block"

    for late in range(8):
        on_copy(sounding, lambda copy: case(copy, late))


@on_serial
@pytest.mark.every_image
@pytest.mark.parametrize("reading", READINGS)
def test_a_host_that_begins_at_another_rate_is_answered_once_it_has_the_right_one(armed, reading):
    """A program that opens the port at 115200 baud first, as many do."""
    armed.board.uart.reading = reading
    armed.cable.move_line(levels(b"AT\r"), 115_200)
    armed.board.run(2e-3)
    armed.cable.receive()
    assert armed.host.status()["state"] == "armed"


@on_serial
@pytest.mark.every_image
@pytest.mark.parametrize("reading", READINGS)
def test_an_overrun_is_counted_and_the_link_goes_on(sounding, reading):
    """The DMA is kept from the bus for longer than the receiver has room: it receives nothing while the flag stands."""
    board, host = sounding.board, sounding.host
    board.uart.reading = reading
    before = host.status()["crc_errors"]
    board.dma[1].blocked.add(RECEIVES)
    sounding.cable.send(framed(host.session, 9, "Status") * 3)
    # The error's interrupt clears the flag at once.
    board.run(12 * BYTE)
    board.dma[1].blocked.clear()
    board.run(0.01)
    assert not board.uart.flags & OVERRUN
    sounding.cable.receive()
    assert is_undisturbed(sounding)["crc_errors"] > before


@on_serial
@pytest.mark.every_image
@pytest.mark.parametrize("milliseconds", [2, 4, 6, 15])
def test_a_thread_that_is_late_loses_no_byte_in_silence_and_has_those_that_came_last(sounding, milliseconds):
    """While nobody reads the ring takes half of it, 2.8 ms of the line's time."""
    board, host, cable = sounding.board, sounding.host, sounding.cable
    before = host.status()["crc_errors"]
    request = framed(host.session, 9, "Status")
    board.is_thread_frozen = True
    cable.send(request * int(milliseconds * 1e-3 / BYTE / len(request)))
    board.run_until(lambda: not cable.to_device, 0.1, step=1e-4)
    board.run(1e-4)
    board.is_thread_frozen = False
    board.run(0.012)
    answers = len(list(host.replies()))
    status = is_undisturbed(sounding)
    # What waits for its turn is bounded, too; what is dropped there is counted there.
    assert answers > 0
    assert (status["crc_errors"] > before) == (milliseconds > 2.8)


@on_serial
@pytest.mark.every_image
def test_a_sending_dma_that_fails_ends_its_reply_and_the_next_one_is_sent(sounding):
    board, host, cable = sounding.board, sounding.host, sounding.cable
    cable.send(framed(host.session, 9, "Status"))
    channel = board.dma[1].streams[SENDS]
    board.run_until(lambda: channel.control & 1 and channel.left, 0.005, step=1e-5)
    fail(board, SENDS)
    board.run(0.005)
    cable.receive()
    is_undisturbed(sounding)


@on_serial
@pytest.mark.every_image
def test_a_receiving_dma_that_fails_costs_what_it_had_and_the_link_goes_on(sounding):
    host = sounding.host
    before = host.status()["crc_errors"]
    fail(sounding.board, RECEIVES)
    # Until the link's next tick.
    sounding.cable.send(framed(host.session, 9, "Status"))
    sounding.board.run(0.005)
    sounding.cable.receive()
    assert is_undisturbed(sounding)["crc_errors"] > before


def fail(board, channel):
    """A bus error: the channel switches itself off (RM0440 chapter 12, DMA error management)."""
    board.dma[1].streams[channel].control &= ~1
    board.dma[1].set_flag(channel, dma_channels.ERROR)


@on_serial
@pytest.mark.nightly
@pytest.mark.parametrize("rate", [115_200, 1_000_000, 3_000_000])
def test_noise_without_end_is_a_silent_host(armed, rate):
    """R-20: the dead-man holds, and the link recovers."""
    start(armed)
    last = armed.played()
    chance, seconds = random.Random(rate), 1.3
    armed.cable.move_line([chance.getrandbits(1) for _ in range(int(seconds * rate))], rate)
    armed.board.is_hasty = True
    armed.board.run(0.95)
    assert not is_silent(armed.codes(armed.played() - MILLISECOND, armed.played())), "not before its time"
    armed.board.run(seconds - 0.95)
    assert is_silent(armed.codes(last + 1060 * MILLISECOND, armed.played()))
    assert armed.board.pin(armed.facts.unmute) == 0 and armed.board.resets == []
    assert armed.cable.receive() == b""
    armed.cable.send(b"\0")
    armed.host.hello()
    assert armed.host.status()["first_fault"] == "host lost"
