"""First starts of the program on a stranger's desktop: under window managers and without one the demonstration runs, and the
plate moves; and the window for visitors fills the screen.

SLIPLINE_STARTS is the number of starts under each manager (20), SLIPLINE_MANAGERS their names, `none` for no manager;
SLIPLINE_BIN is the program. It needs Xvfb, xdotool, ImageMagick and the managers, all packages of Debian. What is seen is read
from the window's pixels alone: the line is the darkest column through the envelope or, in the dark, the brightest.
"""

import contextlib
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("SLIPLINE_BIN", ROOT / "target" / "debug" / "slipline")
STARTS = int(os.environ.get("SLIPLINE_STARTS", "20"))
MANAGERS = os.environ.get("SLIPLINE_MANAGERS", "openbox icewm fluxbox none").split()
SCREEN = (1400, 900)
# Only a hang reaches these, in seconds.
WINDOW_S, SEEN_S = 120, 90
# What the demonstration does to the line at the least, in pixels: it moves it by more than a tenth of the plate.
MOVED = 40
# Colours of the line in both themes; see view/theme.rs.
LINES = [bytes([0x11, 0x18, 0x27]), bytes([0xF5, 0xF7, 0xFA])]


class Desktop:
    """A display of its own with a manager and a home that nobody has used before."""

    def __init__(self, manager, held):
        home = pathlib.Path(held.enter_context(tempfile.TemporaryDirectory(prefix="slipline-start-")))
        number, end = os.pipe()
        server = ["Xvfb", "-displayfd", str(end), "-screen", "0", f"{SCREEN[0]}x{SCREEN[1]}x24", "-nolisten", "tcp"]
        self._run(held, server, pass_fds=[end])
        os.close(end)
        with os.fdopen(number) as output:
            display = f":{output.readline().strip()}"
        self.env = {name: value for name, value in os.environ.items() if not name.startswith("WAYLAND")}
        self.env |= {"DISPLAY": display, "HOME": str(home)}
        self.env |= {"XDG_CONFIG_HOME": str(home / "config"), "XDG_DATA_HOME": str(home / "data")}
        if manager != "none":
            self._run(held, [manager], env=self.env)
            # Until it manages: a window that is mapped before would be none that it has placed.
            self._until(lambda: self.asked("xprop", "-root", "_NET_SUPPORTING_WM_CHECK").count("#"), WINDOW_S, f"{manager} manages")
        self.start(held)

    def start(self, held, *arguments):
        """Starts the program and waits for its window."""
        self.program = self._run(held, [str(PROGRAM), *arguments], env=self.env)
        names = ["xdotool", "search", "--onlyvisible", "--name", "^Slipline"]
        self._until(lambda: self.program.poll() is not None or self.asked(*names).strip(), WINDOW_S, "a window")
        assert self.program.poll() is None, "the program has ended"
        self.window = self.asked(*names).split()[0]

    @staticmethod
    def _run(held, command, **more):
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **more)

        def end():
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

        held.callback(end)
        return process

    @staticmethod
    def _until(holds, patience_s, what):
        end = time.monotonic() + patience_s
        while not holds():
            if time.monotonic() > end:
                raise AssertionError(f"never: {what}")
            time.sleep(0.1)

    def end(self):
        """Ends the program as a session does that ends: what it keeps is stored."""
        self.program.terminate()
        self.program.wait(20)

    def has_size(self, width, height):
        self._until(lambda: self.place()[2:] == [width, height], SEEN_S, f"{width} x {height}, but {self.place()}")

    def asked(self, *command):
        return subprocess.run(command, env=self.env, capture_output=True, text=True).stdout

    def place(self):
        """Left, top, width and height of the window, in pixels."""
        said = self.asked("xwininfo", "-id", self.window)
        names = ["Absolute upper-left X", "Absolute upper-left Y", "Width", "Height"]
        return [int(re.search(rf"{name}:\s*(-?\d+)", said)[1]) for name in names]

    def pixels(self, left, top, width, height):
        """The colours of a part of the screen, three bytes each."""
        part = f"{width}x{height}+{max(0, left)}+{max(0, top)}"
        command = ["import", "-silent", "-window", "root", "-crop", part, "-depth", "8", "rgb:-"]
        return subprocess.run(command, env=self.env, capture_output=True).stdout

    def line(self):
        """Where the line is, in pixels from the window's left edge; `None` while it is not seen."""
        left, top, width, height = self.place()
        # Just under the top of the envelope, where no curve is: a row over the stage alone.
        row = self.pixels(left, top + int(0.36 * height), int(0.72 * width), 1)
        columns = [x for x in range(80, len(row) // 3) if row[3 * x : 3 * x + 3] in LINES]
        return columns[-1] if columns else None

    def plate(self):
        """The colours of the plate."""
        left, top, width, height = self.place()
        return self.pixels(left + 80, top + int(0.2 * height), int(0.3 * width), 40)


class Starts(unittest.TestCase):
    def first_start(self, manager):
        """Whether the line was moved by itself, and whether the plate moves once it rests."""
        with contextlib.ExitStack() as held:
            desktop = Desktop(manager, held)
            seen = []
            end = time.monotonic() + SEEN_S
            while time.monotonic() < end:
                place = desktop.line()
                if place is not None:
                    seen.append(place)
                if seen and max(seen) - min(seen) >= MOVED:
                    break
                time.sleep(0.2)
            has_run = bool(seen) and max(seen) - min(seen) >= MOVED
            # The wave takes half a second from crest to trough.
            pictures = set()
            end = time.monotonic() + 20
            while len(pictures) < 3 and time.monotonic() < end:
                pictures.add(desktop.plate())
                time.sleep(0.3)
            folder = os.environ.get("SLIPLINE_PICTURES")
            if folder and not (has_run and len(pictures) >= 3):
                name = f"{folder}/{manager}-{time.time():.0f}.png"
                subprocess.run(["import", "-silent", "-window", "root", name], env=desktop.env)
            return has_run, len(pictures) >= 3

    def test_the_demonstration_runs_and_the_plate_moves(self):
        for manager in MANAGERS:
            with self.subTest(manager):
                if manager != "none" and shutil.which(manager) is None:
                    self.skipTest(f"{manager} is not installed: the package of Debian has its name")
                starts = [self.first_start(manager) for _ in range(STARTS)]
                run, moved = (sum(column) for column in zip(*starts))
                print(f"-- {manager}: {STARTS} starts, {run} demonstrations, {moved} moving plates", flush=True)
                self.assertEqual((run, moved), (STARTS, STARTS), manager)


class Visitors(unittest.TestCase):
    @unittest.skipIf(shutil.which("openbox") is None, "openbox is not installed: the package of Debian has its name")
    def test_a_window_for_visitors_fills_the_screen_and_leaves_the_next_one_its_size(self):
        with contextlib.ExitStack() as held:
            desktop = Desktop("openbox", held)
            small = (700, 500)
            desktop.asked("xdotool", "windowsize", "--sync", desktop.window, *map(str, small))
            desktop.has_size(*small)
            for arguments, size in [(["--kiosk"], SCREEN), ([], small)]:
                desktop.end()
                desktop.start(held, *arguments)
                desktop.has_size(*size)


if __name__ == "__main__":
    unittest.main()
