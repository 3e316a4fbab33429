"""How soon the first picture of the plate is there over a slow network, from `slipline page`.

The time is printed. It is a test only where SLIPLINE_FIRST_PICTURE_S states the limit in seconds: on a computer that does nothing
else, with the page as it is shipped (.ci/run page_shipped). What does not depend on the computer is always tested: what is
loaded is packed, nothing twice, and how long the network alone takes for it.
"""

import base64
import contextlib
import json
import os
import pathlib
import subprocess
import unittest

import shared

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("SLIPLINE_BIN", ROOT / "target" / "debug" / "slipline")
# A slow line: 8 Mbit/s, and 150 ms from a request to the first byte of its answer.
BYTES_PER_S = 1e6
LATENCY_MS = 150
LIMIT_S = float(os.environ.get("SLIPLINE_FIRST_PICTURE_S", "inf"))

# Milliseconds from the beginning of the navigation to a picture of the window that nothing covers, by the page's own mark.
FIRST_PICTURE = """() => {
  const isSeen = document.getElementById("loading").style.display === "none";
  return isSeen && performance.getEntriesByName("slipline: first picture")[0]?.startTime;
}"""
# What is seen then has more colours than this; a blank canvas has one, the page while it loads five.
COLOURS = 200


@contextlib.contextmanager
def offered(folder):
    """The address of a page that the program serves."""
    command = [str(PROGRAM), "page", "--folder", folder, "--listen", "127.0.0.1:0", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield json.loads(process.stdout.readline())["address"]
        finally:
            process.terminate()


def colours(page):
    """How many colours the page shows."""
    png = page.screenshot(type="png")
    # Without a library for pictures: the browser decodes its own.
    return page.evaluate(
        """async (png) => {
          const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
          const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
          const drawn = canvas.getContext("2d");
          drawn.drawImage(bitmap, 0, 0);
          return new Set(new Uint32Array(drawn.getImageData(0, 0, bitmap.width, bitmap.height).data.buffer)).size;
        }""",
        base64.b64encode(png).decode(),
    )


class FirstPicture(unittest.TestCase):
    def test_the_first_picture_comes_soon_over_a_slow_network(self):
        with contextlib.ExitStack() as held:
            address = held.enter_context(offered(os.path.abspath(shared.FOLDER)))
            context = held.enter_context(shared.browser()).new_context(viewport={"width": 1280, "height": 800})
            page = context.new_page()
            devtools = context.new_cdp_session(page)
            asked, packed = {}, {}
            devtools.on("Network.requestWillBeSent", lambda event: asked.update({event["requestId"]: event["request"]["url"]}))
            devtools.on("Network.loadingFinished", lambda event: packed.update({event["requestId"]: event["encodedDataLength"]}))
            devtools.send("Network.enable")
            devtools.send(
                "Network.emulateNetworkConditions",
                {
                    "offline": False,
                    "latency": LATENCY_MS,
                    "downloadThroughput": BYTES_PER_S,
                    "uploadThroughput": BYTES_PER_S,
                },
            )
            page.goto(address, wait_until="commit")
            first_s = 1e-3 * page.wait_for_function(FIRST_PICTURE, timeout=shared.PATIENCE_S * 1e3, polling=20).json_value()
            self.assertGreater(colours(page), COLOURS, "a picture of the plate is seen")
            loaded = [(asked[number].split("/")[-1], count) for number, count in packed.items() if number in asked]
        total = sum(count for _, count in loaded)
        print(f"-- first picture after {first_s:.2f} s; {total} bytes, alone {total / BYTES_PER_S:.2f} s", flush=True)
        names = [name for name, _ in loaded]
        self.assertEqual(len(names), len(set(names)), f"nothing is loaded twice: {sorted(names)}")
        for name, count in loaded:
            plain = pathlib.Path(shared.FOLDER, name)
            if name.endswith((".js", ".wasm")):
                self.assertLess(count, 0.6 * plain.stat().st_size, f"{name} is packed")
        self.assertLess(first_s, LIMIT_S)


if __name__ == "__main__":
    unittest.main()
