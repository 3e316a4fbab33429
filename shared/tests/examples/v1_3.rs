//! What minor 3 adds: the comb, what the inputs measure, and the level hold.

use super::Example;
use heapless::Vec;
use slipline_protocol::board::{
    Analogue, BoardReport, BrownOut, BrownOutOrder, ClockReport, FaultEnd, FaultOrder, FaultTrial, MuteFall,
    MutePin, MuteResistor, MuteStep, MuteTrial, OrderedFault, PinLevel, SampleClock, StopInput, UsbFrame,
    UserButton,
};
use slipline_protocol::command::{Apply, ArmLease, Comb, CombTone, ProfileSetting};
use slipline_protocol::event::{
    AcceptedUntil, Fault, Faults, ProfileReport, State, Status, StoredConfig, Wear,
};
use slipline_protocol::hold::{
    Held, HeldTone, HoldLimit, HoldLoss, HoldProgress, HoldSetting, HoldState, HoldTone,
};
use slipline_protocol::listen::{
    CapturePart, CaptureWindow, Captured, InPhaseQuadrature, InputsReport, ListenPart, ListenWindow,
    Listened, Progress, WindowShape,
};
use slipline_protocol::profile::{ActuatorProfile, CoilHeat, TravelLimit};
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::units::{CentiDecibel, Level, Phase};
use slipline_protocol::{Command, Event};

/// The commands of minor 3.
pub(crate) fn commands() -> std::vec::Vec<Example<Command>> {
    let tones = [
        CombTone { harmonic: 1311, level: Level(4000), phase: Phase(0) },
        CombTone { harmonic: 1442, level: Level(4000), phase: Phase(8192) },
    ];
    let comb = Comb {
        period_blocks: 40,
        tones: Vec::from_slice(&tones).unwrap(),
        master: CentiDecibel(-600),
        glide: 4000,
        apply: Apply::Next,
    };
    let tone = CombTone { harmonic: u16::MAX, level: Level(u16::MAX), phase: Phase(u16::MAX) };
    let largest = Comb {
        period_blocks: u16::MAX,
        tones: Vec::from_slice(&[tone; 16]).unwrap(),
        master: CentiDecibel(i16::MIN),
        glide: u32::MAX,
        apply: Apply::At(u64::MAX),
    };
    let window = ListenWindow {
        from: Some(256_000),
        blocks: 400,
        shape: WindowShape::Rectangular,
        slots: 0x0003,
        input: Some(0),
    };
    let all =
        ListenWindow { from: None, blocks: u16::MAX, shape: WindowShape::Hann, slots: u16::MAX, input: None };
    let late = ListenWindow { from: Some(u64::MAX), input: Some(u8::MAX), ..all };
    let capture = CaptureWindow { from: Some(256_000), input: 1, log2_codes: 3, values: 4096 };
    let at_once = CaptureWindow { from: None, input: 0, log2_codes: 0, values: 1 };
    let values =
        CaptureWindow { from: Some(u64::MAX), input: u8::MAX, log2_codes: u8::MAX, values: u16::MAX };
    let commands = [
        ("comb", Command::Comb(comb)),
        ("comb-largest", Command::Comb(largest)),
        ("board", Command::Board),
        ("profile", Command::Profile),
        ("wear", Command::Wear),
        ("analogue", Command::Analogue),
        ("mute-pin", Command::MutePin(MuteStep { trial: MuteTrial::Read })),
        ("mute-pin-lapse", Command::MutePin(MuteStep { trial: MuteTrial::Lapse })),
        ("mute-pin-break", Command::MutePin(MuteStep { trial: MuteTrial::Break })),
        ("clock", Command::Clock),
        ("stall", Command::Stall),
        ("brown-out", Command::BrownOut(BrownOutOrder { is_written: false })),
        ("brown-out-write", Command::BrownOut(BrownOutOrder { is_written: true })),
        ("fault-token", Command::FaultToken),
        ("fault-hang", Command::FaultOrder(FaultOrder { fault: OrderedFault::Hang, token: 0x1234_5678 })),
        (
            "fault-masked-interrupts",
            Command::FaultOrder(FaultOrder { fault: OrderedFault::MaskedInterrupts, token: 1 }),
        ),
        (
            "fault-stack-overflow",
            Command::FaultOrder(FaultOrder { fault: OrderedFault::StackOverflow, token: u32::MAX }),
        ),
        ("bench", Command::Bench(ArmLease { lease_ms: 60_000 })),
        ("bench-largest", Command::Bench(ArmLease { lease_ms: u32::MAX })),
        ("write-profile", Command::WriteProfile(ProfileSetting { profile: Some(profile()) })),
        ("write-profile-none", Command::WriteProfile(ProfileSetting { profile: None })),
        ("arm-for", Command::ArmFor(ArmLease { lease_ms: 60_000 })),
        ("arm-for-largest", Command::ArmFor(ArmLease { lease_ms: u32::MAX })),
        ("inputs", Command::Inputs),
        ("listen", Command::Listen(window)),
        ("listen-next", Command::Listen(all)),
        ("listen-largest", Command::Listen(late)),
        ("listen-read", Command::ListenRead(ListenPart { input: 0, first_slot: 8 })),
        ("listen-stop", Command::ListenStop),
        ("capture", Command::Capture(capture)),
        ("capture-next", Command::Capture(at_once)),
        ("capture-largest", Command::Capture(values)),
        ("capture-read", Command::CaptureRead(CapturePart { first: 40 })),
        ("capture-stop", Command::CaptureStop),
    ];
    commands.into_iter().chain(holds()).map(|(label, command)| (label.to_owned(), command)).collect()
}

