"""The messages of protocol 1.3, as PROTOCOL.md lists them: fields in the order of the wire, types and ranges.

What stands since 1.1 or later is named so: it goes to no device that is older, and none sends it.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional

from errors import DecodeError
from postcard import BOOL, I16, I64, U8, U16, U32, U64, Array, List, Option, Reader, Text
from records import Choice, Enumeration, Fields, Record, field

# ------------------------------------------------------------------------------------------ enumerations

APPLY = Enumeration(
    "Apply", "Next", ("At", {"value": U64}),
    "AtTrigger",  # since 1.1
)  # fmt: skip
BUSY = Enumeration(
    "Busy", "CommitPending", "DriveActive", "TableInUse", "DigestPending",
    "Holding",  # since 1.3
)  # fmt: skip
FAULT = Enumeration(
    "Fault", "HostLost", "EmergencyStop", "Underrun", "Overheat", "DriveTime", "Watchdog", "Crash", "BrownOut",
    "StoreDamaged",
    "StoreFellBack",  # since 1.1
    "DeskStop",  # since 1.3
    "ProfileFellBack",  # since 1.3
)  # fmt: skip
SAMPLE_CLOCK = Enumeration("SampleClock", "Exact", "Internal")  # since 1.3
MUTE_RESISTOR = Enumeration("MuteResistor", "NotLooked", "Present", "Missing")  # since 1.3
USER_BUTTON = Enumeration("UserButton", "None", "Released", "Pressed")  # since 1.3
STOP_INPUT = Enumeration("StopInput", "Unused", "Closed", "Open", "NotInProfile")  # since 1.3
MUTE_TRIAL = Enumeration("MuteTrial", "Read", "Lapse", "Break")  # since 1.3
ORDERED_FAULT = Enumeration("OrderedFault", "Hang", "MaskedInterrupts", "StackOverflow")  # since 1.3
PIN_LEVEL = Enumeration("PinLevel", "NoPin", "Low", "High")  # since 1.3
FIELD = Enumeration(
    "Field", "ToneCount", "ToneSlot", "MasterLevel", "Glide", "ApplyAt", "KnotCount", "KnotStep", "KnotGain",
    "ChunkFirst", "SampleRate", "Span", "DigestCount",
    "Resonance", "Quality", "StaticTravel",  # since 1.1
    "ChordPeriod", "Harmonic",  # since 1.2
    "CombPeriod", "WindowBlocks", "LockIns", "Input", "CaptureCodes", "CaptureValues",  # since 1.3
    "TimeConstant", "MaxRise", "Slew", "HeldAmplitude", "Lease",  # since 1.3
    "ProfileSum", "CoilTime", "FullSine", "DriveTime", "ReferenceVoltage", "ReadProtection",  # since 1.3
)  # fmt: skip
REFUSAL = Enumeration(
    "Refusal",
    ("UnknownMessage", {"id": U8}),
    "Malformed",
    "StaleSession",
    ("BadSequence", {"expected": U16}),
    "VersionMismatch",
    "NotArmed",
    ("Faulted", {"faults": U32}),
    ("Busy", {"value": BUSY}),
    ("OutOfRange", {"field": FIELD, "min": I64, "max": I64, "got": I64}),
    ("SlotTwice", {"slot": U8}),
    ("Headroom", {"sum_per_mille": U16}),
    "NoTable",
    "NoUpload",
    ("ChunkOrder", {"expected": U16}),
    ("UploadIncomplete", {"received": U16}),
    "TableCrc",
    ("NotMonotonic", {"knot": U16}),
    "BadToken",
    "NotSupported",
    "StoreFailed",
    "Armed",
    "SafeMode",
    "NoDigest",
    "DisarmFirst",  # since 1.1
    ("Travel", {"travel_per_mille": U16, "allowed_per_mille": U16}),  # since 1.1
    ("Peak", {"peak_per_mille": U16}),  # since 1.2
    ("SilentTone", {"slot": U8}),  # since 1.3
    "HoldButton",  # since 1.3
    ("StoresSpent", {"wait_s": U16}),  # since 1.3
    "NoClock",  # since 1.3
)
RESET_CAUSE = Enumeration("ResetCause", "PowerOn", "Pin", "Software", "Watchdog", "BrownOut", "Panic", "HardFault")
STATE = Enumeration(
    "State", "Idle", "Armed", "Driving", "Stopping", "Fault", "SafeMode",
    "Waiting",  # since 1.1
)  # fmt: skip
STORED_CONFIG = Enumeration("StoredConfig", "Empty", "Loaded", "WrongVersion", "Damaged", "FellBack")
PROGRESS = Enumeration("Progress", "Idle", "Running", "Finished", ("Broken", {"at": U64}))
WINDOW_SHAPE = Enumeration("WindowShape", "Rectangular", "Hann")
HOLD_PROGRESS = Enumeration("HoldProgress", "Off", "On", "Ended", "Lost")
HOLD_LIMIT = Enumeration("HoldLimit", "Rise", "Level", "Headroom", "Thermal", "Travel", "Fall")
HOLD_LOSS = Enumeration("HoldLoss", "NotFollowed", "TooWeak", "Clipped", "Stuck", "Broken", "AtRise")
HOLD_STATE = Enumeration(
    "HoldState", "Settling", "Held", ("AtLimit", {"value": HOLD_LIMIT}), ("Lost", {"value": HOLD_LOSS})
)

NEXT_BLOCK = Choice("Next")
AT_TRIGGER = Choice("AtTrigger")
RECTANGULAR = Choice("Rectangular")
HANN = Choice("Hann")


def at(index: int) -> Choice:
    """Begin at this index of the device's clock, not at the next block."""
    return Choice("At", value=index)


