//! The self-test on the simulated device: in full, in short, without wires, and interrupted. Planted faults: `planted_faults.rs`.

use crate::desk::{Desk, everything, expect, good, in_full, named};
use crate::session::Session;
use slipline_instrument::measure::{MeasureError, Run};
use slipline_instrument::selftest::{LIMITS, SelftestRequest, Selftesting, Verdict, Wire, is_step, step};
use slipline_instrument::{DeviceIntent, MeasureIntent};
use slipline_link::protocol::event::{ResetCause, State};
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::{LinkState, Request};
use slipline_plate::truth::Random;

/// A test took this time of the device, which is less than `most_s`.
fn took(which: &str, time_s: f64, most_s: f64) {
    println!("{which}: {time_s:.3} s of the device's time, {:.0} samples", time_s * 400e3);
    assert!(time_s < most_s, "{which}: {time_s} s");
}

#[test]
fn a_good_board_passes_in_full_with_both_wires_and_the_mute_pin_stays_low() {
    let mut desk = Desk::new(good(), None);
    let began = desk.time_s();
    let request = SelftestRequest { is_amplifier_unplugged: false, ..in_full() };
    let report = desk.test(request).unwrap();
    expect(&report, &[], &[step::MUTE_TIME, step::FAULTS]);
    assert_eq!(desk.unmuted(), 0, "a step that does not ask has unmuted the amplifier");
    took("in full", desk.time_s() - began, 180.0);
    assert!(report.line().starts_with("SELFTEST PASS unit=73696d756c617465642d3030 build=slipline_"));
    assert!(report.line().ends_with(" skipped=mute_time,faults,amplifier,others"), "{}", report.line());
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
    took("in short", desk.time_s() - began, 3.0);
    assert!(desk.is_muted() && desk.unmuted() > 0, "the mute pin is timed where it may be high");
}

#[test]
fn a_full_test_with_the_amplifier_unplugged_makes_the_device_fail_and_finds_it_again() {
    let mut desk = Desk::new(good(), None);
    let report = desk.test(in_full()).unwrap();
    expect(&report, &[], &[]);
    took("in full, with faults on purpose", desk.time_s(), 180.0);
    let readings = |name| report.steps.iter().find(|step| step.name == name).unwrap().readings.iter();
    let shown: Vec<String> =
        readings(step::FAULTS).map(|it| format!("{}: {}", it.quantity, it.shown())).collect();
    let times = &shown[3..];
    assert_eq!(times.len(), 3, "{shown:?}");
    assert_eq!(
        times[1..],
        ["time to mute with interrupts masked: 4 ms", "time to mute by a stack overflow: 0 ms"]
    );
    let hang = readings(step::FAULTS).find(|it| it.quantity == "time to mute in a hang").unwrap().value;
    // The supervisor feeds the watchdog at most 100 ms later.
    assert!((200.0..410.0).contains(&hang), "{hang}");
    let reopened = readings(step::LINK).find(|it| it.quantity == "reopenings").unwrap();
    assert_eq!(reopened.value, 20.0);
    // Three resets by faults that were not ordered would be safe mode.
    let snapshot = desk.snapshot();
    assert_eq!(snapshot.drive.status.unwrap().state, State::Idle);
    assert_eq!(snapshot.device.identity.unwrap().reset, ResetCause::HardFault);
    assert!(desk.is_muted());
}

#[test]
fn a_device_that_nobody_resets_out_of_its_bootloader_is_reported_and_ends_the_test() {
    let mut desk = Desk::new(good(), None);
    desk.obeys = false;
    let report = desk.test(in_full()).unwrap();
    expect(&report, &[step::BUTTONS, step::BOOTLOADER], &[step::STORE, step::FAULTS]);
    let bootloader = report.steps.iter().find(|it| it.name == step::BOOTLOADER).unwrap();
    assert!(bootloader.sentence.contains("press reset again"), "{bootloader:?}");
    assert!(!desk.snapshot().is_connected() && desk.is_muted());
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
        step::STALL,
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
    // The amplifier, which is all that this test is asked for.
    let request = SelftestRequest { is_amplifier_on: true, ..SelftestRequest::default() };
    assert_eq!(desk.test(request), Err(MeasureError::NoInputs));
    assert_eq!(desk.unmuted(), 0);
}

#[test]
fn a_standing_fault_is_refused_with_its_way_out_and_nothing_is_driven() {
    let mut desk = Desk::new(good(), None);
    desk.send(Request::EmergencyStop);
    (0..100).for_each(|_| desk.pass());
    let error = desk.test(everything()).unwrap_err();
    assert!(matches!(error, MeasureError::StandingFault(_)), "{error:?}");
    let sentence = error.to_string();
    assert!(
        sentence.starts_with("the device has stopped: emergency stop; clear that fault first"),
        "{sentence}"
    );
    assert!(sentence.contains("`slipline board clear-faults`"), "{sentence}");
    assert_eq!(desk.unmuted(), 0);
    desk.send(Request::ClearFaults);
    (0..100).for_each(|_| desk.pass());
    expect(&desk.test(everything()).unwrap(), &[], &[]);
}

