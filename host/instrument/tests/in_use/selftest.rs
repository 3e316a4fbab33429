//! The self-test on the simulated device: in full, in short, without wires, with each planted fault, and interrupted.

use crate::desk::{Alter, Desk, FaultyWire, everything, wired};
use crate::session::Session;
use slipline_instrument::MeasureIntent;
use slipline_instrument::measure::{MeasureError, Run};
use slipline_instrument::selftest::{
    LIMITS, SelftestReport, SelftestRequest, Selftesting, Verdict, Wire, is_step, step,
};
use slipline_link::Request;
use slipline_link::protocol::Event;
use slipline_link::protocol::board::{BoardReport, ClockReport, UsbFrame};
use slipline_link::protocol::event::State;
use slipline_link::simulator::{MuteFault, Options, SimulatedDevice};
use slipline_plate::truth::Random;

/// The steps that no message of today can show.
const NEVER: [&str; 3] = [step::STALL, step::BOOTLOADER, step::FAULTS];
/// The steps by drives.
const DRIVEN: [&str; 6] =
    [step::DAC_TO_ADC, step::DELAY, step::NOISE, step::LOAD, step::CODES, step::TRIGGER];

fn good() -> SimulatedDevice {
    wired(Options::default(), FaultyWire::good())
}

fn named(report: &SelftestReport, verdict: Verdict) -> Vec<&str> {
    report.named(verdict).collect()
}

/// The report with its red and skipped steps as expected, and no other that is not green.
fn expect(report: &SelftestReport, red: &[&str], skipped: &[&str]) {
    assert_eq!(named(report, Verdict::Red), red, "{report:#?}");
    let mut expected: Vec<&str> = skipped.iter().chain(&NEVER).copied().collect();
    expected.sort_by_key(|name| step::ALL.iter().position(|step| step == name));
    assert_eq!(named(report, Verdict::Skipped), expected, "{report:#?}");
    assert_eq!(named(report, Verdict::Amber), [""; 0], "{report:#?}");
}

#[test]
fn a_good_board_passes_in_full_with_both_wires_and_the_mute_pin_stays_low() {
    let mut desk = Desk::new(good(), None);
    let began = desk.time_s();
    let request = SelftestRequest { is_short: false, is_amplifier_unplugged: false, ..everything() };
    let report = desk.test(request).unwrap();
    expect(&report, &[], &[step::MUTE_TIME]);
    assert_eq!(desk.unmuted(), 0, "a step that does not ask has unmuted the amplifier");
    let took_s = desk.time_s() - began;
    assert!(took_s < 180.0, "{took_s}");
    assert!(report.line().starts_with("SELFTEST PASS unit=73696d756c617465642d3030 build=slipline_"));
    assert!(report.line().ends_with(" skipped=mute_time,stall,bootloader,faults"), "{}", report.line());
    assert!(report.simulated && report.board == "simulated" && report.codes_crc.is_some());
    let names: Vec<&str> = report.steps.iter().map(|step| step.name.as_str()).collect();
    assert_eq!(names, step::ALL);
    assert_eq!(desk.snapshot().drive.status.unwrap().state, State::Idle);
}

#[test]
fn a_short_test_takes_three_seconds_and_gives_the_same_verdicts() {
    let mut desk = Desk::new(good(), None);
    let began = desk.time_s();
    let report = desk.test(everything()).unwrap();
    expect(&report, &[], &[]);
    let took_s = desk.time_s() - began;
    assert!(took_s < 3.0, "{took_s}");
    assert!(desk.is_muted() && desk.unmuted() > 0, "the mute pin is timed where it may be high");
}

#[test]
fn steps_without_their_wire_or_their_person_are_skipped_and_never_green() {
    let mut desk = Desk::new(SimulatedDevice::new(Options::default()), None);
    let report = desk.test(SelftestRequest { is_short: true, ..SelftestRequest::default() }).unwrap();
    let skipped = [
        step::MUTE_TIME,
        step::DAC_TO_ADC,
        step::DELAY,
        step::NOISE,
        step::TRIGGER,
        step::STORE,
        step::BUTTONS,
    ];
    expect(&report, &[], &skipped);
    assert_eq!(desk.unmuted(), 0);
    let missing = report.steps.iter().find(|result| result.name == step::DELAY).unwrap();
    assert!(missing.sentence.contains("dac=sensor") && missing.readings.is_empty(), "{missing:?}");
    // A wire to an input that the device does not have.
    let mut desk = Desk::new(SimulatedDevice::new(Options::default()), None);
    let request = SelftestRequest { is_short: true, ..SelftestRequest::default() };
    let report = desk.test(request.with_wires(&[Wire::DacToSensor])).unwrap();
    expect(&report, &[], &skipped);
}

