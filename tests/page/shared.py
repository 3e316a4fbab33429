"""A browser on the built page: served from its folder, driven by pointer and keys."""

import contextlib
import functools
import http.server
import os
import pathlib
import threading
import time

from playwright.sync_api import sync_playwright

FOLDER = os.environ.get("SLIPLINE_PAGE", "target/page")
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
# The first picture is drawn by the processor, in a build that may not be optimised.
PATIENCE_S = float(os.environ.get("SLIPLINE_PAGE_PATIENCE", "60"))

# Milliseconds from a press of STOP to its frame on the link.
STOP_MS = 50
# Notes when the browser has made each event, in milliseconds since 1970.
NOTE_EVENTS = """
window.noted = {};
for (const name of ["keydown", "pointerdown", "visibilitychange", "freeze", "pagehide"]) {
  window.addEventListener(name, (event) => { noted[name] = performance.timeOrigin + event.timeStamp; }, { capture: true });
}
"""

# In front of the workers' script: each worker reports to other pages that it lives; the device's also its state.
TELLING = b"""
{
  const channel = new BroadcastChannel("reports");
  const report = (state) => channel.postMessage({ name: self.name, origin: performance.timeOrigin, now: performance.now(), state });
  const post = self.postMessage.bind(self);
  self.postMessage = (message, ...more) => {
    if (message.state) {
      report(message.state);
    }
    post(message, ...more);
  };
  setInterval(report, 20);
}
"""
# A page that receives that: the time of each worker's latest report, by its own clock, and the device's latest state.
HEARING = b"""<!DOCTYPE html><title>Heard</title><script>
window.heard = {};
new BroadcastChannel("reports").onmessage = ({ data: { name, origin, now, state } }) => {
  heard[name] = { origin, at: origin + now, state: state ? JSON.parse(state) : heard[name]?.state };
};
</script>"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class Telling(Quiet):
    """Serves the page with workers that report their state, and the page that receives it."""

    def do_GET(self):
        name = self.path.split("/")[-1]
        if name == "heard.html":
            self.answer("text/html", HEARING)
        elif name.startswith("worker") and name.endswith(".js"):
            self.answer("text/javascript", TELLING + pathlib.Path(FOLDER, name).read_bytes())
        else:
            super().do_GET()

    def answer(self, kind, body):
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


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
            args=["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox", "--disable-dev-shm-usage"],
        )
        yield chromium
        chromium.close()


def state(page):
    return page.evaluate("window.slipline.state()")


def until(page, holds, what, patience_s=PATIENCE_S):
    """The first state that holds; polled, because no event reports it."""
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


def computing(page, kind):
    """Waits until a job of this kind runs."""
    return until(page, lambda seen: kind in seen["computing"], f"computing a {kind}")


def sent_since(before, field, seen):
    """The times of the frames that were sent since a state."""
    latest = max(before[field], default=0)
    return [at for at in seen[field] if at > latest]


def sent_after(test, page, event, field, before):
    """Milliseconds from a noted event to the first frame that was not sent before, and the state with it."""
    after = until(page, lambda seen: sent_since(before, field, seen), f"{field} after {event}")
    latency = after["time_origin_ms"] + sent_since(before, field, after)[0] - page.evaluate(f"noted.{event}")
    print(f"-- {test.id().split('.')[-1]}, {event}: {latency:.1f} ms", flush=True)
    return latency, after


def assert_silent(test, page):
    until(page, lambda seen: seen["device_state"] not in ("Driving", "Waiting", "Stopping"), "silent")
    # And until another press of STOP is not taken for the second of an emergency stop.
    page.wait_for_timeout(1100)
    test.assertNotEqual(state(page)["device_state"], "Driving", "nothing drives it again")


def assert_soon(test, page, field, event, act, limit_ms, kind=None, begin=drive):
    """An event is followed by its frame within the limit, while it drives and a job of this kind runs, as `begin` has left it.
    It is made again where that took longer, up to twice: the computer may have been busy with something else."""
    for _ in range(3):
        begin(page)
        before = computing(page, kind) if kind else state(page)
        test.assertEqual(before["device_state"], "Driving")
        act()
        latency, _ = sent_after(test, page, event, field, before)
        assert_silent(test, page)
        if latency < limit_ms:
            return
    test.fail(f"{field} {latency:.1f} ms after {event}, three times more than {limit_ms} ms")


# ---- By the names of what is on the screen: a build with the feature `tests`


def has_names(page):
    return page.evaluate("window.slipline.nodes !== undefined")


def need_names(test, page):
    """Skips a test in a build without names."""
    if not has_names(page):
        test.skipTest("this build has no names: PAGE_FEATURES=tests .ci/page")


def nodes(page):
    return page.evaluate("window.slipline.nodes()")


def words(page):
    """All that can be read, a line each."""
    seen = nodes(page)
    return "\n".join(text for node in seen for text in [node["label"], node["value"]] if text)


def reads(page, part, patience_s=PATIENCE_S):
    """Waits until a part of a name or text can be read."""
    end = time.monotonic() + patience_s
    while part not in words(page):
        if time.monotonic() > end:
            raise AssertionError(f"not to be read: {part!r}\n{words(page)}")
        page.wait_for_timeout(100)


def found(page, label, role=None):
    """The node of a name, or nothing; the highest of several, as an open menu's is."""
    named = [node for node in nodes(page) if node["label"] == label and role in (None, node["role"])]
    return min(named, key=lambda node: node["rect"][1], default=None)


