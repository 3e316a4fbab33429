"""A window, and a text in it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Window:
    """A window that shows nothing, and does on a flip what was asked for."""

    def __init__(self, fullscr: bool = False) -> None:
        self._on_flip: list[Callable[[], Any]] = []

    def callOnFlip(self, function: Callable[..., Any], *arguments: Any, **named: Any) -> None:
        """Calls a function at the next flip."""
        self._on_flip.append(lambda: function(*arguments, **named))

    def flip(self) -> None:
        """The next frame."""
        calls, self._on_flip = self._on_flip, []
        for call in calls:
            call()

    def close(self) -> None:
        """No window any more."""


class TextStim:
    """A text."""

    def __init__(self, win: Window, text: str) -> None:
        self.text = text

    def draw(self) -> None:
        """Draws it into the next frame."""
