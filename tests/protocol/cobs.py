"""COBS, which removes all zero bytes so that a zero can end a frame."""
from __future__ import annotations

from errors import DecodeError

# Bytes of a piece, at most: its length plus 1 fits into one byte.
LONGEST_PIECE = 254


def encode(data: bytes) -> bytes:
    """Returns `data` without zero bytes; the delimiter is not part of it."""
    encoded = bytearray()
    pieces = data.split(b"\0")
    for index, piece in enumerate(pieces):
        while len(piece) >= LONGEST_PIECE:
            encoded.append(LONGEST_PIECE + 1)
            encoded += piece[:LONGEST_PIECE]
            piece = piece[LONGEST_PIECE:]
            if not piece and index == len(pieces) - 1:
                # The data ends with a full piece; an empty one after it would say nothing.
                return bytes(encoded)
        encoded.append(len(piece) + 1)
        encoded += piece
    return bytes(encoded)


def decode(encoded: bytes) -> bytes:
    """Returns what was encoded. Raises `DecodeError` if these bytes cannot be COBS."""
    data = bytearray()
    place = 0
    while place < len(encoded):
        length = encoded[place]
        piece = encoded[place + 1 : place + length]
        if length == 0 or 0 in piece:
            raise DecodeError(f"COBS: a zero byte within the {len(encoded)} bytes of a frame")
        if len(piece) != length - 1:
            raise DecodeError(f"COBS: a piece of {length - 1} bytes at {place} in a frame of {len(encoded)} bytes")
        data += piece
        place += length
        if length != LONGEST_PIECE + 1 and place < len(encoded):
            data.append(0)
    return bytes(data)
