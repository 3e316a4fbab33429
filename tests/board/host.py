"""A small host in the board's own time, on the host's end of a link of the model. Its wire is that of tests/protocol."""
import dataclasses
import re
from typing import Any, NamedTuple

import messages
from frame import TO_DEVICE, TO_HOST, Frame, FrameReader
from messages import COMMANDS, NEXT_BLOCK, VERSION_1_3, fault_names, kind_of
from records import Choice
from table import Table

RATE_HZ, BLOCK, KEEP_ALIVE_PERIOD = 400_000, 128, 0.2
# A hold's levels change by 6.02 dB at most from window to window.
SLEW = 602
# Accepted without a change of what sounds.
SILENT = ("KeepAlive", "Listen", "Capture", "Hold")


class Reply(NamedTuple):
    """An answer: `name` is that of its kind, `value` what its body says."""

    session: int
    sequence: int
    name: str
    value: Any

    @property
    def is_accepted(self):
        return self.name in ("Accepted", "AcceptedUntil")

    def refuses(self, reason):
        """Whether it is a refusal of this name."""
        return self.name == "Refused" and self.value.name == reason


def framed(session, sequence, command, value=None, direction=TO_DEVICE):
    """The bytes of a command on the wire."""
    kind = COMMANDS[command]
    return Frame(direction, session, sequence, kind.id, kind.encode(value)).encode()


def words(choice):
    """A variant's name as words: `FellBack` is "fell back"."""
    return choice and re.sub(r"(?<!^)(?=[A-Z])", " ", choice.name).lower()


def plain(record):
    """A record's fields by their names, variants as words."""
    fields = {part.name: getattr(record, part.name) for part in dataclasses.fields(record)}
    return {name: words(value) if isinstance(value, Choice) else value for name, value in fields.items()}


def hello(nonce):
    return messages.Hello(VERSION_1_3, nonce.to_bytes(4, "little"))


def table(count, first_hz=60_000, last_hz=20_000):
    """Knots on a line of frequencies with rising gain."""
    shares = [i / (count - 1) for i in range(count)]
    frequencies = [first_hz + share * (last_hz - first_hz) for share in shares]
    return Table.from_frequencies((80_000, 270_000), RATE_HZ, frequencies, [0.5 + 0.5 * share for share in shares])


def begin(at):
    """When a drive begins: at the next block, at an index, or `AT_TRIGGER`."""
    return NEXT_BLOCK if at is None else at if isinstance(at, Choice) else messages.at(at)


def drive(tones, glide, at=None):
    """A drive of tones (slot, position 0..=1, level 0..=1)."""
    tones = [messages.Tone(slot, round(position * 65535), round(level * 65535), 0) for slot, position, level in tones]
    return messages.Drive(tones, 0, glide, begin(at))


def chord(period_log2, tones, glide, at=None):
    """A chord of tones (multiple of the base frequency, level 0..=1, phase in turns)."""
    return messages.Chord(period_log2, multiples(messages.ChordTone, tones), 0, glide, begin(at))


def comb(period_blocks, tones, glide, at=None):
    """A comb of tones as a chord's."""
    return messages.Comb(period_blocks, multiples(messages.CombTone, tones), 0, glide, begin(at))


def multiples(kind, tones):
    return [kind(harmonic, round(level * 65535), round(turns % 1 * 65536) % 65536) for harmonic, level, turns in tones]


def profile(name, sum_per_mille=1000, stop_input=False, travel=None, drive_ms=600_000):
    """A profile to write: the constants of a device without one, but for what is given."""
    heat = messages.CoilHeat(8000, 120_000, 1300)
    return messages.WriteProfile(messages.ActuatorProfile(name, sum_per_mille, travel, heat, 2000, drive_ms, stop_input))


