"""Runs the blocks of a page in order, as one program, in the working folder: python page_blocks.py PAGE.md

A block ``python`` runs with the names of those before it. A block ``text`` right after it is the text that it prints; with
``SLIPLINE_BLESS=1`` the page gets the printed text.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

#: A block of Python, and the text below it, if one follows.
_BLOCK = re.compile(r"^```python\n(?P<code>.*?)^```\n(?:\n```text\n(?P<text>.*?)^```\n)?", re.M | re.S)


@dataclass
class Block:
    """A block of a page: its first line, from 1, its code, the text it must print, and where that stands in the page."""

    line: int
    code: str
    text: str | None
    span: tuple[int, int]


def blocks(page: str) -> Iterator[Block]:
    """The blocks of Python of a page."""
    for found in _BLOCK.finditer(page):
        yield Block(page.count("\n", 0, found.start("code")) + 1, found["code"], found["text"], found.span("text"))


def printed(block: Block, path: str, names: dict[str, object]) -> str:
    """Runs a block with these names; what it prints. A traceback has the lines of the page."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        exec(compile("\n" * (block.line - 1) + block.code, path, "exec"), names)
    return text.getvalue()


def run(path: Path, *, bless: bool) -> int:
    """Runs a page; the number of its blocks. Raises ``SystemExit`` where one prints another text than the page has."""
    page = path.read_text(encoding="utf-8")
    # Pickled functions and processes of its own find the page's names as those of a script.
    program = sys.modules["__main__"] = ModuleType("__main__")
    count, end, blessed = 0, 0, ""
    for block in blocks(page):
        count += 1
        text = printed(block, str(path), program.__dict__)
        if block.text is not None:
            if text != block.text and not bless:
                sys.exit(f"{path}, line {block.line}: the block prints\n{text}\nand the page has\n{block.text}")
            blessed += page[end : block.span[0]] + text
            end = block.span[1]
    if bless:
        path.write_text(blessed + page[end:], encoding="utf-8")
    return count


if __name__ == "__main__":
    print(f"{run(Path(sys.argv[1]).resolve(), bless=bool(os.environ.get('SLIPLINE_BLESS')))} blocks")
