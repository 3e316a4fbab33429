"""STOP comes first: with the focus anywhere, after the window has failed, out of sight, and while its thread is stuck."""

import contextlib
import unittest

import shared

# Milliseconds from the event to the frame on the link.
STOP_MS = 50
# From the moment at which the page is out of sight.
LEFT_MS = 300
# From the moment at which the page's thread is stuck: the patience of the watch, and a tenth.
STUCK_MS = 1100

# Notes when the browser has made each event, in milliseconds since 1970.
NOTE_EVENTS = """
window.noted = {};
for (const name of ["keydown", "pointerdown", "visibilitychange", "freeze", "pagehide"]) {
  window.addEventListener(name, (event) => { noted[name] = performance.timeOrigin + event.timeStamp; }, { capture: true });
}
"""


class Stop(unittest.TestCase):
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
        self.context.add_init_script(NOTE_EVENTS)
        self.page, self.errors = shared.opened(self.context, self.address)

    def tearDown(self):
        self.context.close()

    def latency(self, field, event, act):
        """Milliseconds from an event to the frame that it has sent."""
        before = shared.drive(self.page)
        act()
        after = shared.until(self.page, lambda seen: seen[field] not in (None, before[field]), f"{field} after {event}")
        latency = after["time_origin_ms"] + after[field] - self.page.evaluate(f"noted.{event}")
        print(f"-- {self.id().split('.')[-1]}: {latency:.1f} ms", flush=True)
        return latency

    def assert_silent(self):
        shared.until(self.page, lambda seen: seen["device_state"] not in ("Driving", "Waiting", "Stopping"), "silent")
        self.page.wait_for_timeout(700)
        self.assertNotEqual(shared.state(self.page)["device_state"], "Driving", "nothing drives it again")

    def test_keys_stop_wherever_the_focus_is(self):
        for focus in ["#window", "#stop", None]:
            for key in ["Escape", " "]:
                with self.subTest(focus=focus, key=key):
                    def press():
                        if focus is None:
                            self.page.evaluate("document.activeElement.blur()")
                        else:
                            self.page.locator(focus).focus()
                        self.page.keyboard.press(key)
                    self.assertLess(self.latency("stop_sent_ms", "keydown", press), STOP_MS)
                    self.assert_silent()
        self.assertEqual(self.errors, [])

    def test_the_button_stops(self):
        self.assertLess(self.latency("stop_sent_ms", "pointerdown", self.page.locator("#stop").click), STOP_MS)
        self.assert_silent()
        self.assertEqual(self.errors, [])

    def test_button_and_keys_stop_after_the_window_has_failed(self):
        # An error that passes through the window's code in the middle of a picture: it never runs again.
        fail = """() => new Promise((done) => {
          window.addEventListener("error", () => setTimeout(done));
          WebGL2RenderingContext.prototype.drawElements = () => { throw new Error("a failure of the window"); };
        })"""
        before = shared.drive(self.page)
        self.page.evaluate(fail)
        # The failure stops by itself.
        failed = shared.until(self.page, lambda seen: seen["has_failed"], "failed")
        stopped = shared.until(self.page, lambda seen: seen["stop_sent_ms"] not in (None, before["stop_sent_ms"]), "stopped")
        self.assertTrue(failed["has_failed"] and "failed" in self.page.locator("#line").inner_text())
        for event, act in [
            ("pointerdown", self.page.locator("#stop").click),
            ("keydown", lambda: self.page.keyboard.press("Escape")),
        ]:
            act()
            after = shared.until(self.page, lambda seen: seen["stop_sent_ms"] != stopped["stop_sent_ms"], f"stopped by {event}")
            latency = after["time_origin_ms"] + after["stop_sent_ms"] - self.page.evaluate(f"noted.{event}")
            print(f"-- {event} after a failure: {latency:.1f} ms", flush=True)
            self.assertLess(latency, STOP_MS)
            stopped = after

    def test_out_of_sight_it_stops_and_disarms(self):
        hide = """() => {
          Object.defineProperty(document, "hidden", { value: true, configurable: true });
          document.dispatchEvent(new Event("visibilitychange"));
        }"""
        self.assertLess(self.latency("disarm_sent_ms", "visibilitychange", lambda: self.page.evaluate(hide)), LEFT_MS)
        shared.until(self.page, lambda seen: not seen["armed"], "disarmed")
        self.assertEqual(self.errors, [])

    def test_put_to_sleep_it_stops_and_disarms(self):
        freeze = "() => document.dispatchEvent(new Event('freeze'))"
        self.assertLess(self.latency("disarm_sent_ms", "freeze", lambda: self.page.evaluate(freeze)), LEFT_MS)
        shared.until(self.page, lambda seen: not seen["armed"], "disarmed")

    def test_the_watch_stops_and_disarms_while_the_thread_is_stuck(self):
        before = shared.drive(self.page)
        began = self.page.evaluate("""() => {
          const began = performance.timeOrigin + performance.now();
          while (performance.timeOrigin + performance.now() < began + 5000);
          return began;
        }""")
        after = shared.until(self.page, lambda seen: seen["driver_stalls"] > before["driver_stalls"], "stopped by the watch")
        latency = after["time_origin_ms"] + after["disarm_sent_ms"] - began
        print(f"-- a stuck thread: {latency:.0f} ms", flush=True)
        self.assertTrue(0 < latency < STUCK_MS, latency)
        self.assertFalse(after["armed"])


if __name__ == "__main__":
    unittest.main()
