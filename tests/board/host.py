"""A small host: the protocol of shared/PROTOCOL.md over the model's USB cable, in the board's own time."""
import struct
import zlib
from pathlib import Path

GOLDEN = (Path(__file__).parents[2] / "shared/wire/v1.snap").read_text().splitlines()
SCHEMA = zlib.crc32(b"".join(bytes.fromhex(line.split()[1]) for line in GOLDEN if not line.startswith("#")))
TO_DEVICE, TO_HOST = 0xA5, 0x5A
HELLO, KEEP_ALIVE, STATUS, MAINTENANCE, ARM, DISARM, DRIVE, STOP, EMERGENCY_STOP, CLEAR_FAULTS = (
    0x01, 0x02, 0x03, 0x04, 0x10, 0x11, 0x12, 0x13, 0x14, 0x15,
)  # fmt: skip
TABLE_BEGIN, TABLE_CHUNK, TABLE_COMMIT, TABLE_DIGEST, DIGEST_START, STORE, BOOTLOADER_TOKEN, BOOTLOADER_ENTER = (
    0x20, 0x21, 0x22, 0x24, 0x30, 0x40, 0x50, 0x51,
)  # fmt: skip
UNSEQUENCED = (HELLO, KEEP_ALIVE, STATUS, STOP, EMERGENCY_STOP)
HELLO_REPLY, STATUS_REPLY, MAINTENANCE_REPLY, ACCEPTED, REFUSED, UNCHANGED, TABLE_REPLY, TOKEN_REPLY = (
    0x81, 0x83, 0x84, 0x90, 0x91, 0x92, 0xA4, 0xD0,
)  # fmt: skip
TRIGGER, TRIGGER_REPLY = 0x18, 0x98
# As ACCEPTED, of a drive whose glide takes longer than asked: the index of its end follows.
ACCEPTED_UNTIL = 0x93
SET_TRAVEL_LIMIT, TRAVEL_LIMIT_REPLY = 0x16, 0x97
CHORD = 0x19
COMB = 0x1A
BOARD, PROFILE, BOARD_REPLY, PROFILE_REPLY = 0x05, 0x06, 0x85, 0x86
WEAR, WEAR_REPLY = 0x07, 0x87
FORGET, WRITE_PROFILE = 0x41, 0x42
HOLD_BUTTON = b"\x1b"
# Then the seconds until the next store.
STORES_SPENT = 0x1C
ARM_FOR = 0x1B
DIGEST_READ, DIGEST_REPLY = 0x31, 0xB1
INPUTS, LISTEN, CAPTURE, CAPTURE_READ, INPUTS_REPLY, CAPTURED_REPLY = 0x60, 0x61, 0x64, 0x65, 0xE0, 0xE5
HOLD, HOLD_READ, HELD_REPLY = 0x67, 0x68, 0xE8
# Refusals without a field are their number.
DISARM_FIRST = b"\x17"
BUSY_DRIVE_ACTIVE = b"\x07\x01"
# Then the peak.
PEAK = 0x19
STATES = ("idle", "armed", "driving", "stopping", "fault", "safe mode", "waiting")
RESETS = ("power-on", "pin", "software", "watchdog", "brown-out", "panic", "hard fault")
STORED = ("empty", "loaded", "wrong version", "damaged", "fell back")
FAULTS = (
    "host lost", "emergency stop", "underrun", "overheat", "drive time", "watchdog", "crash", "brown-out",
    "store damaged", "store fell back", "desk stop", "profile fell back",
)  # fmt: skip
PROGRESS = ("idle", "running", "finished", "broken")
# In the place of an index: a drive waits for the trigger input.
AT_TRIGGER = "trigger"
RATE_HZ, BLOCK, KEEP_ALIVE_PERIOD, CHUNK_KNOTS = 400_000, 128, 0.2, 22


def varint(value):
    """An unsigned number as postcard writes it: seven bits a byte, the lowest first."""
    data = bytearray()
    while value >= 0x80:
        data.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes(data) + bytes([value])


def zigzag(value):
    return varint(value << 1 if value >= 0 else (-value << 1) - 1)


def frame(session, sequence, message, body, direction=TO_DEVICE):
    raw = struct.pack("<BIHB", direction, session, sequence, message) + body
    raw += struct.pack("<I", zlib.crc32(raw))
    coded, block = bytearray(), bytearray()
    for byte in raw:
        if byte:
            block.append(byte)
        if not byte or len(block) == 254:
            coded += bytes([len(block) + 1]) + block
            block.clear()
    coded += bytes([len(block) + 1]) + block + b"\0"
    return bytes(coded) + (b"\0" if len(coded) % 64 == 0 else b"")