/// A device with a fault.
fn with(change: impl FnOnce(&mut Options)) -> SimulatedDevice {
    let mut options = Options::default();
    change(&mut options);
    wired(options, FaultyWire::good())
}

fn with_wire(change: impl FnOnce(&mut FaultyWire)) -> SimulatedDevice {
    let mut wire = FaultyWire::good();
    change(&mut wire);
    wired(Options::default(), wire)
}

/// The first digest of a window is that of codes of which one is wrong.
fn one_wrong_code() -> Alter {
    let mut is_planted = false;
    Box::new(move |event| match event {
        Event::Digest(mut digest) => {
            if let Some(crc) = digest.crc.as_mut().filter(|_| !is_planted) {
                *crc ^= 1;
                is_planted = true;
            }
            Event::Digest(digest)
        }
        event => event,
    })
}

/// A test of a device with a fault: its red steps, and those that are skipped because of it.
type Case = (&'static str, fn() -> Desk, &'static [&'static str], &'static [&'static str]);

const CASES: &[Case] = &[
    (
        "clock 2 % off",
        || {
            let mut desk = Desk::new(good(), None);
            desk.clock = 1.02;
            desk
        },
        &[step::CLOCKS],
        &[],
    ),
    (
        "VREF+ 2.7 V",
        || Desk::new(with(|options| options.analogue.reference_mv = 2700), None),
        &[step::SUPPLY],
        &[],
    ),
    (
        "mute stuck high",
        || Desk::new(with(|options| options.mute_fault = Some(MuteFault::StuckHigh)), None),
        &[step::MUTE, step::MUTE_TIME],
        &[],
    ),
    (
        "break input dead",
        || Desk::new(with(|options| options.mute_fault = Some(MuteFault::DeadBreak)), None),
        &[step::MUTE_TIME],
        &[],
    ),
    (
        "resistor missing",
        || Desk::new(with(|options| options.mute_resistor_missing = true), None),
        &[step::MUTE],
        &[step::MUTE_TIME],
    ),
    (
        "dead ADC",
        || Desk::new(with_wire(|wire| wire.stuck = Some(0)), None),
        &[step::DAC_TO_ADC],
        &[step::DELAY, step::NOISE],
    ),
    (
        "DAC and sensor swapped: the input reads mid-scale",
        || Desk::new(with_wire(|wire| wire.stuck = Some(2048)), None),
        &[step::DAC_TO_ADC],
        &[step::DELAY, step::NOISE],
    ),
    ("DMA late by a block", || Desk::new(with_wire(|wire| wire.late_blocks = 1), None), &[step::DELAY], &[]),
    ("noisy reference", || Desk::new(with_wire(|wire| wire.noise = 4.0), None), &[step::NOISE], &[]),
    ("one wrong code", || Desk::new(good(), Some(one_wrong_code())), &[step::CODES], &[]),
    (
        "lost trigger edge",
        || {
            let options = Options::default();
            Desk::new(SimulatedDevice::with_inputs(options, Box::new(FaultyWire::good())), None)
        },
        &[step::TRIGGER],
        &[],
    ),
    (
        "block of the inputs lost under load",
        || {
            let mut desk = Desk::new(good(), None);
            desk.before = Some(|device, request| {
                if matches!(request, Request::Listen(listen) if listen.slots == u16::MAX) {
                    device.inject_overrun(1);
                }
            });
            desk
        },
        &[step::LOAD],
        &[],
    ),
    (
        "block too late for the DAC",
        || {
            let mut desk = Desk::new(good(), None);
            desk.before = Some(|device, request| {
                if matches!(request, Request::Digest(_)) {
                    device.inject_underrun();
                }
            });
            desk
        },
        &[step::CODES],
        &[step::TRIGGER, step::MUTE_TIME],
    ),
    (
        "stuck button",
        || {
            let mut device = good();
            device.press_button(true);
            let mut desk = Desk::new(device, None);
            desk.obeys = false;
            desk
        },
        &[step::BUTTONS],
        &[step::MUTE_TIME, DRIVEN[0], DRIVEN[1], DRIVEN[2], DRIVEN[3], DRIVEN[4], DRIVEN[5], step::STORE],
    ),
];

#[test]
fn each_planted_fault_is_caught_by_its_own_step_and_no_other_verdict_is_wrong() {
    for (fault, desk, red, skipped) in CASES {
        println!("{fault}");
        let report = desk().test(everything()).unwrap();
        expect(&report, red, skipped);
        assert!(!report.passed() && report.line().starts_with("SELFTEST FAIL "), "{}", report.line());
        for result in report.steps.iter().filter(|result| result.verdict == Verdict::Red) {
            assert!(result.sentence.ends_with(['.', '?']), "{result:?}");
        }
    }
}

/// The looks that a short test takes.
fn looks() -> f64 {
    let mut looks = 0;
    let mut desk = Desk::new(good(), None);
    assert!(desk.run(&mut Run::of(Selftesting::new(everything())), 100_000, |look, _| looks = look));
    looks as f64
}

#[test]
fn a_stop_at_any_moment_leaves_the_board_muted_and_disarmed() {
    let (mut random, looks) = (Random::new(4), looks());
    for _ in 0..25 {
        let mut desk = Desk::new(good(), None);
        let stopped_at = random.within(0.0, looks) as usize;
        let mut run = Run::of(Selftesting::new(everything()));
        let cancel = |look, run: &mut Run<Selftesting>| {
            if look == stopped_at {
                run.cancel();
            }
        };
        assert!(desk.run(&mut run, 100_000, cancel));
        assert_eq!(run.finish(), Err(MeasureError::Cancelled), "{stopped_at}");
        (0..500).for_each(|_| desk.pass());
        let status = desk.snapshot().drive.status.unwrap();
        assert!(desk.is_muted() && status.state == State::Idle, "{stopped_at}: {status:?}");
    }
}

#[test]
fn a_host_that_is_killed_at_any_moment_leaves_the_board_muted_and_the_next_hello_is_normal() {
    let (mut random, looks) = (Random::new(5), looks());
    for _ in 0..25 {
        let mut desk = Desk::new(good(), None);
        let killed_at = random.within(1.0, looks) as usize;
        let mut run = Run::of(Selftesting::new(everything()));
        assert!(!desk.run(&mut run, killed_at, |_, _| ()));
        drop(run);
        // Longer than the dead-man and its ramp.
        (0..1200).for_each(|_| desk.pass_alone());
        assert!(desk.is_muted(), "{killed_at}");
        desk.connect_again();
        let status = desk.snapshot().drive.status.unwrap();
        assert!(matches!(status.state, State::Idle | State::Fault), "{killed_at}: {status:?}");
        desk.send(Request::ClearFaults);
        (0..100).for_each(|_| desk.pass());
        assert_eq!(desk.snapshot().drive.status.unwrap().state, State::Idle, "{killed_at}");
    }
}

#[test]
fn a_cable_that_is_pulled_at_any_moment_ends_the_test_and_the_board_is_muted() {
    let (mut random, looks) = (Random::new(6), looks());
    for _ in 0..10 {
        let mut desk = Desk::new(good(), None);
        let pulled_at = random.within(1.0, looks) as usize;
        let mut run = Run::of(Selftesting::new(everything()));
        assert!(!desk.run(&mut run, pulled_at, |_, _| ()));
        desk.plug(false);
        assert!(desk.run(&mut run, 100_000, |_, _| ()));
        assert_eq!(run.finish(), Err(MeasureError::Lost), "{pulled_at}");
        (0..1200).for_each(|_| desk.pass_alone());
        assert!(desk.is_muted(), "{pulled_at}");
        desk.plug(true);
        desk.connect_again();
        let status = desk.snapshot().drive.status.unwrap();
        assert!(matches!(status.state, State::Idle | State::Fault), "{pulled_at}: {status:?}");
    }
}

#[test]
fn a_board_whose_dac_saturates_where_it_states_passes_and_its_ends_are_reported() {
    let mut desk = Desk::new(with(|options| options.analogue.linear_per_mille = 880), None);
    let report = desk.test(everything()).unwrap();
    expect(&report, &[], &[]);
    let dac = report.steps.iter().find(|result| result.name == step::DAC_TO_ADC).unwrap();
    for (quantity, code) in [("lowest linear code", 246.0), ("highest linear code", 3850.0)] {
        let reading = dac.readings.iter().find(|reading| reading.quantity == quantity).unwrap();
        assert!((reading.value - code).abs() <= 64.0, "{reading:?}");
    }
    // One that saturates earlier than it states does not.
    let early = with_wire(|wire| wire.ends = 1500.0);
    let report = Desk::new(early, None).test(everything()).unwrap();
    assert_eq!(named(&report, Verdict::Red), [step::DAC_TO_ADC]);
}

/// A processor of 168 MHz at USB, whose cycle counter, and whose host's frames, run by these shares of the samples' time.
fn at_usb(counter: f64, frames: f64, worst_block: u32) -> Alter {
    const CYCLES: f64 = 420.0;
    Box::new(move |event| match event {
        Event::Board(board) => Event::Board(BoardReport { core_hz: 168_000_000, ..board }),
        Event::Clock(clock) => {
            let cycles = |samples: f64| (samples * CYCLES * counter) as u64 as u32;
            let frame = (clock.at as f64 / 400.0 * frames).floor();
            let usb = UsbFrame { number: (frame % 2048.0) as u16, cycles: cycles(frame * 400.0 / frames) };
            Event::Clock(ClockReport { cycles: cycles(clock.at as f64), usb: Some(usb), ..clock })
        }
        Event::Status(mut status) => {
            status.counters.max_cycles = worst_block;
            Event::Status(status)
        }
        event => event,
    })
}

#[test]
fn a_boards_own_clocks_are_compared_with_its_samples_and_with_the_usb() {
    let tested = |counter, frames, worst_block| {
        Desk::new(good(), Some(at_usb(counter, frames, worst_block))).test(everything()).unwrap()
    };
    let clocks =
        |report: &SelftestReport| report.steps.iter().find(|it| it.name == step::CLOCKS).unwrap().clone();
    let report = tested(1.0, 1.0, 30_000);
    expect(&report, &[], &[]);
    let quantities: Vec<String> = clocks(&report).readings.into_iter().map(|it| it.quantity).collect();
    assert_eq!(quantities, ["rate error in a short time", "cycle error", "error by USB frames"]);
    // A resonator instead of a crystal is less exact.
    let report = tested(1.0, 1.0 - 200e-6, 30_000);
    assert_eq!((clocks(&report).verdict, report.passed()), (Verdict::Amber, true), "{report:#?}");
    assert_eq!(clocks(&tested(1.0, 0.98, 30_000)).verdict, Verdict::Red);
    assert_eq!(clocks(&tested(1.0002, 1.0, 30_000)).verdict, Verdict::Red);
    // 53 760 cycles are the time of a block.
    assert_eq!(named(&tested(1.0, 1.0, 50_000), Verdict::Red), [step::LOAD]);
}

#[test]
fn every_limit_belongs_to_a_step_and_a_number_beyond_it_is_judged_by_it() {
    let report = Desk::new(good(), None).test(everything()).unwrap();
    for limit in LIMITS {
        assert!(is_step(limit.step), "{}", limit.step);
        for beyond in [limit.at_least.map(|least| least - 1.0), limit.at_most.map(|most| most + 1000.0)] {
            let Some(value) = beyond else { continue };
            let mut moved = report.clone();
            let step = moved.steps.iter_mut().find(|step| step.name == limit.step).unwrap();
            let Some(reading) = step.readings.iter_mut().find(|it| it.quantity == limit.quantity) else {
                continue;
            };
            // Limits that stand in the report are not believed.
            (reading.value, reading.at_least, reading.at_most) = (value, None, None);
            let judged = moved.judged_again();
            let step = judged.steps.iter().find(|step| step.name == limit.step).unwrap();
            assert!(step.verdict >= limit.beyond, "{} {value}: {step:?}", limit.quantity);
            assert!(step.sentence.contains(limit.remedy) || step.verdict > limit.beyond, "{step:?}");
        }
    }
    assert_eq!(report.clone().judged_again(), report);
}

#[test]
fn the_instrument_tests_the_board_at_the_users_request_and_gives_its_table_back() {
    let mut session = Session::driving();
    let table = |session: &Session| session.instrument.drive.snapshot().table.report.active;
    let before = table(&session);
    let request = SelftestRequest { is_short: true, ..SelftestRequest::default() };
    session.instrument.perform_measure(MeasureIntent::SelftestDraft(request));
    session.instrument.perform_measure(MeasureIntent::Selftest);
    session.pass(200);
    assert!(session.is_measuring(), "{}", session.notice());
    session.end_of_measuring();
    assert_eq!(session.notice(), "The board passes 6 of 16 steps; the others are not shown.");
    let shown = session.instrument.shown();
    assert_eq!(named(shown.selftest.report.unwrap(), Verdict::Red), [""; 0]);
    assert!(!session.is_driving() && table(&session) == before);
    // STOP ends it.
    session.instrument.perform_measure(MeasureIntent::Selftest);
    session.pass(2000);
    session.instrument.press_stop();
    session.end_of_measuring();
    assert_eq!(session.notice(), "The self-test was cancelled.");
    session.pass(500);
    assert_eq!(session.instrument.drive.snapshot().drive.status.unwrap().state, State::Idle);
    assert_eq!(table(&session), before);
}
