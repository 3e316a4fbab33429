//! Tables on their way in: wrong ones, half ones, and what stays in force.

use proptest::prelude::*;
use slipline_protocol::command::{TableChunk, TableHeader};
use slipline_protocol::event::{Event, State};
use slipline_protocol::limits::{MAX_KNOT_STEP, STAGING_TIMEOUT_MS};
use slipline_protocol::refusal::{Busy, Field};
use slipline_protocol::table::Knot;
use slipline_protocol::units::Gain;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::rig::{Rig, Table};

/// One thing that is wrong with an upload.
#[derive(Clone, Debug)]
enum Wrong {
    Knot(prop::sample::Index, Knot),
    Crc(u32),
    Missing,
    ChunkTwice(prop::sample::Index),
    Swapped,
    Count(u16),
    Rate(u32),
    Span,
}

fn wrong() -> impl Strategy<Value = Wrong> {
    let bad_knot = prop_oneof![
        Just(Knot { step: 0, gain: Gain(1 << 30) }),
        (MAX_KNOT_STEP + 1..).prop_map(|step| Knot { step, gain: Gain(1 << 30) }),
        Just(Knot { step: 1, gain: Gain(0) }),
        (Gain::FULL.0 + 1..).prop_map(|gain| Knot { step: 1_000_000, gain: Gain(gain) }),
        any::<u32>().prop_map(|step| Knot { step, gain: Gain(1 << 30) }),
    ];
    prop_oneof![
        4 => (any::<prop::sample::Index>(), bad_knot).prop_map(|(at, knot)| Wrong::Knot(at, knot)),
        1 => (1u32..).prop_map(Wrong::Crc),
        1 => Just(Wrong::Missing),
        1 => any::<prop::sample::Index>().prop_map(Wrong::ChunkTwice),
        1 => Just(Wrong::Swapped),
        1 => prop_oneof![Just(0u16), Just(1), 1026u16..].prop_map(Wrong::Count),
        1 => any::<u32>().prop_map(Wrong::Rate),
        1 => Just(Wrong::Span),
    ]
}

