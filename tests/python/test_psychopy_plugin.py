"""The plug-in of PsychoPy, found by its entry points, on a stand-in for the parts of PsychoPy that it uses."""

from __future__ import annotations

import sys
import tomllib
from importlib.metadata import EntryPoint
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
import slipline

PLUGIN = Path(__file__).resolve().parents[2] / "host/python/psychopy-slipline"


class BaseDevice:
    """As PsychoPy's: it notes the names by which an experiment finds the class."""

    names: dict[str, str] = {}

    def __init_subclass__(cls, aliases: tuple[str, ...] = ()) -> None:
        for alias in aliases:
            BaseDevice.names[alias] = f"{cls.__module__}.{cls.__name__}"


@pytest.fixture
def hardware(monkeypatch: pytest.MonkeyPatch) -> Any:
    """`psychopy.hardware` after PsychoPy has activated its plug-ins: each entry point is an attribute of its group."""
    ports = [SimpleNamespace(device="/dev/ttyACM7", product="Slipline tactile display"), SimpleNamespace(device="/dev/ttyS0", product=None)]
    modules = {
        "psychopy": {},
        "psychopy.hardware": {},
        "psychopy.hardware.base": {"BaseDevice": BaseDevice},
        "serial": {},
        "serial.tools": {"list_ports": SimpleNamespace(comports=lambda: ports)},
    }
    for name, attributes in modules.items():
        module = ModuleType(name)
        module.__dict__.update(attributes)
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.syspath_prepend(str(PLUGIN))
    project = tomllib.loads((PLUGIN / "pyproject.toml").read_text())["project"]
    assert list(project["entry-points"]) == ["psychopy.hardware"]
    hardware = sys.modules["psychopy.hardware"]
    for name, value in project["entry-points"]["psychopy.hardware"].items():
        setattr(hardware, name, EntryPoint(name, value, "psychopy.hardware").load())
    yield hardware
    sys.modules.pop("psychopy_slipline")


def test_psychopy_finds_the_device_drives_it_and_closes_it(hardware: Any) -> None:
    assert BaseDevice.names == {"slipline": "psychopy_slipline.SliplineDevice"}
    devices = hardware.SliplineDevice.getAvailableDevices()
    assert [device["port"] for device in devices] == ["/dev/ttyACM7", "sim"]
    display = hardware.SliplineDevice(port="sim", plate="membrane")
    drive = display.drive(felt_edge_m=0.21, level=0.5)
    assert display.device.status().state == "Driving" and display.stop() >= drive.at_samples
    assert [display.isSameDevice(device) for device in devices] == [False, True] and display.isSameDevice(display)
    display.close()
    display.close()
    assert display.device.closed
    with pytest.raises(slipline.BadFile):
        hardware.SliplineDevice(plate="none")
