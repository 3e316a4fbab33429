//! The replay on journals with gaps, with stops of the device and with long silences.

use super::exactness::FOLDBACK_SETTLES;
use super::*;
use crate::table::DeviceTable;
use slipline_protocol::command::{Apply, Drive, Tone};
use slipline_protocol::units::{CentiDecibel, Level, Phase, Position};
use std::sync::Arc;

const RATE_HZ: u32 = 400_000;

fn drive(position: u16) -> Change {
    let tone = Tone { slot: 0, position: Position(position), level: Level::FULL, phase: Phase(0) };
    let tones = [tone].into_iter().collect();
    let drive = Drive { tones, master: CentiDecibel(0), glide: 2000, apply: Apply::Next };
    Change::Play(drive.into())
}

fn table() -> Arc<DeviceTable> {
    let knots = (0..65).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
    Arc::new(DeviceTable::from_knots((0.1, 0.2), f64::from(RATE_HZ), knots, 1e-6).unwrap())
}

fn history(entries: &[(u64, u64, Change)], now: u64) -> DeviceHistory {
    let entry = |(number, at, change): &(u64, u64, Change)| {
        Arc::new(Acknowledged { number: *number, at: *at, change: change.clone(), is_exact: true })
    };
    let journal = Arc::new(entries.iter().map(entry).collect());
    let foldback_per_mille = 1000;
    DeviceHistory { sample_rate_hz: RATE_HZ, journal, table: Some(table()), now, foldback_per_mille }
}

/// A replay that has followed these entries, up to `now`.
fn followed(entries: &[(u64, u64, Change)], now: u64) -> Replay {
    let mut replay = Replay::new(RATE_HZ as usize);
    replay.follow(&history(entries, now));
    replay
}

/// Whether all kept codes are exact.
fn is_exact(replay: &Replay) -> bool {
    replay.exact_since().is_some_and(|since| since <= replay.codes().0)
}

#[test]
fn after_missing_entries_the_codes_are_exact_from_the_next_silence_and_the_table_is_kept() {
    let mut replay = followed(&[(1, 12_800, Change::Session), (2, 25_600, drive(20_000))], 128_000);
    assert!(is_exact(&replay));
    replay.follow(&history(&[(40, 256_000, Change::Stop)], 260_000));
    assert!(!is_exact(&replay));
    let later = [(40, 256_000, Change::Stop), (41, 512_000, drive(20_000))];
    replay.follow(&history(&later, 640_000));
    assert!(is_exact(&replay));
    assert!(replay.codes().1.iter().any(|&code| code > 2500), "the table was kept");
}

#[test]
fn a_drive_after_missing_entries_is_not_exact_while_an_unknown_drive_may_sound() {
    let mut replay = followed(&[(1, 12_800, Change::Session)], 128_000);
    // Entry 2 may have been a drive: entry 3 is then a glide from unknown tones.
    replay.follow(&history(&[(3, 512_000, drive(20_000))], 640_000));
    assert_eq!(replay.exact_since(), None);
    assert!(replay.exact_codes(600_000, 1000).is_none());
}

#[test]
fn a_stop_of_the_devices_own_makes_the_codes_inexact_until_the_next_silence() {
    let entries = [(1, 12_800, Change::Session), (2, 25_600, drive(20_000)), (3, 200_000, Change::Stop)];
    let mut replay = followed(&entries[..2], 128_000);
    let mut own = history(&entries, 204_800);
    Arc::make_mut(Arc::make_mut(&mut own.journal).back_mut().unwrap()).is_exact = false;
    replay.follow(&own);
    assert!(!is_exact(&replay));
    Arc::make_mut(&mut own.journal)
        .extend(history(&[(4, 512_000, drive(20_000))], 0).journal.iter().cloned());
    replay.follow(&DeviceHistory { now: 640_000, ..own });
    assert!(is_exact(&replay) && !replay.codes().1.is_empty());
}

#[test]
fn dropped_steps_of_the_fold_back_cost_only_the_codes_before_the_next_one() {
    let start = [(1, 12_800, Change::Session), (2, 25_600, drive(20_000))];
    let mut replay = followed(&start, 128_000);
    let later = [start[0].clone(), start[1].clone(), (9, 131_072, Change::Limit(900))];
    replay.follow(&history(&later, 256_000));
    assert!(is_exact(&replay) && !replay.codes().1.is_empty());
    assert_eq!(replay.exact_since(), Some(131_072 + FOLDBACK_SETTLES));
}

#[test]
fn dropped_steps_are_caught_up_from_the_next_status() {
    let entries = [(1, 12_800, Change::Session), (2, 25_600, drive(20_000)), (9, 200_000, drive(30_000))];
    let mut replay = followed(&entries[..2], 128_000);
    // A new period of the fold-back has begun with the last block.
    replay.follow(&history(&entries, 256_000 + BLOCK as u64));
    assert_eq!(replay.exact_since(), Some(256_000 + FOLDBACK_SETTLES));
}

