"""Sessions, numbers, repeats, beats and versions, at the simulated device in real time."""
from __future__ import annotations

import time
import unittest

from channel import Channel
from device_case import DeviceCase
from errors import Refused
from frame import TO_DEVICE, Frame
from messages import (
    COMMANDS, VERSION_1_0, VERSION_1_1, VERSION_1_2, VERSION_1_3, Hello, KeepAlive, Kind, Tone, Version, fault_names,
)  # fmt: skip
from postcard import U8
from records import Choice
from stream import Stream


class Sessions(DeviceCase):
    """What the page says of them, statement by statement."""

    def test_sessions_of_answers(self) -> None:
        client = self.client
        self.make_ready()
        client.drive([Tone(0, 32768, 40000, 0)])
        # An answer repeats the session of its command; a stop is taken from every session.
        for session in (0, client.channel.session, client.channel.session ^ 1):
            with self.subTest(session=session):
                frame, _ = client.channel.request("Stop", session=session)
                self.assertEqual(frame.session, session)
        self.wait_for(lambda status: status.state.name == "Armed" and status.sum_per_mille == 0)

    def test_beats_rise_from_any_number_on(self) -> None:
        client = self.client
        client.keeps_alive = False
        client.hello()
        client.arm()
        # Each comes 0.7 s after the one before; the third does not rise, so the dead-man acts 1 s after the second.
        for beat, state in ((0, "Armed"), (4_000_000_000, "Armed"), (4_000_000_000, "Armed"), (4_000_000_001, "Idle")):
            time.sleep(0.7)
            _, status = client.channel.request("KeepAlive", KeepAlive(beat))
            self.assertEqual(status.state.name, state, beat)

    def test_beats_do_not_wrap(self) -> None:
        client = self.client
        client.keeps_alive = False
        client.hello()
        client.arm()
        self.assertEqual(client.channel.request("KeepAlive", KeepAlive(2**32 - 1))[1].state.name, "Armed")
        # Beats from 0 on feed nothing, however often they come.
        beat, state, until = 0, "Armed", time.monotonic() + 5
        while state == "Armed" and time.monotonic() < until:
            state = client.channel.request("KeepAlive", KeepAlive(beat))[1].state.name
            beat += 1
            time.sleep(0.05)
        self.assertEqual(state, "Idle")
        # A new session starts from the beginning.
        client.hello()
        client.arm()
        self.assertEqual(client.channel.request("KeepAlive", KeepAlive(0))[1].state.name, "Armed")

    def test_a_second_program_is_refused_and_its_stop_is_taken(self) -> None:
        client = self.client
        self.make_ready()
        client.drive([Tone(0, 32768, 40000, 0)])
        self.wait_for(lambda status: status.sum_per_mille > 0)
        second = Channel(Stream.to_socket(self.server.path))
        self.addCleanup(second.close)
        nonce = b"2nd!"
        for command, value in (("Hello", Hello(VERSION_1_3, nonce)), ("Hello", Hello(VERSION_1_0, nonce)), ("Status", None), ("Arm", None)):
            self.assert_refused(Choice("StaleSession"), lambda: second.request(command, value, session=0))
        # The first one's session and drive go on.
        self.assertEqual(client.status().state.name, "Driving")
        second.request("Stop", session=0)
        self.wait_for(lambda status: status.state.name == "Armed" and status.sum_per_mille == 0)
        second.request("EmergencyStop", session=0)
        self.assertEqual(fault_names(client.status().faults), ["EmergencyStop"])
        # Once the first one has gone, the second one is taken.
        client.close()
        until = time.monotonic() + 5
        while True:
            try:
                frame, _ = second.request("Hello", Hello(VERSION_1_3, nonce), session=0)
                break
            except Refused:
                self.assertLess(time.monotonic(), until)
        self.assertNotEqual(frame.session, 0)

    def test_a_device_that_is_sent_into_its_bootloader_restarts(self) -> None:
        client = self.client
        client.keeps_alive = False
        session = client.channel.session
        _, token = client.channel.request("BootloaderToken")
        client.channel.request("BootloaderEnter", token)
        until = time.monotonic() + 5
        try:
            while time.monotonic() < until:
                client.channel.request("Status")
                time.sleep(0.01)
        except Refused as error:
            self.assertEqual(error.refusal, Choice("StaleSession"))
        device = client.hello()
        self.assertEqual(device.reset.name, "Software")
        self.assertNotEqual(client.channel.session, session)
        self.assertLess(client.status().now, device.sample_rate_hz)

    def test_a_silent_host_is_lost(self) -> None:
        client = self.client
        self.make_ready()
        client.drive([Tone(0, 32768, 40000, 0)])
        self.wait_for(lambda status: status.sum_per_mille > 0)
        client.keeps_alive = False
        # A status does not feed the dead-man.
        until = time.monotonic() + client.device.dead_man_ms / 1000 + 0.2
        while time.monotonic() < until:
            status = client.status()
            time.sleep(0.05)
        self.assertEqual((status.state.name, fault_names(status.faults)), ("Fault", ["HostLost"]))
        self.assertEqual(status.sum_per_mille, 0)
        client.keeps_alive = True
        client.keep_alive()
        client.clear_faults()
        client.arm()

    def test_a_second_hello_ends_the_session(self) -> None:
        client = self.client
        self.make_ready()
        client.drive([Tone(0, 32768, 40000, 0)])
        old = client.channel.session
        # The same nonce is a repeat and begins nothing; another one stops, disarms, and begins a session.
        nonce = b"abcd"
        client.hello(nonce=nonce)
        session = client.channel.session
        self.assertNotEqual(session, old)
        self.wait_for(lambda status: status.state.name == "Idle" and status.sum_per_mille == 0)
        frame, _ = client.channel.request("Hello", Hello(VERSION_1_1, nonce), session=0)
        self.assertEqual(frame.session, session)
        self.assert_refused(Choice("StaleSession"), lambda: client.channel.request("Arm", session=old))
        # The number of the refused command is still the next one.
        client.arm()
        self.assertEqual(client.status().state.name, "Armed")

    def test_a_repeated_command_is_not_done_twice(self) -> None:
        client = self.client
        self.make_ready()
        before = client.status().counters
        sequence = client.channel.next_sequence
        wire = Frame(TO_DEVICE, client.channel.session, sequence, COMMANDS["Disarm"].id, b"").encode()
        client.channel.send_bytes(wire + wire)
        self.wait_for(lambda status: status.counters.duplicates == before.duplicates + 1)
        # The device waits for the number after it, and says so; the next command has that number.
        client.channel.next_sequence = sequence + 2
        self.assert_refused(Choice("BadSequence", expected=sequence + 1), client.arm)
        client.arm()

    def test_a_number_is_never_used_for_another_command(self) -> None:
        # The device knows a repeat by its number alone, as the page warns.
        client = self.client
        armed = client.arm()
        client.channel.next_sequence -= 1
        self.assertEqual(client.disarm(), armed)
        self.assertEqual(client.status().state.name, "Armed")

    def test_a_damaged_frame_is_dropped_and_counted(self) -> None:
        client = self.client
        before = client.status().counters
        channel = client.channel
        wire = bytearray(Frame(TO_DEVICE, channel.session, channel.next_sequence, COMMANDS["Arm"].id, b"").encode())
        wire[-2] ^= 1
        channel.send_bytes(bytes(wire) + b"\1" * 400 + b"\0")
        after = self.wait_for(lambda status: status.counters.crc_errors > before.crc_errors)
        self.assertEqual(after.counters.crc_errors, before.crc_errors + 1)
        self.assertEqual(after.counters.overlong, before.overlong + 1)
        self.assertEqual(after.state.name, "Idle")

    def test_versions(self) -> None:
        client = self.client
        for version, driven in (
            (VERSION_1_0, True),
            (VERSION_1_1, True),
            (VERSION_1_2, True),
            (VERSION_1_3, True),
            (Version(1, 9, VERSION_1_0.schema), True),
            (Version(2, 0, VERSION_1_0.schema), False),
            (Version(1, 0, bytes(4)), False),
        ):
            with self.subTest(version=str(version)):
                client.hello(version)
                if driven:
                    client.arm()
                else:
                    self.assert_refused(Choice("VersionMismatch"), client.arm)
                    # The refused command has used its number, and both sides speak minor 0.
                    self.assert_refused(Choice("VersionMismatch"), client.arm)
                    self.assert_refused(Choice("UnknownMessage", id=0x04), lambda: client.channel.request("Maintenance"))
                client.status()
                client.stop()
                client.disarm()

    def test_an_unknown_message_and_a_malformed_one(self) -> None:
        client = self.client
        for kind, value, refusal in (
            (Kind(0x7E, "Unknown"), None, Choice("UnknownMessage", id=0x7E)),
            (Kind(0x12, "Drive", U8), 1, Choice("Malformed")),
            (Kind(0x10, "Arm", U8), 0, Choice("Malformed")),
        ):
            with self.subTest(message=kind.name):
                self.assert_refused(refusal, lambda: client.channel.request(kind, value))
        client.arm()


if __name__ == "__main__":
    unittest.main()
