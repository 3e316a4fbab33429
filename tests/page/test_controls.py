"""What a user does on the page, by the names on the screen: a build with the feature `tests`.

SLIPLINE_PICTURES names a folder for pictures to look at.
"""

import contextlib
import pathlib
import unittest

import shared

DESK = {"width": 1280, "height": 800}
PHONE = {"width": 390, "height": 844}


def near(value, expected, by):
    return value is not None and abs(value - expected) < by


class Controls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.open = contextlib.ExitStack()
        cls.address = cls.open.enter_context(shared.served())
        cls.browser = cls.open.enter_context(shared.browser())

    @classmethod
    def tearDownClass(cls):
        cls.open.close()

    def opened(self, fragment="", **options):
        """A page of a visitor who was never here, with the demonstration ended."""
        context = self.browser.new_context(**{"viewport": DESK, **options})
        context.add_init_script(shared.NOTE_EVENTS)
        self.addCleanup(context.close)
        page, errors = shared.opened(context, self.address, fragment)
        shared.need_names(self, page)
        # Any press ends the demonstration of a first visit; this one moves no line.
        shared.felt(page)
        page.locator("#window").focus()
        page.keyboard.press("Shift")
        return page, errors

    def undo(self, page, turning_point_m):
        """Takes changes back until the line is where it was."""
        page.locator("#window").focus()
        for _ in range(8):
            if shared.state(page)["turning_point_m"] == turning_point_m:
                break
            seen = shared.state(page)
            page.keyboard.press("Control+z")
            shared.until(page, lambda now: now["frames"] > seen["frames"] + 2, "drawn")
        shared.until(page, lambda seen: seen["turning_point_m"] == turning_point_m, "undone")

    def test_the_boundary_is_typed_moved_by_arrow_keys_and_undone(self):
        page, errors = self.opened()
        page.mouse.click(420, 250)
        first = shared.settled(page, shared.drive(page))
        shared.press(page, "Boundary", "Button")
        shared.type_into(page, "Boundary position", "140 mm")
        shared.until(page, lambda seen: near(seen["felt_edge_m"], 0.14, 1e-3), "at 140 mm")
        shared.type_into(page, "Boundary frequency", "300 Hz")
        moved = shared.until(page, lambda seen: not near(seen["felt_edge_m"], 0.14, 1e-3), "at 300 Hz")
        frequency = lambda: shared.found(page, "Boundary frequency", "TextInput")["value"]
        self.assertTrue(frequency().startswith("300"), frequency())
        self.assertEqual(moved["device_state"], "Driving")
        shared.type_into(page, "Boundary position", "900 mm")
        shared.reads(page, "outside 87 to 300 mm")
        page.keyboard.press("Escape")
        shared.picture(page, "typed")
        # With the focus on the line and not in the field.
        page.locator("#window").focus()
        before = shared.state(page)["turning_point_m"]
        page.keyboard.press("ArrowRight")
        shared.until(page, lambda seen: seen["turning_point_m"] > before, "moved by a key")
        self.undo(page, first["turning_point_m"])
        self.assertEqual(errors, [])

    def test_a_texture_is_played(self):
        page, errors = self.opened()
        page.mouse.click(420, 250)
        before = shared.settled(page, shared.state(page))
        shared.press(page, "Texture", "Button")
        shared.press(page, "Beat", "Button")
        shared.press(page, "Play this", "Button")
        shared.until(page, lambda seen: seen["tones"] == 2, "of two tones")
        shared.drive(page)
        shared.picture(page, "texture")
        page.keyboard.press("Control+z")
        shared.until(page, lambda seen: seen["tones"] == before["tones"], "undone")
        self.assertEqual(errors, [])

    def test_a_secret_plate_is_measured_and_calibrated(self):
        page, errors = self.opened()
        page.mouse.click(420, 250)
        shared.press(page, "Plate", "Button")
        shared.press(page, "Measure", "Button")
        shared.press(page, "Hidden test plate (its numbers differ)", "CheckBox")
        shared.press(page, "Measure now", "Button")
        shared.reads(page, "run 1", 3 * shared.PATIENCE_S)
        shared.picture(page, "measured")
        shared.press(page, "Calibrate…", "Button")
        for _ in range(2):
            shared.press(page, "Next", "Button")
        # The place that is measured already, and another.
        shared.press(page, "30.0 mm, run 1 at 30.0 mm")
        shared.press(page, "Next", "Button")
        # Measured again, should STOP be pressed again: what was fitted is not fitted once more.
        def begin(page):
            if "5 of 5" in shared.words(page):
                shared.press(page, "Back", "Button")
            shared.press(page, "Measure now", "Button")
            shared.picture(page, "calibrating")
            self.wait_until_measured(page)
            shared.drive(page)
            x, y = shared.middle(shared.reached(page, "Next", "Button")["rect"])
            page.mouse.click(x, y)
        press = page.locator("#stop").click
        shared.assert_soon(self, page, "stops_sent_ms", "pointerdown", press, shared.STOP_MS, "Calibration", begin)
        shared.reads(page, "Boundary off by", 3 * shared.PATIENCE_S)
        shared.picture(page, "calibrated")
        before = page.evaluate("window.slipline.fragment()")
        shared.press(page, "Use this plate", "Button")
        page.wait_for_function("before => window.slipline.fragment() !== before", arg=before)
        self.assertTrue(shared.state(page)["can_undo"])
        page.locator("#window").focus()
        page.keyboard.press("Control+z")
        page.wait_for_function("before => window.slipline.fragment() === before", arg=before)
        self.assertEqual(errors, [])

    def wait_until_measured(self, page):
        shared.reads(page, "Cancel measuring")
        page.wait_for_function(
            "window.slipline.nodes().every((node) => node.label !== 'Cancel measuring')",
            timeout=3e3 * shared.PATIENCE_S,
        )

    def test_a_setup_is_saved_opened_and_shared_by_the_menu(self):
        page, errors = self.opened(permissions=["clipboard-read", "clipboard-write"])
        page.on("filechooser", lambda _: None)
        page.mouse.click(450, 250)
        kept = shared.settled(page, shared.state(page))
        with page.expect_download() as saved:
            shared.choose(page, "File", "Save setup…")
        text = pathlib.Path(saved.value.path()).read_text()
        self.assertIn("slipline_setup = 1", text)
        page.mouse.click(560, 250)
        shared.until(page, lambda seen: seen["turning_point_m"] != kept["turning_point_m"], "moved")
        with page.expect_file_chooser() as chooser:
            shared.choose(page, "File", "Open…")
        chooser.value.set_files([{"name": "setup.toml", "mimeType": "text/plain", "buffer": text.encode()}])
        shared.until(page, lambda seen: seen["turning_point_m"] == kept["turning_point_m"], "opened")
        shared.choose(page, "File", "Share")
        shared.reads(page, "Copied the address of this setup")
        address = page.evaluate("navigator.clipboard.readText()")
        self.assertLess(len(address.split("#")[1]), 2000)
        other, other_errors = shared.opened(page.context, address)
        shared.until(other, lambda seen: seen["turning_point_m"] == kept["turning_point_m"], "the same setup")
        self.assertEqual(errors + other_errors, [])

    def test_what_cannot_be_opened_is_refused_by_a_sentence(self):
        page, errors = self.opened()
        page.on("filechooser", lambda _: None)
        page.mouse.click(450, 250)
        kept = shared.settled(page, shared.state(page))
        for name, content, sentence in [
            ("bad.toml", b"nonsense", "bad.toml"),
            ("bytes.toml", b"\xff\xfe\x00", "not UTF-8 text"),
        ]:
            with page.expect_file_chooser() as chooser:
                shared.choose(page, "File", "Open…")
            chooser.value.set_files([{"name": name, "mimeType": "text/plain", "buffer": content}])
            shared.reads(page, sentence)
            shared.picture(page, f"refused-{name}")
            shared.press(page, "Dismiss", "Button")
        for fragment, sentence in [
            ("setup=1.AAAA", "the setup in the address is damaged"),
            ("setup=2.AAAA", "load it again"),
            ("setup=1." + "A" * 17_000, "more than the 16000 that are read"),
        ]:
            page.evaluate("fragment => { location.hash = fragment; }", fragment)
            shared.reads(page, sentence)
        shared.picture(page, "refused-address")
        self.assertEqual(shared.state(page)["turning_point_m"], kept["turning_point_m"])
        self.assertEqual(errors, [])

    def test_theme_and_setup_are_kept_and_both_themes_are_whole(self):
        page, errors = self.opened()
        page.mouse.click(500, 250)
        kept = shared.settled(page, shared.state(page))
        for theme in ("Light", "Dark"):
            shared.choose(page, "View", theme, "RadioButton")
            shared.until(page, lambda seen: seen["frames"] > kept["frames"] + 3, "drawn")
            page.mouse.move(420, 60)
            shared.picture(page, theme.lower())
        # Stored when the page is left.
        page.reload()
        page.wait_for_function("window.slipline !== undefined")
        shared.until(page, lambda seen: seen["is_open"] and seen.get("link") == "connected", "open")
        shared.until(page, lambda seen: seen["turning_point_m"] == kept["turning_point_m"], "the setup of before")
        shared.press(page, "View", "Button")
        chosen = shared.reached(page, "Dark", "RadioButton")
        self.assertTrue(chosen["is_toggled"])
        shared.picture(page, "reloaded")
        self.assertEqual(errors, [])

    def test_on_a_phone_a_finger_drags_and_a_number_is_typed(self):
        # A scale that chromium only emulates does not reach the size of a canvas in pixels.
        page, errors = self.opened(viewport=PHONE, has_touch=True, is_mobile=True)
        shared.picture(page, "phone-first")
        line = shared.found(page, "Boundary", "Slider")
        self.assertIsNotNone(line, shared.words(page))
        before = shared.state(page)
        x, y = shared.middle(line["rect"])
        touch = page.context.new_cdp_session(page)
        def send(kind, points):
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        send("touchStart", [{"x": x, "y": y}])
        for step in range(1, 13):
            send("touchMove", [{"x": x - 5 * step, "y": y}])
            page.wait_for_timeout(30)
        send("touchEnd", [])
        dragged = shared.until(
            page, lambda seen: abs(seen["turning_point_m"] - before["turning_point_m"]) > 5e-3, "dragged"
        )
        self.assertLess(dragged["turning_point_m"], before["turning_point_m"])
        shared.picture(page, "phone-dragged")
        # Panel and plots have no room side by side.
        if not shared.found(page, "Boundary position", "TextInput"):
            shared.tap(page, "Panel", "Button")
        shared.tap(page, "Boundary position", "TextInput")
        page.wait_for_function("document.activeElement instanceof HTMLInputElement")
        page.keyboard.press("Control+a")
        page.keyboard.type("140 mm")
        page.keyboard.press("Enter")
        shared.until(page, lambda seen: near(seen["felt_edge_m"], 0.14, 1e-3), "at 140 mm")
        shared.picture(page, "phone-typed")
        self.assertEqual(errors, [])


if __name__ == "__main__":
    unittest.main()
