"""Two builds in turn, a page without a network, and what a browser lacks."""

import contextlib
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import shared

ASSEMBLE = pathlib.Path(__file__).parents[2] / ".ci/page-assemble"


def assemble(source, into):
    subprocess.run([ASSEMBLE, source, into], check=True)


def named(folder, stem):
    """The name of a file of a build by its beginning."""
    (found,) = [path.name for path in pathlib.Path(folder).iterdir() if path.name.startswith(f"{stem}.") and path.suffix != ".gz"]
    return found


def version(page):
    return page.evaluate("document.documentElement.dataset.version")


def kept(page):
    """The names of the files that the service worker keeps."""
    return page.evaluate(
        """async () => {
          const names = [];
          for (const cache of await caches.keys()) {
            names.push(...(await (await caches.open(cache)).keys()).map((it) => it.url.split("/").pop()));
          }
          return names;
        }"""
    )


def controlled(page):
    """Waits until the page's files are kept and its service worker answers."""
    page.wait_for_function("navigator.serviceWorker.controller !== null", timeout=shared.PATIENCE_S * 1e3)


def look(page):
    """Asks for a new version, as the page itself does each hour."""
    page.evaluate("navigator.serviceWorker.getRegistration().then((it) => it.update())")


def offer(page):
    return page.get_by_role("button", name="A new version is here: load it")


def offered(page, is_offered=True):
    offer(page).wait_for(state="visible" if is_offered else "hidden", timeout=shared.PATIENCE_S * 1e3)


def disarmed(page):
    """Stops and disarms the simulated device, which the page arms by itself: nothing is offered before."""
    shared.until(page, lambda seen: seen["armed"], "armed by itself")
    page.bring_to_front()
    # Two presses at once are an emergency stop; one leaves a simulated device armed.
    page.locator("#stop").click()
    page.locator("#stop").click()
    shared.until(page, lambda seen: not seen["armed"], "disarmed")


def gone(page, name):
    """Waits until a file is not kept any more."""
    for _ in range(int(shared.PATIENCE_S * 10)):
        if name not in kept(page):
            return
        page.wait_for_timeout(100)
    raise AssertionError(f"{name} is still kept")


