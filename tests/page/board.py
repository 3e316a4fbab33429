"""The emulated board behind a fake Web Serial: the image of `slipline-qemu` in QEMU, and a bridge of WebSockets to it.

    page's worker: fake_serial.js <--WebSocket--> Bridge <--Unix socket--> QEMU [ UART0 -> application -> DAC -> UART1 ]
"""

import json
import os
import pathlib
import socket
import subprocess
import tempfile
import threading
import time

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import serve

import shared

ROOT = pathlib.Path(__file__).parents[2]
TARGET = "thumbv7em-none-eabihf"
IMAGE = os.environ.get("SLIPLINE_QEMU_IMAGE", str(ROOT / "target" / TARGET / "release/slipline-qemu"))
FAKE = pathlib.Path(__file__).with_name("fake_serial.js")
PATIENCE_S = 30
# Codes of a block, and a block as the emulator shows it: the index of its first code, and its codes.
BLOCK = 128
SHOWN_BYTES = 8 + 2 * BLOCK


def build():
    """Builds the image, unless the environment names one."""
    if "SLIPLINE_QEMU_IMAGE" not in os.environ:
        command = ["cargo", "build", "--quiet", "--locked", "--release", "-p", "slipline-qemu", "--bin", "slipline-qemu"]
        subprocess.run([*command, "--target", TARGET], cwd=ROOT, check=True)


class Emulator:
    """A board that has power."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()
        paths = [pathlib.Path(self.folder.name, name) for name in ("link", "codes")]
        machine = ["-M", "mps2-an386", "-display", "none", "-monitor", "none", "-icount", "shift=0"]
        lines = [word for path in paths for word in ("-serial", f"unix:{path},server=on,wait=off")]
        self.process = subprocess.Popen(["qemu-system-arm", *machine, *lines, "-kernel", IMAGE])
        self.link, self.codes = map(self.connected, paths)
        self.codes.settimeout(PATIENCE_S)

    def connected(self, path):
        end = time.monotonic() + PATIENCE_S
        while True:
            line = socket.socket(socket.AF_UNIX)
            try:
                line.connect(str(path))
                return line
            except OSError:
                line.close()
                if time.monotonic() > end or self.process.poll() is not None:
                    raise
                time.sleep(0.005)

    def shown(self, blocks):
        """The codes of the next blocks that the DAC plays, at most 255 blocks."""
        self.codes.sendall(bytes([blocks]))
        data = b""
        while len(data) < blocks * SHOWN_BYTES:
            data += self.codes.recv(1 << 16)
        codes = []
        for at in range(0, len(data), SHOWN_BYTES):
            block = data[at + 8 : at + SHOWN_BYTES]
            codes += [block[i] | block[i + 1] << 8 for i in range(0, len(block), 2)]
        return codes

    def end(self):
        self.process.kill()
        self.process.wait()
        self.link.close()
        self.codes.close()
        self.folder.cleanup()


class Bridge:
    """The board on the cable, as the browsers see it. One of them at a time has the port."""

    def __init__(self):
        self.lock = threading.Lock()
        self.emulator = None
        self.is_allowed = False
        # Whether an equal board, whose port never opens, is plugged in beside it; the user then chooses that one.
        self.has_twin = False
        self.listeners = set()
        # The browser that has the port, and how many readers were ended.
        self.holder = None
        self.server = serve(self.serve, "127.0.0.1", 0, compression=None)
        self.port = self.server.socket.getsockname()[1]
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def serve(self, socket_):
        try:
            {"/events": self.tell, "/line": self.carry}[socket_.request.path](socket_)
        except ConnectionClosed:
            pass

    def state(self):
        return json.dumps({"is_plugged": self.emulator is not None, "is_allowed": self.is_allowed, "has_twin": self.has_twin})

    def tell_all(self):
        for listener in list(self.listeners):
            try:
                listener.send(self.state())
            except ConnectionClosed:
                pass

    def tell(self, socket_):
        self.listeners.add(socket_)
        try:
            socket_.send(self.state())
            for _ in socket_:
                self.is_allowed = True
                self.tell_all()
        finally:
            self.listeners.discard(socket_)

    def carry(self, socket_):
        """Carries bytes both ways, from the opening of a port to its closing."""
        with self.lock:
            emulator = self.emulator
            if self.holder or not emulator:
                return
            self.holder = socket_
        try:
            socket_.send("open")
            reading = threading.Thread(target=self.read, args=(socket_, emulator), daemon=True)
            reading.start()
            for data in socket_:
                emulator.link.sendall(data)
        except OSError:
            # Unplugged.
            pass
        finally:
            with self.lock:
                self.holder = None
            reading.join()

    def read(self, socket_, emulator):
        emulator.link.settimeout(0.2)
        while self.holder is socket_:
            try:
                data = emulator.link.recv(4096)
                if not data:
                    return
                socket_.send(data)
            except TimeoutError:
                pass
            except (OSError, ConnectionClosed):
                return

    def plug(self):
        self.emulator = Emulator()
        self.tell_all()

    def unplug(self):
        """Takes the cable away, and with it the board's power."""
        emulator, self.emulator = self.emulator, None
        if self.holder:
            self.holder.close()
        if emulator:
            emulator.end()
        self.tell_all()

    def disturb(self, error):
        """Ends the reader of the browser that has the port, by an error of this name."""
        self.holder.send(error)

    def close(self):
        self.unplug()
        self.server.shutdown()


class WithSerial(shared.Quiet):
    """Serves the page with a fake Web Serial before its scripts."""

    fake = ""

    def do_GET(self):
        path = pathlib.Path(self.translate_path(self.path.split("?")[0]))
        if path.is_dir():
            path = path / "index.html"
        is_page, is_worker = path.name == "index.html", path.name.startswith("worker") and path.suffix == ".js"
        if not (is_page or is_worker) or not path.is_file():
            super().do_GET()
            return
        text = path.read_text()
        text = text.replace("<head>", f"<head><script>{self.fake}</script>", 1) if is_page else self.fake + text
        self.send_response(200)
        self.send_header("Content-Type", "text/html" if is_page else "text/javascript")
        self.end_headers()
        self.wfile.write(text.encode())


def serial_of(bridge):
    """A handler of the test's server whose pages have the bridge's board."""
    fake = FAKE.read_text().replace("BRIDGE_PORT", str(bridge.port))
    return type("Handler", (WithSerial,), {"fake": fake})


def without_serial():
    """A handler whose pages have no Web Serial at all."""
    fake = 'Object.defineProperty(navigator, "serial", { value: undefined, configurable: true });\n'
    return type("Handler", (WithSerial,), {"fake": fake})
