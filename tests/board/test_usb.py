"""A USB host at its worst: what it does on the bus changes no sample, and the link comes back."""
import random
import struct

import pytest

from boards import on_usb
from core.usb_core import OUT_DATA, OUT_DONE
from frame import TO_HOST
from host import RATE_HZ, drive, framed, hello
from rig import MILLISECOND, is_silent, start

DESCRIPTOR, LINE_CODING, TO_INTERFACE, FROM_DEVICE = 6, 0x20, 0x21, 0x80
CONFIGURATION, DEVICE = 0x200, 0x100
# A host that gives a transfer up waits at least so long.
PATIENCE = 1e-3


def comes_back(rig):
    """After a bus reset the host finds the device as it was after the first."""
    rig.board.run_until(lambda: rig.cable.is_configured, 0.02)
    assert rig.cable.takes_data and len(rig.cable.strings) == 3


def is_undisturbed(rig):
    """It has played what the mirror plays, and goes on doing so in the same session."""
    rig.host.forget()
    # Ends whatever has been begun on the link.
    rig.cable.send(b"\0")
    status = rig.host.status()
    assert rig.leaves_the_mirror() == rig.played()
    assert (status["state"], status["faults"], rig.board.resets) == ("driving", set(), [])
    return status


# --- sleep


@on_usb
@pytest.mark.every_image
def test_a_bus_that_sleeps_for_a_moment_does_not_touch_the_samples(sounding):
    board, cable = sounding.board, sounding.cable
    cable.fall_asleep()
    board.run(8e-3)
    cable.wake_up()
    board.run(2e-3)
    assert cable.flags() == 0, "the driver has seen both"
    is_undisturbed(sounding)


@on_usb
@pytest.mark.nightly
def test_a_bus_that_stays_asleep_ends_the_drive_as_any_silent_host(armed):
    """R-20: and in the same session it goes on afterwards."""
    start(armed)
    last = armed.played()
    armed.cable.fall_asleep()
    armed.board.is_hasty = True
    armed.board.run(1.3)
    assert is_silent(armed.codes(last + 1060 * MILLISECOND, armed.played()))
    armed.cable.wake_up()
    status = armed.host.status()
    assert (status["state"], status["first_fault"]) == ("fault", "host lost")


# --- babble


def garbage(host, chance):
    """What no host of ours sends, some kilobytes of each kind."""
    commands = [framed(host.session, sequence, message) for sequence, message in ((1, "Disarm"), (9, "Stop"), (9, "EmergencyStop"))]

    def flipped(data):
        at = chance.randrange(len(data) - 1)
        # Not the delimiter, and not by a bit that makes another one.
        bit = next(bit for bit in (1, 2, 4, 8) if data[at] ^ bit)
        return data[:at] + bytes([data[at] ^ bit]) + data[at + 1 :]

    return {
        "noise": chance.randbytes(2000),
        "only delimiters": bytes(2000),
        "no delimiter": b"\xff" * 3000 + b"\0",
        "wrong bits": b"".join(flipped(chance.choice(commands)) for _ in range(80)),
        "cut frames": b"".join(command[: chance.randrange(len(command) - 1)] + b"\0" for command in commands * 20),
        "echoes": b"".join(framed(host.session, 9, message, direction=TO_HOST) for message in ("Stop", "EmergencyStop") * 20),
        "frames in frames": b"".join(command[:-3] + command[:-3] + b"\0" for command in commands * 20),
    }


@on_usb
@pytest.mark.every_image
def test_a_host_that_babbles_does_not_touch_the_samples(sounding):
    board, cable = sounding.board, sounding.cable
    for data in garbage(sounding.host, random.Random(1)).values():
        cable.send(data)
        board.run(2e-3)
    status = is_undisturbed(sounding)
    assert not cable.to_device, "the device has taken all"
    assert status["crc_errors"] > 50 and status["overlong"] >= 1


