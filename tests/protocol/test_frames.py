"""Frames and bodies: the examples of PROTOCOL.md and the frozen frames, decoded and encoded again."""
from __future__ import annotations

import random
import re
import unittest
import zlib
from typing import Any, Iterator

import cobs
import codes
import page
from errors import DecodeError, FieldError
from frame import TO_DEVICE, TO_HOST, Frame, FrameReader
from messages import COMMANDS, EVENTS, NEXT_BLOCK, VERSION_1_0, Drive, Tone, at, kind_of
from postcard import I16, I64, U8, U16, U32, U64, Array, List, Option, Reader
from records import Choice, Enumeration, Fields, Record


def words(value: Any, kind: Any, path: str = "") -> Iterator[str]:
    """The values of a body as the page writes them: `path = value`, a field each."""

    def sentence(text: str) -> str:
        return f"{path} = {text}" if path else text

    if isinstance(kind, Option):
        if value is None:
            yield sentence("none")
        else:
            yield from words(value, kind.item, path)
    elif isinstance(kind, Fields):
        for name, part, _ in kind.record.layout():
            shown = name.rstrip("_")
            yield from words(getattr(value, name), part, f"{path}.{shown}" if path else shown)
    elif isinstance(value, bytes):
        yield sentence(value.hex())
    elif isinstance(kind, (List, Array)):
        for index, item in enumerate(value):
            yield from words(item, kind.item, f"{path}[{index}]")
    elif isinstance(kind, Enumeration):
        yield sentence(f"{kind.number(value.name)} ({value.name})")
        for name, part in dict(kind.variants)[value.name].items():
            yield from words(value.values[name], part, f"{path}.{name}" if path else name)
    elif isinstance(value, bool):
        yield sentence(str(value).lower())
    else:
        yield sentence(f'"{value}"' if isinstance(value, str) else str(value))


def only_frame(wire: bytes) -> Frame:
    """The one frame that these bytes are."""
    (found,) = FrameReader().feed(wire)
    if isinstance(found, DecodeError):
        raise found
    return found


def encode_again(frame: Frame) -> bytes:
    """A frame as it is after its body was decoded and encoded."""
    kind = kind_of(frame.id)
    body = kind.encode(kind.decode(frame.body))
    return Frame(frame.direction, frame.session, frame.sequence, frame.id, body).encode()


class Examples(unittest.TestCase):
    """The frames that the page and the frozen file show."""

    def test_examples_of_the_page(self) -> None:
        for example in page.examples():
            with self.subTest(chapter=example.section.chapter, message=example.section.name):
                frame = only_frame(example.wire)
                self.assertEqual(frame.id, example.section.id)
                self.assertEqual((frame.session, frame.sequence), (0x04030201, 0x0605))
                expected = TO_DEVICE if example.section.chapter == "Commands" else TO_HOST
                self.assertEqual(frame.direction, expected)
                self.assertEqual(frame.body, example.body)
                self.assertEqual(encode_again(frame), example.wire)

    def test_values_of_the_examples(self) -> None:
        # Two fields of one type in the wrong order would still encode to the same bytes; their values show it.
        for example in page.examples():
            with self.subTest(chapter=example.section.chapter, message=example.section.name):
                kind = kind_of(example.section.id)
                value = kind.decode(example.body)
                self.assertEqual(", ".join(words(value, kind.body)) if kind.body else "", example.values)

    def test_frozen_frames(self) -> None:
        frames = list(page.frozen_frames())
        self.assertGreater(len(frames), 90)
        for label, wire in frames:
            with self.subTest(label=label):
                self.assertEqual(encode_again(only_frame(wire)), wire)

    def test_frozen_frames_hold_every_message(self) -> None:
        held = {only_frame(wire).id for _, wire in page.frozen_frames()}
        self.assertEqual(held, {kind.id for kind in (*COMMANDS.values(), *EVENTS.values())})

    def test_fingerprint_is_the_crc_of_the_frozen_frames(self) -> None:
        crc = zlib.crc32(b"".join(wire for _, wire in page.frozen_frames(minor=0)))
        self.assertEqual(VERSION_1_0.schema, crc.to_bytes(4, "little"))
        self.assertIn(f"`{VERSION_1_0.schema.hex()}`", page.PAGE)


    def test_a_message_stands_among_the_frames_of_its_minor(self) -> None:
        for kind in (*COMMANDS.values(), *EVENTS.values()):
            with self.subTest(message=kind.name):
                held = {only_frame(wire).id for _, wire in page.frozen_frames(kind.since)}
                self.assertIn(kind.id, held)


