//! Chords through the protocol: an accepted chord sounds code by code; one that does not fit is refused.

use slipline_link::mirror::chord_extent;
use slipline_link::mirror::replay::{DeviceHistory, Replay};
use slipline_link::simulator::loopback::Loopback;
use slipline_link::{Change, ChordRequest, DeviceTable, HarmonicRequest, Played, Request, Sounding};
use slipline_protocol::Command;
use slipline_protocol::command::{Apply, Chord, Drive, TravelLimit, TravelSetting};
use slipline_protocol::event::{Event, State};
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::units::Level;
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, MID, RATE_HZ, Rig, Table, chord, drive};
use std::sync::Arc;

/// Sixteen tones of the usual table, 20 to 60 kHz at gains of 0.5 to 1, with Schroeder's phases: their amplitudes add up to
/// about 2.5 times full scale.
fn loud() -> Chord {
    let tones: Vec<(u16, f64, f64)> = (0..16u16)
        .map(|i| {
            let n = f64::from(i);
            (240 + 20 * i, 0.22, -n * n / 32.0)
        })
        .collect();
    chord(12, &tones)
}

fn with_levels(chord: &Chord, level: f64) -> Chord {
    let mut scaled = chord.clone();
    scaled.tones.iter_mut().for_each(|tone| tone.level = Level((level * 65_535.0) as u16));
    scaled
}

/// The lowest and the highest of these codes.
fn ends(codes: &[u16]) -> (u16, u16) {
    (*codes.iter().min().unwrap(), *codes.iter().max().unwrap())
}

/// The usual table as the host holds it.
fn table() -> DeviceTable {
    let usual = Table::usual();
    let hz = |step: u32| f64::from(step) / 4_294_967_296.0 * f64::from(RATE_HZ);
    let knots =
        usual.knots.iter().map(|knot| (hz(knot.step), f64::from(knot.gain.0) / f64::from(1u32 << 31)));
    let table = DeviceTable::from_knots((0.08, 0.27), f64::from(RATE_HZ), knots, 1e-6).unwrap();
    assert_eq!(table.knots(), usual.knots);
    table
}