def fault_names(bits: int) -> list[str]:
    """The names of the faults in a word of latched faults."""
    return [FAULT[number] for number in range(len(FAULT.variants)) if bits >> number & 1]


# ------------------------------------------------------------------------------------------ types with fields


@dataclass(frozen=True)
class Version(Record):
    """A version of the protocol."""

    major: int = field(U8)
    minor: int = field(U8)
    schema: bytes = field(Array(4, U8))


VERSION_1_0 = Version(1, 0, bytes.fromhex("e7457e07"))
VERSION_1_1 = Version(1, 1, VERSION_1_0.schema)
VERSION_1_2 = Version(1, 2, VERSION_1_0.schema)
VERSION_1_3 = Version(1, 3, VERSION_1_0.schema)


@dataclass(frozen=True)
class Tone(Record):
    """A tone of a drive: `position` in 1/65535 of the span, `level` in 1/65535, `phase` in 1/65536 turn."""

    slot: int = field(U8, 0, 15)
    position: int = field(U16)
    level: int = field(U16)
    phase: int = field(U16)


@dataclass(frozen=True)
class ChordTone(Record):
    """A tone of a chord: `harmonic` counts the base frequency, `level` in 1/65535, `phase` in 1/65536 turn. Since 1.2."""

    harmonic: int = field(U16, 1, 7372)
    level: int = field(U16)
    phase: int = field(U16)


@dataclass(frozen=True)
class CombTone(Record):
    """A tone of a comb: `harmonic` counts the base frequency, `level` in 1/65535, `phase` in 1/65536 turn. Since 1.3."""

    harmonic: int = field(U16, 1, 65535)
    level: int = field(U16)
    phase: int = field(U16)


@dataclass(frozen=True)
class InPhaseQuadrature(Record):
    """How an input answers one tone: along its sine and along its cosine. Since 1.3."""

    in_phase: int = field(I64)
    quadrature: int = field(I64)


@dataclass(frozen=True)
class HoldTone(Record):
    """A tone to hold, and its amplitude at the input in 1/256 code. Since 1.3."""

    slot: int = field(U8, 0, 15)
    amplitude: int = field(U32, 16, 2047 << 8)


@dataclass(frozen=True)
class HeldTone(Record):
    """A held tone: `correction` in 1/100 dB, `amplitude` as the last window measured it in 1/256 code. Since 1.3."""

    slot: int = field(U8, 0, 15)
    state: Choice = field(HOLD_STATE)
    correction: int = field(I16)
    amplitude: int = field(U32)