class Tables(unittest.TestCase):
    """The page's tables: names, order, types and ranges are those of this client."""

    def test_messages(self) -> None:
        for chapter, kinds in (("Commands", COMMANDS), ("Events", EVENTS)):
            found = page.sections(chapter)
            known = [(kind.id, kind.name) for kind in kinds.values()]
            self.assertEqual([(part.id, part.name) for part in found], known)
            for section in found:
                with self.subTest(message=f"{chapter}, {section.name}"):
                    kind = kinds[section.name]
                    self.assertIn(f"Since 1.{kind.since}.", section.text)
                    if isinstance(kind.body, Fields):
                        self.compare_fields(section, kind.body.record)
                    elif kind.body == U32:
                        self.assertIn("The body is one u32: ", section.text)
                    else:
                        sentence = f"The body is a {kind.body}." if kind.body else "No body."
                        self.assertIn(sentence, unlinked(section.text))

    def test_the_page_lists_the_commands_without_a_number(self) -> None:
        sentence = re.search(r"wrap from 65535 to 0\. (.*?) are not numbered", page.PAGE)[1]
        known = [kind.name for kind in COMMANDS.values() if not kind.numbered]
        self.assertEqual(re.findall(r"`(\w+)`", sentence), known)

    def test_types(self) -> None:
        compared = set()

        def compare(kind: Any) -> None:
            if isinstance(kind, Fields):
                compared.add(str(kind))
                if str(kind) in listed:
                    self.compare_fields(listed[str(kind)], kind.record)
                for _, part, _ in kind.record.layout():
                    compare(part)
            elif isinstance(kind, Enumeration):
                compared.add(str(kind))
                self.compare_variants(listed[str(kind)], kind)
                for _, fields in kind.variants:
                    for part in fields.values():
                        compare(part)
            elif isinstance(kind, (Option, List, Array)):
                compare(kind.item)

        listed = {section.name: section for section in page.sections("Types")}
        for kind in (*COMMANDS.values(), *EVENTS.values()):
            compare(kind.body)
        self.assertEqual(listed.keys() - compared, {"Faults"})

    def test_types_have_the_minor_they_came_with(self) -> None:
        since: dict[str, int] = {}

        def carry(kind: Any, minor: int) -> None:
            if isinstance(kind, (Fields, Enumeration)):
                since[str(kind)] = min(minor, since.get(str(kind), minor))
            if isinstance(kind, Fields):
                parts = [part for _, part, _ in kind.record.layout()]
            elif isinstance(kind, Enumeration):
                parts = [part for _, fields in kind.variants for part in fields.values()]
            else:
                parts = [kind.item] if isinstance(kind, (Option, List, Array)) else []
            for part in parts:
                carry(part, minor)

        for kind in (*COMMANDS.values(), *EVENTS.values()):
            carry(kind.body, kind.since)
        for section in page.sections("Types"):
            if section.name != "Faults":
                self.assertIn(f"\nSince 1.{since[section.name]}.\n", section.text, section.name)

    def test_constants_of_the_law_of_the_codes(self) -> None:
        constants = re.findall(r"hi\([yd], (\d{8,})\)", page.PAGE)
        self.assertEqual([int(constant) for constant in constants], [codes._RADIANS, codes._THETA])

    def test_the_session_in_bytes(self) -> None:
        rows = re.findall(r"^\| (host|device) \| `([0-9a-f]+)` \| `(\w+)`, session ([0-9a-f]{8}), sequence ([0-9a-f]{4})", page.PAGE, re.M)
        self.assertGreaterEqual(len(rows), 20)
        hosts = [row for row in rows if row[0] == "host"]
        self.assertEqual([row[2] for row in hosts[:2]], ["Hello", "TableBegin"])
        for (_, wire, command, _, sequence), (_, answer, event, session, answered) in zip(rows[::2], rows[1::2]):
            sent, got = only_frame(bytes.fromhex(wire)), only_frame(bytes.fromhex(answer))
            self.assertEqual((sent.direction, sent.id, sent.sequence), (TO_DEVICE, COMMANDS[command].id, int(sequence, 16)))
            self.assertEqual((got.id, got.session, got.sequence), (EVENTS[event].id, int(session, 16), int(answered, 16)))
            self.assertEqual(sequence, answered)
            for frame in (sent, got):
                kind = kind_of(frame.id)
                self.assertEqual(kind.encode(kind.decode(frame.body)), frame.body)

    def compare_fields(self, section: page.Section, record: type[Record]) -> None:
        known = [
            [name.rstrip("_"), str(kind), "any" if limits is None else f"{limits[0]} to {limits[1]}"]
            for name, kind, limits in record.layout()
        ]
        rows = [[name, unlinked(kind), limits] for name, kind, _, limits, _ in section.table("field")]
        self.assertEqual(known, rows, section.name)

    def compare_variants(self, section: page.Section, kind: Enumeration) -> None:
        for number, row in enumerate(section.table("number")):
            self.assertEqual(row[:2], [str(number), kind.variants[number][0]])
            carried = re.findall(r"`(\w+)`: (\w+)", unlinked(row[3]))
            self.assertEqual(carried, [(name, str(part)) for name, part in kind.variants[number][1].items()])
        self.assertEqual(len(section.table("number")), len(kind.variants))