def unframe(coded):
    """Session, sequence, message and body of a frame without its delimiter, or None."""
    raw, i = bytearray(), 0
    while i < len(coded):
        code = coded[i]
        raw += coded[i + 1 : i + code]
        i += code
        if code < 255 and i < len(coded):
            raw.append(0)
    if len(raw) < 12 or zlib.crc32(raw[:-4]) != struct.unpack("<I", raw[-4:])[0] or raw[0] != TO_HOST:
        return None
    session, sequence, message = struct.unpack_from("<IHB", raw, 1)
    return session, sequence, message, bytes(raw[8:-4])


def hello_body(nonce):
    return bytes([1, 3]) + struct.pack("<I", SCHEMA) + struct.pack("<I", nonce)


class Reader:
    """Takes a postcard body apart."""

    def __init__(self, body):
        self.body, self.at = body, 0

    def raw(self, count):
        self.at += count
        return self.body[self.at - count : self.at]

    def byte(self):
        return self.raw(1)[0]

    def number(self):
        value = shift = 0
        while True:
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return value

    def signed(self):
        value = self.number()
        return value >> 1 ^ -(value & 1)

    def text(self):
        return self.raw(self.number()).decode()

    def option(self, read):
        return read() if self.byte() else None


def identity(body):
    r = Reader(body)
    r.raw(6)
    return dict(
        firmware=tuple(r.raw(3)), board=r.text(), build=r.text(), unit=r.raw(12), simulated=bool(r.byte()),
        rate=r.number(), block=r.number(), bits=r.byte(), tones=r.byte(), knots=r.number(), min_glide=r.number(),
        max_glide=r.number(), dead_man_ms=r.number(), reset=RESETS[r.number()], stored=STORED[r.number()],
        crash=r.text(),
    )  # fmt: skip


def status(body):
    r = Reader(body)
    result = dict(state=STATES[r.number()])
    bits = r.number()
    result["faults"] = {name for bit, name in enumerate(FAULTS) if bits >> bit & 1}
    result["first_fault"] = r.option(lambda: FAULTS[r.number()])
    for name in ("first_fault_at", "now", "sum", "heat", "foldback"):
        result[name] = r.number()
    result["foldback_before"] = [r.number() for _ in range(3)]
    for name in ("foldback_changes", "table_crc"):
        result[name] = r.number()
    for name in ("frames", "crc_errors", "overlong", "duplicates", "dropped", "underruns", "clips", "max_cycles"):
        result[name] = r.number()
    return result


def table(count, first_hz=60_000, last_hz=20_000):
    """Knots on a line of frequencies with rising gain: (header without CRC..., knots)."""
    knots = []
    for i in range(count):
        u = i / (count - 1)
        knots.append((round((first_hz + u * (last_hz - first_hz)) / RATE_HZ * 2**32), round((0.5 + 0.5 * u) * 2**31)))
    header = (80_000, 270_000, RATE_HZ, count)
    crc = zlib.crc32(struct.pack("<IIIH", *header) + b"".join(struct.pack("<II", *knot) for knot in knots))
    return header, crc, knots


def drive(tones, glide, at=None):
    """A drive of tones (slot, position 0..=1, level 0..=1), at the next block, at an index, or `AT_TRIGGER`."""
    body = varint(len(tones))
    for slot, position, level in tones:
        body += bytes([slot]) + varint(round(position * 65535)) + varint(round(level * 65535)) + varint(0)
    return body + zigzag(0) + varint(glide) + _apply(at)


def _apply(at):
    return b"\0" if at is None else b"\2" if at == AT_TRIGGER else b"\1" + varint(at)


def chord(period_log2, tones, glide, at=None):
    """A chord, begun as a drive is, of tones (multiple of the base frequency, level 0..=1, phase in turns)."""
    return bytes([period_log2]) + _multiples(tones, glide, at)


def comb(period_blocks, tones, glide, at=None):
    """A comb, begun as a drive is, of tones as a chord's."""
    return varint(period_blocks) + _multiples(tones, glide, at)


def _multiples(tones, glide, at):
    body = varint(len(tones))
    for harmonic, level, turns in tones:
        body += varint(harmonic) + varint(round(level * 65535)) + varint(round(turns % 1 * 65536) % 65536)
    return body + zigzag(0) + varint(glide) + _apply(at)


