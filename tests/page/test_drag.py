"""Dragging while driving: how soon pictures follow is printed, and that the link does not suffer is asserted."""

import contextlib
import unittest

import shared


class Drag(unittest.TestCase):
    def test_a_drag_of_ten_seconds_leaves_the_link_alone(self):
        with contextlib.ExitStack() as open_:
            address = open_.enter_context(shared.served())
            browser = open_.enter_context(shared.browser())
            context = browser.new_context(viewport={"width": 1280, "height": 800})
            page, errors = shared.opened(context, address)
            page.mouse.click(420, 250)
            before = shared.drive(page)
            began = page.evaluate("performance.now()")
            page.mouse.move(420, 250)
            page.mouse.down()
            x, step = 420, 4
            while page.evaluate("performance.now()") - began < 10_000:
                x += step
                if not 380 < x < 620:
                    step = -step
                page.mouse.move(x, 250)
                page.wait_for_timeout(15)
            page.mouse.up()
            after = shared.state(page)
            seconds = (page.evaluate("performance.now()") - began) / 1e3
            print(f"-- {(after['frames'] - before['frames']) / seconds:.1f} pictures a second while dragging", flush=True)
            # The watch and the dead-man would both have ended the drive.
            self.assertEqual((after["device_state"], after["driver_stalls"]), ("Driving", before["driver_stalls"]))
            self.assertEqual(errors, [])


if __name__ == "__main__":
    unittest.main()
