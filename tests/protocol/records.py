"""Types with fields, and enumerations: what the tables of PROTOCOL.md describe."""
from __future__ import annotations

import dataclasses
from typing import Any, Callable, Optional

from errors import DecodeError, FieldError
from postcard import Reader, check_instance, check_integer, join, write_varint


def field(kind: Any, low: Optional[int] = None, high: Optional[int] = None) -> Any:
    """A field of a `Record`: its type and, if it has one, its range."""
    return dataclasses.field(metadata={"kind": kind, "range": None if low is None else (low, high)})


class Record:
    """Base of the types with fields: frozen dataclasses whose fields are made by `field`."""

    @classmethod
    def layout(cls) -> list[tuple[str, Any, Optional[tuple[int, int]]]]:
        """Each field's name, type and range, in the order of the wire."""
        return [(part.name, part.metadata["kind"], part.metadata["range"]) for part in dataclasses.fields(cls)]


@dataclasses.dataclass(frozen=True)
class Fields:
    """A `Record` as a type: its fields in order."""

    record: type

    def __str__(self) -> str:
        return self.record.__name__

    def check(self, value: Record, field: str) -> None:
        check_instance(value, self.record, field)
        for name, kind, limits in self.record.layout():
            part = getattr(value, name)
            kind.check(part, join(field, name))
            if limits:
                check_integer(part, *limits, join(field, name))

    def encode(self, value: Record, out: bytearray, field: str) -> None:
        check_instance(value, self.record, field)
        for name, kind, _ in self.record.layout():
            kind.encode(getattr(value, name), out, join(field, name))

    def decode(self, reader: Reader, field: str) -> Any:
        return self.record(*(kind.decode(reader, join(field, name)) for name, kind, _ in self.record.layout()))


class Choice:
    """A value of an enumeration: the variant's `name`, and its fields as attributes."""

    def __init__(self, name: str, **values: Any) -> None:
        self.name = name
        self.values = values

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["values"][name]
        except KeyError:
            raise AttributeError(f"{self.__dict__.get('name')} carries no {name}") from None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Choice) and (self.name, self.values) == (other.name, other.values)

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value}" for name, value in self.values.items())
        return f"{self.name}({values})" if values else self.name


class Enumeration:
    """The number of the variant as a varint, then the variant's fields. Variants are numbered from 0, in order."""

    def __init__(self, name: str, *variants: Any) -> None:
        # A variant is its name, or its name and a dictionary of its fields' names and types.
        self._name = name
        self.variants = [(variant, {}) if isinstance(variant, str) else variant for variant in variants]

    def __str__(self) -> str:
        return self._name

    def __getitem__(self, number: int) -> str:
        return self.variants[number][0]

    def number(self, name: str, field: str = "variant") -> int:
        """The number of a variant."""
        for number, (candidate, _) in enumerate(self.variants):
            if candidate == name:
                return number
        raise FieldError(field, f"one of {', '.join(name for name, _ in self.variants)}", name)

    def check(self, value: Choice, field: str) -> None:
        self._each(value, field, lambda kind, part, name: kind.check(part, name))

    def encode(self, value: Choice, out: bytearray, field: str) -> None:
        check_instance(value, Choice, field)
        write_varint(self.number(value.name, field), out)
        self._each(value, field, lambda kind, part, name: kind.encode(part, out, name))

    def decode(self, reader: Reader, field: str) -> Choice:
        number = reader.varint(32, field)
        if number >= len(self.variants):
            raise DecodeError(f"{field}: {self._name} has no variant {number}")
        name, fields = self.variants[number]
        return Choice(name, **{part: kind.decode(reader, join(field, part)) for part, kind in fields.items()})

    def _each(self, value: Choice, field: str, act: Callable[[Any, Any, str], None]) -> None:
        check_instance(value, Choice, field)
        fields = self.variants[self.number(value.name, field)][1]
        if fields.keys() != value.values.keys():
            raise FieldError(field, f"{value.name} with the fields {list(fields)}", value)
        for name, kind in fields.items():
            act(kind, value.values[name], join(field, name))
