"""Reads PROTOCOL.md and the frozen frames, so that the tests compare with the page itself."""
from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator, Optional

SHARED = Path(__file__).resolve().parents[2] / "shared"
PAGE = (SHARED / "PROTOCOL.md").read_text(encoding="utf-8")


@dataclass(frozen=True)
class Section:
    """A third-level section: its heading without the id, the id if it is a message, and its text."""

    chapter: str
    name: str
    id: Optional[int]
    text: str

    def table(self, first_column: str) -> list[list[str]]:
        """The rows of the table whose first column has this heading; a cell of code is without its marks."""
        rows = []
        within = False
        for line in self.text.splitlines():
            cells = [re.sub(r"^`([^`]*)`$", r"\1", cell.strip()) for cell in line.strip().strip("|").split("|")]
            if not line.startswith("|"):
                within = False
            elif cells[0] == first_column:
                within = True
            elif within and not cells[0].startswith("---"):
                rows.append(cells)
        return rows


@dataclass(frozen=True)
class Example:
    """An example frame of a message: the bytes on the wire, and the body with its values if there is one."""

    section: Section
    wire: bytes
    body: bytes
    values: str


def sections(chapter: str) -> list[Section]:
    """The sections of a chapter, in order."""
    found = []
    text = re.search(rf"^## {chapter}\n(.*?)(?=^## |\Z)", PAGE, re.M | re.S).group(1)
    for part in re.split(r"^### ", text, flags=re.M)[1:]:
        heading, _, body = part.partition("\n")
        message = re.fullmatch(r"`([0-9a-f]{2})` (\w+)", heading)
        number, name = (int(message[1], 16), message[2]) if message else (None, heading)
        found.append(Section(chapter, name, number, body))
    return found


def examples() -> Iterator[Example]:
    """The example of every command and every event."""
    for section in sections("Commands") + sections("Events"):
        wire = re.search(r"^Example: `([0-9a-f]+)`$", section.text, re.M)
        body = re.search(r"^Its body is `([0-9a-f]+)`: (.*)\.$", section.text, re.M)
        content = (bytes.fromhex(body[1]), body[2]) if body else (b"", "")
        yield Example(section, bytes.fromhex(wire[1]), *content)


def frozen_frames(minor: Optional[int] = None) -> Iterator[tuple[str, bytes]]:
    """The label and the bytes of every frame that a minor version has brought; without a minor, that any has."""
    for number, name in enumerate(("v1.snap", "v1_1.snap", "v1_2.snap", "v1_3.snap")):
        if minor not in (None, number):
            continue
        for line in (SHARED / "wire" / name).read_text(encoding="utf-8").splitlines():
            if not line.startswith("#"):
                label, encoded = line.split()
                yield label, bytes.fromhex(encoded)