@dataclass(frozen=True)
class Knot(Record):
    """A knot of the table: `step` in 2^-32 turns per sample, `gain` in 2^-31 of the DAC's half swing."""

    step: int = field(U32, 1, 1932735283)
    gain: int = field(U32, 1, 1 << 31)


@dataclass(frozen=True)
class TableHeader(Record):
    """What a table is made for. `crc` covers this and all knots (`table.Table` computes it)."""

    knots: int = field(U16, 2, 1025)
    span_start_um: int = field(U32)
    span_end_um: int = field(U32)
    sample_rate_hz: int = field(U32)
    crc: int = field(U32)


@dataclass(frozen=True)
class TravelLimit(Record):
    """How an actuator moves, against its peak travel. Since 1.1."""

    resonance_uhz: int = field(U64, 100_000, 10_000_000_000_000)
    quality_per_mille: int = field(U32, 100, 1_000_000)
    static_ppm: int = field(U32, 1, 1_000_000_000)


@dataclass(frozen=True)
class CoilHeat(Record):
    """How an actuator's coil warms. Since 1.3."""

    winding_ms: int = field(U32, 1000, 3_600_000)
    body_ms: int = field(U32, 1000, 3_600_000)
    full_sine_per_mille: int = field(U16, 10, 20_000)


@dataclass(frozen=True)
class ActuatorProfile(Record):
    """What an actuator bears; the device itself keeps these limits. Since 1.3."""

    name: str = field(Text(24))
    max_sum_per_mille: int = field(U16, 1, 1000)
    travel: Optional[TravelLimit] = field(Option(Fields(TravelLimit)))
    heat: CoilHeat = field(Fields(CoilHeat))
    max_rise: int = field(I16, 0, 2000)
    max_drive_ms: int = field(U32, 1000, 600_000)
    has_stop_input: bool = field(BOOL)


@dataclass(frozen=True)
class WriteProfile(Record):
    """Keeps a profile of the actuator, or erases it. Since 1.3."""

    profile: Optional[ActuatorProfile] = field(Option(Fields(ActuatorProfile)))


@dataclass(frozen=True)
class Counters(Record):
    """Counters since the reset."""

    frames: int = field(U32)
    crc_errors: int = field(U32)
    overlong: int = field(U32)
    duplicates: int = field(U32)
    dropped: int = field(U32)
    underruns: int = field(U32)
    clips: int = field(U32)
    max_cycles: int = field(U32)


# ------------------------------------------------------------------------------------------ bodies


@dataclass(frozen=True)
class Hello(Record):
    """Asks who the device is and begins a session."""

    version: Version = field(Fields(Version))
    nonce: bytes = field(Array(4, U8))


@dataclass(frozen=True)
class KeepAlive(Record):
    """Says that the host is alive."""

    beat: int = field(U32)


@dataclass(frozen=True)
class Drive(Record):
    """Sounds these tones: `master` in 1/100 dB, `glide` in samples."""

    tones: tuple[Tone, ...] = field(List(16, Fields(Tone)))
    master: int = field(I16, -9600, 0)
    glide: int = field(U32)
    apply: Choice = field(APPLY)


@dataclass(frozen=True)
class ArmLease(Record):
    """How long the device stays armed, or on the bench, without a drive. Since 1.3."""

    lease_ms: int = field(U32, 1000, 600000)


@dataclass(frozen=True)
class MuteStep(Record):
    """How the mute pin is to go low. Since 1.3."""

    trial: Choice = field(MUTE_TRIAL)


@dataclass(frozen=True)
class BrownOutOrder(Record):
    """Whether the level of the brown-out reset that the board needs is written, or the present one only read. Since 1.3."""

    is_written: bool = field(BOOL)


@dataclass(frozen=True)
class FaultOrder(Record):
    """A fault on purpose, with the token that lets the device make it. Since 1.3."""

    fault: Choice = field(ORDERED_FAULT)
    token: int = field(U32)


@dataclass(frozen=True)
class Chord(Record):
    """Sounds multiples of the sample rate over `1 << period_log2`: `master` in 1/100 dB, `glide` in samples. Since 1.2."""

    period_log2: int = field(U8, 7, 14)
    tones: tuple[ChordTone, ...] = field(List(16, Fields(ChordTone)))
    master: int = field(I16, -9600, 0)
    glide: int = field(U32)
    apply: Choice = field(APPLY)


