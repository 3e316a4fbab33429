"""For the site's reference: the marks of docstrings, which are those of reStructuredText, as Markdown."""

from __future__ import annotations

import re
from typing import Any

import griffe


def markdown(text: str) -> str:
    """The text of a docstring as Markdown: roles are code, and a literal block is one of Python."""
    text = re.sub(r":(?:class|attr|func):`~?([^`]*)`", r"`\1`", text)
    text = re.sub(r":meth:`~?([^`]*)`", r"`\1()`", text)
    lines: list[str] = []
    is_literal = False
    for line in text.splitlines():
        if is_literal and line.strip() and not line.startswith("    "):
            lines.append("```\n")
            is_literal = False
        if not is_literal and line.endswith("::"):
            lines.extend([line.removesuffix("::").rstrip() + ":" if line != "::" else "", "", "```python"])
            is_literal = True
        else:
            lines.append(line.removeprefix("    ") if is_literal else line)
    return "\n".join([*lines, "```"] if is_literal else lines)


class DocstringRoles(griffe.Extension):
    """Rewrites each docstring that is read."""

    def on_instance(self, *, obj: griffe.Object, **_: Any) -> None:
        """Called for each module, class, function and attribute."""
        if obj.docstring:
            obj.docstring.value = markdown(obj.docstring.value)
