"""A browser on the built page: served from its folder, driven by pointer and keys."""

import contextlib
import functools
import http.server
import os
import threading
import time

from playwright.sync_api import sync_playwright

FOLDER = os.environ.get("SLIPLINE_PAGE", "target/page")
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
# The first picture is drawn by the processor, in a build that may not be optimised.
PATIENCE_S = float(os.environ.get("SLIPLINE_PAGE_PATIENCE", "60"))


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@contextlib.contextmanager
def served(kind=Quiet, folder=None):
    """The address of the built page, or of another folder, served by a handler of this kind."""
    handler = functools.partial(kind, directory=folder or FOLDER)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


@contextlib.contextmanager
def browser():
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=CHROMIUM,
            args=["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"],
        )
        yield chromium
        chromium.close()


def state(page):
    return page.evaluate("window.slipline.state()")


def until(page, holds, what, patience_s=PATIENCE_S):
    """The first state that holds; polled, because nothing tells of it."""
    end = time.monotonic() + patience_s
    while True:
        seen = state(page)
        if holds(seen):
            return seen
        if time.monotonic() > end:
            raise AssertionError(f"not {what}: {seen}")
        page.wait_for_timeout(20)


def opened(context, address, fragment=""):
    """A page that shows the window and is connected, and the list of its errors."""
    page = context.new_page()
    errors = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.goto(address + fragment)
    page.wait_for_function("window.slipline !== undefined")
    until(page, lambda seen: seen["is_open"] and seen.get("link") == "connected", "open")
    return page, errors


def felt(page):
    """The state once the felt edge is computed, which the line is: a press before that places the turning point instead."""
    return until(page, lambda seen: seen["felt_edge_m"] is not None, "felt")


def settled(page, since):
    """The state once there are pictures since that one, and the line stands where it stood a second before."""
    seen = until(page, lambda seen: seen["frames"] > since["frames"] + 1, "drawn")
    while True:
        before = seen
        page.wait_for_timeout(1000)
        seen = state(page)
        if seen["turning_point_m"] == before["turning_point_m"]:
            return seen


def drive(page):
    """Drives, pressing again where a press fell into the picture of a STOP, which comes first."""
    page.locator("#window").focus()
    end = time.monotonic() + PATIENCE_S
    while True:
        page.keyboard.press("Control+Enter")
        try:
            return until(page, lambda seen: seen["device_state"] == "Driving", "driving", 5)
        except AssertionError:
            if time.monotonic() > end:
                raise
