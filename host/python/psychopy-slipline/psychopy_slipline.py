"""Slipline's tactile display as a device of PsychoPy. PsychoPy loads it by its entry point, as any plug-in::

    from psychopy import plugins
    plugins.activatePlugins()
    from psychopy.hardware import DeviceManager
    display = DeviceManager.addDevice(deviceClass="slipline", deviceName="display", port="sim", plate="membrane")
    window.callOnFlip(display.drive, felt_edge_m=0.21, level=0.6)
    window.flip()
    display.stop()
"""

from __future__ import annotations

from typing import Any

import slipline
from psychopy.hardware.base import BaseDevice
from serial.tools import list_ports

__all__ = ["SliplineDevice"]


class SliplineDevice(BaseDevice, aliases=["slipline"]):
    """A display with a plate, armed until it is closed.

    ``port`` and ``unattended_s`` are those of ``slipline.connect``; ``plate`` is a preset's name, a plate file, or a
    ``slipline.Plate``. ``device`` is the ``slipline.Device``, with all of its calls.
    """

    def __init__(self, port: str = "sim", plate: Any = "membrane", unattended_s: float = 60.0) -> None:
        self.port = port
        found = plate if isinstance(plate, slipline.Plate) else slipline.Plate(plate)
        self.device = slipline.connect(port, unattended_s=unattended_s)
        self.device.__enter__()
        try:
            self.device.use(found)
            self.device.arm()
        except BaseException:
            self.close()
            raise

    def drive(self, **tone: Any) -> Any:
        """Plays a tone, as ``slipline.Device.drive``; its result has ``at_samples``."""
        return self.device.drive(**tone)

    def stop(self) -> int:
        """Ramps to silence; returns the sample index at which the ramp begins. The device stays armed."""
        return self.device.stop()

    def close(self) -> None:
        """Stops and disarms the device, and closes the connection."""
        if not self.device.closed:
            self.device.__exit__(None, None, None)

    def isSameDevice(self, other: Any) -> bool:
        """Whether ``other``, a device or its parameters, is at the same port."""
        port = other.get("port") if isinstance(other, dict) else getattr(other, "port", None)
        return bool(port == self.port)

    @staticmethod
    def getAvailableDevices() -> list[dict[str, Any]]:
        """The parameters of each available device: those at USB, and the simulated one."""
        ports = [port.device for port in list_ports.comports() if "Slipline" in (port.product or "")]
        return [{"deviceName": f"Slipline at {port}", "port": port} for port in (*ports, "sim")]