/// A profile with everything in it.
fn profile() -> ActuatorProfile {
    ActuatorProfile {
        name: "coil on a membrane".try_into().unwrap(),
        max_sum_per_mille: 800,
        travel: Some(TravelLimit { resonance_uhz: 60_000_000, quality_per_mille: 2000, static_ppm: 500_000 }),
        heat: CoilHeat { winding_ms: 8000, body_ms: 120_000, full_sine_per_mille: 1300 },
        max_rise: CentiDecibel(600),
        max_drive_ms: 60_000,
        has_stop_input: true,
    }
}

/// The commands of the level hold.
fn holds() -> [(&'static str, Command); 4] {
    let tones = [HoldTone { slot: 0, amplitude: 128_000 }, HoldTone { slot: 5, amplitude: 16 }];
    let hold = HoldSetting {
        input: 0,
        time_constant: 3200,
        blocks: 400,
        max_rise: CentiDecibel(1200),
        slew: CentiDecibel(602),
        tones: Vec::from_slice(&tones).unwrap(),
    };
    let tone = HoldTone { slot: u8::MAX, amplitude: u32::MAX };
    let largest = HoldSetting {
        input: u8::MAX,
        time_constant: u32::MAX,
        blocks: u16::MAX,
        max_rise: CentiDecibel(i16::MAX),
        slew: CentiDecibel(i16::MIN),
        tones: Vec::from_slice(&[tone; 16]).unwrap(),
    };
    [
        ("hold", Command::Hold(hold)),
        ("hold-off", Command::Hold(HoldSetting::default())),
        ("hold-largest", Command::Hold(largest)),
        ("hold-read", Command::HoldRead),
    ]
}

/// Reports of the level hold: every state, and the largest report.
fn held() -> [(&'static str, Event); 4] {
    let states = [
        HoldState::Settling,
        HoldState::Held,
        HoldState::AtLimit(HoldLimit::Rise),
        HoldState::AtLimit(HoldLimit::Level),
        HoldState::AtLimit(HoldLimit::Headroom),
        HoldState::AtLimit(HoldLimit::Thermal),
        HoldState::AtLimit(HoldLimit::Travel),
        HoldState::AtLimit(HoldLimit::Fall),
        HoldState::Lost(HoldLoss::NotFollowed),
        HoldState::Lost(HoldLoss::TooWeak),
        HoldState::Lost(HoldLoss::Clipped),
        HoldState::Lost(HoldLoss::Stuck),
        HoldState::Lost(HoldLoss::Broken),
        HoldState::Lost(HoldLoss::AtRise),
    ];
    let tone = |(slot, state)| HeldTone { slot, state, correction: CentiDecibel(-312), amplitude: 127_500 };
    let held = Held {
        progress: HoldProgress::On,
        input: 1,
        begin: 256_000,
        windows: 70,
        tones: (0..).zip(states).map(tone).collect(),
    };
    let most = HeldTone {
        slot: u8::MAX,
        state: HoldState::Lost(HoldLoss::AtRise),
        correction: CentiDecibel(i16::MIN),
        amplitude: u32::MAX,
    };
    let largest = Held {
        progress: HoldProgress::Lost,
        input: u8::MAX,
        begin: u64::MAX,
        windows: u32::MAX,
        tones: Vec::from_slice(&[most; 16]).unwrap(),
    };
    [
        ("held", Event::Held(held.clone())),
        ("held-nothing", Event::Held(Held::default())),
        ("held-ended", Event::Held(Held { progress: HoldProgress::Ended, tones: Vec::new(), ..held })),
        ("held-largest", Event::Held(largest)),
    ]
}

/// The events of minor 3.
pub(crate) fn events() -> std::vec::Vec<Example<Event>> {
    let inputs = InputsReport { inputs: 2, lock_ins: 16, delay_ns: -1125, lost_blocks: 3, now: 128_000 };
    let most = InputsReport {
        inputs: u8::MAX,
        lock_ins: u8::MAX,
        delay_ns: i64::MIN,
        lost_blocks: u32::MAX,
        now: u64::MAX,
    };
    let answers = [
        InPhaseQuadrature { in_phase: 1_234_567_890, quadrature: -987_654_321 },
        InPhaseQuadrature { in_phase: 0, quadrature: 0 },
    ];
    let listened = Listened {
        progress: Progress::Finished,
        begin: 256_000,
        blocks: 400,
        weight: 400 << 15,
        followed: 1,
        lowest: 1800,
        highest: 2290,
        answers: Vec::from_slice(&answers).unwrap(),
    };
    let running = Listened { progress: Progress::Running, answers: Vec::new(), ..listened };
    let highest = InPhaseQuadrature { in_phase: i64::MIN, quadrature: i64::MAX };
    let largest = Listened {
        progress: Progress::Broken { at: u64::MAX },
        begin: u64::MAX,
        blocks: u16::MAX,
        weight: u32::MAX,
        followed: u16::MAX,
        lowest: u16::MAX,
        highest: u16::MAX,
        answers: Vec::from_slice(&[highest; 8]).unwrap(),
    };
    let captured = Captured {
        progress: Progress::Running,
        from: 256_000,
        captured: 42,
        first: 40,
        values: Vec::from_slice(&[2047, 2049]).unwrap(),
    };
    let all = Captured {
        progress: Progress::Broken { at: u64::MAX },
        from: u64::MAX,
        captured: u16::MAX,
        first: u16::MAX,
        values: Vec::from_slice(&[u32::MAX; 40]).unwrap(),
    };
    let board = BoardReport {
        core_hz: 168_000_000,
        mute_resistor: MuteResistor::Present,
        user_button: UserButton::Released,
        stop_input: StopInput::Closed,
        trigger_input: true,
        sample_clock: SampleClock::Exact,
    };
    let bare = BoardReport {
        core_hz: u32::MAX,
        mute_resistor: MuteResistor::Missing,
        user_button: UserButton::Pressed,
        stop_input: StopInput::NotInProfile,
        trigger_input: true,
        sample_clock: SampleClock::Internal,
    };
    let analogue = Analogue {
        reference_mv: 3302,
        linear_per_mille: 880,
        brown_out_level: Some(3),
        chip: 0x469,
        revision: 0x2003,
        ram_errors: Some(0),
    };
    let fall = MuteFall { low_after_us: 4003, within_us: 1 };
    let clock = ClockReport {
        at: 256_000,
        cycles: 107_520_000,
        usb: Some(UsbFrame { number: 640, cycles: 107_600_000 }),
    };
    let brown_out =
        BrownOut { level: 2, needed: 2, options: 0x0fff_aae5, read_protection: 0xaa, restarts: true };
    let fault_end = FaultEnd { fault: OrderedFault::MaskedInterrupts, muted_after_us: 4003, by_reset: false };
    let desk_stop = Status {
        state: State::Fault,
        faults: Faults::NONE.with(Fault::DeskStop),
        first_fault: Some(Fault::DeskStop),
        first_fault_at: 128_000,
        ..Status::default()
    };
    let mut events = std::vec![
        ("board-reply".to_owned(), Event::Board(board)),
        ("board-reply-largest".to_owned(), Event::Board(bare)),
        ("board-reply-open".to_owned(), Event::Board(BoardReport { stop_input: StopInput::Open, ..board })),
        ("board-reply-none".to_owned(), Event::Board(BoardReport::default())),
        (
            "profile-reply".to_owned(),
            Event::Profile(ProfileReport { profile: Some(profile()), stored: StoredConfig::Loaded })
        ),
        ("profile-reply-none".to_owned(), Event::Profile(ProfileReport::default())),
        (
            "wear-reply".to_owned(),
            Event::Wear(Wear { profile_erasures: 3, profile_erasures_promised: 20_000, stores_left: 15 })
        ),
        (
            "wear-reply-largest".to_owned(),
            Event::Wear(Wear {
                profile_erasures: u32::MAX,
                profile_erasures_promised: u32::MAX,
                stores_left: u8::MAX,
            })
        ),
        ("analogue-reply".to_owned(), Event::Analogue(analogue)),
        ("analogue-reply-none".to_owned(), Event::Analogue(Analogue::default())),
        (
            "analogue-reply-largest".to_owned(),
            Event::Analogue(Analogue {
                reference_mv: u16::MAX,
                linear_per_mille: u16::MAX,
                brown_out_level: Some(u8::MAX),
                chip: u16::MAX,
                revision: u16::MAX,
                ram_errors: Some(u8::MAX),
            })
        ),
        (
            "mute-pin-reply".to_owned(),
            Event::MutePin(MutePin { level: PinLevel::Low, is_on_bench: true, fall: None })
        ),
        ("mute-pin-reply-none".to_owned(), Event::MutePin(MutePin::default())),
        (
            "mute-pin-reply-fall".to_owned(),
            Event::MutePin(MutePin { level: PinLevel::High, is_on_bench: false, fall: Some(fall) })
        ),
        ("clock-reply".to_owned(), Event::Clock(clock)),
        (
            "clock-reply-largest".to_owned(),
            Event::Clock(ClockReport {
                at: u64::MAX,
                cycles: u32::MAX,
                usb: Some(UsbFrame { number: u16::MAX, cycles: u32::MAX }),
            })
        ),
        ("clock-reply-none".to_owned(), Event::Clock(ClockReport { usb: None, ..clock })),
        ("brown-out-reply".to_owned(), Event::BrownOut(BrownOut { restarts: false, ..brown_out })),
        ("brown-out-reply-restarts".to_owned(), Event::BrownOut(brown_out)),
        (
            "brown-out-reply-largest".to_owned(),
            Event::BrownOut(BrownOut {
                level: u8::MAX,
                needed: u8::MAX,
                options: u32::MAX,
                read_protection: u8::MAX,
                restarts: true,
            })
        ),
        ("fault-trial".to_owned(), Event::FaultTrial(FaultTrial { token: 0x1234_5678, last: None })),
        ("fault-trial-last".to_owned(), Event::FaultTrial(FaultTrial { token: 1, last: Some(fault_end) })),
        (
            "fault-trial-largest".to_owned(),
            Event::FaultTrial(FaultTrial {
                token: u32::MAX,
                last: Some(FaultEnd {
                    fault: OrderedFault::StackOverflow,
                    muted_after_us: u32::MAX,
                    by_reset: true,
                }),
            })
        ),
        ("status-reply-fault-10".to_owned(), Event::Status(desk_stop)),
        (
            "status-reply-fault-11".to_owned(),
            Event::Status(Status {
                faults: Faults::NONE.with(Fault::ProfileFellBack),
                first_fault: Some(Fault::ProfileFellBack),
                ..desk_stop
            })
        ),
        ("accepted-until".to_owned(), Event::AcceptedUntil(AcceptedUntil { at: 128_000, until: 138_485 }),),
        ("inputs-reply".to_owned(), Event::Inputs(inputs)),
        ("inputs-reply-largest".to_owned(), Event::Inputs(most)),
        ("listened".to_owned(), Event::Listened(listened)),
        ("listened-nothing".to_owned(), Event::Listened(Listened::default())),
        ("listened-running".to_owned(), Event::Listened(running)),
        ("listened-largest".to_owned(), Event::Listened(largest)),
        ("captured".to_owned(), Event::Captured(captured)),
        ("captured-largest".to_owned(), Event::Captured(all)),
    ];
    let fields = [
        ("comb-period", Field::CombPeriod),
        ("window-blocks", Field::WindowBlocks),
        ("lock-ins", Field::LockIns),
        ("input", Field::Input),
        ("capture-codes", Field::CaptureCodes),
        ("capture-values", Field::CaptureValues),
        ("time-constant", Field::TimeConstant),
        ("max-rise", Field::MaxRise),
        ("slew", Field::Slew),
        ("held-amplitude", Field::HeldAmplitude),
        ("lease", Field::Lease),
        ("profile-sum", Field::ProfileSum),
        ("coil-time", Field::CoilTime),
        ("full-sine", Field::FullSine),
        ("drive-time", Field::DriveTime),
        ("reference-voltage", Field::ReferenceVoltage),
        ("read-protection", Field::ReadProtection),
    ];
    events.extend(held().map(|(label, event)| (label.to_owned(), event)));
    events.push(("refused-holding".to_owned(), Event::Refused(Refusal::Busy(Busy::Holding))));
    events.push(("refused-hold-button".to_owned(), Event::Refused(Refusal::HoldButton)));
    events.push(("refused-no-clock".to_owned(), Event::Refused(Refusal::NoClock)));
    events.push(("refused-stores-spent".to_owned(), Event::Refused(Refusal::StoresSpent { wait_s: 60 })));
    events.push(("refused-silent-tone".to_owned(), Event::Refused(Refusal::SilentTone { slot: 7 })));
    for (label, field) in fields {
        let refusal = Refusal::OutOfRange { field, min: 0, max: 1, got: 2 };
        events.push((format!("refused-out-of-range-{label}"), Event::Refused(refusal)));
    }
    events
}