@on_usb
@pytest.mark.every_image
def test_packets_of_one_byte_and_of_none_are_the_same_bytes(sounding):
    """A command comes byte by byte, with a packet of no bytes after each."""
    board, cable, host = sounding.board, sounding.cable, sounding.host
    host.forget()
    for byte in framed(host.session, 9, "Status"):
        cable.send(bytes([byte]))
        board.run_until(lambda: not cable.to_device and not cable.out_refuses[cable.bulk_out], 1e-3, step=2e-5)
        cable.out_refuses[cable.bulk_out] = True
        cable.push(OUT_DATA, cable.bulk_out)
        cable.push(OUT_DONE, cable.bulk_out)
        board.run_until(lambda: not cable.out_refuses[cable.bulk_out], 1e-3, step=2e-5)
    board.run(5e-3)
    assert len(list(host.replies())) == 1
    is_undisturbed(sounding)


# --- control transfers that their host does not end


def descriptor_not_fetched(cable):
    cable.setup(FROM_DEVICE, DESCRIPTOR, CONFIGURATION, 0, 255)
    yield


def descriptor_cut_short(cable):
    """Its first packet of two is fetched."""
    cable.setup(FROM_DEVICE, DESCRIPTOR, CONFIGURATION, 0, 255)
    yield
    while cable.take(0) is None:
        yield


def descriptor_without_its_status(cable):
    cable.setup(FROM_DEVICE, DESCRIPTOR, DEVICE, 0, 18)
    yield
    while cable.take(0) is None:
        yield


def data_not_sent(cable):
    cable.setup(TO_INTERFACE, LINE_CODING, 0, 0, 7)
    yield


def data_without_its_status(cable):
    cable.setup(TO_INTERFACE, LINE_CODING, 0, 0, 7)
    yield
    yield from cable.give(bytes(7))


def more_data_than_announced(cable):
    cable.setup(TO_INTERFACE, LINE_CODING, 0, 0, 7)
    yield
    yield from cable.give(bytes(64))


def more_data_than_fits(cable):
    yield from cable.control(TO_INTERFACE, LINE_CODING, 0, 0, 0xFFFF)


def three_setups_at_once(cable):
    for _ in range(3):
        cable.setup(FROM_DEVICE, DESCRIPTOR, CONFIGURATION, 0, 255)
    yield


def unknown_requests(cable):
    for kind, request, value in ((0xC0, 0x51, 0), (0x40, 0x51, 7), (FROM_DEVICE, DESCRIPTOR, 0x7F00), (0xA1, 0xFF, 0)):
        assert (yield from cable.control(kind, request, value, 0, 64 if kind & 0x80 else 0)) is None, "stalled"


ABANDONED = [
    descriptor_not_fetched, descriptor_cut_short, descriptor_without_its_status, data_not_sent, data_without_its_status,
    more_data_than_announced, more_data_than_fits, three_setups_at_once, unknown_requests,
]  # fmt: skip


def abandon(cable, transfer):
    """Begins a control transfer and lets it lie."""
    cable.transfer = transfer(cable)
    cable.board.run(PATIENCE)
    cable.transfer = None


def device_descriptor(cable):
    """Asks for it, and returns it when the transfer is over."""
    answer = []

    def transfer():
        answer.append((yield from cable.control(FROM_DEVICE, DESCRIPTOR, DEVICE, 0, 18)))

    cable.transfer = transfer()
    cable.board.run_until(lambda: answer, 5e-3, step=1e-4)
    return answer[0]


@on_usb
@pytest.mark.every_image
@pytest.mark.parametrize("transfer", ABANDONED)
def test_a_new_setup_ends_a_control_transfer_that_lies(sounding, transfer):
    """USB 2.0, 8.5.3: a device takes a SETUP at any time, and the transfer before it is over."""
    abandon(sounding.cable, transfer)
    descriptor = device_descriptor(sounding.cable)
    assert descriptor and struct.unpack_from("<HH", descriptor, 8) == (0x1209, 0x0001)
    is_undisturbed(sounding)