@dataclass(frozen=True)
class Comb(Record):
    """Sounds multiples of the sample rate over `128 * period_blocks`: `master` in 1/100 dB, `glide` in samples. Since 1.3."""

    period_blocks: int = field(U16, 1, 65535)
    tones: tuple[CombTone, ...] = field(List(16, Fields(CombTone)))
    master: int = field(I16, -9600, 0)
    glide: int = field(U32)
    apply: Choice = field(APPLY)


@dataclass(frozen=True)
class TableChunk(Record):
    """The next knots of the upload."""

    first: int = field(U16)
    knots: tuple[Knot, ...] = field(List(22, Fields(Knot)))


@dataclass(frozen=True)
class SetTravelLimit(Record):
    """Limits the actuator's travel, or sets it free again. Since 1.1."""

    limit: Optional[TravelLimit] = field(Option(Fields(TravelLimit)))


@dataclass(frozen=True)
class DigestStart(Record):
    """Orders a CRC-32 over the DAC codes of a window that lies ahead."""

    from_: int = field(U64)
    count: int = field(U32, 1, 1 << 20)


@dataclass(frozen=True)
class Listen(Record):
    """Measures how an input, or all, answer the tones of these slots (bits), over `blocks` blocks from an index on. Since 1.3."""

    from_: Optional[int] = field(Option(U64))
    blocks: int = field(U16, 1, 65535)
    shape: Choice = field(WINDOW_SHAPE)
    slots: int = field(U16)
    input: Optional[int] = field(Option(U8))


@dataclass(frozen=True)
class ListenRead(Record):
    """Asks for eight slots of an input's answers. Since 1.3."""

    input: int = field(U8)
    first_slot: int = field(U8, 0, 15)


@dataclass(frozen=True)
class Capture(Record):
    """Captures sums of `1 << log2_codes` codes of an input from an index on. Since 1.3."""

    from_: Optional[int] = field(Option(U64))
    input: int = field(U8)
    log2_codes: int = field(U8, 0, 10)
    values: int = field(U16, 1, 4096)


@dataclass(frozen=True)
class CaptureRead(Record):
    """Asks for captured values from one on. Since 1.3."""

    first: int = field(U16)


@dataclass(frozen=True)
class Hold(Record):
    """Holds the measured amplitudes of these tones, with windows of `blocks` blocks: `time_constant` of the plate in samples,
    `max_rise` above the drive's level and `slew` from window to window in 1/100 dB. No tones: the hold ends. Since 1.3."""

    input: int = field(U8)
    time_constant: int = field(U32)
    blocks: int = field(U16, 1, 65535)
    max_rise: int = field(I16, 0, 2000)
    slew: int = field(I16, 1, 6020)
    tones: tuple[HoldTone, ...] = field(List(16, Fields(HoldTone)))


@dataclass(frozen=True)
class HelloEvent(Record):
    """Who the device is."""

    version: Version = field(Fields(Version))
    firmware: bytes = field(Array(3, U8))
    board: str = field(Text(24))
    build: str = field(Text(24))
    unit: bytes = field(Array(12, U8))
    simulated: bool = field(BOOL)
    sample_rate_hz: int = field(U32)
    block: int = field(U16)
    dac_bits: int = field(U8)
    tones: int = field(U8)
    max_knots: int = field(U16)
    min_glide: int = field(U32)
    max_glide: int = field(U32)
    dead_man_ms: int = field(U32)
    reset: Choice = field(RESET_CAUSE)
    stored: Choice = field(STORED_CONFIG)
    crash: str = field(Text(96))


@dataclass(frozen=True)
class StatusEvent(Record):
    """State, faults and counters."""

    state: Choice = field(STATE)
    faults: int = field(U32)
    first_fault: Optional[Choice] = field(Option(FAULT))
    first_fault_at: int = field(U64)
    now: int = field(U64)
    sum_per_mille: int = field(U16)
    heat_per_mille: int = field(U16)
    foldback_per_mille: int = field(U16)
    foldback_before_per_mille: tuple[int, ...] = field(Array(3, U16))
    foldback_changes: int = field(U32)
    table_crc: int = field(U32)
    counters: Counters = field(Fields(Counters))


