"""For the site's reference: the marks of docstrings, which are those of reStructuredText, as Markdown; and types in short."""

from __future__ import annotations

import re
from typing import Any

import griffe

#: What takes any number, in the words of the reference.
SHORT = {"SupportsFloat | SupportsIndex": "float", "SupportsIndex": "int"}


def markdown(text: str) -> str:
    """The text of a docstring as Markdown: roles are code, and literal blocks and examples are blocks of Python."""
    text = re.sub(r":(?:class|attr|func|mod):`~?([^`]*)`", r"`\1`", text)
    text = re.sub(r":meth:`~?([^`]*)`", r"`\1()`", text)
    text = re.sub(r"^((?:>>> .*\n)+)", lambda found: f"```python\n{found[1].replace('>>> ', '')}```\n", text, flags=re.M)
    lines: list[str] = []
    is_literal = False
    for line in text.splitlines():
        if is_literal and line.strip() and not line.startswith("    "):
            lines.append("```\n")
            is_literal = False
        if not is_literal and line.endswith("::"):
            lines.extend([line.removesuffix("::").rstrip() + ":" if line != "::" else "", "", "```python"])
            is_literal = True
        elif not is_literal or line.strip() or lines[-1] != "```python":
            lines.append(line.removeprefix("    ") if is_literal else line)
    return "\n".join([*lines, "```"] if is_literal else lines)


class DocstringRoles(griffe.Extension):
    """Rewrites each docstring that is read, and the types of arguments."""

    def on_instance(self, *, obj: griffe.Object, **_: Any) -> None:
        """Called for each module, class, function and attribute."""
        if obj.docstring:
            obj.docstring.value = markdown(obj.docstring.value)

    def on_function(self, *, func: griffe.Function, **_: Any) -> None:
        """Called for each function."""
        for parameter in func.parameters:
            text = str(parameter.annotation)
            for long, short in SHORT.items():
                text = text.replace(long, short)
            if text != str(parameter.annotation):
                parameter.annotation = text
