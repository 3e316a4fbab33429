"""The break of a device: disarmed, until its program goes on."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import Device

__all__ = ["Rest"]


class Rest:
    """The break that ``device.rest()`` begins. The device is disarmed and needs no call.

    :meth:`go_on` arms it again. In a ``with`` block its end does so, unless the block is left by an exception.
    """

    def __init__(self, device: Device, despite_brown_out_level: bool = False, despite_no_profile: bool = False) -> None:
        """The consent is that of the latest ``device.arm()``."""
        self._device = device
        self._consent = {"despite_brown_out_level": despite_brown_out_level, "despite_no_profile": despite_no_profile}
        self._is_over = False

    def go_on(self) -> None:
        """Ends the break and arms the device. Nothing happens if the break is over."""
        if not self._is_over:
            self._device.arm(**self._consent)
            self._is_over = True

    def __enter__(self) -> Rest:
        return self

    def __exit__(self, kind: type[BaseException] | None, _error: object, _trace: object) -> None:
        if kind is None:
            self.go_on()

    def __repr__(self) -> str:
        return "Rest(over)" if self._is_over else "Rest(the device is disarmed: go_on() arms it again)"