def profile(name, sum_per_mille=1000, stop_input=False, travel=None, drive_ms=600_000):
    """A profile: the constants of a device without one, but for what is given. `travel`: uHz, 1/1000, ppm."""
    body = b"\1" + bytes([len(name)]) + name.encode() + varint(sum_per_mille)
    body += b"\0" if travel is None else b"\1" + b"".join(map(varint, travel))
    return body + varint(8000) + varint(120_000) + varint(1300) + zigzag(2000) + varint(drive_ms) + bytes([stop_input])


class Host:
    """`cable` is the host's end of the link: of USB or of a serial port."""

    def __init__(self, board, cable):
        self.board, self.cable = board, cable
        self.inbox = bytearray()
        self.session = self.sequence = self.keep_alives = 0
        self.nonce = 0
        self.keep_alive_due = 0.0
        self.lives = True
        # Input of the mirror: (index, frame) of every accepted command that changes what sounds.
        self.accepted = []

    def connect(self):
        """Waits for the port and begins a session."""
        self.board.run_until(lambda: self.cable.is_configured, 0.2)
        return self.hello()

    def hello(self):
        self.nonce += 1
        self.session, self.sequence = 0, 0
        session, message, body = self.exchange(HELLO, hello_body(self.nonce))
        assert message == HELLO_REPLY, f"{message:#x}"
        self.session, self.keep_alives = session, 0
        self.keep_alive_due = self.board.seconds
        return identity(body)

    def exchange(self, message, body=b"", patience=0.6):
        """Sends a command and waits for its answer: session, message and body."""
        if message not in UNSEQUENCED:
            self.sequence = self.sequence + 1 & 0xFFFF
        sent = frame(self.session, self.sequence, message, body)
        self.cable.send(sent)
        end = self.board.seconds + patience
        while self.board.seconds < end:
            self.board.run(0.0005)
            for session, sequence, reply, reply_body in self.replies():
                if sequence == self.sequence:
                    if reply in (ACCEPTED, ACCEPTED_UNTIL) and message not in (KEEP_ALIVE, LISTEN, CAPTURE, HOLD):
                        self.accepted.append((Reader(reply_body).number(), sent))
                    return session, reply, reply_body
        raise AssertionError(f"no answer to {message:#x} within {patience} s")

    def replies(self):
        self.inbox += self.cable.receive()
        while b"\0" in self.inbox:
            coded, _, rest = self.inbox.partition(b"\0")
            self.inbox = rest
            if coded:
                reply = unframe(coded)
                assert reply, "the device sends whole frames"
                yield reply

    def accept(self, message, body=b"", patience=0.6):
        """Sends a command that must be accepted; returns the index."""
        _, reply, reply_body = self.exchange(message, body, patience)
        assert reply in (ACCEPTED, ACCEPTED_UNTIL), f"{message:#x} is answered by {reply:#x} {reply_body.hex()}"
        return Reader(reply_body).number()

    def status(self):
        _, reply, body = self.exchange(STATUS)
        assert reply == STATUS_REPLY, f"{reply:#x} {body.hex()}"
        return status(body)

    def maintenance(self):
        """Erasures, those that the data sheet promises, and whether the brown-out level is set."""
        _, reply, body = self.exchange(MAINTENANCE)
        assert reply == MAINTENANCE_REPLY, f"{reply:#x} {body.hex()}"
        r = Reader(body)
        return r.number(), r.number(), bool(r.byte())

    def wear(self):
        """Erasures of the profile's places, those that the data sheet promises, and the stores of tables that are left."""
        _, reply, body = self.exchange(WEAR)
        assert reply == WEAR_REPLY, f"{reply:#x} {body.hex()}"
        r = Reader(body)
        return r.number(), r.number(), r.byte()

    def board_report(self):
        """The core's clock, and what is known of the mute resistor, the user button and the stop input."""
        _, reply, body = self.exchange(BOARD)
        assert reply == BOARD_REPLY, f"{reply:#x} {body.hex()}"
        r = Reader(body)
        return (
            r.number(), ("not looked", "present", "missing")[r.number()], ("none", "released", "pressed")[r.number()],
            ("unused", "closed", "open", "not in profile")[r.number()],
        )  # fmt: skip

    def profile(self):
        """The profile's name, or None, and how the flash was found."""
        _, reply, body = self.exchange(PROFILE)
        assert reply == PROFILE_REPLY, f"{reply:#x} {body.hex()}"
        r = Reader(body)
        if not r.byte():
            return None, STORED[r.number()]
        name = r.text()
        r.number()
        if r.byte():
            r.number(), r.number(), r.number()
        for _ in range(5):
            r.number()
        r.byte()
        return name, STORED[r.number()]

    def trigger(self):
        """Whether a drive waits for the trigger input, and where the last one began that had waited."""
        _, reply, body = self.exchange(TRIGGER)
        assert reply == TRIGGER_REPLY, f"{reply:#x} {body.hex()}"
        r = Reader(body)
        return bool(r.byte()), r.option(r.number)

    def inputs(self):
        """How many there are, their delay in ns, and the blocks of theirs that were lost."""
        _, reply, body = self.exchange(INPUTS)
        assert reply == INPUTS_REPLY, f"{reply:#x} {body.hex()}"
        r = Reader(body)
        count, _, delay, lost = r.byte(), r.byte(), r.signed(), r.number()
        return count, delay, lost

    def capture(self, input, values, at=None):
        """Begins to capture single codes of an input, at an index or with the next block; returns the first one's index."""
        from_ = b"\0" if at is None else b"\1" + varint(at)
        return self.accept(CAPTURE, from_ + bytes([input, 0]) + varint(values))

    def captured(self):
        """How far the capture has come, its first index, and its codes."""
        codes = []
        while True:
            _, reply, body = self.exchange(CAPTURE_READ, varint(len(codes)))
            assert reply == CAPTURED_REPLY, f"{reply:#x} {body.hex()}"
            r = Reader(body)
            progress = PROGRESS[r.number()]
            if progress == "broken":
                r.number()
            at, count, first, sent = r.number(), r.number(), r.number(), r.number()
            assert first == len(codes)
            codes += [r.number() for _ in range(sent)]
            if not sent or len(codes) == count:
                return progress, at, codes

    def hold(self, tones, blocks, rise=1200):
        """Holds tones (slot, codes of amplitude) at the sensor, with windows of `blocks` blocks and a rise of at most 12 dB, or of
        another one in 1/100 dB."""
        listed = b"".join(bytes([slot]) + varint(round(256 * codes)) for slot, codes in tones)
        body = b"\0\0" + varint(blocks) + zigzag(rise) + zigzag(602) + bytes([len(tones)]) + listed
        return self.accept(HOLD, body)

    def held(self):
        """How far the hold has come, how many windows it has taken, and each tone's slot, state and correction in dB."""
        _, reply, body = self.exchange(HOLD_READ, b"")
        assert reply == HELD_REPLY, f"{reply:#x} {body.hex()}"
        r = Reader(body)
        progress, _, _, windows = ("off", "on", "ended", "lost")[r.number()], r.byte(), r.number(), r.number()
        tones = []
        for _ in range(r.number()):
            slot, state = r.byte(), r.number()
            cause = r.number() if state >= 2 else None
            correction = r.number()
            tones.append((slot, (state, cause), (correction >> 1 ^ -(correction & 1)) / 100))
            r.number()
        return progress, windows, tones

    def upload(self, count=33):
        """Uploads a table and makes it the one in force; returns its CRC."""
        crc = self.stage(count)
        self.accept(TABLE_COMMIT)
        return crc

    def stage(self, count):
        """Uploads a table, which waits to be committed; returns its CRC."""
        header, crc, knots = table(count)
        body = varint(header[3]) + varint(header[0]) + varint(header[1]) + varint(header[2]) + varint(crc)
        self.accept(TABLE_BEGIN, body)
        for first in range(0, count, CHUNK_KNOTS):
            chunk = knots[first : first + CHUNK_KNOTS]
            body = varint(first) + varint(len(chunk))
            self.accept(TABLE_CHUNK, body + b"".join(varint(step) + varint(gain) for step, gain in chunk))
        return crc

    def arm(self):
        at = self.accept(ARM)
        self.live(0.005)
        return at

    def live(self, seconds):
        """Lets time pass while the host shows that it lives."""
        end = self.board.seconds + seconds
        while self.board.seconds < end:
            if self.lives and self.board.seconds >= self.keep_alive_due:
                self.keep_alive_due = self.board.seconds + KEEP_ALIVE_PERIOD
                self.keep_alives += 1
                self.exchange(KEEP_ALIVE, varint(self.keep_alives))
            self.board.run(min(0.002, max(end - self.board.seconds, 1e-5)))
