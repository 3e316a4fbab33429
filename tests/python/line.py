"""The simulated device in real time, a tap on its line, and programs that drive it.

    program under test --socket--> tap (notes each command and its time) --socket--> slipline serve

The device and the reading of its frames are those of `tests/protocol`, which know nothing of the package.
"""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

if "SLIPLINE" in os.environ:
    os.environ.setdefault("SLIPLINE_BIN", os.environ["SLIPLINE"])
sys.path.append(str(Path(__file__).resolve().parents[1] / "protocol"))

from client import Client  # noqa: E402
from frame import Frame, FrameReader  # noqa: E402
from messages import COMMANDS, fault_names  # noqa: E402
from page import sections  # noqa: E402
from server import Server, binary  # noqa: E402

__all__ = ["Line", "Program", "binary", "drives"]

_NAMES = {section.id: section.name for section in sections("Commands")}
#: Longest time for what takes a fraction of a second.
PATIENCE_S = 30.0


class Line:
    """A device at a socket, and the commands that have reached it. A context manager."""

    def __enter__(self) -> Line:
        self._ended = threading.Event()
        self._commands: list[tuple[float, str, bytes]] = []
        self._ends: list[socket.socket] = []
        self._stack = contextlib.ExitStack()
        self.server = self._stack.enter_context(Server())
        folder = self._stack.enter_context(tempfile.TemporaryDirectory(prefix="slipline-tap-"))
        self._listener = self._stack.enter_context(socket.socket(socket.AF_UNIX))
        self._listener.bind(f"{folder}/device")
        self._listener.listen()
        self._stack.callback(self._ended.set)
        threading.Thread(target=self._accept, daemon=True).start()
        self.port = f"unix:{folder}/device"
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def _accept(self) -> None:
        while not self._ended.is_set():
            try:
                program = self._listener.accept()[0]
            except OSError:
                return
            device = socket.socket(socket.AF_UNIX)
            device.connect(self.server.path)
            self._ends += [program, device]
            threading.Thread(target=self._carry, args=(program, device, FrameReader()), daemon=True).start()
            threading.Thread(target=self._carry, args=(device, program, None), daemon=True).start()

    def _carry(self, source: socket.socket, sink: socket.socket, reader: FrameReader | None) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(4096):
                sink.sendall(self._to_program(data) if reader is None else self._to_device(data, reader))
        for end in (source, sink):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def cut(self) -> None:
        """Ends the connections of all programs, as a pulled cable does; the next one connects as usual."""
        for end in self._ends:
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
        self._ends.clear()

    def _to_device(self, data: bytes, reader: FrameReader) -> bytes:
        """Notes the commands that these bytes complete; returns what the device gets."""
        self._note(frame for frame in reader.feed(data) if isinstance(frame, Frame))
        return data

    def _to_program(self, data: bytes) -> bytes:
        """What the program gets of these bytes of the device."""
        return data

    def _note(self, frames: Iterable[Frame]) -> None:
        now = time.monotonic()
        self._commands += [(now, _NAMES.get(frame.id, ""), frame.body) for frame in frames]

    def count(self, name: str) -> int:
        """How many commands of this name have reached the device."""
        return sum(1 for _, command, _ in self._commands if command == name)

    def bodies(self, name: str) -> list[Any]:
        """The fields of all commands of this name that have reached the device, in order."""
        return [COMMANDS[name].decode(body) for _, command, body in self._commands if command == name]

    def time_of(self, name: str, number: int = 0) -> float:
        """When the command of this name and number has reached the device, by the monotonic clock; waits for it."""
        until = time.monotonic() + PATIENCE_S
        while time.monotonic() < until:
            times = [at for at, command, _ in self._commands if command == name]
            if len(times) > number:
                return times[number]
            time.sleep(0.005)
        raise TimeoutError(f"no {name} {number} among {[name for _, name, _ in self._commands]}")

    def status(self) -> tuple[str, list[str]]:
        """State and faults of the device, which no program has any more, once the ramp of a stop has ended."""
        until = time.monotonic() + PATIENCE_S
        with Client.at_socket(self.server.path) as client:
            while (status := client.status()).state.name == "Stopping" and time.monotonic() < until:
                pass
            return status.state.name, fault_names(status.faults)


#: A program that takes longer hangs, seconds.
HANG_S = 300


class Program:
    """A Python program of its own, whose lines are read. A context manager; the process is always ended."""

    def __init__(self, body: str, *arguments: str, **names: str) -> None:
        for name, value in names.items():
            body = body.replace(name, value)
        command = [sys.executable, "-X", "faulthandler", "-u", "-c", textwrap.dedent(body), *arguments]
        streams = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        # Its workers are ended with it: they hold its streams.
        self._process = subprocess.Popen(command, text=True, start_new_session=True, **streams)
        # One that hangs says where.
        self._limit = threading.Timer(HANG_S, self._process.send_signal, [signal.SIGABRT])
        self._limit.daemon = True
        self._limit.start()

    def __enter__(self) -> Program:
        return self

    def __exit__(self, *_: object) -> None:
        self._limit.cancel()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.communicate()

    def line(self) -> str:
        """Its next line."""
        line = self._process.stdout.readline()
        assert line, f"the program has ended:\n{self._process.stderr.read()}"
        return line.rstrip("\n")

    def write(self, line: str) -> None:
        """Gives it a line."""
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()

    def signal(self, number: signal.Signals) -> float:
        """Sends it a signal; returns when, by the monotonic clock."""
        now = time.monotonic()
        os.kill(self._process.pid, number)
        return now

    def end(self) -> tuple[int, str]:
        """Waits for its end: exit code and error stream."""
        _, errors = self._process.communicate(timeout=PATIENCE_S)
        return self._process.returncode, errors


#: A program that drives, and then does THEN in the block.
DRIVES = """
import gc, os, sys, threading, time
import slipline

plate = slipline.Plate("membrane")
with slipline.connect(sys.argv[1], **dict(OPTIONS)) as device:
    device.use(plate)
    device.arm()
    drive = device.drive(turning_point_m=0.16)
    print("drives")
    THEN
"""


def drives(line: Line, then: str, options: str = "{}") -> Program:
    """A program that drives the device of a line, and then does this in the block."""
    indented = textwrap.indent(textwrap.dedent(then).strip(), "    ").strip()
    return Program(DRIVES, line.port, THEN=indented, OPTIONS=options)