#[test]
fn the_proven_peak_matches_the_hosts_and_that_of_the_sent_codes() {
    let mut rig = Rig::armed();
    let begin = rig.accepted(&Command::Chord(loud()));
    rig.live_ms(10);
    assert!(rig.status().sum_per_mille > 2000, "more than a drive may have");
    rig.record();
    let period = 1 << 12;
    rig.live_blocks(2 * period / BLOCK);
    let codes = &rig.recording.codes;
    assert_eq!(ends(codes), chord_extent(&loud(), &table()).unwrap().codes());
    assert_eq!(codes[..period as usize], codes[period as usize..], "it repeats");
    assert_eq!((rig.status().state, rig.status().counters.clips), (State::Driving, 0));
    assert!(rig.recording.first > begin);
    // A step louder than fits: refused with the peak, and not a code is other than silence.
    let fits = f64::from(1u32 << 27) / f64::from(chord_extent(&loud(), &table()).unwrap().peak()) * 0.22;
    for (level, is_accepted) in [(0.999 * fits, true), (1.001 * fits, false)] {
        let mut rig = Rig::armed();
        let answer = rig.send(&Command::Chord(with_levels(&loud(), level)));
        rig.record();
        rig.live_ms(20);
        match answer {
            Event::Accepted(_) => {
                assert!(is_accepted);
                let (low, high) = ends(&rig.recording.codes);
                assert!((low <= 5 || high >= 4091) && low >= 1, "{low} {high}");
            }
            Event::Refused(Refusal::Peak { peak_per_mille }) => {
                assert!(!is_accepted);
                assert!((1001..=1002).contains(&peak_per_mille), "{peak_per_mille}");
                assert!(rig.recording.codes.iter().all(|&code| code == MID));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_false_chord_is_refused_and_makes_no_sound() {
    let mut rig = Rig::armed();
    rig.record();
    let range = |field, min, max, got| Refusal::OutOfRange { field, min, max, got };
    // 20 to 60 kHz are the multiples 205 to 614 of 97.7 Hz.
    let harmonic = |min, got| range(Field::Harmonic, min, 614, got);
    for (tones, refusal) in [
        (&[(0, 0.1, 0.0)][..], harmonic(205, 0)),
        (&[(204, 0.1, 0.0)], harmonic(205, 204)),
        (&[(2048, 0.1, 0.0)], harmonic(205, 2048)),
        (&[(u16::MAX, 0.1, 0.0)], harmonic(205, 65_535)),
        (&[(300, 0.1, 0.0), (300, 0.1, 0.5)], harmonic(301, 300)),
        (&[(301, 0.1, 0.0), (300, 0.1, 0.0)], harmonic(302, 300)),
        (&[], range(Field::ToneCount, 1, 16, 0)),
    ] {
        assert_eq!(rig.refused(&Command::Chord(chord(12, tones))), refusal);
    }
    for period_log2 in [0, 6, 15, 64, 255] {
        let refused = rig.refused(&Command::Chord(Chord { period_log2, ..loud() }));
        assert_eq!(refused, range(Field::ChordPeriod, 7, 14, period_log2.into()));
    }
    let refused = rig.refused(&Command::Chord(Chord { glide: 1999, ..loud() }));
    assert_eq!(refused, range(Field::Glide, 2000, 4_000_000, 1999));
    // Sixteen tones in phase: the sum is the peak. Louder still, and no phases could help.
    let mut meet = with_levels(&loud(), 0.4);
    meet.tones.iter_mut().for_each(|tone| tone.phase.0 = 16_384);
    let Refusal::Peak { peak_per_mille } = rig.refused(&Command::Chord(meet)) else { panic!() };
    assert!((4500..5657).contains(&peak_per_mille), "{peak_per_mille}");
    let refused = rig.refused(&Command::Chord(with_levels(&loud(), 1.0)));
    assert!(matches!(refused, Refusal::Headroom { sum_per_mille: 5658.. }), "{refused:?}");
    rig.live_ms(20);
    assert!(rig.recording.codes.iter().all(|&code| code == MID));
    // The travel's limit counts, and so do the states.
    let limit = TravelLimit { resonance_uhz: 30_000_000_000, quality_per_mille: 1000, static_ppm: 1_000_000 };
    rig.send(&Command::SetTravelLimit(TravelSetting { limit: Some(limit) }));
    let refused = rig.refused(&Command::Chord(loud()));
    assert!(matches!(refused, Refusal::Travel { travel_per_mille: 1001.., .. }), "{refused:?}");
    rig.accepted(&Command::Disarm);
    assert_eq!(rig.refused(&Command::Chord(loud())), Refusal::NotArmed);
    let mut rig = Rig::greeted();
    rig.arm();
    assert_eq!(rig.refused(&Command::Chord(loud())), Refusal::NoTable);
}

#[test]
fn a_chord_waits_for_silence_and_fades_whatever_its_sum() {
    let mut rig = Rig::driving(&[(0, 0.1, 0.5)], 2000, 10);
    assert_eq!(rig.refused(&Command::Chord(loud())), Refusal::Busy(Busy::DriveActive));
    // A chord waits for the end of a fade.
    let fade = rig.accepted(&Command::Drive(drive(&[], 20_000)));
    rig.live_blocks(4);
    let at = rig.accepted(&Command::Chord(loud()));
    assert_eq!(at, (fade + 20_000).next_multiple_of(BLOCK));
    rig.live_ms(100);
    assert_eq!(rig.status().state, State::Driving);
    assert_eq!(rig.refused(&Command::Chord(loud())), Refusal::Busy(Busy::DriveActive));
    // A drive of any tones begins with the chord's sum.
    let refused = rig.refused(&Command::Drive(drive(&[(0, 0.1, 0.01)], 20_000)));
    assert!(matches!(refused, Refusal::Headroom { sum_per_mille: 2000.. }), "{refused:?}");
    rig.stage(&Table::line(65, 59_000.0, 21_000.0, |_| 1.0));
    assert!(matches!(rig.refused(&Command::TableCommit), Refusal::Headroom { .. }));
    let fade = rig.play(&[], 2000, 10);
    assert_eq!(rig.recording.from(fade + 2048).iter().find(|&&code| code != MID), None);
    assert_eq!((rig.status().state, rig.status().counters.clips), (State::Armed, 0));
    // A chord within the sum is like any tones: a drive takes them on.
    rig.accepted(&Command::Chord(with_levels(&loud(), 0.05)));
    rig.live_ms(10);
    rig.play(&[(0, 0.1, 0.2)], 4000, 20);
    assert_eq!(rig.status().counters.clips, 0);
}

#[test]
fn a_chord_begins_at_its_index_or_at_the_trigger() {
    let mut rig = Rig::armed();
    let ahead = rig.device.now() + 10_000;
    let at = rig.accepted(&Command::Chord(Chord { apply: Apply::At(ahead), ..loud() }));
    assert_eq!(at, ahead.next_multiple_of(BLOCK));
    rig.record();
    rig.live_ms(50);
    let first = rig.recording.first_sound(rig.recording.first).unwrap();
    assert!((at..at + 2 * BLOCK).contains(&first), "{at} {first}");
    rig.accepted(&Command::Stop);
    rig.live_ms(50);
    rig.accepted(&Command::Chord(Chord { apply: Apply::AtTrigger, ..loud() }));
    rig.record();
    rig.live_ms(20);
    assert_eq!((rig.status().state, ends(&rig.recording.codes)), (State::Waiting, (MID, MID)));
    rig.device.raise_trigger();
    rig.live_ms(20);
    assert_eq!(
        ends(rig.recording.from(rig.device.now() - 4096)),
        chord_extent(&loud(), &table()).unwrap().codes()
    );
}

#[test]
fn the_link_sends_chords_and_its_mirror_replays_them_code_by_code() {
    let mut loopback = Loopback::connect(RATE_HZ).unwrap();
    let mut sent = Vec::new();
    let before = loopback.samples();
    let mut perform =
        |loopback: &mut Loopback, request| loopback.perform(request, |codes| sent.extend(codes));
    perform(&mut loopback, Request::Upload(Arc::new(table()))).unwrap();
    let tones = (0..16u16).map(|i| HarmonicRequest {
        harmonic: 240 + 20 * i,
        level: 0.22,
        phase_turns: -f64::from(i).powi(2) / 32.0,
    });
    let request = ChordRequest { glide_s: 0.005, ..ChordRequest::of(12, tones.collect()) };
    let at = perform(&mut loopback, Request::Play(Sounding::Chord(request.clone()))).unwrap();
    loopback.pass(50_000, |codes| sent.extend(codes));
    let mut perform =
        |loopback: &mut Loopback, request| loopback.perform(request, |codes| sent.extend(codes));
    perform(&mut loopback, Request::Stop).unwrap();
    let louder =
        ChordRequest { tones: vec![HarmonicRequest { level: 1.1, ..request.tones[0] }], ..request.clone() };
    let refused = perform(&mut loopback, Request::Play(Sounding::Chord(louder))).unwrap_err();
    assert!(refused.to_string().contains("level is 1.1; allowed are 0 to 1"), "{refused}");
    // The stop ramps: the chord is sent again until it is taken.
    let again =
        perform(&mut loopback, Request::Play(Sounding::Chord(ChordRequest { master_db: -3.0, ..request })))
            .unwrap();
    loopback.pass(30_000, |codes| sent.extend(codes));
    loopback.perform(Request::Refresh, |codes| sent.extend(codes)).unwrap();
    assert!(again > at + 50_000);
    let chords: Vec<_> = loopback
        .view()
        .record
        .journal
        .iter()
        .filter_map(|entry| match &entry.change {
            Change::Play(Played::Chord(chord)) => Some((entry.at, chord.glide, chord.master.0)),
            _ => None,
        })
        .collect();
    assert_eq!(chords, [(at, 2000, 0), (again, 2000, -300)]);
    let history = DeviceHistory::of(loopback.view()).unwrap();
    let mut replay = Replay::new(10_000_000);
    replay.follow(&history);
    for from in [at, again] {
        let count = 20_000;
        let replayed: Vec<u16> = replay.exact_codes(from, count).expect("exact").collect();
        let device = &sent[(from - before) as usize..][..count as usize];
        assert_eq!(replayed, device);
        assert!(ends(device).1 > 2800, "it sounds");
    }
}

#[test]
fn to_a_host_of_1_1_a_chord_is_no_message() {
    let mut rig = Rig::armed();
    rig.hello_of_minor(1);
    rig.live_ms(50);
    rig.arm();
    assert_eq!(rig.refused(&Command::Chord(loud())), Refusal::UnknownMessage { id: 0x19 });
}

#[test]
fn a_newer_chord_takes_the_place_of_a_drive_that_waits() {
    let mut rig = Rig::armed();
    let waiting = Drive { apply: Apply::AtTrigger, ..drive(&[(0, 0.1, 0.5)], 2000) };
    rig.accepted(&Command::Drive(waiting));
    rig.live_ms(5);
    let at = rig.accepted(&Command::Chord(loud()));
    rig.record();
    rig.live_ms(10);
    assert!(rig.recording.first_sound(rig.recording.first).is_some_and(|first| first < at + 2 * BLOCK));
}

#[test]
fn a_chord_is_fitted_to_the_linear_part_of_the_devices_output() {
    let identity = Loopback::connect(RATE_HZ).unwrap().view().device.identity.clone().unwrap();
    let loud = loud();
    let tone = |tone: &slipline_protocol::command::ChordTone| HarmonicRequest {
        harmonic: tone.harmonic,
        level: f64::from(tone.level.0) / 65_535.0,
        phase_turns: f64::from(tone.phase.0) / 4_294_967_296.0,
    };
    let chord = ChordRequest::of(12, loud.tones.iter().map(tone).collect());
    for linear in [1.0, 0.88] {
        let fitted =
            chord.clone().fitted(&identity, &table(), linear).unwrap().for_device(&identity, None).unwrap();
        let (low, high) = chord_extent(&fitted, &table()).unwrap().codes();
        let swing = f64::from((high - MID).max(MID - low)) / 2048.0;
        assert!(swing <= linear + 1e-3 && swing > linear - 0.01, "{linear}: {low} {high}");
    }
}
