"""The plug-in of PsychoPy, found by its entry points, on a stand-in for the parts of PsychoPy that it uses."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import slipline

STAND_INS = Path(__file__).resolve().parent / "stand_ins"


@pytest.fixture
def hardware(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """`psychopy.hardware` after PsychoPy has activated its plug-ins: each entry point is an attribute of its group."""
    monkeypatch.setattr(sys, "path", [str(STAND_INS), *sys.path])
    before = set(sys.modules)
    from psychopy import hardware, plugins

    plugins.activatePlugins()
    yield hardware
    for name in set(sys.modules) - before:
        if name.split(".")[0] in ("psychopy", "psychopy_slipline", "serial"):
            del sys.modules[name]


def test_psychopy_finds_the_device_drives_it_and_closes_it(hardware: Any) -> None:
    assert {name: found.__module__ for name, found in hardware.BaseDevice.classes.items()} == {"slipline": "psychopy_slipline"}
    devices = hardware.SliplineDevice.getAvailableDevices()
    assert [device["port"] for device in devices] == ["/dev/ttyACM7", "sim"]
    display = hardware.DeviceManager.addDevice("slipline", "display", port="sim", plate="membrane")
    drive = display.drive(felt_edge_m=0.21, level=0.5)
    assert display.device.status().state == "Driving" and display.stop() >= drive.at_samples
    assert [display.isSameDevice(device) for device in devices] == [False, True] and display.isSameDevice(display)
    display.close()
    display.close()
    assert display.device.closed
    with pytest.raises(slipline.BadFile):
        hardware.SliplineDevice(plate="none")
