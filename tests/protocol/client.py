"""A client of the Slipline protocol for Python 3.9 or later, written from shared/PROTOCOL.md alone, without packages.

It shows that the page is all that a program needs. Offer a simulated device and drive a tone for two seconds:

    slipline serve --socket /tmp/slipline.sock &
    python3 tests/protocol/client.py --socket /tmp/slipline.sock

In a program of your own:

    from client import Client, Tone

    with Client.at_socket("/tmp/slipline.sock") as device:    # says hello, keeps alive; stops and disarms at the end
        device.upload(table)                                  # table.Table.from_frequencies(..)
        device.arm()
        device.drive([Tone(slot=0, position=32768, level=30000, phase=0)], glide=4000)

The files, from the wire up: `cobs`, `postcard`, `records`, `messages`, `frame`, `stream`, `channel`, `table`, this one;
and `codes`, which computes what a device plays.
"""
from __future__ import annotations

import argparse
import os
import threading
import time
from typing import Any, Callable, Optional, Sequence

from channel import Channel
from errors import FieldError, NoAnswer, Refused, SliplineError
from messages import (
    AT_TRIGGER, COMMANDS, EVENTS, NEXT_BLOCK, RECTANGULAR, VERSION_1_3, Accepted, ActuatorProfile, AnalogueEvent, ArmLease,
    BoardEvent, BrownOutEvent, BrownOutOrder, Capture, CaptureRead, Chord, ChordTone, ClockEvent, Comb, CombTone, DigestStart, Drive,
    FaultOrder, FaultTrialEvent, HeldEvent, Hello, HelloEvent, Hold, HoldTone, InputsEvent, KeepAlive, Listen, ListenRead, MaintenanceEvent, MutePinEvent, MuteStep, ProfileEvent,
    SetTravelLimit, StatusEvent, TableEvent, Tone, TravelLimit, TriggerEvent, Version, WearEvent, WriteProfile, at, fault_names,
)  # fmt: skip
from postcard import check_integer
from records import Choice
from stream import Stream
from table import Table

__all__ = [
    "AT_TRIGGER", "ChordTone", "Client", "CombTone", "HoldTone", "Refused", "SliplineError", "Table", "Tone", "at", "fault_names",
]  # fmt: skip

KEEP_ALIVE_S = 0.2
_FIRST_SESSION = 0


