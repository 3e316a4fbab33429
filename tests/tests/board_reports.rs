//! What a device reports of its board beside `Board`: the mute pin and its trials, the supply, the clocks, the linear share.

use super::on_bench::{BENCH, mute_pin, sounding, was_muted_throughout};
use slipline_link::simulator::{MuteFault, Options, Wires};
use slipline_link::{DriveRequest, Request, Sounding, ToneRequest};
use slipline_protocol::board::{
    Analogue, ClockReport, MuteFall, MutePin, MuteStep, MuteTrial, PinLevel, SampleClock,
};
use slipline_protocol::command::{Apply, ArmLease, Drive};
use slipline_protocol::event::State;
use slipline_protocol::listen::{CapturePart, CaptureWindow};
use slipline_protocol::refusal::Busy;
use slipline_protocol::{Command, Refusal};
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::link_rig::LinkRig;
use slipline_tests::rig::{MID, Rig, Table, drive};
use std::time::Duration;

#[test]
fn a_trial_measures_the_fall_of_the_pin_and_disarms() {
    let mut rig = Rig::armed();
    for (trial, low_after_us) in [(MuteTrial::Lapse, 4000), (MuteTrial::Break, 0)] {
        let tried = mute_pin(&mut rig, trial);
        let fall = Some(MuteFall { low_after_us, within_us: 0 });
        assert_eq!(tried, MutePin { level: PinLevel::High, is_on_bench: false, fall });
        assert!(rig.device.is_muted());
        rig.record();
        rig.live_ms(50);
        assert!(was_muted_throughout(&rig));
        let status = rig.status();
        assert_eq!((status.state, status.first_fault), (State::Idle, None), "it is no fault");
        rig.arm();
        assert!(!rig.device.is_muted(), "and the next arming unmutes");
    }
}

#[test]
fn a_trial_is_refused_where_nothing_is_unmuted_or_something_sounds() {
    let lapse = Command::MutePin(MuteStep { trial: MuteTrial::Lapse });
    let mut rig = Rig::greeted();
    assert_eq!(rig.refused(&lapse), Refusal::NotArmed);
    let mut rig = sounding(Options::default());
    assert_eq!(rig.refused(&lapse), Refusal::NotArmed, "on the bench");
    let mut rig = Rig::greeted();
    rig.upload(&Table::usual());
    rig.accepted(&Command::Arm);
    assert_eq!(rig.refused(&lapse), Refusal::Busy(Busy::DriveActive), "not yet unmuted");
    rig.keep_alive();
    rig.live_ms(10);
    rig.accepted(&Command::Drive(Drive { apply: Apply::AtTrigger, ..drive(&[(0, 0.5, 0.5)], 2000) }));
    rig.live_ms(10);
    assert_eq!(rig.refused(&lapse), Refusal::Busy(Busy::DriveActive), "a drive waits");
    rig.accepted(&Command::Stop);
    rig.play(&[(0, 0.5, 0.5)], 2000, 20);
    assert_eq!(rig.refused(&lapse), Refusal::Busy(Busy::DriveActive), "it sounds");
    assert_eq!(rig.status().state, State::Driving, "and goes on");
}

#[test]
fn a_mute_pin_that_does_not_fall_shows() {
    let stuck = Options { mute_fault: Some(MuteFault::StuckHigh), ..Options::default() };
    let mut rig = Rig::greeted_with(stuck);
    assert_eq!(mute_pin(&mut rig, MuteTrial::Read).level, PinLevel::High, "muted, and yet high");
    rig.arm();
    assert_eq!(mute_pin(&mut rig, MuteTrial::Lapse).fall, None);
    let dead = Options { mute_fault: Some(MuteFault::DeadBreak), ..Options::default() };
    let mut rig = Rig::greeted_with(dead);
    rig.arm();
    assert_eq!(mute_pin(&mut rig, MuteTrial::Break).fall, None);
    rig.live_ms(60);
    rig.arm();
    assert!(mute_pin(&mut rig, MuteTrial::Lapse).fall.is_some());
    // Without its resistor the pin never rises.
    let mut rig = Rig::greeted_with(Options { mute_resistor_missing: true, ..Options::default() });
    rig.arm();
    let tried = mute_pin(&mut rig, MuteTrial::Lapse);
    assert_eq!(tried, MutePin { level: PinLevel::Low, is_on_bench: false, fall: None });
}

#[test]
fn the_device_reports_its_supply_and_its_clocks() {
    let mut rig = Rig::greeted();
    let analogue = answer!(rig, Command::Analogue, Analogue);
    assert_eq!(analogue, Analogue { reference_mv: 3300, linear_per_mille: 1000, ..Analogue::default() });
    rig.live_ms(100);
    let clock = answer!(rig, Command::Clock, Clock);
    assert_eq!(clock, ClockReport { at: rig.device.now(), cycles: 0, usb: None });
}

