//! Combs through the protocol: exact tones, within the table's frequencies and beyond them.

use std::f64::consts::TAU;
use std::sync::Arc;

use slipline_link::mirror::replay::{DeviceHistory, Replay};
use slipline_link::simulator::loopback::Loopback;
use slipline_link::{CombRequest, DeviceTable, DriveRequest, HarmonicRequest, Request, Sounding};
use slipline_protocol::Command;
use slipline_protocol::command::{Apply, Comb, TravelLimit, TravelSetting};
use slipline_protocol::event::Event;
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::units::CentiDecibel;
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, RATE_HZ, Rig, Table, comb, drive};

/// 40 blocks: 78.125 Hz. The usual table goes from 60 kHz at a gain of 0.5 to 20 kHz at a gain of 1. So the tones of 234 Hz
/// and 10 kHz have the gain 1, that of 100 kHz the gain 0.5, and that of 40 kHz 0.75.
const PERIOD_BLOCKS: u16 = 40;
const TONES: [(u16, f64, f64); 4] = [(3, 0.1, 0.0), (128, 0.2, 0.25), (512, 0.2, 0.5), (1280, 0.4, 0.125)];
const GAINS: [f64; 4] = [1.0, 1.0, 0.75, 0.5];

fn example() -> Comb {
    comb(PERIOD_BLOCKS, &TONES)
}

fn out_of_range(field: Field, min: i64, max: i64, got: i64) -> Refusal {
    Refusal::OutOfRange { field, min, max, got }
}

#[test]
fn a_combs_tones_are_exact_and_have_the_gain_of_the_nearest_place() {
    let mut rig = Rig::armed();
    let at = rig.accepted(&Command::Comb(example()));
    rig.live_ms(6);
    rig.record();
    let period = u64::from(PERIOD_BLOCKS) * BLOCK;
    rig.live_blocks(2 * period / BLOCK);
    let codes = &rig.recording.codes;
    assert_eq!(codes[..period as usize], codes[period as usize..], "it repeats");
    for (n, code) in codes.iter().enumerate() {
        let index = rig.recording.first + n as u64 - at;
        let sine = |((harmonic, level, turns), gain): ((u16, f64, f64), f64)| {
            let turn = (u64::from(harmonic) * index % period) as f64 / period as f64 + turns;
            level * gain * (TAU * turn).sin()
        };
        let sum: f64 = TONES.into_iter().zip(GAINS).map(sine).sum();
        let off = f64::from(*code) - (2047.5 + 2047.0 * sum);
        // Half a code of rounding, and half of the place of mid-scale.
        assert!(off.abs() < 1.1, "sample {n}: {code}, {off} off");
    }
}

#[test]
fn a_combs_phases_hold_over_a_period_of_seconds() {
    // The longest period: 21 s, 0.048 Hz. One tone of 19 999.97 Hz, whose step no 32 bits hold.
    let mut rig = Rig::armed();
    let harmonic = 65_535;
    let at = rig.accepted(&Command::Comb(comb(u16::MAX, &[(harmonic, 1.0, 0.0)])));
    rig.live_ms(4000);
    rig.record();
    rig.live_blocks(4);
    // 65535 / (128 * 65535) = 1/128 of the rate: the gain beyond the table's low end.
    for (n, code) in rig.recording.codes.iter().enumerate() {
        let index = rig.recording.first + n as u64 - at;
        let sum = (TAU * (index % 128) as f64 / 128.0).sin();
        assert!((f64::from(*code) - (2047.5 + 2047.0 * sum)).abs() < 1.1, "sample {n}: {code}");
    }
}

#[test]
fn what_does_not_fit_is_refused_and_nothing_sounds() {
    let mut rig = Rig::armed();
    let with = |tones: &[(u16, f64, f64)]| Command::Comb(comb(PERIOD_BLOCKS, tones));
    let highest = 40 * 128 * 45 / 100;
    for (command, refusal) in [
        (with(&[]), out_of_range(Field::ToneCount, 1, 16, 0)),
        (with(&[(0, 0.1, 0.0)]), out_of_range(Field::Harmonic, 1, highest, 0)),
        (with(&[(7, 0.1, 0.0), (7, 0.1, 0.0)]), out_of_range(Field::Harmonic, 8, highest, 7)),
        (with(&[(2305, 0.1, 0.0)]), out_of_range(Field::Harmonic, 1, highest, 2305)),
        (Command::Comb(comb(0, &TONES)), out_of_range(Field::CombPeriod, 1, 65_535, 0)),
        (Command::Comb(Comb { glide: 1999, ..example() }), out_of_range(Field::Glide, 2000, 4_000_000, 1999)),
        (
            Command::Comb(Comb { master: CentiDecibel(1), ..example() }),
            out_of_range(Field::MasterLevel, -9600, 0, 1),
        ),
        // In quadrature their sum would fit; a comb's phases are not looked at.
        (with(&[(128, 0.7, 0.0), (129, 0.4, 0.25)]), Refusal::Headroom { sum_per_mille: 1101 }),
    ] {
        assert_eq!(rig.refused(&command), refusal);
    }
    rig.record();
    rig.live_ms(10);
    assert_eq!(rig.recording.first_sound(rig.recording.first), None);
    assert_eq!(rig.send(&with(&[(2304, 0.1, 0.0)])), Event::Accepted(accepted_next(&rig)));
    rig.live_ms(10);
    assert_eq!(rig.refused(&Command::Comb(example())), Refusal::Busy(Busy::DriveActive));
    rig.accepted(&Command::Disarm);
    assert_eq!(rig.refused(&Command::Comb(example())), Refusal::NotArmed);

    let mut bare = Rig::greeted();
    bare.arm();
    assert_eq!(bare.refused(&Command::Comb(example())), Refusal::NoTable);
    let mut older = Rig::armed();
    older.hello_of_minor(2);
    older.live_ms(50);
    older.arm();
    assert_eq!(older.refused(&Command::Comb(example())), Refusal::UnknownMessage { id: 0x1a });
}

