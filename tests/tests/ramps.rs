//! How the sound begins and ends: ramps, the mute pin, and the very first codes.

use slipline_link::simulator::Options;
use slipline_protocol::Command;
use slipline_protocol::command::{Apply, Drive};
use slipline_protocol::event::{AcceptedUntil, Event, Fault, ResetCause, State};
use slipline_protocol::limits::{EMERGENCY_RAMP_MS, STOP_RAMP_MS};
use slipline_protocol::units::Phase;
use slipline_tests::client::Client;
use slipline_tests::measure::{envelope, peak};
use slipline_tests::rig::{BLOCK, MID, Rig, Table, drive, tone};

/// Sounds 20 kHz at full scale.
fn driving() -> Rig {
    let mut rig = Rig::driving(&[(0, 1.0, 1.0)], 2000, 20);
    rig.record();
    rig
}

#[test]
fn a_stop_is_a_ramp_of_its_stated_length_and_leaves_the_device_armed() {
    //
    let mut rig = driving();
    let at = rig.accepted(&Command::Stop);
    assert_eq!(rig.status().state, State::Stopping);
    rig.live_ms(60);
    let end = rig.recording.end_of_sound().unwrap();
    let ramp = rig.samples(STOP_RAMP_MS);
    assert!((20..=50).contains(&STOP_RAMP_MS));
    assert!(end <= at + ramp + BLOCK && end > at + ramp * 8 / 10, "{} of {ramp}", end - at);
    // Half-way down half is left: the ramp is a raised cosine.
    let middle = rig.recording.from(at + ramp / 2 - 100);
    assert!((900..1150).contains(&peak(&middle[..200])), "{}", peak(&middle[..200]));
    let peaks = envelope(&rig.recording.from(at)[..ramp as usize], 100);
    assert!(peaks.windows(2).all(|pair| pair[1] <= pair[0] + 1), "{peaks:?}");
    assert_eq!(rig.status().state, State::Armed);
    assert!(!rig.device.is_muted());
}

#[test]
fn an_emergency_stop_is_silent_within_its_time_then_mutes_and_latches() {
    //
    let mut rig = driving();
    let at = rig.accepted(&Command::EmergencyStop);
    assert!(at - rig.recording.first <= BLOCK);
    rig.live_ms(20);
    let end = rig.recording.end_of_sound().unwrap();
    const { assert!(EMERGENCY_RAMP_MS <= 2) };
    assert!(end <= at + rig.samples(EMERGENCY_RAMP_MS) + BLOCK, "{}", end - at);
    assert!(!rig.recording.was_muted(end - 1), "not before the ramp is out");
    assert!(rig.recording.was_muted(end + 8 * BLOCK));
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::EmergencyStop)));
}

#[test]
fn a_glide_that_takes_longer_than_asked_says_until_when() {
    // The law of PROTOCOL.md: 131072 (n k + 2 d) samples.
    let table = Table::line(65, 60_000.0, 20_000.0, |_| 1.0);
    let step = (60_000.0 - 20_000.0) / 64.0 / 400_000.0;
    let needed = 131_072.0 * (0.9 - 0.1) * 64.0 * step;
    for (minor, asked, takes) in
        [(3, 2000, Some(needed)), (3, needed as u32 + 10, None), (2, 2000, None), (0, 2000, None)]
    {
        let mut rig = Rig::default();
        rig.hello_of_minor(minor);
        rig.upload(&table);
        rig.arm();
        rig.play(&[(0, 0.1, 0.3), (1, 0.5, 0.3)], 2000, 20);
        match (rig.send(&Command::Drive(drive(&[(0, 0.9, 0.3), (1, 0.5, 0.3)], asked))), takes) {
            (Event::AcceptedUntil(AcceptedUntil { at, until }), Some(takes)) => {
                assert!(((until - at) as f64 - takes).abs() < 3.0, "{} of {takes}", until - at);
            }
            (Event::Accepted(_), None) => {}
            other => panic!("minor {minor}: {other:?}"),
        }
    }
}

#[test]
fn a_slow_stop_does_not_lengthen_a_quick_one() {
    //
    let mut rig = driving();
    let at = rig.accepted(&Command::EmergencyStop);
    rig.live_blocks(1);
    rig.accepted(&Command::Stop);
    rig.send(&Command::Disarm);
    rig.live_ms(20);
    let end = rig.recording.end_of_sound().unwrap();
    assert!(end <= at + rig.samples(EMERGENCY_RAMP_MS) + BLOCK, "{}", end - at);
}

#[test]
fn a_quick_stop_shortens_a_slow_one() {
    let mut rig = driving();
    rig.accepted(&Command::Stop);
    rig.live_blocks(4);
    let at = rig.accepted(&Command::EmergencyStop);
    rig.live_ms(60);
    let end = rig.recording.end_of_sound().unwrap();
    assert!(end <= at + rig.samples(EMERGENCY_RAMP_MS) + BLOCK, "{}", end - at);
}