/// Uploads and says whether every step was accepted.
fn upload(rig: &mut Rig, table: &Table, chunks: &[TableChunk]) -> bool {
    let mut commands = vec![Command::TableBegin(table.header)];
    commands.extend(chunks.iter().cloned().map(Command::TableChunk));
    commands.push(Command::TableCommit);
    commands.iter().all(|command| matches!(rig.send(command), Event::Accepted(_)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn an_upload_with_one_thing_wrong_is_refused_and_the_old_table_sounds_on_bit_for_bit(
        knots in 2u16..120,
        first_hz in 1000.0..60_000.0f64,
        last_hz in 70_000.0..150_000.0f64,
        wrong in wrong(),
    ) {
        //
        let mut rig = Rig::armed();
        let mut left = Rig::armed();
        for rig in [&mut rig, &mut left] {
            rig.play(&[(0, 0.5, 0.9)], 2000, 10);
            rig.record();
        }
        let good = Table::line(knots, first_hz, last_hz, |_| 0.5);
        let mut table = good.clone();
        let mut chunks: Vec<TableChunk> = good.chunks().collect();
        match wrong {
            Wrong::Knot(at, knot) => {
                let at = at.index(table.knots.len());
                table.knots[at] = knot;
                let in_range = (1..=MAX_KNOT_STEP).contains(&knot.step) && (1..=Gain::FULL.0).contains(&knot.gain.0);
                // By chance the odd knot may fit after all.
                let fits = in_range && (table.knots.windows(2).all(|pair| pair[1].step > pair[0].step)
                    || table.knots.windows(2).all(|pair| pair[1].step < pair[0].step));
                prop_assume!(!fits);
                table = Table::of(table.knots);
                chunks = table.chunks().collect();
            }
            Wrong::Crc(other) => table.header.crc ^= other,
            Wrong::Missing => { chunks.pop(); }
            Wrong::ChunkTwice(at) => {
                let at = at.index(chunks.len());
                chunks.insert(at, chunks[at].clone());
            }
            Wrong::Swapped => {
                prop_assume!(chunks.len() > 1);
                chunks.swap(0, 1);
            }
            Wrong::Count(count) => table.header.knots = count,
            Wrong::Rate(rate) => {
                prop_assume!(rate != table.header.sample_rate_hz);
                table.header.sample_rate_hz = rate;
            }
            Wrong::Span => table.header.span_end_um = table.header.span_start_um,
        }
        let before = rig.send(&Command::TableDigest);
        prop_assert!(!upload(&mut rig, &table, &chunks));
        rig.accepted(&Command::TableAbort);
        prop_assert_eq!(rig.send(&Command::TableDigest), before);
        rig.live_ms(5);
        left.live_ms(5);
        prop_assert_eq!(&rig.recording.codes, &left.recording.codes);

        // The same without the fault is taken.
        let chunks: Vec<TableChunk> = good.chunks().collect();
        prop_assert!(upload(&mut rig, &good, &chunks));
        prop_assert_eq!(rig.status().table_crc, good.header.crc);
    }
}

#[test]
fn the_first_knot_at_fault_is_named() {
    //
    let mut rig = Rig::greeted();
    let cases = [
        (Knot { step: MAX_KNOT_STEP + 1, gain: Gain(5) }, Field::KnotStep),
        (Knot { step: 0, gain: Gain(5) }, Field::KnotStep),
        (Knot { step: 1_000_000, gain: Gain(0) }, Field::KnotGain),
    ];
    for (knot, field) in cases {
        let mut knots = Table::line(30, 1000.0, 30_000.0, |_| 0.5).knots;
        knots[29] = knot;
        rig.stage(&Table::of(knots));
        let refusal = rig.refused(&Command::TableCommit);
        assert!(matches!(refusal, Refusal::OutOfRange { field: named, .. } if named == field), "{refusal:?}");
    }
    let mut knots = Table::line(30, 1000.0, 30_000.0, |_| 0.5).knots;
    knots[17].step = knots[16].step;
    rig.stage(&Table::of(knots));
    assert_eq!(rig.refused(&Command::TableCommit), Refusal::NotMonotonic { knot: 17 });
    assert_eq!(rig.refused(&Command::TableCommit), Refusal::NoUpload, "what is wrong stays wrong");

    // The bounds themselves are allowed.
    let edge = vec![Knot { step: 1, gain: Gain(1) }, Knot { step: MAX_KNOT_STEP, gain: Gain::FULL }];
    rig.upload(&Table::of(edge));
}

#[test]
fn a_span_is_refused_with_a_range_that_has_room() {
    //
    let mut rig = Rig::greeted();
    for (start, end) in [(7, 7), (u32::MAX - 1, 5), (u32::MAX, 5), (u32::MAX, u32::MAX)] {
        let header = TableHeader { span_start_um: start, span_end_um: end, ..Table::usual().header };
        let refusal = rig.refused(&Command::TableBegin(header));
        let Refusal::OutOfRange { field: Field::Span, min, max, got } = refusal else {
            panic!("{refusal:?}")
        };
        assert!(min <= max && max <= i64::from(u32::MAX) && !(min..=max).contains(&got), "{refusal:?}");
    }
}

#[test]
fn an_upload_that_does_not_go_on_is_dropped_after_its_time() {
    //
    let mut rig = Rig::armed();
    let old = rig.status().table_crc;
    let table = Table::line(100, 1000.0, 30_000.0, |_| 0.5);
    let chunks: Vec<TableChunk> = table.chunks().collect();
    rig.accepted(&Command::TableBegin(table.header));
    rig.accepted(&Command::TableChunk(chunks[0].clone()));
    rig.live_ms(STAGING_TIMEOUT_MS - 100);
    rig.accepted(&Command::TableChunk(chunks[1].clone()));
    rig.live_ms(STAGING_TIMEOUT_MS - 100);
    rig.accepted(&Command::TableChunk(chunks[2].clone()));
    rig.live_ms(STAGING_TIMEOUT_MS + 10);
    assert_eq!(rig.refused(&Command::TableChunk(chunks[3].clone())), Refusal::NoUpload);
    assert_eq!(rig.refused(&Command::TableCommit), Refusal::NoUpload);
    let status = rig.status();
    assert_eq!((status.table_crc, status.state), (old, State::Armed));
}

#[test]
fn a_table_swapped_in_while_tones_sound_glides_and_the_old_slot_is_free_a_block_later() {
    // at a block boundary, without a jump. Low frequencies, so that a jump would stand out.
    let slow = Table::line(65, 40.0, 200.0, |u| 1.0 - 0.5 * u);
    let slower = Table::line(9, 150.0, 20.0, |u| 0.4 + 0.5 * u);
    let mut rig = Rig::armed_with(&slow);
    rig.play(&[(0, 0.2, 0.4), (1, 0.8, 0.4)], 2000, 20);
    rig.record();
    rig.stage(&slower);
    rig.live_ms(5);
    let at = rig.accepted(&Command::TableCommit);
    assert_eq!(at % 128, 0);
    assert_eq!(rig.refused(&Command::TableBegin(slow.header)), Refusal::Busy(Busy::TableInUse));
    rig.live_blocks(2);
    rig.accepted(&Command::TableBegin(slow.header));
    rig.live_ms(60);
    // 200 Hz at full scale: 2 pi 200 / 400 000 * 2047 = 6.4 codes a sample, and the ramps' slope.
    let step = slipline_tests::measure::largest_step(&rig.recording.codes);
    assert!(step <= 8, "{step}");
    assert!(slipline_tests::measure::peak(rig.recording.from(at)) > 500);
}

#[test]
fn a_table_by_which_the_sounding_tones_would_be_too_loud_is_refused() {
    //
    let mut rig = Rig::armed_with(&Table::line(9, 1000.0, 2000.0, |_| 0.4));
    rig.play(&[(0, 0.2, 1.0), (1, 0.8, 1.0)], 2000, 20);
    rig.stage(&Table::line(9, 1000.0, 2000.0, |_| 0.6));
    assert!(matches!(rig.refused(&Command::TableCommit), Refusal::Headroom { sum_per_mille: 1200..=1201 }));
    assert_eq!(rig.status().state, State::Driving);
}
