"""Devices, by the names under which their classes are known."""

from __future__ import annotations

from typing import Any

from psychopy.hardware.base import BaseDevice


class DeviceManager:
    """As PsychoPy's, of which all calls are static."""

    devices: dict[str, Any] = {}

    @staticmethod
    def addDevice(deviceClass: str, deviceName: str, **parameters: Any) -> Any:
        """Makes a device of a class, and keeps it under a name."""
        device = DeviceManager.devices[deviceName] = BaseDevice.classes[deviceClass](**parameters)
        return device