@dataclass(frozen=True)
class Accepted(Record):
    """Done, or will be done at this index."""

    at: int = field(U64)


@dataclass(frozen=True)
class AcceptedUntil(Record):
    """As `Accepted`, of a drive whose glide takes longer than asked: it ends at `until`. Since 1.3."""

    at: int = field(U64)
    until: int = field(U64)


@dataclass(frozen=True)
class MaintenanceEvent(Record):
    """The wear of the flash, and whether the supply is guarded. Since 1.1."""

    erasures: int = field(U32)
    erasures_promised: int = field(U32)
    brown_out_guarded: bool = field(BOOL)


@dataclass(frozen=True)
class WearEvent(Record):
    """The wear of the profile's flash, and the tables that may be stored now. Since 1.3."""

    profile_erasures: int = field(U32)
    profile_erasures_promised: int = field(U32)
    stores_left: int = field(U8, 0, 16)


@dataclass(frozen=True)
class BoardEvent(Record):
    """What the device has found on its board. Since 1.3."""

    core_hz: int = field(U32)
    mute_resistor: Choice = field(MUTE_RESISTOR)
    user_button: Choice = field(USER_BUTTON)
    stop_input: Choice = field(STOP_INPUT)
    trigger_input: bool = field(BOOL)
    sample_clock: Choice = field(SAMPLE_CLOCK)


@dataclass(frozen=True)
class AnalogueEvent(Record):
    """What the start has found of the analogue supply. Since 1.3."""

    reference_mv: int = field(U16)
    linear_per_mille: int = field(U16, 1, 1000)
    brown_out_level: Optional[int] = field(Option(U8))
    chip: int = field(U16)
    revision: int = field(U16)
    ram_errors: Optional[int] = field(Option(U8))


@dataclass(frozen=True)
class MuteFall(Record):
    """When the mute pin went low in a trial. Since 1.3."""

    low_after_us: int = field(U32)
    within_us: int = field(U32)


@dataclass(frozen=True)
class MutePinEvent(Record):
    """The mute pin's level, and how long it took to go low. Since 1.3."""

    level: Choice = field(PIN_LEVEL)
    is_on_bench: bool = field(BOOL)
    fall: Optional[MuteFall] = field(Option(Fields(MuteFall)))


@dataclass(frozen=True)
class UsbFrame(Record):
    """A frame of the USB: its number, and the cycle counter when it began. Since 1.3."""

    number: int = field(U16, 0, 2047)
    cycles: int = field(U32)


@dataclass(frozen=True)
class ClockEvent(Record):
    """Sample index, cycle counter and USB frame at one moment. Since 1.3."""

    at: int = field(U64)
    cycles: int = field(U32)
    usb: Optional[UsbFrame] = field(Option(Fields(UsbFrame)))


@dataclass(frozen=True)
class BrownOutEvent(Record):
    """The level of the brown-out reset, and whether the device restarts with it. Since 1.3."""

    level: int = field(U8)
    needed: int = field(U8)
    options: int = field(U32)
    read_protection: int = field(U8)
    restarts: bool = field(BOOL)


@dataclass(frozen=True)
class FaultEnd(Record):
    """How an ordered fault ended: when the mute pin was first read low, or last high where the reset came first. Since 1.3."""

    fault: Choice = field(ORDERED_FAULT)
    muted_after_us: int = field(U32)
    by_reset: bool = field(BOOL)


@dataclass(frozen=True)
class FaultTrialEvent(Record):
    """The token of a fault on purpose, and how the last one ended. Since 1.3."""

    token: int = field(U32)
    last: Optional[FaultEnd] = field(Option(Fields(FaultEnd)))


@dataclass(frozen=True)
class ProfileEvent(Record):
    """The profile of the actuator that is in force. Since 1.3."""

    profile: Optional[ActuatorProfile] = field(Option(Fields(ActuatorProfile)))
    stored: Choice = field(STORED_CONFIG)


@dataclass(frozen=True)
class TravelLimitEvent(Record):
    """The limit of the travel that is in force. Since 1.1."""

    limit: Optional[TravelLimit] = field(Option(Fields(TravelLimit)))


