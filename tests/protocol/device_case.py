"""What the tests with a device share."""
from __future__ import annotations

import time
import unittest
from typing import Any, Callable, ContextManager

from client import Client, Refused, demonstration_table
from messages import StatusEvent
from records import Choice
from server import Server
from table import Table


class DeviceCase(unittest.TestCase):
    """Every test has a server and a client of its own."""

    pty = False

    def setUp(self) -> None:
        self.server = self.enter(Server(self.pty))
        self.client = self.enter(self.connect())

    def enter(self, manager: ContextManager[Any]) -> Any:
        """Enters a context that ends with the test."""
        entered = manager.__enter__()
        self.addCleanup(manager.__exit__, None, None, None)
        return entered

    def connect(self) -> Client:
        return Client.at_terminal(self.server.path) if self.pty else Client.at_socket(self.server.path)

    def make_table(self, gain: float = 0.5) -> Table:
        table = demonstration_table(self.client.device.sample_rate_hz)
        hertz = [knot.step / 2**32 * table.sample_rate_hz for knot in table.knots]
        return Table.from_frequencies((50_000, 250_000), table.sample_rate_hz, hertz, [gain] * len(hertz))

    def make_ready(self, gain: float = 0.5) -> Table:
        """Uploads a table and arms."""
        table = self.make_table(gain)
        self.client.upload(table)
        self.client.arm()
        return table

    def wait_for(self, what: Callable[[StatusEvent], bool], seconds: float = 5) -> StatusEvent:
        """The first status of which this is true."""
        until = time.monotonic() + seconds
        while True:
            status = self.client.status()
            if what(status):
                return status
            self.assertLess(time.monotonic(), until, f"still {status}")
            time.sleep(0.01)

    def assert_refused(self, refusal: Choice, act: Callable[[], object]) -> Choice:
        """Demands a refusal of this name; if `refusal` has fields, they must be the same."""
        with self.assertRaises(Refused) as caught:
            act()
        got = caught.exception.refusal
        self.assertEqual(got if refusal.values else got.name, refusal if refusal.values else refusal.name)
        return got
