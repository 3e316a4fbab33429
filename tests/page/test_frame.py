"""The page in a frame of another page, such as a paper's: `?embed` shows plate and line alone, with state and STOP."""

import contextlib
import unittest

import shared
from test_window import fragment_of, whole_setup

PAPER = """<!DOCTYPE html><title>A paper</title><p>The wave turns back at the line:</p>
<iframe src="./?embed{fragment}" width="720" height="420" title="Slipline"></iframe>"""


class Paper(shared.Quiet):
    """Serves the page, and a paper with it in a frame."""

    def do_GET(self):
        if self.path.split("/")[-1] != "paper.html":
            return super().do_GET()
        body = PAPER.format(fragment=fragment_of(whole_setup())).encode()
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


class Frame(unittest.TestCase):
    def setUp(self):
        self.open = contextlib.ExitStack()
        self.addCleanup(self.open.close)
        self.address = self.open.enter_context(shared.served(Paper))
        browser = self.open.enter_context(shared.browser())
        self.page = browser.new_context(viewport={"width": 900, "height": 700}).new_page()

    def test_a_paper_shows_plate_and_line_alone_with_state_and_stop(self):
        self.page.goto(self.address + "paper.html")
        frame = next(frame for frame in self.page.frames if "?embed" in frame.url)
        frame.wait_for_function("window.slipline !== undefined")
        shared.until(frame, lambda seen: seen["is_open"] and seen.get("link") == "connected", "open")
        shared.until(frame, lambda seen: abs(seen["turning_point_m"] - 0.15) < 1e-6, "the setup of the address")
        shared.until(frame, lambda seen: seen["device_state"] == "Driving", "driving")
        self.assertFalse(self.page.evaluate("document.activeElement instanceof HTMLIFrameElement"), "it takes no focus by itself")
        box = self.page.locator("iframe").bounding_box()
        # STOP is on the window's own, whole, at the right.
        stop = frame.locator("#stop").bounding_box()
        self.assertLessEqual(stop["x"] + stop["width"], box["x"] + box["width"])
        shared.picture(self.page, "paper")
        if shared.has_names(frame):
            shared.reads(frame, "State: driving")
            named = {node["label"] for node in shared.nodes(frame)}
            self.assertTrue({"STOP", "Boundary"} <= named, named)
            self.assertFalse({"File", "Edit", "View", "Help", "Tones", "Log", "Boundary position"} & named, named)
            x, y = shared.middle(shared.found(frame, "Boundary", "Slider")["rect"])
            self.page.mouse.move(box["x"] + x, box["y"] + y)
            self.page.mouse.down()
            for step in range(10):
                self.page.mouse.move(box["x"] + x - 6 * step, box["y"] + y)
                self.page.wait_for_timeout(30)
            self.page.mouse.up()
            shared.until(frame, lambda seen: seen["turning_point_m"] < 0.145, "dragged")
        frame.locator("#stop").click()
        shared.until(frame, lambda seen: seen["device_state"] in ("Armed", "Idle"), "silent")
        # Nothing of it is kept: the reader's own page begins as on a first visit.
        self.page.goto(self.address)
        seen = shared.until(self.page, lambda seen: seen["is_open"] and seen.get("link") == "connected", "open")
        self.assertNotAlmostEqual(seen["turning_point_m"], 0.15, places=3)
        kept = self.page.evaluate("Object.keys(localStorage)")
        self.assertEqual([key for key in kept if key.startswith("slipline")], [])


if __name__ == "__main__":
    unittest.main()