class Client:
    """A device and the session with it. Every method may raise `Refused`, `NoAnswer` or `Closed`."""

    def __init__(self, stream: Stream) -> None:
        """Says hello over a stream and keeps the session alive from then on."""
        self.channel = Channel(stream)
        self.keeps_alive = True
        """Whether keep-alives are sent, every 200 ms. Without them an armed device stops after a second."""
        self.minor = 0
        """The minor version that the two sides share."""
        self.keep_alive_error: Optional[Exception] = None
        """Why the last keep-alive failed, if it did."""
        self._beat = 0
        self._beating = threading.Lock()
        self._closing = threading.Event()
        try:
            # Ends whatever an earlier host has left unfinished.
            self.channel.send_bytes(b"\0")
            self.device = self.hello()
        except BaseException:
            self.channel.close()
            raise
        self._keeper = threading.Thread(target=self._keep, name="slipline-keep-alive", daemon=True)
        self._keeper.start()

    @classmethod
    def at_socket(cls, path: str) -> Client:
        """A device at a Unix socket."""
        return cls(Stream.to_socket(path))

    @classmethod
    def at_terminal(cls, path: str) -> Client:
        """A device at a serial port or a pseudo-terminal."""
        return cls(Stream.to_terminal(path))

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def hello(self, version: Version = VERSION_1_3, nonce: Optional[bytes] = None) -> HelloEvent:
        """Begins a new session, which ends the one before, and returns who the device is.

        From then on both speak the lower of the two minors: `minor`.
        """
        nonce = os.urandom(4) if nonce is None else nonce
        frame, device = self._request("Hello", "Hello", Hello(version, nonce), session=_FIRST_SESSION)
        with self._beating:
            self.channel.begin(frame.session)
            self._beat = 0
        self.minor = min(version.minor, device.version.minor)
        return device

    def keep_alive(self) -> StatusEvent:
        """Feeds the dead-man once."""
        with self._beating:
            self._beat += 1
            # A lost one is not repeated: the next one does the same.
            return self._request("KeepAlive", "Status", KeepAlive(self._beat), repeats=0)[1]

    def status(self) -> StatusEvent:
        """The state, the faults and the counters."""
        return self._request("Status", "Status")[1]

    def arm(self) -> int:
        """Unmutes the amplifier, once nothing sounds any more. Returns the index from which it holds."""
        return self._patiently("DriveActive", 0.01, lambda: self._accepted("Arm"))

    def arm_for(self, lease_ms: int) -> int:
        """The same on a lease of 1000 to 600000 ms: without a drive for so long the device disarms by itself. Raises
        `FieldError`, and `SliplineError` with a device older than 1.3.
        """
        return self._patiently("DriveActive", 0.01, lambda: self._accepted("ArmFor", ArmLease(lease_ms)))

    def bench(self, lease_ms: int) -> int:
        """As `arm_for`, but the mute pin stays low until the device is disarmed. Raises as `arm_for`."""
        return self._patiently("DriveActive", 0.01, lambda: self._accepted("Bench", ArmLease(lease_ms)))

    def disarm(self) -> int:
        """Ramps to silence and mutes."""
        return self._accepted("Disarm")

    def drive(
        self, tones: Sequence[Tone], *, master: int = 0, glide: Optional[int] = None, apply: Choice = NEXT_BLOCK
    ) -> int:
        """Sounds these tones, and only these, from an index on.

        `master` is in 1/100 dB, -9600 to 0. `glide` is in samples, from `min_glide` to `max_glide` of `device`; the
        shortest if it is not given. `apply` is `NEXT_BLOCK`, `at(index)`, or `AT_TRIGGER`: then the index is the one
        from which on a rise of the trigger input counts. Raises `FieldError`, and `SliplineError` for `AT_TRIGGER` with a
        device of 1.0.
        """
        if apply == AT_TRIGGER and self.minor < 1:
            raise SliplineError(f"AtTrigger needs protocol 1.1, the device has 1.{self.minor}")
        glide = self.device.min_glide if glide is None else glide
        check_integer(glide, self.device.min_glide, self.device.max_glide, "Drive.glide")
        drive = Drive(tuple(tones), master, glide, apply)
        return self._patiently("CommitPending", 0.001, lambda: self._accepted("Drive", drive))

    def chord(
        self,
        period_log2: int,
        tones: Sequence[ChordTone],
        *,
        master: int = 0,
        glide: Optional[int] = None,
        apply: Choice = NEXT_BLOCK,
    ) -> int:
        """Sounds multiples of `sample_rate_hz / 2**period_log2` from an index on, once nothing else sounds.

        The device takes amplitudes that add up to more than 1 if the peak of a period, which it renders first, does not
        exceed full scale; else it refuses with `Peak`. The other arguments are those of `drive`. Raises `FieldError`, and
        `SliplineError` with a device older than 1.2.
        """
        return self._risen("Chord", Chord(period_log2, tuple(tones), master, self._glide("Chord", glide), apply))

    def comb(
        self,
        period_blocks: int,
        tones: Sequence[CombTone],
        *,
        master: int = 0,
        glide: Optional[int] = None,
        apply: Choice = NEXT_BLOCK,
    ) -> int:
        """Sounds multiples of `sample_rate_hz / (128 * period_blocks)` from an index on, once nothing else sounds: within
        the table's frequencies or beyond them. The other arguments are those of `drive`. Raises `FieldError`, and
        `SliplineError` with a device older than 1.3.
        """
        return self._risen("Comb", Comb(period_blocks, tuple(tones), master, self._glide("Comb", glide), apply))

    def inputs(self) -> InputsEvent:
        """What the inputs can do. Raises `SliplineError` with a device older than 1.3."""
        return self._request("Inputs", "Inputs")[1]

    def listen(
        self, blocks: int, *, slots: int = 0xFFFF, input: int = 0, shape: Choice = RECTANGULAR, start: Optional[int] = None
    ) -> list[Optional[complex]]:
        """The answer of an input to each slot's tone over `blocks` blocks from the index `start` on: a complex amplitude in
        codes against the tone's sine, None for a tone that stopped or restarted. Waits until the window is over. Raises
        `SliplineError` with a device older than 1.3, and if a block was lost.
        """
        begin = self._accepted("Listen", Listen(start, blocks, shape, slots, input))
        self._wait_for_index(begin + 128 * blocks)
        answers: list[Optional[complex]] = []
        for first in (0, 8):
            read_out = self._until_over(lambda: self._request("ListenRead", "Listened", ListenRead(input, first))[1])
            scale = 4 / (16383 * 128 * read_out.weight)
            for slot, sums in enumerate(read_out.answers, first):
                heard = complex(sums.in_phase, sums.quadrature) * scale
                answers.append(heard if read_out.followed >> slot & 1 else None)
        return answers

    def capture(self, values: int, *, input: int = 0, log2_codes: int = 0, start: Optional[int] = None) -> list[float]:
        """`values` means of `2**log2_codes` codes of an input from the index `start` on; 2048 is mid-scale. Waits until they
        exist. Raises `SliplineError` with a device older than 1.3, and if a block was lost."""
        begin = self._accepted("Capture", Capture(start, input, log2_codes, values))
        self._wait_for_index(begin + (values << log2_codes))
        sums: list[int] = []
        while len(sums) < values:
            read_out = self._until_over(lambda: self._request("CaptureRead", "Captured", CaptureRead(len(sums)))[1])
            sums.extend(read_out.values)
        return [value / 2**log2_codes for value in sums]

    def hold(
        self,
        tones: Sequence[HoldTone],
        blocks: int,
        *,
        input: int = 0,
        time_constant: int = 0,
        max_rise: int = 1200,
        slew: int = 602,
    ) -> int:
        """Holds the measured amplitudes of tones that sound, with windows of `blocks` blocks; returns the first window's first
        sample. `time_constant` is the plate's in samples; `max_rise` above the drive's level and `slew` from window to window
        are in 1/100 dB. Raises `FieldError`, and `SliplineError` with a device older than 1.3.
        """
        hold = Hold(input, time_constant, blocks, max_rise, slew, tuple(tones))
        return self._patiently("CommitPending", 0.001, lambda: self._accepted("Hold", hold))

    def end_hold(self) -> int:
        """Ends the hold: the levels return to those of the drive. Raises `SliplineError` with a device older than 1.3."""
        return self.hold((), 1)

    def held(self) -> HeldEvent:
        """How the hold stands. Raises `SliplineError` with a device older than 1.3."""
        return self._request("HoldRead", "Held")[1]

    def stop(self) -> int:
        """Ramps to silence; the device stays armed."""
        return self._accepted("Stop")

    def emergency_stop(self) -> int:
        """Ramps to silence at once, mutes, and latches a fault."""
        return self._accepted("EmergencyStop")

    def clear_faults(self) -> int:
        """Clears the latched faults whose cause is gone."""
        return self._accepted("ClearFaults")

    def upload(self, table: Table) -> int:
        """Puts a table in force. Raises `FieldError` if it is made for another device."""
        if table.sample_rate_hz != self.device.sample_rate_hz:
            raise FieldError("Table.sample_rate_hz", f"the device's {self.device.sample_rate_hz}", table.sample_rate_hz)
        check_integer(len(table.knots), 2, self.device.max_knots, "the number of Table.knots")
        self._patiently("TableInUse", 0.01, lambda: self._accepted("TableBegin", table.header))
        for chunk in table.chunks():
            self._accepted("TableChunk", chunk)
        return self._patiently("TableInUse", 0.01, lambda: self._accepted("TableCommit"))

    def table(self) -> TableEvent:
        """Which table is in force."""
        return self._request("TableDigest", "Table")[1]

    def digest(self, start: int, count: int) -> int:
        """The CRC-32 of `count` DAC codes from the index `start`, which lies ahead. Waits until they are played."""
        self._accepted("DigestStart", DigestStart(start, count))
        rate = self.device.sample_rate_hz
        until = time.monotonic() + max(0, start + count - self.status().now) / rate + 5
        while time.monotonic() < until:
            digest = self._request("DigestRead", "Digest")[1]
            if digest.crc is not None:
                return digest.crc
            time.sleep(0.01)
        raise NoAnswer(f"the codes {start} to {start + count} have not been played in time")

    def store(self) -> bool:
        """Keeps the table in force in flash; the device must be disarmed. Returns whether the device says that it has
        written: one of 1.1 does not write again what it keeps already, one of 1.0 does not report that."""
        return self._written("Store")

    def forget(self) -> bool:
        """Erases what is kept in flash; the device must be disarmed. Returns whether the device says that it has
        written."""
        return self._written("Forget")

    def board(self) -> BoardEvent:
        """What the device has found on its board. Raises `SliplineError` with a device older than 1.3."""
        return self._request("Board", "Board")[1]

    def analogue(self) -> AnalogueEvent:
        """What the start has found of the analogue supply. Raises `SliplineError` with a device older than 1.3."""
        return self._request("Analogue", "Analogue")[1]

    def mute_pin(self, trial: str = "Read") -> MutePinEvent:
        """The mute pin, read back; a trial (`Lapse`, `Break`) takes it low and disarms. Raises `SliplineError` with a device older
        than 1.3."""
        return self._request("MutePin", "MutePin", MuteStep(Choice(trial)))[1]

    def clock(self) -> ClockEvent:
        """Sample index, cycle counter and USB frame at one moment. Raises `SliplineError` with a device older than 1.3."""
        return self._request("Clock", "Clock")[1]

    def stall(self) -> int:
        """Stops the DAC's DMA for 1 ms, on the bench: the device counts an underrun. Raises `SliplineError` with a device older than 1.3."""
        return self._accepted("Stall")

    def profile(self) -> ProfileEvent:
        """The profile of the actuator that is in force. Raises `SliplineError` with a device older than 1.3."""
        return self._request("Profile", "Profile")[1]

    def write_profile(self, profile: Optional[ActuatorProfile]) -> int:
        """Keeps a profile of the actuator in the device's flash, or erases it. The device refuses with `HoldButton` while the user
        button on its board is not pressed. Raises `FieldError`, and `SliplineError` with a device older than 1.3."""
        return self._accepted("WriteProfile", WriteProfile(profile))

    def brown_out(self, write: bool = False) -> BrownOutEvent:
        """The level of the brown-out reset; with `write`, the one that the board needs is written and the device restarts. The device
        refuses that with `HoldButton` while the user button on its board is not pressed. Raises `SliplineError` with a device older
        than 1.3."""
        return self._request("BrownOut", "BrownOut", BrownOutOrder(write))[1]

    def fault_trial(self) -> FaultTrialEvent:
        """The token of a fault on purpose, and how the last one ended. Raises `SliplineError` with a device older than 1.3."""
        return self._request("FaultToken", "FaultTrial")[1]

    def order_fault(self, fault: str) -> int:
        """Makes an armed, silent device fail on purpose (`Hang`, `MaskedInterrupts`, `StackOverflow`); it resets 0.1 to 0.7 s later.
        Raises `SliplineError` with a device older than 1.3."""
        return self._accepted("FaultOrder", FaultOrder(Choice(fault), self.fault_trial().token))

    def wear(self) -> WearEvent:
        """The wear of the profile's flash, and the tables that may be stored now. Raises `SliplineError` with a device older than
        1.3."""
        return self._request("Wear", "Wear")[1]

    def maintenance(self) -> MaintenanceEvent:
        """The wear of the flash, and whether the supply is guarded. Raises `SliplineError` with a device of 1.0."""
        return self._request("Maintenance", "Maintenance")[1]

    def limit_travel(self, limit: Optional[TravelLimit]) -> None:
        """Limits the actuator's travel until the next hello, or sets it free again; only while nothing sounds. Raises
        `SliplineError` with a device of 1.0."""
        self._request("SetTravelLimit", "TravelLimit", SetTravelLimit(limit))

    def travel_limit(self) -> Optional[TravelLimit]:
        """The limit of the travel that is in force, if there is one. Raises `SliplineError` with a device of 1.0."""
        return self._request("TravelLimit", "TravelLimit")[1].limit

    def trigger(self) -> TriggerEvent:
        """How the drive stands that waits for the trigger input. Raises `SliplineError` with a device of 1.0."""
        return self._request("Trigger", "Trigger")[1]

    def close(self) -> None:
        """Stops, disarms and closes the stream; what fails on the way is left to the device's dead-man. Again does nothing."""
        if self._closing.is_set():
            return
        self._closing.set()
        self._keeper.join(timeout=5)
        for last in (self.stop, self.disarm):
            try:
                last()
            except SliplineError:
                pass
        self.channel.close()

    def _request(
        self, command: str, answer: str, value: Any = None, or_answer: Optional[str] = None, **options: Any
    ) -> tuple[Any, Any]:
        if COMMANDS[command].since > self.minor:
            raise SliplineError(f"{command} needs protocol 1.{COMMANDS[command].since}, the device has 1.{self.minor}")
        frame, event = self.channel.request(command, value, **options)
        if frame.id not in (EVENTS[answer].id, EVENTS[or_answer or answer].id):
            raise SliplineError(f"{command} was answered by the message {frame.id:#04x}, not by {answer}")
        return frame, event

    def _glide(self, command: str, glide: Optional[int]) -> int:
        glide = self.device.min_glide if glide is None else glide
        check_integer(glide, self.device.min_glide, self.device.max_glide, f"{command}.glide")
        return glide

    def _risen(self, command: str, value: Any) -> int:
        """Has something rise from silence, once what sounds has faded."""
        ready = lambda: self._patiently("CommitPending", 0.001, lambda: self._accepted(command, value))
        return self._patiently("DriveActive", 0.01, ready)

    def _wait_for_index(self, index: int) -> None:
        """Waits until the device's clock has passed an index."""
        while (left := index - self.status().now) > 0:
            time.sleep(left / self.device.sample_rate_hz + 0.001)

    def _until_over(self, read: Callable[[], Any]) -> Any:
        """Reads a measurement that should be over until it is; the device takes its last block a moment later."""
        until = time.monotonic() + 5
        while (read_out := read()).progress.name == "Running":
            if time.monotonic() > until:
                raise NoAnswer("the measurement is not over in time")
            time.sleep(0.01)
        if read_out.progress.name != "Finished":
            raise SliplineError(f"the measurement has ended early: {read_out.progress}")
        return read_out

    def _accepted(self, command: str, value: Any = None) -> int:
        accepted: Accepted = self._request(command, "Accepted", value, or_answer="AcceptedUntil")[1]
        return accepted.at

    def _written(self, command: str) -> bool:
        """Has the flash written, once the amplifier is off: that takes some milliseconds after `disarm`."""
        frame, _ = self._patiently("DriveActive", 0.01, lambda: self.channel.request(command))
        if frame.id not in (EVENTS["Accepted"].id, EVENTS["Unchanged"].id):
            raise SliplineError(f"{command} was answered by the message {frame.id:#04x}")
        return frame.id == EVENTS["Accepted"].id

    def _patiently(self, busy: str, pause_s: float, act: Callable[[], Any]) -> Any:
        """Acts again, as a new command, while the device is busy with this; at most for 2 s."""
        until = time.monotonic() + 2
        while True:
            try:
                return act()
            except Refused as error:
                if error.refusal != Choice("Busy", value=Choice(busy)) or time.monotonic() > until:
                    raise
            time.sleep(pause_s)

    def _keep(self) -> None:
        while not self._closing.wait(KEEP_ALIVE_S):
            if not self.keeps_alive:
                continue
            try:
                self.keep_alive()
                self.keep_alive_error = None
            except SliplineError as error:
                self.keep_alive_error = error


