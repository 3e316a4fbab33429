//! Values out of range, and drives that would be too loud: refused by name before anything changes.

use proptest::prelude::*;
use slipline_protocol::command::{Apply, DigestWindow, Drive};
use slipline_protocol::event::{Event, State};
use slipline_protocol::limits::{MAX_APPLY_AHEAD_MS, MAX_DIGEST_SAMPLES};
use slipline_protocol::refusal::{Busy, Field};
use slipline_protocol::units::CentiDecibel;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::measure::peak;
use slipline_tests::rig::{BLOCK, Rig, Table, drive, tone};

#[test]
fn every_master_level_that_is_out_of_range_is_refused_with_its_range() {
    // there are no floats on the wire, so every value of the field can be tried.
    let mut rig = Rig::armed();
    for master in (i16::MIN..=i16::MAX).step_by(3).chain([-9601, -9600, 0, 1, i16::MAX]) {
        let command = Command::Drive(Drive { master: CentiDecibel(master), ..drive(&[(0, 0.5, 0.5)], 2000) });
        if (-9600..=0).contains(&master) {
            continue;
        }
        assert_eq!(
            rig.refused(&command),
            Refusal::OutOfRange { field: Field::MasterLevel, min: -9600, max: 0, got: master.into() }
        );
    }
    assert_eq!(rig.status().state, State::Armed);
    for master in [-9600, 0] {
        rig.accepted(&Command::Drive(Drive {
            master: CentiDecibel(master),
            ..drive(&[(0, 0.5, 0.5)], 2000)
        }));
        rig.live_blocks(2);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_glide_a_slot_and_an_index_out_of_range_are_named(
        glide: u32,
        slot in 16u8..,
        past in 1u64..100_000,
        beyond in 1u64..1_000_000_000_000,
    ) {
        //
        let mut rig = Rig::armed();
        let range = 2000..=4_000_000;
        if !range.contains(&glide) {
            let refusal = rig.refused(&Command::Drive(drive(&[(0, 0.5, 0.5)], glide)));
            prop_assert_eq!(refusal, Refusal::OutOfRange { field: Field::Glide, min: 2000, max: 4_000_000, got: glide.into() });
        }
        let refusal = rig.refused(&Command::Drive(Drive { tones: [tone(slot, 0.5, 0.5)].into_iter().collect(), ..drive(&[], 2000) }));
        prop_assert_eq!(refusal, Refusal::OutOfRange { field: Field::ToneSlot, min: 0, max: 15, got: slot.into() });
        let refusal = rig.refused(&Command::Drive(drive(&[(3, 0.1, 0.1), (3, 0.2, 0.1)], 2000)));
        prop_assert_eq!(refusal, Refusal::SlotTwice { slot: 3 });

        let next = rig.status().now;
        let latest = next + rig.samples(MAX_APPLY_AHEAD_MS);
        for at in [next.saturating_sub(past), latest + beyond] {
            let command = Command::Drive(Drive { apply: Apply::At(at), ..drive(&[(0, 0.5, 0.5)], 2000) });
            prop_assert_eq!(
                rig.refused(&command),
                Refusal::OutOfRange { field: Field::ApplyAt, min: next as i64, max: latest as i64, got: at as i64 }
            );
        }
        prop_assert_eq!(rig.status().state, State::Armed);
    }

    #[test]
    fn an_index_to_apply_at_is_rounded_up_to_a_block_and_kept_to_the_sample(ahead in 0u64..20_000) {
        let mut rig = Rig::armed();
        let asked = rig.status().now + ahead;
        let command = Command::Drive(Drive { apply: Apply::At(asked), ..drive(&[(0, 0.5, 1.0)], 2000) });
        rig.record();
        let at = rig.accepted(&command);
        prop_assert_eq!(at, asked.next_multiple_of(BLOCK));
        let second = rig.refused(&Command::Drive(drive(&[(0, 0.6, 1.0)], 2000)));
        prop_assert_eq!(second, Refusal::Busy(Busy::CommitPending));
        rig.live_blocks(ahead / BLOCK + 10);
        let first = rig.recording.first_sound(rig.recording.first).unwrap();
        prop_assert!(first >= at && first - at < BLOCK, "{} {}", first, at);
    }

    #[test]
    fn what_is_accepted_never_clips_and_what_is_refused_would_have(
        levels in prop::collection::vec(0.0..0.6f64, 1..8),
        places in prop::collection::vec(0.0..=1.0f64, 8),
        moved in prop::collection::vec(0.0..=1.0f64, 8),
    ) {
        // with all phases aligned, the worst that the levels allow.
        let bumpy = Table::line(33, 3000.0, 9000.0, |u| 0.3 + 0.7 * (3.0 * std::f64::consts::PI * u).sin().abs());
        let mut rig = Rig::armed_with(&bumpy);
        let at = |places: &[f64]| -> Drive {
            let tones: Vec<_> = levels.iter().zip(places).enumerate().map(|(i, (&level, &place))| (i as u8, place, level)).collect();
            drive(&tones, 2000)
        };
        let mut last = at(&places);
        for next in [at(&places), at(&moved), at(&places)] {
            match rig.send(&Command::Drive(next.clone())) {
                Event::Accepted(_) | Event::AcceptedUntil(_) => last = next,
                Event::Refused(Refusal::Headroom { sum_per_mille }) => prop_assert!(sum_per_mille > 1000),
                other => prop_assert!(false, "{other:?}"),
            }
            // In the middle of the glide, and at its end.
            rig.live_ms(3);
            rig.live_ms(30);
        }
        let _ = last;
        prop_assert_eq!(rig.status().counters.clips, 0);
        prop_assert!(rig.status().sum_per_mille <= 1000);
        prop_assert!(peak(&rig.recording.codes) <= 2047);
    }
}

#[test]
fn full_scale_is_reached_exactly_and_one_step_more_is_refused() {
    // two tones at one place, in phase, with gains of 1.
    let flat = Table::line(3, 4000.0, 4001.0, |_| 1.0);
    let mut rig = Rig::armed_with(&flat);
    let mut full = drive(&[(0, 0.5, 0.0), (1, 0.5, 0.0)], 2000);
    full.tones[0].level.0 = 30_000;
    full.tones[1].level.0 = 35_535;
    rig.accepted(&Command::Drive(full.clone()));
    rig.live_ms(20);
    assert_eq!(peak(&rig.recording.codes), 2047);
    assert_eq!(rig.status().counters.clips, 0);
    full.tones[1].level.0 += 1;
    assert_eq!(rig.refused(&Command::Drive(full)), Refusal::Headroom { sum_per_mille: 1001 });
    assert_eq!(rig.status().sum_per_mille, 1000);
}

#[test]
fn a_position_of_high_gain_between_two_of_low_gain_counts_in_a_glide() {
    // the glide would pass the gain of 1 in the middle.
    let hill = Table::line(33, 3000.0, 9000.0, |u| 1.0 - 1.6 * (u - 0.5).abs());
    let mut rig = Rig::armed_with(&hill);
    let across = |place| drive(&[(0, place, 1.0), (1, 1.0, 1.0)], 2000);
    rig.accepted(&Command::Drive(across(0.0)));
    rig.live_ms(20);
    assert_eq!(rig.refused(&Command::Drive(across(1.0))), Refusal::Headroom { sum_per_mille: 1201 });
}

#[test]
fn a_fading_tone_counts_while_another_glides_over_a_position_of_high_gain() {
    // the tone that moves passes the gain of 1 while the other has hardly begun to fade.
    let bump = Table::line(11, 3000.0, 9000.0, |u| if (u - 0.1).abs() < 0.01 { 1.0 } else { 0.2 });
    let mut rig = Rig::armed_with(&bump);
    rig.play(&[(0, 0.1, 0.7), (1, 0.0, 0.9)], 2000, 20);
    let alone = Command::Drive(drive(&[(1, 1.0, 0.9)], 2000));
    assert_eq!(rig.refused(&alone), Refusal::Headroom { sum_per_mille: 1600 });
    rig.play(&[(1, 0.0, 0.9)], 2000, 20);
    rig.accepted(&alone);
    rig.live_ms(20);
    assert_eq!(rig.status().counters.clips, 0);
}

#[test]
fn the_old_tables_gain_counts_while_a_swap_blends() {
    // gains on their way from 1 to 0.5 while levels rise from 0.5 to 1 would reach 1.125 of full scale.
    let table = |gain: f64| Table::line(9, 3000.0, 9000.0, move |_| gain);
    let mut rig = Rig::armed_with(&table(1.0));
    rig.play(&[(0, 0.3, 0.499), (1, 0.7, 0.499)], 2000, 20);
    rig.upload(&table(0.5));
    let louder = Command::Drive(drive(&[(0, 0.3, 0.998), (1, 0.7, 0.998)], 2000));
    assert!(matches!(rig.refused(&louder), Refusal::Headroom { .. }));
    rig.live_ms(30);
    rig.accepted(&louder);
    rig.live_ms(20);
    assert_eq!(rig.status().counters.clips, 0);
}

#[test]
fn one_tone_may_fade_while_another_rises_at_full_level() {
    // the bound follows the levels' common ramp, so a change of slot is no overload.
    let flat = Table::line(9, 3000.0, 9000.0, |_| 1.0);
    let mut rig = Rig::armed_with(&flat);
    rig.play(&[(0, 0.3, 1.0)], 2000, 20);
    rig.play(&[(1, 0.7, 1.0)], 2000, 20);
    assert_eq!(rig.status().counters.clips, 0);
}

#[test]
fn a_digest_matches_the_codes_in_its_window() {
    let mut rig = Rig::driving(&[(0, 0.4, 0.9)], 2000, 20);
    assert_eq!(rig.refused(&Command::DigestRead), Refusal::NoDigest);
    for count in [0, MAX_DIGEST_SAMPLES + 1] {
        let window = DigestWindow { from: rig.status().now, count };
        assert!(matches!(
            rig.refused(&Command::DigestStart(window)),
            Refusal::OutOfRange { field: Field::DigestCount, .. }
        ));
    }
    let (from, count) = (rig.status().now + 77, 1000);
    rig.record();
    rig.accepted(&Command::DigestStart(DigestWindow { from, count }));
    let early = rig.send(&Command::DigestRead);
    assert!(matches!(early, Event::Digest(digest) if digest.crc.is_none()));
    rig.live_blocks(12);
    let codes = &rig.recording.from(from)[..count as usize];
    let bytes: Vec<u8> = codes.iter().flat_map(|code| code.to_le_bytes()).collect();
    let want = slipline_protocol::frame::CRC.checksum(&bytes);
    match rig.send(&Command::DigestRead) {
        Event::Digest(digest) => {
            assert_eq!((digest.from, digest.count, digest.crc), (from, count, Some(want)));
        }
        other => panic!("{other:?}"),
    }
}
