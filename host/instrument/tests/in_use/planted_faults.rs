//! Planted faults: each is caught by its own step of the self-test, and no other verdict is wrong.

use crate::desk::{Alter, Desk, FaultyWire, everything, expect, good, in_full, named, wired};
use slipline_instrument::selftest::{SelftestReport, SelftestRequest, StepResult, Verdict, step};
use slipline_link::Request;
use slipline_link::protocol::Event;
use slipline_link::protocol::board::{BoardReport, ClockReport, FaultTrial, UsbFrame};
use slipline_link::protocol::event::{ResetCause, TriggerReport};
use slipline_link::simulator::{MuteFault, Options, SimulatedDevice};

/// The steps by drives.
const DRIVEN: [&str; 7] =
    [step::DAC_TO_ADC, step::DELAY, step::NOISE, step::LOAD, step::CODES, step::TRIGGER, step::STALL];

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

/// Only the first rise of the trigger output begins a drive, as where a stall of the DMA is not mended.
fn one_rise() -> Alter {
    let mut first = None;
    Box::new(move |event| match event {
        Event::Trigger(report) => {
            first = first.or(report.began);
            Event::Trigger(TriggerReport { began: report.began.filter(|at| Some(*at) == first), ..report })
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
        &[step::STALL],
    ),
    ("trigger lost after a stall", || Desk::new(good(), Some(one_rise())), &[step::STALL], &[]),
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
        &[step::TRIGGER, step::STALL, step::MUTE_TIME],
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
        &[
            step::MUTE_TIME,
            DRIVEN[0],
            DRIVEN[1],
            DRIVEN[2],
            DRIVEN[3],
            DRIVEN[4],
            DRIVEN[5],
            DRIVEN[6],
            step::STORE,
        ],
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
fn faults_of_what_restarts_the_device_are_caught_by_their_own_steps() {
    let mut stuck = Desk::new(with(|options| options.mute_fault = Some(MuteFault::StuckHigh)), None);
    let report = stuck.test(in_full()).unwrap();
    expect(&report, &[step::MUTE, step::MUTE_TIME, step::FAULTS], &[]);
    let faults = report.steps.iter().find(|it| it.name == step::FAULTS).unwrap();
    assert!(faults.sentence.contains("Time to mute with interrupts masked is 3"), "{faults:?}");
    // Another firmware answers after the bootloader.
    let flashed: Alter = Box::new(|event| match event {
        Event::Hello(mut identity) if identity.reset == ResetCause::Pin => {
            identity.build = "another".try_into().unwrap();
            Event::Hello(identity)
        }
        event => event,
    });
    expect(&Desk::new(good(), Some(flashed)).test(in_full()).unwrap(), &[step::BOOTLOADER], &[]);
    // The record of the ordered fault is lost.
    let forgets: Alter = Box::new(|event| match event {
        Event::FaultTrial(trial) => Event::FaultTrial(FaultTrial { last: None, ..trial }),
        event => event,
    });
    expect(&Desk::new(good(), Some(forgets)).test(in_full()).unwrap(), &[step::FAULTS], &[]);
}

/// The step with an amplifier, of a device with this fault and a sensor that receives the amplifier; and the blocks with the amplifier on.
fn with_amplifier(
    fault: Option<MuteFault>,
    change: impl FnOnce(&mut FaultyWire),
) -> (StepResult, SelftestReport, f64) {
    let mut wire = FaultyWire::good();
    wire.amplifier = Some(0.0);
    change(&mut wire);
    let device =
        SimulatedDevice::with_inputs(Options { mute_fault: fault, ..Options::default() }, Box::new(wire));
    let mut desk = Desk::new(device, None);
    let report = desk.test(SelftestRequest { is_amplifier_on: true, ..SelftestRequest::default() }).unwrap();
    let step = report.steps.iter().find(|result| result.name == step::AMPLIFIER).unwrap().clone();
    let unmuted_s = desk.unmuted() as f64 * 128.0 / 400e3;
    (step, report, unmuted_s)
}

#[test]
fn an_amplifier_that_is_on_while_it_is_muted_is_caught() {
    let (step, report, unmuted_s) = with_amplifier(None, |_| ());
    assert_eq!((step.verdict, report.passed()), (Verdict::Green, true), "{report:#?}");
    assert!(unmuted_s > 0.3 && unmuted_s < 1.0, "{unmuted_s}");
    let green = ["clocks", "supply", "mute", "link", "amplifier"];
    assert_eq!(named(&report, Verdict::Green), green, "nothing loud is played");
    // Inverted: on while the pin is low, muted while the device drives.
    let (inverted, report, _) = with_amplifier(Some(MuteFault::Inverted), |_| ());
    assert_eq!(named(&report, Verdict::Red), [step::AMPLIFIER]);
    assert!(inverted.sentence.contains("polarity of its enable"), "{inverted:?}");
    assert!(inverted.readings[1].value < -20.0, "{inverted:?}");
    // A mute without effect.
    let (deaf, ..) = with_amplifier(None, |wire| wire.amplifier = Some(1.0));
    assert!(deaf.verdict == Verdict::Red && deaf.readings[1].value.abs() < 3.0, "{deaf:?}");
    // A muted amplifier that leaks at -40 dB is none.
    let (leaking, ..) = with_amplifier(None, |wire| wire.amplifier = Some(0.01));
    assert_eq!(leaking.verdict, Verdict::Green, "{leaking:?}");
    // One that is off.
    let (off, ..) = with_amplifier(None, |wire| wire.stuck = Some(2048));
    assert!(off.verdict == Verdict::Red && off.sentence.contains("is the amplifier on"), "{off:?}");
}

#[test]
fn the_amplifier_is_tested_with_tones_at_minus_40_db() {
    let mut desk = Desk::new(wired(Options::default(), FaultyWire::good()), None);
    desk.test(SelftestRequest { is_amplifier_on: true, ..SelftestRequest::default() }).unwrap();
    let loudest = desk.loudest();
    assert!((10..=21).contains(&loudest), "{loudest} codes from mid-scale");
}
