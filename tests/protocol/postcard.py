"""The types that bodies are made of, and their encoding (postcard).

Each type has `encode(value, out, field)`, `decode(reader, field)` and `check(value, field)`; `str(type)` is the name
that PROTOCOL.md gives it. `encode` demands only that a value fits its type, `check` the protocol's ranges, too.
"""
from __future__ import annotations

import dataclasses
from typing import Any, Optional

from errors import DecodeError, FieldError


class Reader:
    """Takes bytes from the front of a body."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._place = 0

    def take(self, count: int, field: str) -> bytes:
        """The next `count` bytes."""
        taken = self._data[self._place : self._place + count]
        if len(taken) != count:
            raise DecodeError(f"{field}: the body ends after {len(self._data)} bytes")
        self._place += count
        return taken

    def varint(self, bits: int, field: str) -> int:
        """The next varint, of at most `bits` bits."""
        value = 0
        for shift in range(0, bits, 7):
            byte = self.take(1, field)[0]
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                if value >> bits:
                    break
                return value
        raise DecodeError(f"{field}: a varint of more than {bits} bits")

    def end(self, field: str) -> None:
        """Demands that nothing is left."""
        left = len(self._data) - self._place
        if left:
            raise DecodeError(f"{field}: {left} bytes after the last field")


def write_varint(value: int, out: bytearray) -> None:
    """Appends an unsigned number, seven bits a byte, the lowest first."""
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)


@dataclasses.dataclass(frozen=True)
class Unsigned:
    """u8 as one byte; u16, u32 and u64 as a varint."""

    bits: int

    def __str__(self) -> str:
        return f"u{self.bits}"

    def check(self, value: int, field: str) -> None:
        check_integer(value, 0, (1 << self.bits) - 1, field)

    def encode(self, value: int, out: bytearray, field: str) -> None:
        self.check(value, field)
        if self.bits == 8:
            out.append(value)
        else:
            write_varint(value, out)

    def decode(self, reader: Reader, field: str) -> int:
        return reader.take(1, field)[0] if self.bits == 8 else reader.varint(self.bits, field)


@dataclasses.dataclass(frozen=True)
class Signed:
    """i16 and i64: zigzag, then varint."""

    bits: int

    def __str__(self) -> str:
        return f"i{self.bits}"

    def check(self, value: int, field: str) -> None:
        half = 1 << (self.bits - 1)
        check_integer(value, -half, half - 1, field)

    def encode(self, value: int, out: bytearray, field: str) -> None:
        self.check(value, field)
        write_varint(2 * value if value >= 0 else -2 * value - 1, out)

    def decode(self, reader: Reader, field: str) -> int:
        value = reader.varint(self.bits, field)
        return value // 2 if value % 2 == 0 else -(value + 1) // 2


class Bool:
    """One byte, 0 or 1."""

    def __str__(self) -> str:
        return "bool"

    def check(self, value: bool, field: str) -> None:
        if not isinstance(value, bool):
            raise FieldError(field, "True or False", value)

    def encode(self, value: bool, out: bytearray, field: str) -> None:
        self.check(value, field)
        out.append(int(value))

    def decode(self, reader: Reader, field: str) -> bool:
        byte = reader.take(1, field)[0]
        if byte > 1:
            raise DecodeError(f"{field}: {byte} is no bool")
        return byte == 1


@dataclasses.dataclass(frozen=True)
class Option:
    """One byte 0 for none, or 1 and then the item."""

    item: Any

    def __str__(self) -> str:
        return f"option of {self.item}"

    def check(self, value: Optional[Any], field: str) -> None:
        if value is not None:
            self.item.check(value, field)

    def encode(self, value: Optional[Any], out: bytearray, field: str) -> None:
        out.append(int(value is not None))
        if value is not None:
            self.item.encode(value, out, field)

    def decode(self, reader: Reader, field: str) -> Optional[Any]:
        return self.item.decode(reader, field) if BOOL.decode(reader, field) else None


@dataclasses.dataclass(frozen=True)
class Array:
    """`count` items, with no count on the wire. An array of u8 is a `bytes`, any other one a tuple."""

    count: int
    item: Any

    def __str__(self) -> str:
        return f"array of {self.count} {self.item}"

    def check(self, value: Any, field: str) -> None:
        check_items(value, self.item, self.count, self.count, field)

    def encode(self, value: Any, out: bytearray, field: str) -> None:
        check_length(value, self.count, self.count, field)
        for index, item in enumerate(value):
            self.item.encode(item, out, f"{field}[{index}]")

    def decode(self, reader: Reader, field: str) -> Any:
        items = [self.item.decode(reader, f"{field}[{index}]") for index in range(self.count)]
        return bytes(items) if self.item == U8 else tuple(items)


@dataclasses.dataclass(frozen=True)
class List:
    """The count as a varint, then that number of items: a tuple."""

    longest: int
    item: Any

    def __str__(self) -> str:
        return f"list of {self.item}, at most {self.longest}"

    def check(self, value: Any, field: str) -> None:
        check_items(value, self.item, 0, self.longest, field)

    def encode(self, value: Any, out: bytearray, field: str) -> None:
        check_length(value, 0, self.longest, field)
        write_varint(len(value), out)
        for index, item in enumerate(value):
            self.item.encode(item, out, f"{field}[{index}]")

    def decode(self, reader: Reader, field: str) -> Any:
        count = read_length(reader, self.longest, field)
        return tuple(self.item.decode(reader, f"{field}[{index}]") for index in range(count))


@dataclasses.dataclass(frozen=True)
class Text:
    """The length in bytes as a varint, then UTF-8."""

    longest: int

    def __str__(self) -> str:
        return f"text, at most {self.longest} bytes"

    def check(self, value: str, field: str) -> None:
        if not isinstance(value, str) or len(value.encode()) > self.longest:
            raise FieldError(field, f"a text of at most {self.longest} bytes", value)

    def encode(self, value: str, out: bytearray, field: str) -> None:
        self.check(value, field)
        data = value.encode()
        write_varint(len(data), out)
        out += data

    def decode(self, reader: Reader, field: str) -> str:
        try:
            return reader.take(read_length(reader, self.longest, field), field).decode()
        except UnicodeDecodeError as error:
            raise DecodeError(f"{field}: no UTF-8: {error}") from error


def check_integer(value: int, low: int, high: int, field: str) -> None:
    """Refuses what is no integer from `low` to `high`."""
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise FieldError(field, f"an integer from {low} to {high}", value)


def check_length(value: Any, shortest: int, longest: int, field: str) -> None:
    """Refuses what has fewer or more items."""
    if not isinstance(value, (bytes, tuple, list)) or not shortest <= len(value) <= longest:
        count = f"{longest}" if shortest == longest else f"{shortest} to {longest}"
        raise FieldError(field, f"{count} items", value)


def check_items(value: Any, item: Any, shortest: int, longest: int, field: str) -> None:
    """Refuses a wrong number of items, and an item out of range."""
    check_length(value, shortest, longest, field)
    for index, part in enumerate(value):
        item.check(part, f"{field}[{index}]")


def check_instance(value: Any, kind: type, field: str) -> None:
    """Refuses a value of another class."""
    if not isinstance(value, kind):
        raise FieldError(field, f"a {kind.__name__}", value)


def read_length(reader: Reader, longest: int, field: str) -> int:
    """Reads the length of a list or a text."""
    length = reader.varint(32, field)
    if length > longest:
        raise DecodeError(f"{field}: {length} items or bytes, at most {longest} are allowed")
    return length


def join(field: str, name: str) -> str:
    """The path of a field within another."""
    return f"{field}.{name}" if field else name


U8, U16, U32, U64 = Unsigned(8), Unsigned(16), Unsigned(32), Unsigned(64)
I16, I64 = Signed(16), Signed(64)
BOOL = Bool()
