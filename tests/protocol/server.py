"""The simulated device, offered by the built program for the length of a test."""
from __future__ import annotations

import json
import os
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Optional

_ROOT = Path(__file__).resolve().parents[2]
_START_TIME_S = 20


def binary() -> Path:
    """The program: the one that SLIPLINE_BIN names, else the newest that cargo has built."""
    named = os.environ.get("SLIPLINE_BIN")
    if named:
        return Path(named)
    target = Path(os.environ.get("CARGO_TARGET_DIR", _ROOT / "target"))
    built = [path for path in (target / "debug" / "slipline", target / "release" / "slipline") if path.is_file()]
    if not built:
        raise FileNotFoundError(f"there is no slipline in {target}: `cargo build -p slipline`, or set SLIPLINE_BIN")
    return max(built, key=lambda path: path.stat().st_mtime)


class Server:
    """`slipline serve`, at a socket or at a pseudo-terminal, with more arguments. A context manager; the process is always
    ended."""

    def __init__(self, pty: bool = False, *arguments: str) -> None:
        self.path = ""
        """Where the device is, once the program has said so."""
        self._pty = pty
        self._arguments = arguments
        self._folder: Optional[tempfile.TemporaryDirectory[str]] = None
        self._process: Optional[subprocess.Popen[str]] = None

    def __enter__(self) -> Server:
        self._folder = tempfile.TemporaryDirectory(prefix="slipline-")
        output = Path(self._folder.name, "output")
        place = ["--pty"] if self._pty else ["--socket", str(Path(self._folder.name, "device"))]
        try:
            with output.open("w") as file:
                command = [str(binary()), "serve", *place, *self._arguments, "--json"]
                streams = {"stdin": subprocess.PIPE, "text": True, "stdout": file, "stderr": subprocess.STDOUT}
                self._process = subprocess.Popen(command, **streams)
            self.path = self._wait_for_path(output)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process.stdin.close()
            self._process.terminate()
            try:
                self._process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait(timeout=5)
        if self._folder is not None:
            self._folder.cleanup()

    def raise_trigger(self) -> None:
        """Raises the device's trigger input for a moment."""
        self.type("")

    def type(self, line: str) -> None:
        """Types a line: `press` and `release` are the device's user button, `open` and `close` its stop input."""
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()

    def kill(self) -> None:
        """Ends the program at once, as the power of a device ends: nothing is sent any more."""
        self._process.kill()

    def _wait_for_path(self, output: Path) -> str:
        until = time.monotonic() + _START_TIME_S
        while time.monotonic() < until:
            text = output.read_text(encoding="utf-8")
            try:
                return json.JSONDecoder().raw_decode(text)[0]["path"]
            except json.JSONDecodeError:
                if self._process.poll() is not None:
                    status = self._process.returncode
                    raise RuntimeError(f"slipline serve ended with {status}: {text.strip()}") from None
            time.sleep(0.02)
        raise TimeoutError(f"slipline serve has not said within {_START_TIME_S} s where the device is: {text!r}")
