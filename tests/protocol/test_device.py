"""Tables, drives, stops and digests, at the simulated device that `slipline serve` offers in real time."""
from __future__ import annotations

import math
import struct
import subprocess
import sys
import time
import unittest
import zlib
from dataclasses import replace
from pathlib import Path

from client import Client
from codes import Motion, bytes_of, played
from device_case import DeviceCase
from errors import Closed, FieldError, Refused, SliplineError
from messages import (
    AT_TRIGGER, NEXT_BLOCK, VERSION_1_0, VERSION_1_1, VERSION_1_2, ActuatorProfile, Chord, ChordTone, CoilHeat, Comb, CombTone, DigestStart,
    Drive, HoldTone, Kind, Tone, TravelLimit, at, fault_names,
)  # fmt: skip
from postcard import U8, Array
from records import Choice
from server import Server
from table import Table


class DriveCase(DeviceCase):
    """A whole session."""

    def drive_a_tone(self) -> None:
        """From hello to silence; the same at a socket and at a pseudo-terminal."""
        client = self.client
        who = client.device
        self.assertTrue(who.simulated)
        self.assertEqual((who.version.major, who.tones, who.max_knots), (1, 16, 1025))
        self.assertEqual(client.status().state.name, "Idle")

        table = self.make_ready()
        self.assertEqual(client.table().active, table.header)
        self.assertEqual(client.status().state.name, "Armed")

        tone = Tone(slot=3, position=32768, level=40000, phase=0)
        start = client.drive([tone], master=-600)
        self.assertEqual(start % who.block, 0)
        # Past the ramp the sum is gain * level * master, as the page says.
        status = self.wait_for(lambda status: status.now > start + 2 * who.min_glide and status.sum_per_mille > 0)
        self.assertEqual(status.state.name, "Driving")
        self.assertEqual(status.table_crc, table.crc)
        self.assertAlmostEqual(status.sum_per_mille, 1000 * 0.5 * 40000 / 65535 * 10 ** (-600 / 2000), delta=3)

        # At an index, rounded up to a block.
        ahead = client.status().now + who.sample_rate_hz // 5 + 1
        index = client.drive([tone, Tone(4, 1000, 20000, 0)], apply=at(ahead))
        self.assertEqual(index, -(-ahead // who.block) * who.block)

        # Longer than the dead-man allows without a beat: the keep-alives come.
        time.sleep(who.dead_man_ms / 1000 + 0.3)
        self.assertIsNone(client.keep_alive_error)
        self.assertEqual(client.status().state.name, "Driving")

        client.stop()
        status = self.wait_for(lambda status: status.state.name == "Armed")
        self.assertEqual(status.sum_per_mille, 0)
        client.disarm()
        status = self.wait_for(lambda status: status.state.name == "Idle")
        self.assertEqual((fault_names(status.faults), status.counters.crc_errors), ([], 0))
        self.assertEqual(client.channel.damaged, 0)


class AtSocket(DriveCase):
    """The device at a socket, and what the page says of it, statement by statement."""

    def test_drive_a_tone(self) -> None:
        self.drive_a_tone()

    def test_digest_of_silence(self) -> None:
        # Mid-scale, two bytes a code, little-endian.
        count = 4096
        silence = struct.pack("<H", 1 << (self.client.device.dac_bits - 1)) * count
        start = self.client.status().now + self.client.device.sample_rate_hz // 10
        self.assertEqual(self.client.digest(start, count), zlib.crc32(silence))

    def test_digest_of_a_tone(self) -> None:
        self.make_ready()
        count = 4096
        start = self.client.drive([Tone(0, 32768, 65535, 0)])
        digests = []
        for _ in range(2):
            start = self.client.status().now + self.client.device.sample_rate_hz // 10
            digests.append(self.client.digest(start, count))
        silence = zlib.crc32(struct.pack("<H", 1 << (self.client.device.dac_bits - 1)) * count)
        self.assertNotIn(silence, digests)
        self.assertNotEqual(*digests)

    def test_the_codes_of_a_glide(self) -> None:
        # From silence, then on: a tone moves, one fades, one begins, one stays; and at last nothing moves.
        client, rate = self.client, self.client.device.sample_rate_hz
        table = self.make_ready()
        before = [Tone(0, 9000, 20000, 7000), Tone(3, 30000, 30000, 0), Tone(5, 50000, 9000, 65535)]
        after = [Tone(0, 41000, 26000, 1), Tone(5, 50000, 9000, 0), Tone(15, 65535, 12000, 40000)]
        motions, motion = [], Motion(table)
        for tones, glide in ((before, 2000), (after, 3333)):
            start = client.drive(tones, glide=glide, apply=at(client.status().now + rate // 2))
            motion = motion.drive(tones, start, glide)
            motions.append(motion)
            count = 40 * client.device.block
            codes = bytes_of(list(played(motions, start, start + count)))
            self.assertEqual(client.digest(start, count), zlib.crc32(codes))
            self.assertEqual(client.status().foldback_per_mille, 1000)

    def test_the_codes_while_a_table_is_put_in_the_place_of_another(self) -> None:
        client, block = self.client, self.client.device.block
        first = self.make_ready()
        second = self.make_table(gain=0.4)
        second = replace(second, knots=tuple(replace(knot, step=knot.step * 9 // 10) for knot in second.knots))
        tones = [Tone(0, 9000, 20000, 7000), Tone(7, 50000, 30000, 0)]
        motions = [Motion(first).drive(tones, client.drive(tones, glide=2000), 2000)]
        # Again, until a change comes while codes are counted: it cannot be ordered for an index.
        for table in (second, first) * 5:
            client.channel.request("TableBegin", table.header)
            for chunk in table.chunks():
                client.channel.request("TableChunk", chunk)
            begin = (client.status().now + client.device.sample_rate_hz // 4) // block * block
            end = begin + 200 * block
            client.channel.request("DigestStart", DigestStart(begin, end - begin))
            self.wait_for(lambda status: status.now >= begin)
            start = client.channel.request("TableCommit")[1].at
            # 20 ms, which is longer than what the glide under way has left.
            motions.append(motions[-1].swap(table, start, 4 * client.device.min_glide))
            self.wait_for(lambda status: status.now > max(start, end) + client.device.sample_rate_hz // 20)
            codes = bytes_of(list(played(motions, begin, end)))
            self.assertEqual(client.channel.request("DigestRead")[1].crc, zlib.crc32(codes))
            if start + 5 * client.device.min_glide < end:
                return
        self.fail("no change has come in time")

    def test_the_codes_of_a_stop(self) -> None:
        client, block = self.client, self.client.device.block
        motion = Motion(self.make_ready())
        tones = [Tone(0, 9000, 20000, 7000), Tone(7, 50000, 30000, 0)]
        motions = [motion.drive(tones, client.drive(tones, glide=2000), 2000)]
        begin = (client.status().now + client.device.sample_rate_hz // 4) // block * block
        end = begin + 200 * block
        client.channel.request("DigestStart", DigestStart(begin, end - begin))
        self.wait_for(lambda status: status.now >= begin)
        start = client.stop()
        motions.append(motions[0].stop(start, 30 * client.device.sample_rate_hz // 1000))
        self.wait_for(lambda status: status.now > end + client.device.sample_rate_hz // 20)
        codes = bytes_of(list(played(motions, begin, end)))
        self.assertEqual(client.channel.request("DigestRead")[1].crc, zlib.crc32(codes))

    def test_one_change_at_most_stands_ahead_and_a_stop_frees_it(self) -> None:
        client, tone, rate = self.client, Tone(0, 32768, 30000, 0), self.client.device.sample_rate_hz
        table = self.make_ready()
        far = client.drive([tone], apply=at(client.status().now + 59 * rate))
        pending = Choice("Busy", value=Choice("CommitPending"))
        for apply in (NEXT_BLOCK, at(far + rate // 2), AT_TRIGGER):
            drive = Drive((tone,), 0, client.device.min_glide, apply)
            self.assert_refused(pending, lambda: client.channel.request("Drive", drive))
        self.assert_refused(pending, lambda: client.channel.request("Chord", Chord(12, (ChordTone(10, 9000, 0),), 0, 2000, NEXT_BLOCK)))
        client.stop()
        self.assertLess(client.drive([tone]), far)

    def test_a_chord_and_a_comb_need_a_tone_and_a_drive_does_not(self) -> None:
        client = self.client
        self.make_ready()
        refusal = Choice("OutOfRange", field=Choice("ToneCount"), min=1, max=16, got=0)
        for name, value in (("Chord", Chord(12, (), 0, 2000, NEXT_BLOCK)), ("Comb", Comb(40, (), 0, 2000, NEXT_BLOCK))):
            self.assert_refused(refusal, lambda: client.channel.request(name, value))
        seventeen = bytes([17]) + bytes(17 * 4) + bytes([0, 0xA0, 0x1F, 0])
        self.assert_refused(Choice("Malformed"), lambda: client.channel.request(Kind(0x12, "Drive", Array(len(seventeen), U8)), seventeen))
        client.drive([])

    def test_refusals(self) -> None:
        client, tone = self.client, Tone(0, 32768, 65535, 0)
        self.assert_refused(Choice("NoDigest"), lambda: client.channel.request("DigestRead"))
        self.assert_refused(Choice("NoUpload"), lambda: client.channel.request("TableCommit"))
        client.upload(self.make_table(gain=1.0))
        self.assert_refused(Choice("NotArmed"), lambda: client.drive([tone]))
        client.arm()
        self.assert_refused(Choice("Headroom", sum_per_mille=2000), lambda: client.drive([tone, Tone(1, 0, 65535, 0)]))
        self.assert_refused(Choice("SlotTwice", slot=0), lambda: client.drive([Tone(0, 0, 100, 0)] * 2))
        glide = client.device.min_glide - 1
        with self.assertRaisesRegex(FieldError, f"Drive.glide must be an integer from {glide + 1} to "):
            client.drive([tone], glide=glide)
        allowed = {"min": client.device.min_glide, "max": client.device.max_glide}
        refusal = Choice("OutOfRange", field=Choice("Glide"), got=glide, **allowed)
        self.assert_refused(refusal, lambda: client.channel.request("Drive", Drive((tone,), 0, glide, NEXT_BLOCK)))
        for index in (0, client.status().now + 61 * client.device.sample_rate_hz):
            refusal = self.assert_refused(Choice("OutOfRange"), lambda: client.drive([tone], apply=at(index)))
            self.assertEqual((refusal.field.name, refusal.got), ("ApplyAt", index))
            self.assertAlmostEqual((refusal.max - refusal.min) / client.device.sample_rate_hz, 60, delta=0.01)
        # None of them has changed anything.
        self.assertEqual(client.status().state.name, "Armed")

    def test_the_limit_of_the_travel(self) -> None:
        client, tone = self.client, Tone(0, 32768, 65535, 0)
        self.assertIsNone(client.travel_limit())
        # At its resonance of 20 kHz full scale would move it ten times too far.
        limit = TravelLimit(resonance_uhz=20_000_000_000, quality_per_mille=1000, static_ppm=10_000_000)
        client.limit_travel(limit)
        self.assertEqual(client.travel_limit(), limit)
        client.upload(self.make_table(gain=1.0))
        client.arm()
        refusal = self.assert_refused(Choice("Travel"), lambda: client.drive([tone]))
        self.assertGreater(refusal.travel_per_mille, 1000)
        quiet = Tone(0, 32768, 65535 * refusal.allowed_per_mille // 1000 * 99 // 100, 0)
        client.drive([quiet])
        client.stop()
        client.hello()
        self.assertIsNone(client.travel_limit(), "it holds for a session")

    def test_a_drive_that_waits_for_the_trigger(self) -> None:
        client, tone = self.client, Tone(0, 32768, 30000, 0)
        self.make_ready()
        for way_out in (client.stop, lambda: client.drive([])):
            client.drive([tone], apply=AT_TRIGGER)
            self.assertEqual(client.status().state.name, "Waiting")
            self.assertEqual((client.trigger().waits, client.trigger().began), (True, None))
            way_out()
            self.assertEqual((client.trigger().waits, client.trigger().began), (False, None))
        since = client.drive([tone], apply=AT_TRIGGER)
        # What rises before the device has taken the drive up counts for nothing.
        self.wait_for(lambda status: status.now > since + client.device.block)
        self.server.raise_trigger()
        self.wait_for(lambda status: status.state.name == "Driving")
        began = client.trigger().began
        self.assertGreater(began, since)
        self.assertEqual(began % client.device.block, 0)
        client.hello(VERSION_1_0)
        with self.assertRaisesRegex(SliplineError, "AtTrigger needs protocol 1.1, the device has 1.0"):
            client.drive([tone], apply=AT_TRIGGER)

    def test_a_chord_whose_peak_the_device_proves(self) -> None:
        client = self.client
        self.make_ready()
        rate = client.device.sample_rate_hz
        # Frequencies of the table, 500 to 2000 Hz, whose gain is 0.5: two amplitudes of 0.5 and two of 0.3.
        base = rate / 2**14
        harmonics = [round(hertz / base) for hertz in (600, 900, 1300, 1900)]

        def tones(*phases: int) -> list[ChordTone]:
            levels = (65535, 65535, 39321, 39321)
            return [ChordTone(*tone) for tone in zip(harmonics, levels, phases)]

        with self.assertRaises(Refused) as caught:
            client.chord(14, tones(16384, 16384, 16384, 16384))
        self.assertEqual(caught.exception.refusal.name, "Peak")
        self.assertAlmostEqual(caught.exception.refusal.peak_per_mille, 1600, delta=2)
        # The peak of other phases, from the page's formulas.
        turns = (0, 16384, 40000, 9000)
        peak = max(
            abs(
                sum(
                    amplitude * math.sin(2 * math.pi * (harmonic * n / 2**14 + phase / 65536))
                    for amplitude, harmonic, phase in zip((0.5, 0.5, 0.3, 0.3), harmonics, turns)
                )
            )
            for n in range(2**14)
        )
        master = math.floor(-2000 * math.log10(peak * 1.001))
        start = client.chord(14, tones(*turns), master=master)
        status = self.wait_for(lambda status: status.now > start + 2 * client.device.min_glide)
        self.assertEqual((status.state.name, status.counters.clips), ("Driving", 0))
        self.assertAlmostEqual(status.sum_per_mille, 1600 * 10 ** (master / 2000), delta=3)
        self.assertGreater(status.sum_per_mille, 1000)
        # Whole periods later the codes are the same.
        first = client.status().now + rate // 10
        later = first + 20 * 2**14
        self.assertEqual(client.digest(first, 2**14), client.digest(later, 2**14))
        client.drive([])
        self.wait_for(lambda status: status.state.name == "Armed")
        for harmonic in (5, 7000):
            with self.assertRaises(Refused) as caught:
                client.chord(14, [ChordTone(harmonic, 1, 0)])
            self.assertEqual(caught.exception.refusal.field.name, "Harmonic")
        client.hello(VERSION_1_1)
        with self.assertRaisesRegex(SliplineError, "Chord needs protocol 1.2, the device has 1.1"):
            client.chord(14, tones(0, 0, 0, 0))

    def test_a_comb_within_the_table_and_beyond_it(self) -> None:
        client = self.client
        self.make_ready()
        # 40 blocks: 78.125 Hz at 400 kS/s. The table ends at 500 and at 2000 Hz; its gain is 0.5.
        tones = [CombTone(harmonic, 20000, 5000 * harmonic % 65536) for harmonic in (2, 9, 400)]
        start = client.comb(40, tones)
        status = self.wait_for(lambda status: status.now > start + 2 * client.device.min_glide)
        self.assertEqual(status.state.name, "Driving")
        self.assertAlmostEqual(status.sum_per_mille, 3 * 20000 / 65535 * 500, delta=2)
        period = 40 * 128
        first = client.status().now + client.device.sample_rate_hz // 10
        self.assertEqual(client.digest(first, period), client.digest(first + 40 * period, period))
        client.stop()
        self.wait_for(lambda status: status.state.name == "Armed")
        for harmonics in ((9, 9), (2305,)):
            with self.assertRaises(Refused) as caught:
                client.comb(40, [CombTone(harmonic, 1, 0) for harmonic in harmonics])
            self.assertEqual(caught.exception.refusal.field.name, "Harmonic")
        with self.assertRaises(Refused) as caught:
            client.comb(40, [CombTone(9, 65535, 0), CombTone(10, 65535, 16384), CombTone(11, 1000, 0)])
        self.assertEqual(caught.exception.refusal.name, "Headroom")
        client.hello(VERSION_1_2)
        with self.assertRaisesRegex(SliplineError, "Comb needs protocol 1.3, the device has 1.2"):
            client.comb(40, tones)

    def test_a_device_that_is_armed_on_a_lease_disarms_by_itself(self) -> None:
        client = self.client
        client.upload(self.make_table())
        client.arm_for(1000)
        self.assertEqual(client.status().state.name, "Armed")
        status = self.wait_for(lambda status: status.state.name == "Idle")
        self.assertEqual(fault_names(status.faults), [])
        with self.assertRaisesRegex(FieldError, "lease_ms"):
            client.arm_for(999)
        client.hello(VERSION_1_2)
        with self.assertRaisesRegex(SliplineError, "ArmFor needs protocol 1.3, the device has 1.2"):
            client.arm_for(1000)

    def test_a_device_on_the_bench_drives_with_its_mute_pin_low(self) -> None:
        client = self.client
        client.upload(self.make_table())
        client.bench(60_000)
        self.assertEqual(client.status().state.name, "Armed")
        pin = client.mute_pin()
        self.assertEqual((pin.level.name, pin.is_on_bench, pin.fall), ("Low", True, None))
        self.assert_refused(Choice("Armed"), client.arm)
        self.assert_refused(Choice("NotArmed"), lambda: client.mute_pin("Lapse"))
        client.disarm()
        client.arm()
        self.wait_for(lambda _: client.mute_pin().level.name == "High")
        fall = client.mute_pin("Lapse").fall
        self.assertEqual((fall.low_after_us, fall.within_us), (4000, 0))
        self.wait_for(lambda status: status.state.name == "Idle")
        self.assertEqual(client.analogue().reference_mv, 3300)
        self.assertIsNone(client.clock().usb)
        client.hello(VERSION_1_2)
        with self.assertRaisesRegex(SliplineError, "Bench needs protocol 1.3, the device has 1.2"):
            client.bench(1000)

    def test_a_simulated_board_has_no_profile_and_takes_none_without_its_button(self) -> None:
        client = self.client
        board = client.board()
        self.assertEqual((board.core_hz, board.mute_resistor.name, board.user_button.name), (0, "Present", "Released"))
        self.assertEqual((client.profile().profile, client.profile().stored.name), (None, "Empty"))
        wear = client.wear()
        self.assertEqual((wear.profile_erasures, wear.profile_erasures_promised, wear.stores_left), (0, 20_000, 16))
        travel = TravelLimit(resonance_uhz=60_000_000, quality_per_mille=2000, static_ppm=500_000)
        profile = ActuatorProfile("coil", 800, travel, CoilHeat(8000, 120_000, 1300), 600, 60_000, False)
        for setting in (profile, None):
            self.assert_refused(Choice("HoldButton"), lambda: client.write_profile(setting))
        client.hello(VERSION_1_2)
        with self.assertRaisesRegex(SliplineError, "Profile needs protocol 1.3, the device has 1.2"):
            client.profile()

    def test_a_device_without_inputs_says_so(self) -> None:
        inputs = self.client.inputs()
        self.assertEqual((inputs.inputs, inputs.lock_ins, inputs.lost_blocks), (0, 0, 0))
        self.assert_refused(Choice("NotSupported"), lambda: self.client.listen(10))
        self.assert_refused(Choice("NotSupported"), lambda: self.client.capture(10))
        self.assert_refused(Choice("NotSupported"), lambda: self.client.hold([HoldTone(0, 1000)], 400))
        self.assert_refused(Choice("NotSupported"), self.client.held)
        self.assert_refused(Choice("NotSupported"), self.client.end_hold)

    def test_a_plate_is_measured_through_the_inputs(self) -> None:
        server = self.enter(Server(False, "--plate", "membrane", "--sensor", "30mm"))
        client = self.client = self.enter(Client.at_socket(server.path))
        inputs = client.inputs()
        self.assertEqual((inputs.inputs, inputs.lock_ins, inputs.lost_blocks), (2, 16, 0))
        self.make_ready()
        tones = [CombTone(harmonic, 15000, 0) for harmonic in (8, 12, 20)]
        start = client.comb(40, tones)
        # 0.3 s: the plate has followed.
        settled = start + client.device.sample_rate_hz * 3 // 10
        first = client.listen(400, start=settled)
        second = client.listen(400, start=settled + 1200 * 128)
        self.assertEqual([answer is not None for answer in first], [True] * 3 + [False] * 13)
        for one, other in zip(first[:3], second[:3]):
            # Whole periods: the same answer, but for noise of 0.7 codes over 51200 of them.
            self.assertGreater(abs(one), 1)
            self.assertLess(abs(one - other), 0.05)
        captured = client.capture(100, log2_codes=4)
        self.assertEqual(len(captured), 100)
        self.assertLess(abs(sum(captured) / 100 - 2048), 1000)

    def test_the_kept_table(self) -> None:
        client = self.client
        self.make_ready()
        self.assert_refused(Choice("DisarmFirst"), client.store)
        client.disarm()
        self.assertTrue(client.store())
        self.assertFalse(client.store(), "it is kept already")
        kept = client.maintenance()
        self.assertEqual((kept.erasures, kept.erasures_promised, kept.brown_out_guarded), (1, 20_000, True))
        self.assertTrue(client.forget())
        self.assertFalse(client.forget())
        self.assertEqual(client.maintenance().erasures, 2)

    def test_the_kept_table_in_the_words_of_1_0(self) -> None:
        client = self.client
        client.hello(VERSION_1_0)
        self.make_ready()
        self.assert_refused(Choice("Armed"), client.store)
        client.disarm()
        for _ in range(2):
            self.assertTrue(client.store(), "1.0 has no word for what is kept already")
        with self.assertRaisesRegex(SliplineError, "Maintenance needs protocol 1.1, the device has 1.0"):
            client.maintenance()
        self.assert_refused(Choice("UnknownMessage", id=4), lambda: client.channel.request("Maintenance"))

    def test_table_with_a_wrong_crc(self) -> None:
        client, table = self.client, self.make_table()
        before = client.table().active
        for changed in (0, 1):
            header = table.header
            client.channel.request("TableBegin", type(header)(*list(vars(header).values())[:-1], header.crc ^ changed))
            for chunk in list(table.chunks())[:-1]:
                client.channel.request("TableChunk", chunk)
            staged = client.table().staged
            self.assertEqual(staged, len(table.knots) // 22 * 22)
            refusal = Choice("UploadIncomplete", received=staged)
            self.assert_refused(refusal, lambda: client.channel.request("TableCommit"))
            client.channel.request("TableChunk", list(table.chunks())[-1])
            if changed:
                self.assert_refused(Choice("TableCrc"), lambda: client.channel.request("TableCommit"))
            else:
                client.channel.request("TableCommit")
                self.assertEqual(client.table().active, table.header)
        self.assertNotEqual(before, table.header)
        self.assertEqual(client.table().active, table.header)

    def test_a_table_that_the_client_does_not_send(self) -> None:
        rate = self.client.device.sample_rate_hz
        with self.assertRaisesRegex(FieldError, r"knots\[2\].step must be strictly below"):
            Table.from_frequencies((0, 1000), rate, [900, 800, 850], [1, 1, 1])
        with self.assertRaisesRegex(FieldError, r"knots\[1\].gain must be an integer from 1 to 2147483648"):
            Table.from_frequencies((0, 1000), rate, [900, 800], [1, 1.1])
        with self.assertRaisesRegex(FieldError, "sample_rate_hz"):
            self.client.upload(Table.from_frequencies((0, 1000), rate + 1, [900, 800], [1, 1]))

    def test_the_device_disconnects(self) -> None:
        self.server.__exit__()
        began = time.monotonic()
        with self.assertRaises(Closed):
            self.client.status()
        self.assertLess(time.monotonic() - began, 1)

    def test_emergency_stop_and_clear_faults(self) -> None:
        client = self.client
        self.make_ready()
        client.drive([Tone(0, 32768, 40000, 0)])
        self.wait_for(lambda status: status.sum_per_mille > 0)
        client.emergency_stop()
        status = self.wait_for(lambda status: status.sum_per_mille == 0)
        self.assertEqual((status.state.name, fault_names(status.faults)), ("Fault", ["EmergencyStop"]))
        self.assertEqual(status.first_fault.name, "EmergencyStop")
        self.assertGreater(status.first_fault_at, 0)
        self.assert_refused(Choice("Faulted", faults=status.faults), client.arm)
        client.clear_faults()
        self.assertEqual(client.status().state.name, "Idle")
        client.arm()
        self.assertEqual(client.status().state.name, "Armed")


class AtTerminal(DriveCase):
    """The same over a pseudo-terminal, as over a serial port."""

    pty = True

    def test_drive_a_tone(self) -> None:
        self.drive_a_tone()


class Demonstration(unittest.TestCase):
    """The client as a program."""

    def run_client(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, str(Path(__file__).with_name("client.py")), *arguments]
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        return subprocess.run(command, timeout=30, text=True, **streams)

    def test_demonstration(self) -> None:
        with Server() as server:
            done = self.run_client("--socket", server.path, "--seconds", "0.6")
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertRegex(done.stdout, r"(?m)^Driving, at sample \d+, \d+\.\d % of full scale, faults \[\]$")

    def test_without_a_device(self) -> None:
        done = self.run_client("--socket", "/nonexistent/device")
        self.assertEqual(done.returncode, 1)
        self.assertIn("No such file", done.stdout)
        self.assertNotIn("Traceback", done.stdout)


if __name__ == "__main__":
    unittest.main()
