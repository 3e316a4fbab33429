"""What fails in a stranger's browser: the graphics, the window's own code, other scripts of the page, the clipboard."""

import contextlib
import os
import signal
import unittest

import shared

# From the loss of the graphics to the frame that disarms: the browser reports the loss after the picture that it is painting, and
# the watch over the page needs no longer than this, should the page be stuck.
DISARM_MS = 1100
# The graphics processor is lost.
LOSE_GRAPHICS = """() => {
  window.lost = performance.timeOrigin + performance.now();
  document.getElementById("window").getContext("webgl2").getExtension("WEBGL_lose_context").loseContext();
}"""
# An error of the window's own code: of the WebAssembly, in the middle of a picture.
FAIL = """() => {
  WebGL2RenderingContext.prototype.drawElements = () => { throw new Error("a failure of the window"); };
}"""
# What other scripts of a page do: extensions, harmless notices of the browser, a page around it.
FOREIGN = """() => {
  const foreign = new Error("a failure of an extension");
  foreign.stack = "Error: a failure of an extension\\n  at chrome-extension://abcdefgh/content.js:1:1";
  window.dispatchEvent(new ErrorEvent("error", { message: "ResizeObserver loop completed with undelivered notifications.",
    filename: location.href }));
  window.dispatchEvent(new ErrorEvent("error", { message: "Script error." }));
  window.dispatchEvent(new ErrorEvent("error", { error: foreign, filename: "chrome-extension://abcdefgh/content.js" }));
  window.dispatchEvent(new PromiseRejectionEvent("unhandledrejection", { promise: Promise.resolve(), reason: foreign }));
  window.dispatchEvent(new PromiseRejectionEvent("unhandledrejection", { promise: Promise.resolve(), reason: "a string" }));
  window.dispatchEvent(new PromiseRejectionEvent("unhandledrejection", { promise: Promise.resolve(), reason: undefined }));
  setTimeout(() => { throw new TypeError("a failure of a script of the page"); });
  Promise.reject(new RangeError("of another one"));
}"""


def sentence(page):
    return page.locator("#progress").inner_text()


