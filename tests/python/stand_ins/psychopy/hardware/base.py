"""The base of a device's class."""

from __future__ import annotations

from typing import Any


class BaseDevice:
    """As PsychoPy's: it notes the names by which an experiment finds the class."""

    classes: dict[str, Any] = {}

    def __init_subclass__(cls, aliases: tuple[str, ...] = ()) -> None:
        for alias in aliases:
            BaseDevice.classes[alias] = cls