#[test]
fn a_wire_from_the_dac_to_the_sensor_shows_the_codes_up_to_the_linear_share() {
    let seen = |linear_per_mille| {
        let analogue = Analogue { linear_per_mille, ..Options::default().analogue };
        let wires = Wires { dac_to_sensor: true, ..Wires::default() };
        let mut rig = Rig::greeted_with(Options { analogue, wires, ..Options::default() });
        rig.upload(&Table::line(2, 10_000.0, 20_000.0, |_| 1.0));
        rig.accepted(&BENCH);
        rig.keep_alive();
        rig.live_ms(10);
        rig.play(&[(0, 0.0, 0.999)], 2000, 20);
        let window = CaptureWindow { from: None, input: 0, log2_codes: 0, values: 40 };
        let from = rig.accepted(&Command::Capture(window));
        rig.record();
        rig.live_ms(10);
        let read = Command::CaptureRead(CapturePart { first: 0 });
        let captured: Vec<u16> =
            answer!(rig, read, Captured).values.iter().map(|value| *value as u16).collect();
        (captured, rig.recording.from(from)[..40].to_vec())
    };
    let (captured, played) = seen(1000);
    assert_eq!(captured, played);
    let (captured, played) = seen(880);
    // 880 per mille of 2048.
    let half = 1802;
    let clipped: Vec<u16> = played.iter().map(|code| (*code).clamp(MID - half, MID + half)).collect();
    assert_eq!(captured, clipped);
    assert_ne!(captured, played, "the codes themselves reach farther");
}

#[test]
fn the_hosts_link_takes_a_device_to_the_bench_and_tries_its_mute_pin() {
    let mut rig = LinkRig::connected();
    // A simulated device is armed unasked.
    rig.ask_and_pass(Request::Disarm, 500);
    assert_eq!(rig.view().device.analogue.map(|it| it.reference_mv), Some(3300));
    rig.done(Request::Bench(Duration::from_millis(2050)), 300);
    assert_eq!(rig.state(), State::Armed);
    rig.done(Request::MutePin(MuteTrial::Read), 300);
    let low = MutePin { level: PinLevel::Low, is_on_bench: true, fall: None };
    assert_eq!(rig.view().device.mute_pin, Some(low));
    // Its lease is over.
    rig.pass_ms(2500);
    assert_eq!((rig.state(), rig.view().drive.leases_over), (State::Idle, 1));
    rig.done(Request::Arm, 300);
    rig.done(Request::MutePin(MuteTrial::Lapse), 300);
    let pin = rig.view().device.mute_pin.unwrap();
    assert_eq!((pin.level, pin.fall.map(|fall| fall.low_after_us)), (PinLevel::High, Some(4000)));
    rig.pass_ms(500);
    assert_eq!(rig.state(), State::Idle);
    rig.done(Request::ReadClock, 300);
    assert!(rig.view().device.clock.is_some_and(|clock| clock.at > 0));
}

#[test]
fn a_drive_beyond_the_linear_share_is_cautioned_once_and_a_wrong_reference_at_the_start() {
    let of = |reference_mv, linear_per_mille| {
        let analogue = Analogue { reference_mv, linear_per_mille, ..Analogue::default() };
        let mut rig = LinkRig::armed_as(Options { analogue, ..Options::default() });
        for level in [0.5, 0.98, 0.97, 0.5] {
            let tone = ToneRequest { slot: 0, boundary_m: 0.05, level, phase_turns: 0.0 };
            rig.ask_and_pass(Request::Play(Sounding::Drive(DriveRequest::of(vec![tone]))), 400);
        }
        let log = &rig.view().record.log;
        let count = |text: &str| log.iter().filter(|line| line.text.contains(text)).count();
        (count("linear up to"), count("The reference voltage VREF+ is"))
    };
    // The table halves the level.
    assert_eq!(of(3300, 400), (1, 0));
    assert_eq!(of(2700, 1000), (0, 1));
    assert_eq!(of(0, 1000), (0, 0));
}

#[test]
fn a_device_without_its_clock_answers_and_cannot_be_armed() {
    let options = Options { sample_clock: SampleClock::Internal, ..Options::default() };
    let mut rig = Rig::greeted_with(options);
    rig.upload(&Table::usual());
    assert_eq!(answer!(rig, Command::Board, Board).sample_clock, SampleClock::Internal);
    for command in [Command::Arm, Command::ArmFor(ArmLease { lease_ms: 60_000 }), BENCH] {
        assert_eq!(rig.refused(&command), Refusal::NoClock);
    }
    rig.live_ms(50);
    assert!(rig.device.is_muted());
    let mut older = Rig::new(Options { sample_clock: SampleClock::Internal, ..Options::default() });
    older.hello_of_minor(2);
    assert_eq!(older.refused(&Command::Arm), Refusal::NotSupported);
}