/// The look from which on a test closes the port and makes the device restart, and that at which it ends.
fn looks(request: SelftestRequest) -> (f64, f64) {
    let last_steps = step::ALL.iter().position(|&name| name == step::BUTTONS).unwrap() as f64;
    let (mut restarts, mut end) = (None, 0);
    let mut run = Run::of(Selftesting::new(request));
    assert!(Desk::new(good(), None).run(&mut run, 100_000, |look, run| {
        end = look;
        if run.progress(0) * step::ALL.len() as f64 > last_steps + 0.5 {
            restarts.get_or_insert(look);
        }
    }));
    (restarts.unwrap() as f64, end as f64)
}

/// A test that is stopped at this look leaves a connected device, muted and disarmed, and a link that looks for a lost one as before.
/// In its bootloader the device waits for a person.
fn stop(request: SelftestRequest, at: usize) {
    let mut desk = Desk::new(good(), None);
    desk.send(Request::AutoReconnect(false));
    let mut run = Run::of(Selftesting::new(request));
    let cancel = |look, run: &mut Run<Selftesting>| {
        if look == at {
            run.cancel();
        }
    };
    assert!(desk.run(&mut run, 100_000, cancel));
    assert_eq!(run.finish(), Err(MeasureError::Cancelled), "{at}");
    if desk.press_reset() {
        assert!(!request.is_short && !desk.snapshot().is_connected(), "{at}");
        desk.connect();
    }
    (0..500).for_each(|_| desk.pass());
    let snapshot = desk.snapshot();
    assert!(snapshot.is_connected() && !snapshot.link.auto_reconnect, "{at}: {:?}", snapshot.link.state);
    let status = snapshot.drive.status.unwrap();
    // A fault on purpose is latched, as any other.
    let is_idle = status.state == State::Idle || !request.is_short && status.state == State::Fault;
    assert!(desk.is_muted() && is_idle, "{at}: {status:?}");
}

#[test]
fn a_stop_at_any_moment_leaves_the_board_connected_muted_and_disarmed() {
    let (mut random, (reopens, end)) = (Random::new(4), looks(everything()));
    for part in [(0.0, end), (reopens, end)] {
        for _ in 0..13 {
            stop(everything(), random.within(part.0, part.1) as usize);
        }
    }
}

#[test]
fn a_stop_while_the_device_restarts_leaves_it_connected_muted_and_disarmed() {
    let (mut random, (restarts, end)) = (Random::new(8), looks(in_full()));
    for _ in 0..8 {
        stop(in_full(), random.within(restarts, end) as usize);
    }
}

#[test]
fn a_user_who_disconnects_while_the_device_restarts_stays_disconnected() {
    let (mut random, (restarts, end)) = (Random::new(12), looks(in_full()));
    for _ in 0..3 {
        let left_at = random.within(restarts, end) as usize;
        let mut desk = Desk::new(good(), None);
        desk.send(Request::AutoReconnect(false));
        let mut run = Run::of(Selftesting::new(in_full()));
        assert!(!desk.run(&mut run, left_at, |_, _| ()));
        run.leave_port();
        desk.send(Request::Disconnect);
        assert!(desk.run(&mut run, 100_000, |_, _| ()));
        assert_eq!(run.finish(), Err(MeasureError::Cancelled), "{left_at}");
        (0..1200).for_each(|_| desk.pass());
        let link = desk.snapshot().link;
        assert_eq!((link.state, link.auto_reconnect), (LinkState::Disconnected, false), "{left_at}");
        assert!(desk.is_muted(), "{left_at}");
    }
}

#[test]
fn a_host_that_is_killed_at_any_moment_leaves_the_board_muted_and_the_next_hello_is_normal() {
    let (mut random, (_, looks)) = (Random::new(5), looks(everything()));
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
    let (mut random, (_, looks)) = (Random::new(6), looks(everything()));
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
    assert_eq!(session.notice(), "The board passes 6 of 18 steps; the others are not shown.");
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

#[test]
fn the_instrument_leaves_the_port_closed_that_the_user_closes_during_a_self_test() {
    let mut session = Session::driving();
    session.instrument.perform_measure(MeasureIntent::SelftestDraft(SelftestRequest::default()));
    session.instrument.perform_measure(MeasureIntent::Selftest);
    let is_open = |session: &Session| session.instrument.drive.snapshot().is_connected();
    session.pass(100);
    while session.is_measuring() && is_open(&session) {
        session.pass(1);
    }
    assert!(session.is_measuring(), "the test closes the port");
    session.instrument.perform(DeviceIntent::Disconnect);
    session.end_of_measuring();
    session.pass(3000);
    assert_eq!(session.instrument.drive.snapshot().link.state, LinkState::Disconnected);
}

#[test]
fn the_amplifier_of_the_simulated_plate_is_tested_with_the_plate_put_up_first() {
    let (mut session, _) = Session::at_bench();
    let request = SelftestRequest { is_amplifier_on: true, ..SelftestRequest::default() };
    session.instrument.perform_measure(MeasureIntent::SelftestDraft(request));
    session.instrument.perform_measure(MeasureIntent::Selftest);
    assert!(session.is_measuring(), "{}", session.notice());
    session.end_of_measuring();
    let shown = session.instrument.shown();
    let report = shown.selftest.report.unwrap();
    let amplifier = report.steps.iter().find(|step| step.name == "amplifier").unwrap();
    assert_eq!(amplifier.verdict, Verdict::Green, "{amplifier:?}");
    assert_eq!(named(report, Verdict::Red), [""; 0]);
    assert!(!session.is_driving());
}