def unlinked(cell: str) -> str:
    """A cell without its links."""
    return re.sub(r"\[(\w+)\]\(#\w+\)", r"\1", cell)


class Framing(unittest.TestCase):
    """The CRC, COBS, and the stream of frames."""

    def test_check_value_of_the_crc(self) -> None:
        self.assertIn("`cbf43926`", page.PAGE)
        self.assertEqual(zlib.crc32(b"123456789"), 0xCBF43926)

    def test_example_in_the_text(self) -> None:
        sentence = r"with sequence `0605` is `([0-9a-f ]+)` and its CRC, and on the wire `(\w+)`"
        content, wire = re.search(sentence, page.PAGE).groups()
        frame = Frame(TO_DEVICE, 0x04030201, 0x0605, COMMANDS["Status"].id, b"")
        self.assertEqual(frame.encode().hex(), wire)
        self.assertEqual(cobs.decode(frame.encode()[:-1])[:-4].hex(" "), content)

    def test_cobs(self) -> None:
        run = bytes(range(1, 255))
        for data, encoded in (
            (b"", b"\1"),
            (b"\0", b"\1\1"),
            (b"\0\0", b"\1\1\1"),
            (b"a\0", b"\2a\1"),
            (b"\0a", b"\1\2a"),
            (run[:253], b"\xfe" + run[:253]),
            (run, b"\xff" + run),
            (run + b"\0", b"\xff" + run + b"\1\1"),
            (run + b"\xff", b"\xff" + run + b"\2\xff"),
            (b"\0" + run, b"\1\xff" + run),
            (run + run, b"\xff" + run + b"\xff" + run),
        ):
            with self.subTest(length=len(data)):
                self.assertEqual(cobs.encode(data), encoded)
                self.assertEqual(cobs.decode(encoded), data)
        # An empty piece after a full one is right, too.
        self.assertEqual(cobs.decode(b"\xff" + run + b"\1"), run)

    def test_cobs_of_random_bytes(self) -> None:
        source = random.Random(1)
        for _ in range(500):
            length = source.randrange(800)
            data = bytes(source.choice((0, 1, 2, 255)) if source.random() < 0.02 else 7 for _ in range(length))
            encoded = cobs.encode(data)
            self.assertNotIn(0, encoded)
            self.assertEqual(cobs.decode(encoded), data)

    def test_impossible_cobs(self) -> None:
        for encoded in (b"\0", b"\3a", b"\2a\5bc", b"\3a\0"):
            with self.subTest(encoded=encoded.hex()), self.assertRaises(DecodeError):
                cobs.decode(encoded)

    def test_any_damaged_byte_is_noticed(self) -> None:
        wire = next(page.frozen_frames())[1]
        for place in range(len(wire) - 1):
            for bit in range(8):
                damaged = bytearray(wire)
                damaged[place] ^= 1 << bit
                found = list(FrameReader().feed(bytes(damaged)))
                self.assertTrue(found and all(isinstance(part, DecodeError) for part in found), damaged.hex())

    def test_frames_come_in_any_pieces(self) -> None:
        wires = [wire for _, wire in page.frozen_frames()]
        stream = b"\0" + b"".join(wires[:5]) + b"\x07damaged\0" + b"\1" * 5000 + b"\0" + b"".join(wires[5:])
        for size in (1, 7, 64, len(stream)):
            reader = FrameReader()
            pieces = [stream[place : place + size] for place in range(0, len(stream), size)]
            found = [part for piece in pieces for part in reader.feed(piece)]
            errors = [part for part in found if isinstance(part, DecodeError)]
            self.assertEqual(len(errors), 2)
            self.assertEqual([part.encode() for part in found if isinstance(part, Frame)], wires)

    def test_no_transfer_ends_with_a_full_packet(self) -> None:
        for length in range(239):
            wire = Frame(TO_DEVICE, 1, 2, 3, bytes(length)).encode()
            self.assertNotEqual(len(wire) % 64, 0)
            self.assertEqual(only_frame(wire).body, bytes(length))
        with self.assertRaises(FieldError):
            Frame(TO_DEVICE, 1, 2, 3, bytes(239)).encode()


