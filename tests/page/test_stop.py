"""STOP comes first: with the focus anywhere, after the window has failed, out of sight, and while its thread is stuck."""

import contextlib
import os
import pathlib
import signal
import unittest

import shared

# From the moment at which the page is out of sight.
LEFT_MS = 300
# From the moment at which the page's thread is stuck: the patience of the watch, and a tenth.
STUCK_MS = 1100

HIDE = """() => {
  Object.defineProperty(document, "hidden", { value: true, configurable: true });
  document.dispatchEvent(new Event("visibilitychange"));
  delete document.hidden;
}"""
FREEZE = "() => document.dispatchEvent(new Event('freeze'))"


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
        self.context.add_init_script(shared.NOTE_EVENTS)
        self.page, self.errors = shared.opened(self.context, self.address)

    def tearDown(self):
        self.context.close()

    def assert_soon(self, *of):
        shared.assert_soon(self, self.page, *of)

    def sent_after(self, event, field, before):
        return shared.sent_after(self, self.page, event, field, before)

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
                    self.assert_soon("stops_sent_ms", "keydown", press, shared.STOP_MS)
        self.assertEqual(self.errors, [])

    def test_the_button_stops(self):
        self.assert_soon("stops_sent_ms", "pointerdown", self.page.locator("#stop").click, shared.STOP_MS)
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
        stopped = shared.until(self.page, lambda seen: shared.sent_since(before, "stops_sent_ms", seen), "stopped")
        self.assertTrue(failed["has_failed"] and "has failed" in self.page.locator("#progress").inner_text())
        for event, act in [
            ("pointerdown", self.page.locator("#stop").click),
            ("keydown", lambda: self.page.keyboard.press("Escape")),
        ]:
            act()
            latency, stopped = self.sent_after(event, "stops_sent_ms", stopped)
            self.assertLess(latency, shared.STOP_MS)

    def test_each_stop_while_sheets_are_computed(self):
        shared.need_names(self, self.page)
        shared.choose(self.page, "View", "Wave: 2-D where possible", "RadioButton")
        self.page.locator("#window").focus()
        for field, event, act, limit_ms in [
            ("stops_sent_ms", "keydown", lambda: self.page.keyboard.press("Escape"), shared.STOP_MS),
            ("stops_sent_ms", "pointerdown", self.page.locator("#stop").click, shared.STOP_MS),
            ("disarms_sent_ms", "visibilitychange", lambda: self.page.evaluate(HIDE), LEFT_MS),
            ("disarms_sent_ms", "freeze", lambda: self.page.evaluate(FREEZE), LEFT_MS),
        ]:
            with self.subTest(event=event):
                self.assert_soon(field, event, act, limit_ms, "Sheet")
        self.assert_stuck_is_stopped("Sheet")
        self.assertEqual(self.errors, [])

    def test_a_key_stops_while_a_plate_is_designed(self):
        shared.need_names(self, self.page)
        shared.press(self.page, "Plate", "Button")
        shared.press(self.page, "Designer", "Button")
        # A second long; the plate that is designed first takes a tenth of that.
        shared.press(self.page, "Wave: Bending, supported", "ComboBox")
        shared.press(self.page, "Bending, clamped")
        bands = iter(["39 kHz", "38 kHz", "37 kHz"])
        def begin(page):
            shared.drive(page)
            shared.type_into(page, "Band to", next(bands))
            page.locator("#window").focus()
        press = lambda: self.page.keyboard.press("Escape")
        self.assert_soon("stops_sent_ms", "keydown", press, shared.STOP_MS, "Design", begin)
        self.assertEqual(self.errors, [])

    def test_a_page_out_of_sight_stops_and_disarms(self):
        self.assert_soon("disarms_sent_ms", "visibilitychange", lambda: self.page.evaluate(HIDE), LEFT_MS)
        shared.until(self.page, lambda seen: not seen["armed"], "disarmed")
        self.assertEqual(self.errors, [])

    def test_a_page_put_to_sleep_stops_and_disarms(self):
        self.assert_soon("disarms_sent_ms", "freeze", lambda: self.page.evaluate(FREEZE), LEFT_MS)
        shared.until(self.page, lambda seen: not seen["armed"], "disarmed")

    def test_the_watch_stops_and_disarms_while_the_thread_is_stuck(self):
        self.assert_stuck_is_stopped()

    def assert_stuck_is_stopped(self, computing=None):
        before = shared.drive(self.page)
        if computing:
            shared.computing(self.page, computing)
        began = self.page.evaluate("""() => {
          const began = performance.timeOrigin + performance.now();
          while (performance.timeOrigin + performance.now() < began + 5000);
          return began;
        }""")
        after = shared.until(self.page, lambda seen: seen["driver_stalls"] > before["driver_stalls"], "stopped by the watch")
        latency = after["time_origin_ms"] + shared.sent_since(before, "disarms_sent_ms", after)[0] - began
        print(f"-- a stuck thread: {latency:.0f} ms", flush=True)
        self.assertTrue(0 < latency < STUCK_MS, latency)
        self.assertFalse(after["armed"])