class Host:
    """`cable` is the host's end of the link: of USB or of a serial port."""

    def __init__(self, board, cable):
        self.board, self.cable = board, cable
        self.session = self.sequence = self.keep_alives = 0
        self.nonce = 0
        self.keep_alive_due = 0.0
        self.lives = True
        # Input of the mirror: (index, frame) of every accepted command that changes what sounds.
        self.accepted = []
        self.forget()

    def forget(self):
        """Drops what has been received and not read."""
        self.reader, self.received = FrameReader(), []

    def connect(self):
        """Waits for the port and begins a session."""
        self.board.run_until(lambda: self.cable.is_configured, 0.2)
        return self.hello()

    def hello(self):
        """Begins a session; returns who the device is."""
        self.nonce += 1
        self.session, self.sequence = 0, 0
        reply = self.exchange("Hello", hello(self.nonce))
        assert reply.name == "Hello", reply
        self.session, self.keep_alives = reply.session, 0
        self.keep_alive_due = self.board.seconds
        return plain(reply.value)

    def exchange(self, command, value=None, patience=0.6):
        """Sends a command and waits for its answer."""
        if COMMANDS[command].numbered:
            self.sequence = self.sequence + 1 & 0xFFFF
        sent = framed(self.session, self.sequence, command, value)
        self.cable.send(sent)
        end = self.board.seconds + patience
        while self.board.seconds < end:
            self.board.run(0.0005)
            for reply in self.replies():
                if reply.sequence == self.sequence:
                    if reply.is_accepted and command not in SILENT:
                        self.accepted.append((reply.value.at, sent))
                    return reply
        raise AssertionError(f"no answer to {command} within {patience} s")

    def replies(self):
        self.received += self.reader.feed(self.cable.receive())
        while self.received:
            frame = self.received.pop(0)
            assert isinstance(frame, Frame) and frame.direction == TO_HOST, f"the device sends whole frames, not {frame}"
            kind = kind_of(frame.id)
            yield Reply(frame.session, frame.sequence, kind.name, kind.decode(frame.body))

    def accept(self, command, value=None, patience=0.6):
        """Sends a command that must be accepted; returns the index."""
        reply = self.exchange(command, value, patience)
        assert reply.is_accepted, f"{command} is answered by {reply}"
        return reply.value.at

    def ask(self, command, value=None, answer=None):
        """Sends a command that must be answered by an event of its own name, or of this one; returns what that says."""
        reply = self.exchange(command, value)
        assert reply.name == (answer or command), f"{command} is answered by {reply}"
        return reply.value

    def status(self):
        status = plain(self.ask("Status"))
        status["faults"] = {words(Choice(name)) for name in fault_names(status["faults"])}
        return status | plain(status.pop("counters"))

    def maintenance(self):
        """Erasures, those that the data sheet promises, and whether the brown-out level is set."""
        return dataclasses.astuple(self.ask("Maintenance"))

    def wear(self):
        """Erasures of the profile's places, those that the data sheet promises, and the stores of tables that are left."""
        return dataclasses.astuple(self.ask("Wear"))

    def board_report(self):
        """The core's clock, and what is known of the mute resistor, the user button and the stop input."""
        return tuple(plain(self.ask("Board")).values())[:4]

    def profile(self):
        """The profile's name, or None, and how the flash was found."""
        event = self.ask("Profile")
        return event.profile and event.profile.name, words(event.stored)

    def trigger(self):
        """Whether a drive waits for the trigger input, and where the last one began that had waited."""
        return dataclasses.astuple(self.ask("Trigger"))

    def inputs(self):
        """How many there are, their delay in ns, and the blocks of theirs that were lost."""
        event = self.ask("Inputs")
        return event.inputs, event.delay_ns, event.lost_blocks

    def capture(self, input, values, at=None):
        """Begins to capture single codes of an input, at an index or with the next block; returns the first one's index."""
        return self.accept("Capture", messages.Capture(at, input, 0, values))

    def captured(self):
        """How far the capture has come, its first index, and its codes."""
        codes = []
        while True:
            part = self.ask("CaptureRead", messages.CaptureRead(len(codes)), "Captured")
            assert part.first == len(codes)
            codes += part.values
            if not part.values or len(codes) == part.captured:
                return words(part.progress), part.from_, codes

    def hold(self, tones, blocks, rise=1200):
        """Holds tones (slot, codes of amplitude) at the sensor, with windows of `blocks` blocks and a rise of at most 12 dB, or of
        another one in 1/100 dB."""
        tones = [messages.HoldTone(slot, round(256 * codes)) for slot, codes in tones]
        return self.accept("Hold", messages.Hold(0, 0, blocks, rise, SLEW, tones))

    def held(self):
        """How far the hold has come, how many windows it has taken, and each tone's slot, state and correction in dB."""
        event = self.ask("HoldRead", answer="Held")
        return words(event.progress), event.windows, [(tone.slot, tone.state, tone.correction / 100) for tone in event.tones]

    def upload(self, count=33):
        """Uploads a table and makes it the one in force; returns its CRC."""
        crc = self.stage(count)
        self.accept("TableCommit")
        return crc

    def stage(self, count):
        """Uploads a table, which waits to be committed; returns its CRC."""
        uploaded = table(count)
        self.accept("TableBegin", uploaded.header)
        for chunk in uploaded.chunks():
            self.accept("TableChunk", chunk)
        return uploaded.crc

    def arm(self):
        at = self.accept("Arm")
        self.live(0.005)
        return at

    def live(self, seconds):
        """Lets time pass while the host shows that it lives."""
        end = self.board.seconds + seconds
        while self.board.seconds < end:
            if self.lives and self.board.seconds >= self.keep_alive_due:
                self.keep_alive_due = self.board.seconds + KEEP_ALIVE_PERIOD
                self.keep_alives += 1
                self.exchange("KeepAlive", messages.KeepAlive(self.keep_alives))
            self.board.run(min(0.002, max(end - self.board.seconds, 1e-5)))
