"""A user's script of four minutes, in virtual time: a browser computes the same as this computer.

`SLIPLINE_SCRIPT` is the output of `cargo test --test in_use -- --ignored --nocapture`.
"""

import contextlib
import math
import os
import pathlib
import re
import unittest

import shared

# Requests and digests of the codes, as the script prints them.
LINE = re.compile(r"codes [0-9a-f]{16}|[A-Z][A-Za-z]*(\(.*\))?")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")
# The two have other functions of mathematics below them, which differ in the last bit; a fit makes more of it.
RELATIVE = 1e-6


def lines(text):
    """The script's lines. The checksum of a table adds nothing to its entries."""
    return [re.sub(r"crc: \d+", "crc", line) for line in text.splitlines() if LINE.fullmatch(line)]


def numbers(line):
    return [float(number) for number in NUMBER.findall(line)]


def codes(lines):
    return [line for line in lines if line.startswith("codes ")]


def before_a_fit(lines):
    """The lines before the second table, which the calibrated plate's fit makes: an entry of it may be another one in its last bits, and
    the codes with it."""
    return lines[: [at for at, line in enumerate(lines) if line.startswith("Upload(")][1]]


class Script(unittest.TestCase):
    maxDiff = None

    def test_a_script_gives_the_same_requests_and_codes(self):
        native = lines(pathlib.Path(os.environ["SLIPLINE_SCRIPT"]).read_text())
        program = next(pathlib.Path(shared.FOLDER).glob("slipline_page*.js")).name
        code = next(pathlib.Path(shared.FOLDER).glob("slipline_page*.wasm")).name
        with shared.served() as address, shared.browser() as browser:
            page = browser.new_page()
            # A place without the window, whose thread may be busy with it.
            page.goto(address + "nothing")
            page.set_default_timeout(600_000)
            played = lines(page.evaluate(
                """async ([program, code]) => {
                  const { default: init, playScript } = await import(`/${program}`);
                  await init({ module_or_path: `/${code}` });
                  return playScript();
                }""",
                [program, code],
            ))
        self.assertGreater(len(codes(native)), 20)
        wording = [[re.sub(r"codes .*", "codes", NUMBER.sub("#", line)) for line in side] for side in (played, native)]
        self.assertEqual(*wording)
        equal = codes(before_a_fit(native))
        self.assertGreater(len(equal), 10)
        self.assertEqual(codes(before_a_fit(played)), equal)
        for in_page, here in zip(played, native):
            if not here.startswith("codes "):
                for a, b in zip(numbers(in_page), numbers(here)):
                    self.assertTrue(math.isclose(a, b, rel_tol=RELATIVE, abs_tol=1e-12), f"{a} {b}: {here[:300]}")
        of = len(codes(native))
        print(f"-- {len(played) - of} requests the same, and {len(equal)} of {of} digests of codes", flush=True)


if __name__ == "__main__":
    unittest.main()