def whole(node):
    """Whether the middle of a node is in sight."""
    seen = node["seen_rect"]
    x, y = middle(node["rect"])
    return seen is not None and seen[0] < x < seen[2] and seen[1] < y < seen[3]


def middle(rect):
    left, top, right, bottom = rect
    return (left + right) / 2, (top + bottom) / 2


def reached(page, label, role=None):
    """The node of a name once it can be pressed and has come to rest, scrolled to by the wheel."""
    end = time.monotonic() + PATIENCE_S
    before = None
    while True:
        node = found(page, label, role)
        if node and whole(node) and not node["is_disabled"] and before == node["rect"]:
            return node
        if time.monotonic() > end:
            raise AssertionError(f"{label!r} cannot be pressed: {node}\n{words(page)}")
        if node and not whole(node) and before == node["rect"]:
            # Over its column, at a height that every scrolled area has.
            x, y = middle(node["rect"])
            size = page.viewport_size
            page.mouse.move(x, size["height"] * 0.4)
            page.mouse.wheel(0, max(-200, min(200, y - size["height"] * 0.4)))
        before = node and node["rect"]
        page.wait_for_timeout(150)


def press(page, label, role=None):
    """Presses what has this name, by the pointer."""
    x, y = middle(reached(page, label, role)["rect"])
    page.mouse.move(x, y)
    page.mouse.click(x, y)
    # What it does is seen in the pictures after it, and the next press cannot meet what stood there before. Press and release
    # each compute a picture of their own, which still shows that; the one after them may be drawn before it can be waited for.
    pressed = state(page)
    page.mouse.move(x + 1, y)
    until(page, lambda seen: seen["frames"] > pressed["frames"], "drawn")


def tap(page, label, role=None):
    """Presses what has this name, by a finger."""
    page.touchscreen.tap(*middle(reached(page, label, role)["rect"]))


def type_into(page, label, text):
    """Types into the field of this name, in place of what it holds."""
    x, y = middle(reached(page, label, "TextInput")["rect"])
    page.mouse.click(x, y)
    # Its keys go to a field of the page, which eframe has for that.
    page.wait_for_function("document.activeElement instanceof HTMLInputElement")
    page.keyboard.press("Control+a")
    page.keyboard.type(text)
    page.keyboard.press("Enter")


def choose(page, menu, entry, role="Button"):
    """Chooses an entry of a menu, whose name goes on with its keys."""
    press(page, menu, "Button")
    named = lambda node: node["role"] == role and (node["label"] or "").startswith(entry)
    end = time.monotonic() + PATIENCE_S
    while not (entries := [node for node in nodes(page) if named(node)]):
        if time.monotonic() > end:
            raise AssertionError(f"no entry {entry!r}\n{words(page)}")
        page.wait_for_timeout(100)
    press(page, entries[0]["label"], role)


def picture(page, name):
    """A picture to look at, into the folder that the environment names."""
    folder = os.environ.get("SLIPLINE_PICTURES")
    if folder:
        page.screenshot(path=str(pathlib.Path(folder, f"{name}.png")))
