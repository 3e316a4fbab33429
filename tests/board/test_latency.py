"""How soon a command sounds at the pin: counted in blocks of 128 codes from its last byte on the cable.

A block is rendered while the one before it plays, so one to two blocks pass in any case, but for a stop, which may begin in
the block that waits. What comes on top is the thread's time: frames, planning, and the renderer's interrupt between. The
host's bytes are sent at eight phases of a block, a stop's at forty while the device measures, which is the worst, and else at
ten; what is sent between two of them is later than both by their distance at most.
"""
import pytest

from boards import on_serial
from copies import on_copy
from host import BLOCK, RATE_HZ, drive, framed, table
from measuring import listen, listened
from messages import COMMANDS, SetTravelLimit, TravelLimit

MOST_KNOTS, PHASES, TONES = 1025, 8, 16
STOP_PHASES, STOP_PHASES_LISTENING = 10, 40
# The USB host asks every 50 us: after five blocks a block's begin has the same phase of that again.
STOP_BLOCKS_APART = 5
MILLISECOND = RATE_HZ // 1000
DRIVE_BLOCKS, STOP_BLOCKS = 4, 2
# While sixteen lock-ins measure, which leaves the thread less than half of its time. A stop comes as soon as otherwise.
DRIVE_BLOCKS_LISTENING = 8
LONGEST_WINDOW = 65_535
# The limit of a stiff actuator, far from what any drive here needs: a resonance of 10 kHz (in uHz), a quality of 2.5
# (per mille), and the smallest share at rest (ppm).
TRAVEL_LIMIT = SetTravelLimit(TravelLimit(10_000_000_000, 2500, 1))
# Unlike every numbered command's.
STOPS_SEQUENCE = 0xFFFF


def sweep(number, milliseconds=5):
    """All tones, each from its place to one far off: a way over hundreds of knots."""
    places = [slot / 15 * 0.5 for slot in range(TONES)]
    return drive([(slot, 1 - u if number % 2 else u, 0.06) for slot, u in enumerate(places)], milliseconds * MILLISECOND)


def send(rig, message, body=None):
    """Sends a command; returns its sequence number and what has been played when its last byte is on the device."""
    host = rig.host
    if COMMANDS[message].numbered:
        host.sequence = host.sequence + 1 & 0xFFFF
    rig.cable.send(framed(host.session, host.sequence, message, body))
    rig.board.run_until(lambda: not rig.cable.to_device, 0.05, step=2e-6)
    return host.sequence, rig.played()


def accepted(rig, wanted):
    """The index that the command was accepted for."""
    for _ in range(100):
        rig.board.run(0.0005)
        for reply in rig.host.replies():
            if reply.sequence == wanted and reply.is_accepted:
                return reply.value.at
    raise AssertionError("no answer")


def wait_phase(rig, phase):
    """Lets time pass to a phase, in blocks from the beginning of one."""
    while rig.played() % BLOCK:
        rig.board.run(1e-6)
    rig.board.run(phase * BLOCK / RATE_HZ)


def measure(rig):
    """Measures all slots from now on, for longer than any test lasts."""
    rig.board.adc.at_pins = lambda: (rig.board.dac.output, 4095 - rig.board.dac.output)
    listen(rig.host, LONGEST_WINDOW, hann=True)
    rig.host.live(0.005)
    assert listened(rig.host, 0).blocks > 0


def check_blocks(host):
    """No block of the inputs was lost, and none came too late to the DAC."""
    assert (host.inputs()[2], host.status()["underruns"]) == (0, 0)


WHILE_MEASURING = pytest.mark.parametrize("measures", [False, True], ids=["", "while it measures"])


@WHILE_MEASURING
def test_sixteen_tones_on_the_largest_table_begin_soon(rig, measures):
    """R-69: planning looks at the knots on each tone's way."""
    seen, limit = [], DRIVE_BLOCKS_LISTENING if measures else DRIVE_BLOCKS
    rig.host.connect()
    rig.host.upload(MOST_KNOTS)
    rig.host.arm()
    rig.host.accept("Drive", sweep(0))
    rig.host.live(0.02)
    if measures:
        measure(rig)
    for phase in range(PHASES):
        rig.host.live(0.02)
        wait_phase(rig, phase / PHASES)
        # The second drive comes while the first one's tones move, so it is planned from where they are.
        send(rig, "Drive", sweep(phase + 1, 20))
        rig.host.live(0.005)
        sequence, played = send(rig, "Drive", sweep(phase, 20))
        seen.append((accepted(rig, sequence) - played) / BLOCK)
    print(f"drive{', measured' * measures}: {min(seen):.2f} to {max(seen):.2f} blocks from the last byte to the pin")
    check_blocks(rig.host)
    assert listened(rig.host, 0).progress == ("running" if measures else "idle")
    assert max(seen) + 1 / PHASES <= limit


# What comes before the stop, and whether the device measures, which leaves the thread least; the others are for the night.
STOPS_OF_THE_GATE = [("nothing", False), ("nothing", True), ("a chunk whose travel is judged", True)]


