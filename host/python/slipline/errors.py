"""The exceptions of this package. All of them are :class:`Error`."""

from __future__ import annotations

__all__ = ["Error", "OutOfRange", "Refused", "Fault", "LinkLost", "Unattended", "BadFile"]


class Error(Exception):
    """What this package could not do. Its message says why, and what to do."""


class OutOfRange(Error, ValueError):
    """A value that is not allowed.

    ``field`` is the name of the argument, or the field of a file; ``value`` is the value that was given; ``low`` and ``high``
    are the ends of the allowed range, both included, in the unit of the value. What is unknown is ``None``.
    """

    field: str | None
    value: object
    low: float | None
    high: float | None

    def __init__(
        self,
        message: str,
        field: str | None = None,
        value: object = None,
        low: float | None = None,
        high: float | None = None,
    ) -> None:
        super().__init__(message, field, value, low, high)
        self.field = field
        self.value = value
        self.low = low
        self.high = high

    def __str__(self) -> str:
        return str(self.args[0])


class Refused(Error):
    """What was asked cannot be done with this plate, these values or this device, as its message explains."""


class Fault(Refused):
    """A fault of the device is latched, which has stopped it or keeps it from being armed.

    ``faults`` are the names of the latched faults (``"HostLost"``, ``"EmergencyStop"``, ``"DeskStop"`` ..); ``remedy`` says what
    to do. Once the cause is gone: ``device.clear_faults()``, and then ``device.arm()``.
    """

    faults: list[str]
    remedy: str

    def __init__(self, message: str, faults: list[str] | None = None, remedy: str = "") -> None:
        super().__init__(message, faults, remedy)
        self.faults = list(faults or [])
        self.remedy = remedy

    def __str__(self) -> str:
        return str(self.args[0])


class LinkLost(Error):
    """The connection to the device is lost, or none could be made."""


class Unattended(Error):
    """No call came for longer than ``unattended_s``; the device was stopped and disarmed."""


class BadFile(Error):
    """A file that cannot be read, or holds something else than was expected; the message names it and the place in it."""


# They are known by the name of the package: slipline.OutOfRange.
for _exception in (Error, OutOfRange, Refused, Fault, LinkLost, Unattended, BadFile):
    _exception.__module__ = "slipline"
del _exception