@dataclass(frozen=True)
class TriggerEvent(Record):
    """Whether a drive waits for the trigger input, and where the last one began that had waited. Since 1.1."""

    waits: bool = field(BOOL)
    began: Optional[int] = field(Option(U64))


@dataclass(frozen=True)
class TableEvent(Record):
    """The table in force."""

    active: Optional[TableHeader] = field(Option(Fields(TableHeader)))
    staged: int = field(U16)


@dataclass(frozen=True)
class DigestEvent(Record):
    """The CRC-32 over a window of DAC codes; `crc` is none while the window is not over."""

    from_: int = field(U64)
    count: int = field(U32)
    crc: Optional[int] = field(Option(U32))


@dataclass(frozen=True)
class InputsEvent(Record):
    """What the inputs can do, and how many of their blocks were lost. Since 1.3."""

    inputs: int = field(U8)
    lock_ins: int = field(U8)
    delay_ns: int = field(I64)
    lost_blocks: int = field(U32)
    now: int = field(U64)


@dataclass(frozen=True)
class ListenedEvent(Record):
    """A measurement: how far it has come, and when it is over the answers of eight slots. Since 1.3."""

    progress: Choice = field(PROGRESS)
    begin: int = field(U64)
    blocks: int = field(U16)
    weight: int = field(U32)
    followed: int = field(U16)
    lowest: int = field(U16)
    highest: int = field(U16)
    answers: tuple[InPhaseQuadrature, ...] = field(List(8, Fields(InPhaseQuadrature)))


@dataclass(frozen=True)
class CapturedEvent(Record):
    """Values of a capture. Since 1.3."""

    progress: Choice = field(PROGRESS)
    from_: int = field(U64)
    captured: int = field(U16)
    first: int = field(U16)
    values: tuple[int, ...] = field(List(40, U32))


@dataclass(frozen=True)
class HeldEvent(Record):
    """How far the level hold has come, and how its tones stand. Since 1.3."""

    progress: Choice = field(HOLD_PROGRESS)
    input: int = field(U8)
    begin: int = field(U64)
    windows: int = field(U32)
    tones: tuple[HeldTone, ...] = field(List(16, Fields(HeldTone)))


# ------------------------------------------------------------------------------------------ messages


@dataclass(frozen=True)
class Kind:
    """A kind of message: its id, its name, the type of its body (none: no body), whether it takes a number, and the
    minor version that brought it."""

    id: int
    name: str
    body: Any = None
    numbered: bool = True
    since: int = 0

    def encode(self, value: Any = None) -> bytes:
        """The body of a message."""
        out = bytearray()
        if self.body is not None:
            self.body.encode(value, out, self.name)
        return bytes(out)

    def decode(self, body: bytes) -> Any:
        """The value of a body, None if this kind has none."""
        reader = Reader(body)
        value = None if self.body is None else self.body.decode(reader, self.name)
        reader.end(self.name)
        return value

    def check(self, value: Any) -> None:
        """Raises `FieldError` if a field lies outside its range."""
        if self.body is not None:
            self.body.check(value, self.name)


