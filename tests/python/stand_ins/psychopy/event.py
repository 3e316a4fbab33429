"""Keys."""

from __future__ import annotations


def waitKeys(keyList: list[str]) -> list[str]:
    """The first of the keys, at once."""
    return keyList[:1]