@on_usb
@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(20))
def test_no_order_of_abandoned_transfers_resets_and_sleep_ends_the_control_pipe(sounding, seed):
    chance, cable = random.Random(seed), sounding.cable
    for _ in range(8):
        abandon(cable, chance.choice(ABANDONED))
        if chance.random() < 0.3:
            cable.fall_asleep()
            cable.board.run(chance.uniform(0, 4e-3))
            cable.wake_up()
    if chance.random() < 0.5:
        cable.bus_reset()
        comes_back(sounding)
    assert device_descriptor(cable)
    is_undisturbed(sounding)


# --- resets of the bus


@on_usb
def test_a_bus_reset_while_a_reply_is_cut_does_not_stop_the_program(rig):
    """R-22. The host takes no packet, so the rest of the reply is dropped after its time: only a delimiter is owed. The
    bus reset disables the endpoint, and every write fails at once. Afterwards the first packet, which was never
    fetched, must not block the endpoint."""
    rig.host.connect()
    rig.cable.reads = False
    rig.cable.send(framed(0, 0, "Hello", hello(99)))
    rig.board.run(0.1)
    rig.cable.unplug()
    rig.board.run(0.01)
    rig.cable.plug()
    # The host does not configure the device, as a computer that boots: nobody enables the endpoint.
    rig.cable.enumerates = False
    rig.board.is_hasty = True
    # The watchdog takes 0.3 s, and 0.57 s with the slowest oscillator.
    rig.board.run(0.9)
    assert rig.board.resets == [], "the supervisor has fed the watchdog"
    rig.cable.enumerates = rig.cable.reads = True
    rig.cable.unplug()
    rig.cable.plug()
    rig.board.is_hasty = False
    rig.host.forget()
    rig.host.connect()
    assert rig.host.status()["state"] == "idle"


@on_usb
@pytest.mark.every_image
@pytest.mark.parametrize("transfer", [descriptor_not_fetched, descriptor_without_its_status, data_not_sent])
def test_a_bus_reset_in_a_control_transfer_ends_it(sounding, transfer):
    abandon(sounding.cable, transfer)
    sounding.cable.bus_reset()
    comes_back(sounding)
    is_undisturbed(sounding)


@on_usb
@pytest.mark.every_image
def test_a_hundred_bus_resets_do_not_touch_the_samples_and_the_link_comes_back(sounding):
    """Most come before the core has reported the speed, some while the host enumerates."""
    chance, board, cable = random.Random(100), sounding.board, sounding.cable
    for number in range(100):
        cable.bus_reset()
        board.run(chance.uniform(5e-4, 2e-3) if number % 12 == 7 else chance.uniform(5e-6, 1e-4))
    comes_back(sounding)
    is_undisturbed(sounding)


@on_usb
@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(2))
def test_bus_resets_without_end_are_a_silent_host(cool, mirror, seed):
    """R-20: what sounds is the mirror's up to the dead-man's time, and nothing sounds after it."""
    chance, board, cable = random.Random(seed), cool.board, cool.cable
    at = cool.host.accept("Drive", drive([(0, 0.3, 0.3), (1, 0.9, 0.2)], 5 * MILLISECOND))
    accepted, last = list(cool.host.accepted), cool.played()
    end, resets = board.seconds + 1.3, 0
    while board.seconds < end:
        cable.bus_reset()
        resets += 1
        board.run(chance.choice([1e-5, 3e-4, 2e-3, 6e-3, 0.02]) * chance.random())
    assert resets > 100
    codes, expected = cool.codes(at, cool.played()), mirror(accepted, at, cool.played())
    left = at + next(i for i, (a, b) in enumerate(zip(codes, expected)) if a != b)
    assert 0.99 < (left - last) / RATE_HZ < 1.01, "the host's last sign of life was about then"
    assert is_silent(cool.codes(last + 1060 * MILLISECOND, cool.played()))
    assert board.pin(cool.facts.unmute) == 0 and board.resets == []
    comes_back(cool)
    cool.host.forget()
    cool.host.hello()
    assert cool.host.status()["first_fault"] == "host lost"
