"""A stream of bytes to a device: a Unix socket, or a terminal (a serial port or a pseudo-terminal)."""
from __future__ import annotations

import os
import select
import socket
import time
import tty

from errors import Closed, NoAnswer


class Stream:
    """Reads and writes, each for a bounded time."""

    def __init__(self, descriptor: int) -> None:
        """Takes over an open file descriptor."""
        self._descriptor = descriptor
        os.set_blocking(descriptor, False)

    @classmethod
    def to_socket(cls, path: str) -> Stream:
        """Connects to a Unix socket."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
            connection.settimeout(5)
            connection.connect(path)
            return cls(connection.detach())

    @classmethod
    def to_terminal(cls, path: str) -> Stream:
        """Opens a terminal and makes it carry bytes as they are: no echo, no lines, no flow control."""
        descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY)
        try:
            tty.setraw(descriptor)
            return cls(descriptor)
        except BaseException:
            os.close(descriptor)
            raise

    def read(self, timeout_s: float) -> bytes:
        """What has come, at the latest after `timeout_s`; nothing if nothing has. Raises `Closed` at the end."""
        ready, _, _ = select.select([self._descriptor], [], [], timeout_s)
        if not ready:
            return b""
        try:
            data = os.read(self._descriptor, 4096)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise Closed(f"the stream cannot be read: {error}") from error
        if not data:
            raise Closed("the device's side has closed the stream")
        return data

    def write(self, data: bytes, timeout_s: float) -> None:
        """Writes everything, or raises `NoAnswer` if it is not taken in time."""
        until = time.monotonic() + timeout_s
        while data:
            _, ready, _ = select.select([], [self._descriptor], [], max(0.0, until - time.monotonic()))
            if not ready:
                raise NoAnswer(f"the device has not taken {len(data)} bytes within {timeout_s} s")
            try:
                data = data[os.write(self._descriptor, data) :]
            except BlockingIOError:
                continue
            except OSError as error:
                raise Closed(f"the stream cannot be written: {error}") from error

    def close(self) -> None:
        """Closes the stream; again does nothing."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1