#[test]
fn a_fold_back_step_in_a_silence_counts_although_it_is_reported_after_the_next_drive() {
    let entries = [
        (1, 0, Change::Limit(500)),
        (2, 12_800, Change::Session),
        (3, 144_128, drive(20_000)),
        (4, 128_000, Change::Limit(551)),
    ];
    // The codes of the last block are not known before the next one is rendered.
    let replay = followed(&entries, 182_400 + BLOCK as u64);
    let mut mirror = Mirror::new(RATE_HZ, 12_800);
    mirror.acknowledge_table(table().knots().into(), 12_800).unwrap();
    mirror.acknowledge_limit(551, 0).unwrap();
    let Change::Play(drive) = &entries[2].2 else { panic!() };
    mirror.acknowledge_play(drive.clone(), 144_128).unwrap();
    let mut rendered = Vec::new();
    mirror.render(182_400, |_, codes| rendered.extend_from_slice(codes));
    let codes = replay.exact_codes(144_128, 38_272).expect("exact");
    assert!(codes.eq(rendered[rendered.len() - 38_272..].iter().copied()));
}

#[test]
fn codes_over_a_skipped_silence_match_a_mirror_that_renders_all_of_it() {
    let entries = [
        (1, 12_800, Change::Session),
        (2, 25_600, drive(20_000)),
        (3, 102_400, Change::Stop),
        (4, 307_200, drive(50_000)),
    ];
    // Followed at once, and entry by entry.
    let mut in_steps = Replay::new(RATE_HZ as usize);
    for (count, now) in [(1, 20_000), (2, 90_000), (3, 110_000), (3, 300_000), (4, 384_000)] {
        in_steps.follow(&history(&entries[..count], now));
    }
    let at_once = followed(&entries, 384_000);
    let mut mirror = Mirror::new(RATE_HZ, 12_800);
    mirror.acknowledge_table(table().knots().into(), 12_800).unwrap();
    for (_, at, change) in &entries {
        if let Change::Play(drive) = change {
            mirror.acknowledge_play(drive.clone(), *at).unwrap();
        } else if matches!(change, Change::Stop) {
            mirror.acknowledge_stop(Stop::Normal, *at).unwrap();
        }
    }
    let mut whole = Vec::new();
    mirror.render(384_000, |_, codes| whole.extend_from_slice(codes));
    let window = |from: u64, count: u32| whole[(from - 12_800) as usize..][..count as usize].to_vec();
    for replay in [&at_once, &in_steps] {
        for (from, count) in [(20_000, 90_000), (90_001, 250_000), (190_000, 7), (300_000, 80_000)] {
            let codes: Vec<u16> = replay.exact_codes(from, count).unwrap().collect();
            assert!(codes == window(from, count), "{count} from {from}");
        }
        assert!(replay.exact_codes(383_000, 2000).is_none(), "not sent yet");
    }
}

#[test]
fn a_table_that_comes_during_a_silence_is_in_force_after_it() {
    // Soon after the session's beginning, and long after it.
    for at in [25_600, 92_800, 93_440, 400_000] {
        let entries =
            [(1, 12_800, Change::Session), (2, at, Change::Table(table())), (3, 600_064, drive(20_000))];
        let mut replay = Replay::new(RATE_HZ as usize);
        for (count, now) in [(1, 20_000), (2, 420_096), (3, 700_032)] {
            replay.follow(&DeviceHistory { table: None, ..history(&entries[..count], now) });
        }
        assert!(is_exact(&replay), "{at}");
        assert!(replay.codes().1.iter().any(|&code| code > 2500), "{at}");
    }
}

#[test]
fn a_stop_that_began_in_the_last_block_is_replayed_exactly() {
    let entries = [
        (1, 12_800, Change::Session),
        (2, 25_600, drive(20_000)),
        (3, 76_801, Change::EmergencyStop),
        (4, 307_200, drive(50_000)),
    ];
    // The status before the stop was a block too late.
    let mut replay = followed(&entries[..2], 76_928);
    replay.follow(&history(&entries, 384_000));
    assert!(is_exact(&replay));
    let mut mirror = Mirror::new(RATE_HZ, 12_800);
    mirror.acknowledge_table(table().knots().into(), 12_800).unwrap();
    let Change::Play(drive) = &entries[1].2 else { panic!() };
    mirror.acknowledge_play(drive.clone(), 25_600).unwrap();
    mirror.acknowledge_stop(Stop::Emergency, 76_801).unwrap();
    let mut whole = Vec::new();
    mirror.render(100_000, |_, codes| whole.extend_from_slice(codes));
    let codes: Vec<u16> = replay.exact_codes(70_000, 20_000).expect("exact").collect();
    assert_eq!(codes, whole[70_000 - 12_800..][..20_000]);
}

#[test]
fn silence_is_known_without_being_rendered() {
    let replay = followed(&[(1, 12_800, Change::Session)], 400_000_000);
    assert!(replay.is_silent());
    let mut codes = replay.exact_codes(399_000_000, 1000).unwrap();
    assert!(codes.all(|code| code == MID_SCALE));
}