@pytest.mark.parametrize(
    "ahead, measures",
    [
        pytest.param(
            ahead,
            measures,
            id=f"{ahead}-{'while it measures' * measures}",
            marks=[] if (ahead, measures) in STOPS_OF_THE_GATE else [pytest.mark.nightly],
        )
        for measures in (False, True)
        for ahead in ("nothing", "a drive", "a chunk", "a chunk whose travel is judged", "a commit", "a digest")
    ],
)
def test_an_emergency_stop_is_at_the_pin_soon_whatever_comes_before_it(rig, ahead, measures):
    """R-69: it is found while bytes come in, and while a command is done that takes long; and as soon while the device measures."""
    host = rig.host
    host.connect()
    host.upload(MOST_KNOTS)
    if ahead == "a chunk whose travel is judged":
        host.ask("SetTravelLimit", TRAVEL_LIMIT, "TravelLimit")
    host.arm()
    host.accept("Drive", sweep(0))
    host.live(0.02)
    host.accept("Drive", sweep(1, 200))
    message, body = prepare(host, ahead)
    if measures:
        measure(rig)
    host.live(0.02)

    def stop(copy, phase):
        wait_phase(copy, phase)
        if message:
            send(copy, message, body)
        copy.host.sequence = STOPS_SEQUENCE
        sequence, played = send(copy, "EmergencyStop")
        blocks = (accepted(copy, sequence) - played) / BLOCK
        # Whether the command before it was still done does not matter: a new session counts from the start.
        copy.host.forget()
        copy.host.hello()
        check_blocks(copy.host)
        return blocks

    count = STOP_PHASES_LISTENING if measures else STOP_PHASES
    phases = [number % STOP_BLOCKS_APART + number / count for number in range(count)]
    seen = [on_copy(rig, lambda copy: stop(copy, phase)) for phase in phases]
    print(f"emergency stop behind {ahead}{', measured' * measures}: {min(seen):.2f} to {max(seen):.2f} blocks from the last byte to the pin")
    assert max(seen) + 1 / count <= STOP_BLOCKS


@on_serial
@pytest.mark.every_image
@pytest.mark.parametrize(
    "flood, measures",
    [
        pytest.param("requests", True, id="requests-while it measures"),
        pytest.param("no frame's end", False, id="no frame's end-", marks=pytest.mark.nightly),
        pytest.param("requests", False, id="requests-", marks=pytest.mark.nightly),
        pytest.param("no frame's end", True, id="no frame's end-while it measures", marks=pytest.mark.nightly),
    ],
)
def test_an_emergency_stop_on_a_busy_line_is_at_the_pin_equally_soon(rig, flood, measures):
    """R-69: no byte takes an interrupt, and the line is full before the stop and after it."""
    host, cable = rig.host, rig.cable
    host.connect()
    host.upload(MOST_KNOTS)
    host.arm()
    host.accept("Drive", sweep(0))
    if measures:
        measure(rig)
    # Bytes without a frame's end are looked at with each tick of the link only.
    ahead = full_line(rig) * 12 if flood == "requests" else b"\x55" * 600 + b"\0"
    after = full_line(rig) * 20

    def stop(copy, phase):
        wait_phase(copy, phase)
        cable.send(ahead + framed(host.session, STOPS_SEQUENCE, "EmergencyStop") + after)
        copy.board.run_until(lambda: len(cable.to_device) <= len(after), 0.05, step=2e-6)
        played = copy.played()
        blocks = (accepted(copy, STOPS_SEQUENCE) - played) / BLOCK
        copy.board.run_until(lambda: not cable.to_device, 0.05)
        copy.board.run(0.003)
        host.forget()
        cable.receive()
        check_blocks(host)
        assert host.status()["first_fault"] == "emergency stop"
        return blocks

    seen = [on_copy(rig, lambda copy: stop(copy, phase / STOP_PHASES)) for phase in range(STOP_PHASES)]
    print(f"emergency stop in a line full of {flood}{', measured' * measures}: {min(seen):.2f} to {max(seen):.2f} blocks from the last byte to the pin")
    assert max(seen) + 1 / STOP_PHASES <= STOP_BLOCKS


def full_line(rig):
    """Bytes whose repetition leaves neither direction of a serial line a pause: a request that is as long as its answer."""
    request = framed(rig.host.session, 9, "Status")
    rig.cable.receive()
    rig.cable.send(request)
    rig.board.run(0.005)
    answer = rig.cable.receive()
    assert len(answer) > len(request)
    return request + b"\0" * (len(answer) - len(request))


def prepare(host, ahead):
    """Brings about what the command needs that is to come before the stop; returns the command, if there is one."""
    if ahead == "a drive":
        return "Drive", sweep(0, 20)
    if ahead.startswith("a chunk"):
        return "TableChunk", begin_upload(host)
    if ahead == "a commit":
        host.stage(MOST_KNOTS)
        return "TableCommit", None
    return ("TableDigest" if ahead == "a digest" else None), None


def begin_upload(host):
    """Begins the upload of a table and returns its first chunk."""
    uploaded = table(MOST_KNOTS)
    host.accept("TableBegin", uploaded.header)
    return next(uploaded.chunks())