fn accepted_next(rig: &Rig) -> slipline_protocol::event::Accepted {
    slipline_protocol::event::Accepted { at: rig.device.now() }
}

#[test]
fn the_travel_matches_each_tones_own_frequency() {
    // A mass on a spring with its resonance at 50 Hz, Q = 4, far above: the travel falls with the square of the frequency. The
    // table ends at 1 kHz.
    let limit = TravelLimit { resonance_uhz: 50_000_000, quality_per_mille: 4000, static_ppm: 1_000_000 };
    let mut rig = Rig::armed_with(&Table::line(65, 5000.0, 1000.0, |_| 1.0));
    rig.send(&Command::SetTravelLimit(TravelSetting { limit: Some(limit) }));
    let glide = RATE_HZ / 25;
    // At 1 kHz 1/399 of the peak travel, at 50 Hz four times as far, at 25 Hz 1.3 times.
    let of = |harmonic, level| Command::Comb(Comb { glide, ..comb(125, &[(harmonic, level, 0.0)]) });
    let travel = |harmonic: f64, level: f64| {
        let r = harmonic * 25.0 / 50.0;
        level / ((1.0 - r * r).powi(2) + (r / 4.0).powi(2)).sqrt()
    };
    for (harmonic, level) in [(2, 0.3), (1, 0.8), (2, 0.26)] {
        let reported = match rig.send(&of(harmonic, level)) {
            Event::Refused(Refusal::Travel { travel_per_mille, .. }) => f64::from(travel_per_mille) / 1000.0,
            other => panic!("{harmonic}: {other:?}"),
        };
        let wanted = travel(harmonic.into(), level);
        assert!(
            wanted > 1.0 && (reported / wanted - 1.0).abs() < 0.003,
            "{harmonic}: {reported}, not {wanted}"
        );
    }
    for (harmonic, level) in [(40, 1.0), (2, 0.24)] {
        rig.accepted(&of(harmonic, level));
        rig.live_ms(60);
        rig.accepted(&Command::Stop);
        rig.live_ms(60);
    }
}

#[test]
fn a_drive_takes_over_a_combs_tones_and_the_mirror_replays_every_code() {
    let mut loopback = Loopback::connect(RATE_HZ).unwrap();
    let knots = (0..=64).map(|i| (60e3 - 625.0 * f64::from(i), 0.5 + f64::from(i) / 128.0));
    let table = DeviceTable::from_knots((0.08, 0.27), f64::from(RATE_HZ), knots, 1e-6).unwrap();
    let mut sent: Vec<u16> = Vec::new();
    let before = loopback.samples();
    let mut perform = |request| loopback.perform(request, |codes| sent.extend(codes)).unwrap();
    perform(Request::Upload(Arc::new(table)));
    let tones = TONES.map(|(harmonic, level, phase_turns)| HarmonicRequest { harmonic, level, phase_turns });
    let request = CombRequest { apply: Apply::Next, ..CombRequest::of(PERIOD_BLOCKS, tones.to_vec()) };
    let began = perform(Request::Play(Sounding::Comb(request.clone())));
    let mut drive = DriveRequest::at(&[(0.1, 0.3)]);
    drive.glide_s = 0.03;
    loopback.pass(20_000, |codes| sent.extend(codes));
    let mut perform = |request| loopback.perform(request, |codes| sent.extend(codes)).unwrap();
    // The tone of 234 Hz glides to some 50 kHz; the others fade.
    perform(Request::Play(Sounding::Drive(drive)));
    loopback.pass(40_000, |codes| sent.extend(codes));
    let mut perform = |request| loopback.perform(request, |codes| sent.extend(codes)).unwrap();
    perform(Request::Stop);
    let again = perform(Request::Play(Sounding::Comb(request)));
    loopback.pass(20_000, |codes| sent.extend(codes));
    loopback.perform(Request::Refresh, |codes| sent.extend(codes)).unwrap();
    let history = DeviceHistory::of(loopback.view()).unwrap();
    let mut replay = Replay::new(10_000_000);
    replay.follow(&history);
    for (from, count) in [(began, 60_000), (again, 15_000)] {
        let replayed: Vec<u16> = replay.exact_codes(from, count).expect("exact").collect();
        let device = &sent[(from - before) as usize..][..count as usize];
        assert_eq!(replayed.iter().zip(device).position(|(a, b)| a != b), None);
        assert!(device.iter().any(|code| *code > 3000), "it sounds");
    }
}

#[test]
fn a_comb_waits_for_the_trigger_and_a_newer_drive_replaces_it() {
    let mut rig = Rig::armed();
    rig.accepted(&Command::Comb(Comb { apply: Apply::AtTrigger, ..example() }));
    rig.live_ms(5);
    assert!(rig.device.waits_for_trigger());
    rig.accepted(&Command::Drive(drive(&[(0, 0.3, 0.5)], 2000)));
    assert!(!rig.device.waits_for_trigger());
}
