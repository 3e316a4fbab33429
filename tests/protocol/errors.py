"""What can go wrong, each as an exception of its own."""
from __future__ import annotations


class SliplineError(Exception):
    """Everything that this client raises for a reason of its own."""


class FieldError(SliplineError, ValueError):
    """A value that the client does not send, for it lies outside the range that the protocol allows."""

    def __init__(self, field: str, allowed: str, got: object) -> None:
        super().__init__(f"{field} must be {allowed}, not {got!r}")
        self.field = field
        self.allowed = allowed
        self.got = got


class DecodeError(SliplineError, ValueError):
    """Bytes that are no frame, or no body of the message that they claim to be."""


class NoAnswer(SliplineError):
    """The device did not answer, also not after the repeats. Whether it acted is unknown: say hello again."""


class Closed(SliplineError):
    """The byte stream has ended."""


class Refused(SliplineError):
    """The device refused a command; nothing has changed there. `refusal` has its `name` and its fields."""

    def __init__(self, command: str, refusal) -> None:
        super().__init__(f"{command} was refused: {refusal}")
        self.refusal = refusal
