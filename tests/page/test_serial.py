"""A real board on the page, by Web Serial: the emulated one, behind a fake of the browser's ports."""

import contextlib
import os
import pathlib
import time
import unittest

import board
import shared

# Where the device menu and its entry for boards are in a window of 1280 x 800, on a page that knows no board yet.
MENU = (400, 27)
ENTRY = (400, 92)
# A window that draws little: these tests are about the link.
SETTINGS = "animate = false\nshow_plots = false\nshow_panel = false\n"
# What the page calls a board with these USB ids.
NAME = "Board with ST-LINK"


class Serial(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        board.build()
        cls.open = contextlib.ExitStack()
        cls.browser = cls.open.enter_context(shared.browser())

    @classmethod
    def tearDownClass(cls):
        cls.open.close()

    def setUp(self):
        self.here = contextlib.ExitStack()
        self.bridge = board.Bridge()
        self.here.callback(self.bridge.close)
        self.bridge.plug()
        self.address = self.here.enter_context(shared.served(board.serial_of(self.bridge)))

    def tearDown(self):
        for number, page in enumerate(page for context in self.browser.contexts for page in context.pages):
            self.picture(page, f"{self.id().split('.')[-1]}-{number}")
        self.here.close()

    def opened(self):
        context = self.browser.new_context(viewport={"width": 1280, "height": 800})
        self.here.callback(context.close)
        context.add_init_script(f"localStorage.setItem('slipline-settings', {SETTINGS!r})")
        return shared.opened(context, self.address)

    def picture(self, page, name):
        folder = os.environ.get("SLIPLINE_PICTURES")
        if folder:
            page.screenshot(path=str(pathlib.Path(folder, f"{name}.png")))

    def ask(self, page, holds, what):
        """Presses the entry for boards in the device menu; again where pictures came so slowly that a press was too long."""
        end = time.monotonic() + shared.PATIENCE_S
        while True:
            page.mouse.click(*MENU)
            page.wait_for_timeout(1000)
            self.picture(page, f"{self.id().split('.')[-1]}-menu")
            for _ in range(2):
                page.mouse.click(*ENTRY)
                try:
                    return shared.until(page, holds, what, 5)
                except AssertionError:
                    if time.monotonic() > end:
                        raise

    def connected(self):
        """A page on the board, which the user has chosen."""
        page, errors = self.opened()
        seen = self.ask(page, lambda seen: seen["port"] == NAME and seen["link"] == "connected", "on the board")
        self.assertEqual(seen["board"], "mps2-an386 (emulated)")
        return page, errors

    def is_heard(self):
        """Whether the board's DAC plays: what the page says is not what the plate feels."""
        return len(set(self.bridge.emulator.shown(100))) > 1

    def play(self, page):
        """Drives until the board's DAC plays."""
        seen = shared.drive(page)
        self.wait_for(page, True)
        self.assertTrue(seen["table_verified"], "the board has the table of this plate, by its digest")
        return seen

    def wait_for(self, page, is_heard):
        end = time.monotonic() + shared.PATIENCE_S
        while self.is_heard() != is_heard:
            self.assertLess(time.monotonic(), end, f"heard: {not is_heard}, {shared.state(page)}")

    def assert_drives_on(self, page, before, seconds=2):
        """For longer than a link waits for an answer, and a device for a keep-alive."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            seen = shared.state(page)
            self.assertEqual((seen["link"], seen["device_state"]), ("connected", "Driving"), seen)
            page.wait_for_timeout(50)
        self.assertTrue(self.is_heard())
        self.assertGreater(seen["commands"], before["commands"])
        return seen

    def test_a_board_is_chosen_driven_and_stopped(self):
        page, errors = self.connected()
        self.play(page)
        self.picture(page, "board-driving")
        page.keyboard.press("Escape")
        shared.until(page, lambda seen: seen["device_state"] in ("Idle", "Armed"), "stopped")
        self.wait_for(page, False)
        # Hidden while it drives: a board is stopped and disarmed as the simulated one is.
        self.play(page)
        page.evaluate("""() => {
          Object.defineProperty(document, "hidden", { value: true, configurable: true });
          document.dispatchEvent(new Event("visibilitychange"));
        }""")
        shared.until(page, lambda seen: not seen["armed"], "disarmed")
        self.wait_for(page, False)
        self.assertEqual(errors, [])

    def test_errors_of_the_receiver_leave_the_drive_alone(self):
        page, errors = self.connected()
        before = self.play(page)
        for error in ["FramingError", "ParityError", "BreakError", "BufferOverrunError"]:
            self.bridge.disturb(error)
            after = self.assert_drives_on(page, before)
            print(f"-- {error}: {after['commands'] - before['commands']} commands since", flush=True)
            before = after
        self.assertEqual(errors, [])

    def test_an_unplugged_board_is_missed_and_found_again_disarmed(self):
        page, errors = self.connected()
        self.play(page)
        self.bridge.unplug()
        seen = shared.until(page, lambda seen: seen["link"] == "reconnecting", "missed")
        self.assertEqual(seen["error"], "the device disconnected: unplugged or restarted")
        self.picture(page, "board-unplugged")
        self.bridge.plug()
        shared.until(page, lambda seen: seen["link"] == "connected", "found again")
        page.wait_for_timeout(1000)
        self.assertNotEqual(shared.state(page)["device_state"], "Driving", "nothing drives it again")
        self.assertFalse(self.is_heard())
        self.play(page)
        self.assertEqual(errors, [])

    def test_a_second_page_says_that_the_board_is_taken(self):
        page, errors = self.connected()
        before = self.play(page)
        second, second_errors = self.opened()
        seen = self.ask(second, lambda seen: seen["port"] == NAME and seen["error"] is not None, "refused")
        self.assertIn("Another page or program has it", seen["error"])
        self.assertEqual(seen["link"], "disconnected")
        self.picture(second, "board-taken")
        self.assert_drives_on(page, before)
        self.assertEqual(errors + second_errors, [])

    def test_of_two_equal_boards_the_chosen_one_is_opened_and_its_silence_has_an_end(self):
        self.bridge.has_twin = True
        page, errors = self.opened()
        self.ask(page, lambda seen: seen["port"] == f"{NAME} 2", "on the chosen board")
        seen = shared.until(page, lambda seen: seen["error"] is not None, "an end of the silence")
        self.assertIn("does not answer", seen["error"])
        self.assertEqual(seen["port"], f"{NAME} 2")
        self.assertEqual(errors, [])

    def test_a_browser_without_web_serial_names_those_that_have_it(self):
        with shared.served(board.without_serial()) as self.address:
            page, errors = self.opened()
            seen = self.ask(page, lambda seen: "Firefox" in (seen["notice"] or ""), "a sentence")
            self.assertIn("Chrome, Edge and Firefox from 151 do", seen["notice"])
            self.assertEqual((seen["port"], seen["link"]), ("sim", "connected"))
            self.picture(page, "no-web-serial")
            self.assertEqual(errors, [])


if __name__ == "__main__":
    unittest.main()