def demonstration_table(sample_rate_hz: int) -> Table:
    """A table whose frequency falls from 2000 Hz to 500 Hz along 200 mm, at the same gain everywhere."""
    count = 101
    frequencies = [2000 * 4 ** (-index / (count - 1)) for index in range(count)]
    return Table.from_frequencies((50_000, 250_000), sample_rate_hz, frequencies, [0.5] * count)


def demonstrate(device: Client, seconds: float) -> None:
    """Drives a tone that glides along the plate, and prints the device's answers."""
    who = device.device
    version = ".".join(str(number) for number in who.firmware)
    kind = "simulated" if who.simulated else "connected to a plate"
    print(f"{who.board}, {kind}, firmware {version}, {who.sample_rate_hz} Hz, {who.tones} tones")
    table = demonstration_table(who.sample_rate_hz)
    in_force = device.table().active
    if in_force is None or in_force.crc != table.crc:
        print(f"table {table.crc:08x} in force from sample {device.upload(table)}")
    if device.status().faults:
        device.clear_faults()
    device.arm()
    print(f"tone at 1/4 of the span from sample {device.drive([Tone(0, 16384, 30000, 0)], master=-600)}")
    half = round(seconds / 2 * who.sample_rate_hz)
    time.sleep(seconds / 2)
    start = device.drive([Tone(0, 49152, 30000, 0)], master=-600, glide=min(max(half, who.min_glide), who.max_glide))
    print(f"gliding to 3/4 of the span from sample {start}")
    time.sleep(seconds / 2)
    status = device.status()
    faults = fault_names(status.faults)
    print(f"{status.state}, at sample {status.now}, {status.sum_per_mille / 10} % of full scale, faults {faults}")
    print(f"silence begins at sample {device.stop()}")


def main() -> None:
    """Drives the device that the command line names."""
    parser = argparse.ArgumentParser(description="Drives a tone that glides along the plate of a Slipline device.")
    place = parser.add_mutually_exclusive_group(required=True)
    place.add_argument("--socket", metavar="PATH", help="a Unix socket, as `slipline serve --socket PATH` offers it")
    place.add_argument("--terminal", metavar="PATH", help="a serial port, or what `slipline serve --pty` prints")
    parser.add_argument("--seconds", type=float, default=2.0, help="how long the tone sounds, 0.1 to 60 (default 2)")
    arguments = parser.parse_args()
    if not 0.1 <= arguments.seconds <= 60:
        parser.error(f"--seconds must be from 0.1 to 60, not {arguments.seconds}")
    try:
        device = Client.at_socket(arguments.socket) if arguments.socket else Client.at_terminal(arguments.terminal)
        with device:
            demonstrate(device, arguments.seconds)
    except (SliplineError, OSError) as error:
        parser.exit(1, f"{parser.prog}: {error}\n")


if __name__ == "__main__":
    main()