#[test]
fn a_stop_drops_the_drive_that_was_to_begin_later() {
    // from silence and from sound.
    for sounding in [false, true] {
        let mut rig = Rig::armed();
        if sounding {
            rig.play(&[(0, 1.0, 1.0)], 2000, 20);
        }
        let at = rig.device.now() + rig.samples(200);
        let later = Drive { apply: Apply::At(at), ..drive(&[(1, 0.5, 1.0)], 2000) };
        rig.accepted(&Command::Drive(later));
        rig.accepted(&Command::Stop);
        rig.live_ms(STOP_RAMP_MS + 5);
        rig.record();
        rig.live_ms(400);
        assert_eq!(rig.recording.first_sound(rig.recording.first), None);
        assert_eq!(rig.status().state, State::Armed);
    }
}

#[test]
fn a_stop_right_after_drives_overtakes_them() {
    // all in one breath; the stop is seen before the first drive is looked at.
    let mut rig = Rig::armed();
    let mut bytes = Vec::new();
    for step in 0..5u8 {
        bytes.extend(rig.frame(&Command::Drive(drive(&[(step, 0.5, 1.0)], 2000))));
    }
    bytes.extend(rig.frame(&Command::Stop));
    rig.record();
    rig.device.feed(&bytes);
    rig.live_ms(100);
    assert_eq!(rig.recording.first_sound(rig.recording.first), None);
    rig.collect();
    rig.replies.clear();
    assert_eq!(rig.status().state, State::Armed);
}

#[test]
fn after_every_kind_of_reset_the_amplifier_is_muted_over_mid_scale_until_armed() {
    //
    for cause in [ResetCause::PowerOn, ResetCause::Pin, ResetCause::Watchdog, ResetCause::BrownOut] {
        let mut rig = Rig::new(Options::default());
        rig.device.restart(cause);
        rig.record();
        rig.silent_ms(50);
        assert!(rig.recording.codes.iter().all(|&code| code == MID));
        assert!(rig.recording.muted.iter().all(|&muted| muted));
    }
}

#[test]
fn the_amplifier_is_unmuted_only_over_mid_scale_and_before_the_first_sound() {
    // as the pin and the codes were recorded, block by block. The drive comes with the arming, in one breath.
    let mut rig = Rig::greeted();
    rig.upload(&slipline_tests::rig::Table::usual());
    rig.silent_ms(5);
    let armed_at = rig.status().now;
    let ready = rig.accepted(&Command::Arm);
    let at = rig.accepted(&Command::Drive(drive(&[(0, 1.0, 1.0)], 2000)));
    assert_eq!(at, ready);
    rig.keep_alive();
    rig.live_ms(10);
    let unmuted = rig.recording.muted.iter().position(|&muted| !muted).unwrap();
    let first_sound = rig.recording.first_sound(0).unwrap();
    assert_eq!(unmuted as u64 * BLOCK, ready, "after some blocks of mid-scale, and not before");
    assert!(ready >= armed_at + 4 * BLOCK);
    assert!(first_sound >= at);
    assert!(rig.recording.muted[unmuted..].iter().all(|&muted| !muted));

    rig.record();
    rig.accepted(&Command::Disarm);
    rig.live_ms(60);
    let end = rig.recording.end_of_sound().unwrap();
    let muted = rig.recording.muted.iter().position(|&muted| muted).unwrap() as u64 * BLOCK;
    assert!(rig.recording.first + muted >= end + 2 * BLOCK, "the ramp is out of the DAC before the mute");
}

#[test]
fn dragging_at_a_thousand_drives_a_second_is_taken_without_a_refusal() {
    let mut rig = driving();
    for step in 0..500u32 {
        let place = 0.5 + 0.4 * (f64::from(step) / 50.0).sin();
        rig.accepted(&Command::Drive(drive(&[(0, place, 0.9)], 2000)));
        rig.live_blocks(if step % 8 == 0 { 4 } else { 3 });
    }
    assert_eq!(rig.status().state, State::Driving);
}

/// A tone of 20 kHz that begins at a phase, in turns, in a slot that has played something else before or has not: its
/// codes from where it begins on.
fn begun_at(phase: f64, is_used: bool) -> Vec<u16> {
    let mut rig = Rig::armed();
    if is_used {
        rig.play(&[(0, 0.2, 0.7)], 2000, 20);
        rig.play(&[], 2000, 20);
    }
    rig.record();
    let mut tone = tone(0, 1.0, 0.8);
    tone.phase = Phase((phase * 65_536.0) as u16);
    let tones = [tone].into_iter().collect();
    let at = rig.accepted(&Command::Drive(Drive { tones, ..drive(&[], 2000) }));
    rig.live_ms(20);
    rig.recording.from(at)[..4000].to_vec()
}

#[test]
fn a_tone_begins_at_its_phase_whatever_its_slot_played_before() {
    for phase in [0.0, 0.125, 0.25, 0.6, 0.9375] {
        let codes = begun_at(phase, false);
        assert_eq!(begun_at(phase, true), codes, "{phase} turns");
        // Against sine and cosine of 20 samples a period, over whole periods of the steady part.
        let (sine, cosine) = (2000..4000).fold((0.0, 0.0), |(sine, cosine), n| {
            let (s, c) = (std::f64::consts::TAU * f64::from(n) / 20.0).sin_cos();
            let value = f64::from(codes[n as usize]) - f64::from(MID);
            (sine + s * value, cosine + c * value)
        });
        let turns = cosine.atan2(sine) / std::f64::consts::TAU;
        let off = (turns - phase).rem_euclid(1.0);
        assert!(off.min(1.0 - off) < 1e-3, "{phase} turns: {turns}");
    }
}
