"""Plug-ins: the repository's alone, by the entry points of its project file."""

from __future__ import annotations

import sys
import tomllib
from importlib.metadata import EntryPoint
from pathlib import Path

from psychopy import hardware

_PLUGIN = Path(__file__).resolve().parents[4] / "host/python/psychopy-slipline"


def activatePlugins() -> None:
    """As PsychoPy's: each entry point becomes an attribute of its group, which is a module."""
    if str(_PLUGIN) not in sys.path:
        sys.path.insert(0, str(_PLUGIN))
    groups = tomllib.loads((_PLUGIN / "pyproject.toml").read_text())["project"]["entry-points"]
    assert list(groups) == ["psychopy.hardware"]
    for name, value in groups["psychopy.hardware"].items():
        setattr(hardware, name, EntryPoint(name, value, "psychopy.hardware").load())