COMMANDS = {
    kind.name: kind
    for kind in (
        Kind(0x01, "Hello", Fields(Hello), numbered=False),
        Kind(0x02, "KeepAlive", Fields(KeepAlive), numbered=False),
        Kind(0x03, "Status", numbered=False),
        Kind(0x04, "Maintenance", since=1),
        Kind(0x05, "Board", since=3),
        Kind(0x06, "Profile", since=3),
        Kind(0x07, "Wear", since=3),
        Kind(0x08, "Analogue", since=3),
        Kind(0x09, "MutePin", Fields(MuteStep), since=3),
        Kind(0x0A, "Clock", since=3),
        Kind(0x0B, "Stall", since=3),
        Kind(0x10, "Arm"),
        Kind(0x11, "Disarm"),
        Kind(0x12, "Drive", Fields(Drive)),
        Kind(0x13, "Stop", numbered=False),
        Kind(0x14, "EmergencyStop", numbered=False),
        Kind(0x15, "ClearFaults"),
        Kind(0x16, "SetTravelLimit", Fields(SetTravelLimit), since=1),
        Kind(0x17, "TravelLimit", since=1),
        Kind(0x18, "Trigger", since=1),
        Kind(0x19, "Chord", Fields(Chord), since=2),
        Kind(0x1A, "Comb", Fields(Comb), since=3),
        Kind(0x1B, "ArmFor", Fields(ArmLease), since=3),
        Kind(0x1C, "Bench", Fields(ArmLease), since=3),
        Kind(0x20, "TableBegin", Fields(TableHeader)),
        Kind(0x21, "TableChunk", Fields(TableChunk)),
        Kind(0x22, "TableCommit"),
        Kind(0x23, "TableAbort"),
        Kind(0x24, "TableDigest"),
        Kind(0x30, "DigestStart", Fields(DigestStart)),
        Kind(0x31, "DigestRead"),
        Kind(0x40, "Store"),
        Kind(0x41, "Forget"),
        Kind(0x42, "WriteProfile", Fields(WriteProfile), since=3),
        Kind(0x43, "BrownOut", Fields(BrownOutOrder), since=3),
        Kind(0x50, "BootloaderToken"),
        Kind(0x51, "BootloaderEnter", U32),
        Kind(0x52, "FaultToken", since=3),
        Kind(0x53, "FaultOrder", Fields(FaultOrder), since=3),
        Kind(0x60, "Inputs", since=3),
        Kind(0x61, "Listen", Fields(Listen), since=3),
        Kind(0x62, "ListenRead", Fields(ListenRead), since=3),
        Kind(0x63, "ListenStop", since=3),
        Kind(0x64, "Capture", Fields(Capture), since=3),
        Kind(0x65, "CaptureRead", Fields(CaptureRead), since=3),
        Kind(0x66, "CaptureStop", since=3),
        Kind(0x67, "Hold", Fields(Hold), since=3),
        Kind(0x68, "HoldRead", since=3),
    )
}

EVENTS = {
    kind.name: kind
    for kind in (
        Kind(0x81, "Hello", Fields(HelloEvent)),
        Kind(0x83, "Status", Fields(StatusEvent)),
        Kind(0x84, "Maintenance", Fields(MaintenanceEvent), since=1),
        Kind(0x85, "Board", Fields(BoardEvent), since=3),
        Kind(0x86, "Profile", Fields(ProfileEvent), since=3),
        Kind(0x87, "Wear", Fields(WearEvent), since=3),
        Kind(0x88, "Analogue", Fields(AnalogueEvent), since=3),
        Kind(0x89, "MutePin", Fields(MutePinEvent), since=3),
        Kind(0x8A, "Clock", Fields(ClockEvent), since=3),
        Kind(0x90, "Accepted", Fields(Accepted)),
        Kind(0x91, "Refused", REFUSAL),
        Kind(0x92, "Unchanged", Fields(Accepted), since=1),
        Kind(0x93, "AcceptedUntil", Fields(AcceptedUntil), since=3),
        Kind(0x97, "TravelLimit", Fields(TravelLimitEvent), since=1),
        Kind(0x98, "Trigger", Fields(TriggerEvent), since=1),
        Kind(0xA4, "Table", Fields(TableEvent)),
        Kind(0xB1, "Digest", Fields(DigestEvent)),
        Kind(0xC3, "BrownOut", Fields(BrownOutEvent), since=3),
        Kind(0xD0, "BootloaderToken", U32),
        Kind(0xD2, "FaultTrial", Fields(FaultTrialEvent), since=3),
        Kind(0xE0, "Inputs", Fields(InputsEvent), since=3),
        Kind(0xE2, "Listened", Fields(ListenedEvent), since=3),
        Kind(0xE5, "Captured", Fields(CapturedEvent), since=3),
        Kind(0xE8, "Held", Fields(HeldEvent), since=3),
    )
}

_BY_ID = {kind.id: kind for kind in (*COMMANDS.values(), *EVENTS.values())}


def kind_of(id: int) -> Kind:
    """The kind with this id. Raises `DecodeError` if protocol 1.3 has none."""
    if id not in _BY_ID:
        raise DecodeError(f"no message has the id {id:#04x} in protocol 1.3")
    return _BY_ID[id]