class Failures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.open = contextlib.ExitStack()
        cls.address = cls.open.enter_context(shared.served())
        cls.browser = cls.open.enter_context(shared.browser())

    @classmethod
    def tearDownClass(cls):
        cls.open.close()

    def setUp(self):
        self.context = self.browser.new_context(viewport={"width": 1280, "height": 800})
        self.page, self.errors = shared.opened(self.context, self.address)

    def tearDown(self):
        self.context.close()

    def assert_ended(self, cause):
        """The page says what happened where the window was, the device is disarmed, and nothing drives it any more."""
        page = self.page
        shared.until(page, lambda seen: seen["has_failed"] and not seen["armed"], "failed and disarmed")
        self.assertTrue(sentence(page).startswith(cause), sentence(page))
        self.assertIn("stopped and disarmed", sentence(page))
        # The picture, which is out of date, lies below the sentence; STOP lies above it.
        for place, name in [((640, 400), "loading"), (None, "stop")]:
            box = page.locator("#stop").bounding_box()
            x, y = place or (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            at = page.evaluate("([x, y]) => document.elementFromPoint(x, y).closest('[id]').id", [x, y])
            self.assertIn(at, [name, "progress", "again"] if name == "loading" else [name])
        self.page.locator("#window").focus()
        page.keyboard.press("Control+Enter")
        page.mouse.click(500, 250)
        page.wait_for_timeout(1500)
        seen = shared.state(page)
        self.assertFalse(seen["armed"] or seen["device_state"] == "Driving", seen)

    def assert_loads_again(self, turns_m):
        """Its button loads the page with the setup that was on the screen."""
        with self.page.expect_navigation():
            self.page.get_by_role("button", name="Load the page again").click()
        self.page.wait_for_function("window.slipline !== undefined")
        seen = shared.until(self.page, lambda seen: seen["is_open"] and seen.get("link") == "connected", "open again")
        self.assertEqual(seen["turning_point_m"], turns_m)

    def placed(self):
        """Drives with the line where a press has put it; returns the state."""
        before = shared.felt(self.page)
        self.page.mouse.click(500, 250)
        shared.settled(self.page, before)
        return shared.drive(self.page)

    def test_lost_graphics_stop_and_disarm_and_the_page_says_so(self):
        before = self.placed()
        self.page.evaluate(LOSE_GRAPHICS)
        after = shared.until(
            self.page, lambda seen: shared.sent_since(before, "disarms_sent_ms", seen), "disarmed"
        )
        sent = after["time_origin_ms"] + shared.sent_since(before, "disarms_sent_ms", after)[0]
        latency = sent - self.page.evaluate("window.lost")
        print(f"-- lost graphics: disarmed after {latency:.0f} ms", flush=True)
        self.assertLess(latency, DISARM_MS)
        self.assert_ended("The graphics were lost")
        self.assert_loads_again(before["turning_point_m"])

    def test_a_killed_graphics_process_stops_and_disarms(self):
        before = self.placed()
        devtools = self.browser.new_browser_cdp_session()
        processes = devtools.send("SystemInfo.getProcessInfo")["processInfo"]
        (gpu,) = [process["id"] for process in processes if process["type"] == "GPU"]
        os.kill(gpu, signal.SIGKILL)
        self.assert_ended("The graphics were lost")
        self.assert_loads_again(before["turning_point_m"])

    def test_a_failure_of_the_window_covers_its_picture_and_sends_nothing_but_stops(self):
        before = shared.drive(self.page)
        self.page.evaluate(FAIL)
        self.assert_ended("The window has failed")
        # The watch, which asks whether somebody sees the device, gets no answer; a STOP is sent as ever.
        seen = shared.state(self.page)
        self.page.keyboard.press("Escape")
        shared.until(self.page, lambda after: shared.sent_since(seen, "stops_sent_ms", after), "stopped")
        self.assertGreaterEqual(shared.state(self.page)["commands"], before["commands"])

    def test_failures_of_others_are_no_failure_of_the_window(self):
        before = shared.drive(self.page)
        self.page.evaluate(FOREIGN)
        self.page.wait_for_timeout(1000)
        after = shared.until(self.page, lambda seen: seen["frames"] > before["frames"] + 1, "drawn")
        self.assertFalse(after["has_failed"])
        self.assertEqual(after["device_state"], "Driving")


class Addresses(unittest.TestCase):
    """The address shows the setup; a copy is reported as it ended; a link replaces nothing."""

    @classmethod
    def setUpClass(cls):
        cls.open = contextlib.ExitStack()
        cls.address = cls.open.enter_context(shared.served())
        cls.browser = cls.open.enter_context(shared.browser())

    @classmethod
    def tearDownClass(cls):
        cls.open.close()

    def opened(self, context, fragment=""):
        page, errors = shared.opened(context, self.address, fragment)
        # Any press ends the demonstration of a first visit.
        page.mouse.click(420, 250)
        shared.felt(page)
        return page

    def addressed(self, page):
        """Waits until the address has the setup on the screen, and returns that fragment."""
        page.wait_for_function("window.slipline.fragment() && location.hash === '#' + window.slipline.fragment()")
        return page.evaluate("location.hash")

    def test_the_address_shows_the_setup(self):
        with contextlib.closing(self.browser.new_context(viewport={"width": 1280, "height": 800})) as context:
            page = self.opened(context)
            first = self.addressed(page)
            seen = shared.state(page)
            page.mouse.click(560, 250)
            moved = shared.settled(page, seen)
            self.assertNotEqual(self.addressed(page), first)
            page.reload()
            page.wait_for_function("window.slipline !== undefined")
            again = shared.until(page, lambda seen: seen["is_open"] and seen.get("link") == "connected", "open again")
            self.assertEqual(again["turning_point_m"], moved["turning_point_m"])

    def test_somebodys_link_leaves_the_own_setup_stored(self):
        with contextlib.closing(self.browser.new_context(viewport={"width": 1280, "height": 800})) as context:
            page = self.opened(context)
            other = self.addressed(page)
            seen = shared.state(page)
            page.mouse.click(620, 250)
            own = shared.settled(page, seen)["turning_point_m"]
            stored = lambda: page.evaluate("localStorage.getItem('slipline-setup')")
            # It is stored when the page is left.
            page.evaluate("window.dispatchEvent(new Event('beforeunload'))")
            page.goto("about:blank")
            page, _ = shared.opened(context, self.address, other)
            self.assertNotEqual(shared.state(page)["turning_point_m"], own)
            page.evaluate("window.dispatchEvent(new Event('beforeunload'))")
            page.goto("about:blank")
            page, _ = shared.opened(context, self.address)
            self.assertEqual(shared.state(page)["turning_point_m"], own, stored())

    def test_a_copy_that_the_browser_refuses_is_not_called_done(self):
        refuse = """
        navigator.clipboard.writeText = () => Promise.reject(new DOMException("denied", "NotAllowedError"));
        document.execCommand = () => false;
        """
        with contextlib.closing(self.browser.new_context(viewport={"width": 1280, "height": 800})) as context:
            context.add_init_script(refuse)
            page = self.opened(context)
            shared.need_names(self, page)
            shared.choose(page, "File", "Share")
            seen = shared.until(page, lambda seen: "did not let" in (seen["notice"] or ""), "refused")
            self.assertIn("The address bar has the address of this setup", seen["notice"])
            self.assertFalse(seen["has_failed"])


if __name__ == "__main__":
    unittest.main()
