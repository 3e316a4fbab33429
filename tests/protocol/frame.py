"""Frames: what travels on the wire."""
from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import Iterator, Union

import cobs
from errors import DecodeError, FieldError

TO_DEVICE = 0xA5
TO_HOST = 0x5A
LONGEST_BODY = 238
_HEADER = 8
_CRC = 4
# The longest frame before encoding; COBS adds one byte to so few.
_LONGEST_ENCODED = _HEADER + LONGEST_BODY + _CRC + 1
_USB_PACKET = 64


@dataclass(frozen=True)
class Frame:
    """One message with its header. `session` has 32 bits, `sequence` 16, `id` 8."""

    direction: int
    session: int
    sequence: int
    id: int
    body: bytes

    def encode(self) -> bytes:
        """The bytes on the wire, with the delimiter."""
        if len(self.body) > LONGEST_BODY:
            raise FieldError("body", f"0 to {LONGEST_BODY} bytes", len(self.body))
        content = (
            bytes([self.direction])
            + self.session.to_bytes(4, "little")
            + self.sequence.to_bytes(2, "little")
            + bytes([self.id])
            + self.body
        )
        encoded = cobs.encode(content + zlib.crc32(content).to_bytes(4, "little")) + b"\0"
        # A USB transfer must not end with a full packet.
        return encoded + b"\0" if len(encoded) % _USB_PACKET == 0 else encoded

    @classmethod
    def decode(cls, encoded: bytes) -> Frame:
        """A frame from the bytes before its delimiter. Raises `DecodeError` if they are damaged."""
        data = cobs.decode(encoded)
        if not _HEADER + _CRC <= len(data) <= _HEADER + LONGEST_BODY + _CRC:
            raise DecodeError(f"a frame of {len(data)} bytes")
        content, crc = data[:-_CRC], int.from_bytes(data[-_CRC:], "little")
        if zlib.crc32(content) != crc:
            raise DecodeError(f"a frame with the CRC {crc:08x}, its bytes have {zlib.crc32(content):08x}")
        if content[0] not in (TO_DEVICE, TO_HOST):
            raise DecodeError(f"a frame with the direction {content[0]:#04x}")
        session, sequence = int.from_bytes(content[1:5], "little"), int.from_bytes(content[5:7], "little")
        return cls(content[0], session, sequence, content[7], content[8:])


class FrameReader:
    """Cuts a stream of bytes into frames."""

    def __init__(self) -> None:
        self._begun = bytearray()
        self._overlong = False

    def feed(self, data: bytes) -> Iterator[Union[Frame, DecodeError]]:
        """Yields the frames that `data` completes, and for a damaged one the error. Empty frames are skipped."""
        for byte in data:
            if byte == 0:
                encoded, overlong = bytes(self._begun), self._overlong
                self._begun.clear()
                self._overlong = False
                if overlong:
                    yield DecodeError(f"a frame of more than {_LONGEST_ENCODED} bytes")
                elif encoded:
                    try:
                        yield Frame.decode(encoded)
                    except DecodeError as error:
                        yield error
            elif len(self._begun) < _LONGEST_ENCODED:
                self._begun.append(byte)
            else:
                self._overlong = True
