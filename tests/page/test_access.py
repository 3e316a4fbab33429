"""The page for those who do not see it, or use no pointer: what a screen reader gets, keys alone, less motion."""

import contextlib
import unittest

from axe_playwright_python.sync_playwright import Axe

import shared


class Access(unittest.TestCase):
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
        # Any press ends the demonstration of a first visit.
        self.page.mouse.click(420, 250)
        shared.felt(self.page)

    def tearDown(self):
        self.context.close()

    def tree(self):
        """What the browser gives a screen reader: role and name of each node that is not ignored, in its order."""
        devtools = self.context.new_cdp_session(self.page)
        nodes = devtools.send("Accessibility.getFullAXTree")["nodes"]
        read = lambda node, what: str(node.get(what, {}).get("value", ""))
        return [(read(node, "role"), read(node, "name")) for node in nodes if not node["ignored"]]

    def read_until(self, holds, what):
        for _ in range(int(shared.PATIENCE_S * 2)):
            if holds(tree := self.tree()):
                return tree
            self.page.wait_for_timeout(500)
        raise AssertionError(f"not {what}: {tree}")

    def spoken(self, part):
        self.page.wait_for_function(
            "part => document.getElementById('spoken').textContent.includes(part)", arg=part, timeout=shared.PATIENCE_S * 1e3
        )

    def test_a_screen_reader_gets_state_edge_controls_and_stop(self):
        tree = self.read_until(lambda tree: sum(role == "button" for role, _ in tree) > 10, "the controls")
        for node in [("button", "STOP"), ("button", "Drive")]:
            self.assertIn(node[0], [role for role, name in tree if name.startswith(node[1])], tree)
        self.assertTrue(any(role == "Application" or role == "application" for role, _ in tree), tree)
        self.assertTrue(any(name == "Keys for the window" for role, name in tree), tree)
        edge_mm = 1e3 * shared.felt(self.page)["felt_edge_m"]
        self.spoken(f"The felt edge is at {edge_mm:.1f} mm.")
        shared.drive(self.page)
        self.spoken("Driving.")
        self.page.wait_for_function("document.title === 'Driving - Slipline'", timeout=shared.PATIENCE_S * 1e3)
        self.page.keyboard.press("Escape")
        self.spoken("Armed, at rest.")
        self.assertEqual(self.errors, [])

    def test_the_page_can_be_kept_as_a_program_with_its_icon(self):
        manifest = self.page.evaluate(
            """async () => {
              const link = document.querySelector("link[rel=manifest]").href;
              const manifest = await (await fetch(link)).json();
              const icon = await fetch(new URL(manifest.icons[0].src, link));
              return [manifest.name, new URL(manifest.start_url, link).href, icon.headers.get("content-type")];
            }"""
        )
        self.assertEqual(manifest[0], "Slipline")
        self.assertEqual(manifest[1], self.page.url.split("#")[0])
        self.assertTrue(manifest[2].startswith("image/svg+xml"), manifest)

    def test_a_screen_readers_press_is_a_press(self):
        self.read_until(lambda tree: ("button", "STOP") in tree, "the controls")
        self.page.keyboard.press("Escape")
        shared.until(self.page, lambda seen: seen["device_state"] == "Armed", "stopped")
        # Again where a press fell into the picture of the STOP before, which comes first.
        drive = """() => {
          const drive = [...document.querySelectorAll("#window [role=button]")].find((one) => one.ariaLabel === "Drive");
          drive?.click();
          return window.slipline.state().device_state === "Driving";
        }"""
        self.page.wait_for_function(drive, polling=1000, timeout=shared.PATIENCE_S * 1e3)
        shared.until(self.page, lambda seen: seen["device_state"] == "Driving", "driving")

    def test_keys_alone_reach_what_stands_outside_the_canvas(self):
        self.page.locator("#window").focus()
        focused = lambda: self.page.evaluate("document.activeElement.id || document.activeElement.tagName")
        self.page.keyboard.press("F6")
        self.assertEqual(focused(), "stop")
        self.page.keyboard.press("F6")
        self.assertIn(focused(), ["window", "INPUT"])
        # The controls within: Tab moves egui's focus, and a screen reader learns where it is.
        self.page.keyboard.press("Tab")
        self.page.wait_for_function("document.getElementById('window').getAttribute('aria-activedescendant')")
        named = self.page.evaluate(
            "document.getElementById(document.getElementById('window').getAttribute('aria-activedescendant')).ariaLabel"
        )
        self.assertTrue(named)

    def test_axe_finds_nothing_serious(self):
        self.read_until(lambda tree: sum(role == "button" for role, _ in tree) > 10, "the controls")
        found = Axe().run(self.page).response["violations"]
        serious = [f"{it['id']}: {it['nodes'][0]['html'][:200]}" for it in found if it["impact"] in ("serious", "critical")]
        print(f"-- axe: {[(it['id'], it['impact']) for it in found]}", flush=True)
        self.assertEqual(serious, [])

    def test_with_less_motion_wanted_nothing_moves_by_itself(self):
        with contextlib.closing(self.browser.new_context(reduced_motion="reduce")) as context:
            page, _ = shared.opened(context, self.address)
            before = shared.felt(page)
            page.wait_for_timeout(3000)
            after = shared.state(page)
            self.assertEqual(after["turning_point_m"], before["turning_point_m"])


if __name__ == "__main__":
    unittest.main()