class End(unittest.TestCase):
    """A page that ends has the device disarmed if it still can, and takes its workers along: then nothing is sent any more, to any
    device, and a real one stops by its dead-man, which `tests/tests/health.rs` holds. Its workers tell another page of the same
    origin of each frame and, fifty times a second, that they live.
    """

    def test_a_page_that_is_left_closed_or_killed_drives_nothing_any_more(self):
        with contextlib.ExitStack() as open_:
            address = open_.enter_context(shared.served(shared.Telling))
            browser = open_.enter_context(shared.browser())
            for name, end in [
                ("left", lambda page: page.goto("about:blank")),
                ("closed", lambda page: page.close()),
                ("killed", lambda page: kill_workers_of(browser)),
            ]:
                with self.subTest(name), contextlib.closing(browser.new_context(viewport={"width": 1280, "height": 800})) as context:
                    self.assert_silent_after(context, address, name, end)

    def assert_silent_after(self, context, address, name, end):
        witness = context.new_page()
        witness.goto(address + "heard.html")
        page, errors = shared.opened(context, address)
        if shared.has_names(page):
            shared.choose(page, "View", "Wave: 2-D where possible", "RadioButton")
        # No page that opens comes between this and the end: it would hide this one, which stops by itself.
        page.bring_to_front()
        shared.drive(page)
        if shared.has_names(page):
            shared.computing(page, "Sheet")
        self.assertEqual(errors, [])
        began = witness.evaluate("performance.timeOrigin + performance.now()")
        heard = witness.evaluate("heard")
        self.assertEqual(heard["device"]["state"]["device_state"], "Driving")
        self.assertEqual(set(heard), {"device", "quick", "long"})
        end(page)
        # Until long after the time that is allowed: each worker would tell of itself fifty times in a second.
        witness.wait_for_function("until => performance.timeOrigin + performance.now() > until", arg=began + 2 * STUCK_MS)
        heard = witness.evaluate("heard")
        latest = max(worker["at"] for worker in heard.values()) - began
        disarmed = [round(heard["device"]["origin"] + at - began) for at in heard["device"]["state"]["disarms_sent_ms"]]
        print(f"-- {name}: disarmed after {disarmed} ms, the latest sign of a worker after {latest:.0f} ms", flush=True)
        self.assertLess(min([latest, *disarmed]), STUCK_MS)
        # A browser may let the workers of a page that it leaves end later: disarmed, they drive nothing.
        self.assertFalse(latest > STUCK_MS and heard["device"]["state"]["armed"])


def kill_workers_of(browser):
    """Kills the process of the page that has workers, as a system does that is out of memory."""
    devtools = browser.new_browser_cdp_session()
    processes = devtools.send("SystemInfo.getProcessInfo")["processInfo"]
    renderers = [process["id"] for process in processes if process["type"] == "renderer"]
    killed = [pid for pid in renderers if has_workers(pid)]
    assert len(killed) == 1, renderers
    os.kill(killed[0], signal.SIGKILL)


def has_workers(pid):
    threads = pathlib.Path("/proc", str(pid), "task").glob("*/comm")
    return any(thread.read_text().startswith("Dedicated") for thread in threads)


if __name__ == "__main__":
    unittest.main()