class Updates(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.open = contextlib.ExitStack()
        cls.folder = pathlib.Path(cls.open.enter_context(tempfile.TemporaryDirectory()))
        cls.first, cls.second = cls.folder / "first", cls.folder / "second"
        assemble(shared.FOLDER, cls.first)
        # A build whose worker is another: its own name and those of all that refer to it are others.
        changed = cls.folder / "changed"
        shutil.copytree(cls.first, changed)
        with open(changed / named(changed, "worker"), "a") as worker:
            worker.write("// Another build.\n")
        assemble(changed, cls.second)
        cls.browser = cls.open.enter_context(shared.browser())

    @classmethod
    def tearDownClass(cls):
        cls.open.close()

    def setUp(self):
        self.case = contextlib.ExitStack()
        self.site = pathlib.Path(self.case.enter_context(tempfile.TemporaryDirectory()), "site")
        self.publish(self.first)
        self.server = contextlib.ExitStack()
        self.case.callback(self.server.close)
        self.address = self.server.enter_context(shared.served(folder=self.site))
        self.context = self.browser.new_context(viewport={"width": 1280, "height": 800})
        self.case.callback(self.context.close)

    def tearDown(self):
        self.case.close()

    def publish(self, build):
        """Puts a build on the server in place of the present one, at once; its files are dated now, by which the browser
        recognises them."""
        fresh, link = (pathlib.Path(tempfile.mkdtemp(dir=self.site.parent)) for _ in range(2))
        shutil.copytree(build, fresh, copy_function=shutil.copy, dirs_exist_ok=True)
        link /= "site"
        link.symlink_to(fresh)
        link.replace(self.site)

    def opened(self):
        page, errors = shared.opened(self.context, self.address)
        controlled(page)
        return page, errors

    def test_assembling_an_assembled_page_gives_the_same_bytes(self):
        again = self.folder / "again"
        assemble(self.first, again)
        names = sorted(path.name for path in self.first.iterdir())
        self.assertEqual(names, sorted(path.name for path in again.iterdir()))
        for name in names:
            self.assertEqual((self.first / name).read_bytes(), (again / name).read_bytes(), name)
        unchanged = ["slipline_page", "slipline_page_bg"]
        self.assertEqual([named(self.first, it) for it in unchanged], [named(self.second, it) for it in unchanged])
        for changed in ["page", "worker"]:
            self.assertNotEqual(named(self.first, changed), named(self.second, changed))

    def test_without_a_network_the_page_opens_after_its_first_visit(self):
        page, _ = self.opened()
        self.server.close()
        page.reload()
        page.wait_for_function("window.slipline !== undefined")
        shared.until(page, lambda seen: seen["is_open"] and seen.get("link") == "connected", "open without a network")
        # What is felt is a job worker's.
        shared.felt(page)

    def test_a_new_version_is_offered_and_old_files_go_when_no_page_uses_them(self):
        page, errors = self.opened()
        old = version(page)
        worker = named(self.first, "worker")
        self.assertIn(worker, kept(page))
        self.assertTrue(offer(page).is_hidden())
        disarmed(page)
        other, _ = self.opened()
        disarmed(other)
        self.publish(self.second)
        look(page)
        offered(page)
        offered(other)
        self.assertEqual(version(page), old)
        # The new build is here before the old one goes.
        self.assertLessEqual({worker, named(self.second, "worker")}, set(kept(page)))
        page.mouse.click(500, 250)
        shown = shared.settled(page, shared.state(page))
        with page.expect_navigation():
            offer(page).click()
        page.wait_for_function("window.slipline !== undefined")
        seen = shared.until(page, lambda seen: seen["is_open"] and seen.get("link") == "connected", "open again")
        shared.until(page, lambda seen: seen["turning_point_m"] == shown["turning_point_m"], "the same setup")
        self.assertNotEqual(version(page), old)
        self.assertTrue(offer(page).is_hidden())
        # The other page goes on as it was, and the server has none of its files.
        self.assertEqual(version(other), old)
        offered(other)
        started = """(name) => new Promise((resolve) => {
          const worker = new Worker(name, { type: "module" });
          worker.onerror = () => resolve("no such script");
          worker.onmessage = ({ data }) => resolve(data.failed ? "it runs" : "?");
          worker.postMessage({ entry: "none", module: null });
        })"""
        self.assertEqual(other.evaluate(started, worker), "it runs")
        self.assertIn(worker, kept(page))
        other.close()
        page.reload()
        shared.until(page, lambda seen: seen["is_open"], "open")
        gone(page, worker)
        self.assertIn(named(self.second, "worker"), kept(page))
        self.assertEqual(errors, [])

    def test_nothing_is_offered_or_loaded_while_the_device_is_armed(self):
        page, _ = self.opened()
        old = version(page)
        shared.drive(page)
        self.publish(self.second)
        look(page)
        page.wait_for_function("navigator.serviceWorker.getRegistration().then((it) => it.waiting !== null)")
        page.wait_for_timeout(1000)
        # A busy computer's page may have been stopped meanwhile: then it is offered, and hidden with the next drive. In one step,
        # so that the device is armed when it is pressed.
        pressed = """() => {
          const offer = document.getElementById("offer");
          const [isArmed, isHidden] = [window.slipline.state().armed, offer.hidden];
          if (isArmed) {
            offer.click();
            window.isSame = true;
          }
          return [isArmed, isHidden];
        }"""
        for _ in range(20):
            is_armed, is_hidden = page.evaluate(pressed)
            self.assertEqual(is_hidden, is_armed)
            if is_armed:
                break
            shared.drive(page)
        self.assertTrue(is_armed)
        page.wait_for_timeout(1000)
        self.assertTrue(page.evaluate("window.isSame"))
        self.assertEqual(version(page), old)
        disarmed(page)
        offered(page)
        with page.expect_navigation():
            offer(page).click()
        page.wait_for_function("window.slipline !== undefined")
        shared.until(page, lambda seen: seen["is_open"], "open again")
        self.assertNotEqual(version(page), old)

    def test_a_page_of_the_new_build_needs_no_offer(self):
        page, _ = self.opened()
        self.publish(self.second)
        page.reload()
        page.wait_for_function("window.slipline !== undefined")
        shared.until(page, lambda seen: seen["is_open"], "open again")
        gone(page, named(self.first, "worker"))
        self.assertTrue(offer(page).is_hidden())
        self.server.close()
        page.reload()
        page.wait_for_function("window.slipline !== undefined")
        shared.until(page, lambda seen: seen["is_open"], "open without a network")


class Lacking(unittest.TestCase):
    """A sentence in place of the window, and what works without what a browser lacks."""

    @classmethod
    def setUpClass(cls):
        cls.open = contextlib.ExitStack()
        cls.address = cls.open.enter_context(shared.served())
        cls.browser = cls.open.enter_context(shared.browser())

    @classmethod
    def tearDownClass(cls):
        cls.open.close()

    def test_a_sentence_names_what_a_browser_lacks(self):
        lacks = "This browser has no {}, which Slipline needs: a newer browser has it."
        for missing, script in [
            ("WebAssembly", "delete window.WebAssembly"),
            ("SIMD of WebAssembly", "WebAssembly.validate = () => false"),
            ("WebGL 2", "delete window.WebGL2RenderingContext"),
            # Such a browser passes over the type.
            ("workers of modules", "const Old = Worker; window.Worker = function (address) { return new Old(address); }"),
        ]:
            with self.subTest(missing):
                self.assert_says(lacks.format(missing), script)

    def test_a_sentence_names_the_setting_that_keeps_a_browser_from_the_page(self):
        no_context = """const get = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
          return kind === "webgl2" ? null : get.call(this, kind, ...more);
        };"""
        self.assert_says("switch graphics acceleration on in its settings", no_context)
        policy = "default-src 'self' 'unsafe-inline' blob: data:"
        self.assert_says("its script-src needs 'wasm-unsafe-eval'", "", {"Content-Security-Policy": policy})
        self.assert_says("or its server calls it no JavaScript", "", {"Content-Type": "text/plain"}, "**/page.*.js")

    def assert_says(self, sentence, script, headers=None, files="**/"):
        """A page with this script before its own, whose files come with other headers, says a sentence."""
        def answer(route):
            response = route.fetch()
            route.fulfill(response=response, headers={**response.headers, **{k.lower(): v for k, v in headers.items()}})

        with contextlib.closing(self.browser.new_context(service_workers="block")) as context:
            context.add_init_script(script)
            page = context.new_page()
            if headers:
                page.route(files, answer)
            page.goto(self.address)
            page.get_by_text(sentence).wait_for(timeout=shared.PATIENCE_S * 1e3)
            # Nothing that comes later takes its place.
            page.wait_for_timeout(1000)
            self.assertTrue(page.get_by_text(sentence).is_visible())

    def test_a_page_without_its_script_says_so(self):
        with contextlib.closing(self.browser.new_context(service_workers="block")) as context:
            page = context.new_page()
            page.route("**/page.*.js", lambda route: route.abort())
            page.goto(self.address)
            page.get_by_text("A part of the page could not be loaded").wait_for(timeout=shared.PATIENCE_S * 1e3)

    def test_without_service_workers_the_page_opens(self):
        with contextlib.closing(self.browser.new_context()) as context:
            context.add_init_script("delete Navigator.prototype.serviceWorker")
            _, errors = shared.opened(context, self.address)
            self.assertEqual(errors, [])

    def test_the_share_that_has_arrived_is_shown(self):
        with contextlib.closing(self.browser.new_context()) as context:
            context.add_init_script(
                """window.shares = [];
                new MutationObserver(() => {
                  const text = document.getElementById("progress")?.textContent;
                  if (text && text !== window.shares.at(-1)) window.shares.push(text);
                }).observe(document, { subtree: true, childList: true, characterData: true });"""
            )
            page, _ = shared.opened(context, self.address)
            shares = page.evaluate("window.shares")
            self.assertEqual(shares[0], "Loading: 0 %")
            self.assertEqual(shares[-1], "Loading: 100 %")
            self.assertGreater(len(shares), 3, shares)


if __name__ == "__main__":
    unittest.main()