class Bodies(unittest.TestCase):
    """Types at their limits, and what is refused before it is sent."""

    def test_integers(self) -> None:
        for kind, value, encoded in (
            (U8, 255, "ff"), (U16, 127, "7f"), (U16, 128, "8001"), (U16, 65535, "ffff03"),
            (U32, 2**32 - 1, "ffffffff0f"), (U64, 2**64 - 1, "ffffffffffffffffff01"),
            (I16, 0, "00"), (I16, -1, "01"), (I16, 1, "02"),
            (I16, 32767, "feff03"), (I16, -32768, "ffff03"), (I64, 2**63 - 1, "feffffffffffffffff01"),
            (I64, -(2**63), "ffffffffffffffffff01"),
        ):  # fmt: skip
            with self.subTest(kind=str(kind), value=value):
                out = bytearray()
                kind.encode(value, out, "x")
                self.assertEqual(out.hex(), encoded)
                self.assertEqual(kind.decode(Reader(bytes(out)), "x"), value)
        for kind, encoded in (
            (U16, "ffff04"), (U16, "80808000"), (U32, "ffffffff10"), (U64, "ffffffffffffffffff02"), (U16, "80"),
        ):  # fmt: skip
            with self.subTest(kind=str(kind), encoded=encoded), self.assertRaises(DecodeError):
                kind.decode(Reader(bytes.fromhex(encoded)), "x")

    def test_a_value_out_of_range_is_named(self) -> None:
        tone = Tone(0, 0, 0, 0)
        integer = "must be an integer from"
        for drive, message in (
            (Drive((Tone(16, 0, 0, 0),), 0, 2000, NEXT_BLOCK), f"Drive.tones[0].slot {integer} 0 to 15, not 16"),
            (Drive((Tone(0, 65536, 0, 0),), 0, 0, at(0)), f"Drive.tones[0].position {integer} 0 to 65535, not 65536"),
            (Drive((tone,), 1, 2000, NEXT_BLOCK), f"Drive.master {integer} -9600 to 0, not 1"),
            (Drive((tone,), 0, 1.5, NEXT_BLOCK), f"Drive.glide {integer} 0 to 4294967295, not 1.5"),
            (Drive((tone,), 0, 2000, at(-1)), f"Drive.apply.value {integer} 0 to 18446744073709551615, not -1"),
            (Drive((tone,), 0, 2000, Choice("Later")), "Drive.apply must be one of Next, At, AtTrigger, not 'Later'"),
        ):
            with self.subTest(message=message):
                with self.assertRaises(FieldError) as caught:
                    COMMANDS["Drive"].check(drive)
                self.assertEqual(str(caught.exception), message)
        with self.assertRaisesRegex(FieldError, "0 to 16 items"):
            COMMANDS["Drive"].check(Drive((tone,) * 17, 0, 2000, NEXT_BLOCK))

    def test_a_body_too_short_or_too_long(self) -> None:
        for example in page.examples():
            kind = kind_of(example.section.id)
            with self.subTest(message=kind.name):
                for length in range(len(example.body)):
                    with self.assertRaises(DecodeError):
                        kind.decode(example.body[:length])
                with self.assertRaisesRegex(DecodeError, "after the last field"):
                    kind.decode(example.body + b"\0")

    def test_any_body_decodes_or_is_refused(self) -> None:
        source = random.Random(2)
        for _ in range(3000):
            kind = source.choice((*COMMANDS.values(), *EVENTS.values()))
            try:
                kind.encode(kind.decode(source.randbytes(source.randrange(60))))
            except DecodeError:
                pass


if __name__ == "__main__":
    unittest.main()
