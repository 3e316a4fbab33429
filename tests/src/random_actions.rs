//! Random actions of a user, played on a device and on its mirror: for property tests.

use std::sync::Arc;

use proptest::prelude::*;
use slipline_app::Stop;
use slipline_link::mirror::Mirror;
use slipline_link::simulator::Options;
use slipline_protocol::command::{Apply, Chord, Comb, Drive};
use slipline_protocol::event::{Accepted, AcceptedUntil, Event};
use slipline_protocol::limits::{CHORD_PERIOD_LOG2, COMB_BLOCK};
use slipline_protocol::refusal::{Busy, Field};
use slipline_protocol::units::{CentiDecibel, Gain, Phase};
use slipline_protocol::{Command, Refusal};

use crate::client::Client;
use crate::rig::{BLOCK, RATE_HZ, Rig, Table, chord, comb, tone};

/// One action of the user.
#[derive(Clone, Debug)]
pub enum Action {
    /// A drive.
    Drive {
        /// Slot, position, level and phase of each tone.
        tones: Vec<(u8, f64, f64, u16)>,
        /// In hundredths of a decibel.
        master: i16,
        /// In samples.
        glide: u32,
        /// How far ahead it is to begin, if not at the next block.
        ahead: Option<u64>,
    },
    /// A chord.
    Chord {
        /// The binary logarithm of its period in samples.
        period_log2: u8,
        /// Place among the table's multiples, level and phase of each tone.
        tones: Vec<(f64, f64, u16)>,
        /// In samples.
        glide: u32,
        /// How far ahead it is to begin, if not at the next block.
        ahead: Option<u64>,
    },
    /// A comb.
    Comb {
        /// Its period in blocks.
        period_blocks: u16,
        /// The highest frequency that it may have, in turns a sample.
        highest: f64,
        /// Of each tone: its share of the multiples up to `highest`, its level and its phase.
        tones: Vec<(f64, f64, u16)>,
        /// In samples.
        glide: u32,
        /// How far ahead it is to begin, if not at the next block.
        ahead: Option<u64>,
    },
    /// A table, by its number.
    Table(usize),
    /// A stop.
    Stop,
    /// An emergency stop, and then arming again.
    EmergencyStop,
    /// Nothing, for 60 ms.
    Rest,
}

/// Random actions, each with the blocks that pass after it. The tables bound the frequencies of all but the combs: these have
/// tones of up to `highest` turns a sample.
pub fn actions(highest: f64) -> impl Strategy<Value = Vec<(Action, u64)>> {
    let tones = prop::collection::vec((0..16u8, 0.0..=1.0, 0.0..=1.0, any::<u16>()), 0..5);
    let glide = prop_oneof![2000u32..4000, 2000u32..40_000];
    let ahead = prop::option::weighted(0.2, 0u64..4000);
    let chord_tones = prop::collection::vec((0.0..=1.0, 0.0..=1.0, any::<u16>()), 1..=16);
    // The shortest has one multiple at least.
    let shortest = (1.0 / (f64::from(COMB_BLOCK) * highest)).ceil() as u16;
    let periods = prop_oneof![shortest..shortest + 100, shortest..=u16::MAX];
    let comb = (periods, chord_tones.clone(), glide.clone(), ahead.clone());
    let chord = (CHORD_PERIOD_LOG2.0..=CHORD_PERIOD_LOG2.1, chord_tones, glide.clone(), ahead.clone());
    let action = prop_oneof![
        4 => chord.prop_map(|(period_log2, tones, glide, ahead)| {
            Action::Chord { period_log2, tones, glide, ahead }
        }),
        3 => comb.prop_map(move |(period_blocks, tones, glide, ahead)| {
            Action::Comb { period_blocks, highest, tones, glide, ahead }
        }),
        10 => (tones, -2000i16..=0, glide, ahead)
            .prop_map(|(tones, master, glide, ahead)| Action::Drive { tones, master, glide, ahead }),
        2 => (0..3usize).prop_map(Action::Table),
        1 => Just(Action::Stop),
        1 => Just(Action::EmergencyStop),
        2 => Just(Action::Rest),
    ];
    prop::collection::vec((action, 1u64..40), 1..40)
}

/// Plays the actions with these tables, the first of them from the start, and returns the device's codes. A rendered block
/// waits while the one before it plays, or is played at once.
///
/// # Errors
/// The test fails if the mirror's codes differ from the device's, if a code was clamped, or if a command was answered
/// with anything but what can be expected.
///
/// # Panics
/// If the device refuses what it must accept.
pub fn play(
    actions: &[(Action, u64)],
    tables: &[Table; 3],
    block_waits: bool,
) -> Result<Vec<u16>, TestCaseError> {
    let mut rig = Rig::greeted_with(Options { block_waits, ..Options::default() });
    let mut mirror = Mirror::new(RATE_HZ, 0);
    rig.stage(&tables[0]);
    let mut table = &tables[0];
    let at = rig.accepted(&Command::TableCommit);
    mirror.acknowledge_table(Arc::from(tables[0].knots.as_slice()), at)?;
    rig.arm();
    for (action, blocks) in actions {
        match action {
            Action::Drive { tones, master, glide, ahead } => {
                let drive = random_drive(
                    tones,
                    *master,
                    *glide,
                    ahead.map(|ahead| rig.device.now() + 2 * BLOCK + ahead),
                );
                match rig.send(&Command::Drive(drive.clone())) {
                    Event::Accepted(Accepted { at }) | Event::AcceptedUntil(AcceptedUntil { at, .. }) => {
                        let sum = sum(table, tones, *master);
                        prop_assert!(sum <= 1.0 + 1e-3, "accepted with a sum of {}", sum);
                        mirror.acknowledge_play(drive.clone(), at)?;
                    }
                    Event::Refused(
                        Refusal::Headroom { .. } | Refusal::SlotTwice { .. } | Refusal::Busy(_),
                    ) => {}
                    other => return Err(TestCaseError::fail(format!("{other:?}"))),
                }
            }
            Action::Chord { period_log2, tones, glide, ahead } => {
                let at = ahead.map(|ahead| rig.device.now() + 2 * BLOCK + ahead);
                let chord = random_chord(table, *period_log2, tones, *glide, at);
                match rig.send(&Command::Chord(chord.clone())) {
                    Event::Accepted(accepted) => mirror.acknowledge_play(chord.clone(), accepted.at)?,
                    Event::Refused(
                        Refusal::Headroom { .. }
                        | Refusal::Peak { .. }
                        | Refusal::Busy(_)
                        // The table has none of the multiples, or the chord is to begin before it is silent.
                        | Refusal::OutOfRange { field: Field::Harmonic | Field::ApplyAt, .. },
                    ) => {}
                    Event::Refused(Refusal::OutOfRange { field: Field::ChordPeriod, .. }) => {
                        prop_assert!(!(7..=14).contains(period_log2));
                    }
                    Event::Refused(Refusal::OutOfRange { field: Field::ToneCount, .. }) => {
                        prop_assert!(tones.is_empty());
                    }
                    other => return Err(TestCaseError::fail(format!("{other:?}"))),
                }
            }
            Action::Comb { period_blocks, highest, tones, glide, ahead } => {
                let at = ahead.map(|ahead| rig.device.now() + 2 * BLOCK + ahead);
                let comb = random_comb(*period_blocks, *highest, tones, *glide, at);
                match rig.send(&Command::Comb(comb.clone())) {
                    Event::Accepted(accepted) => mirror.acknowledge_play(comb.clone(), accepted.at)?,
                    Event::Refused(
                        Refusal::Headroom { .. }
                        | Refusal::Busy(_)
                        // It is to begin before it is silent.
                        | Refusal::OutOfRange { field: Field::ApplyAt, .. },
                    ) => {}
                    Event::Refused(Refusal::OutOfRange { field: Field::CombPeriod, .. }) => {
                        prop_assert_eq!(*period_blocks, 0);
                    }
                    Event::Refused(Refusal::OutOfRange { field: Field::ToneCount, .. }) => {
                        prop_assert!(tones.is_empty());
                    }
                    other => return Err(TestCaseError::fail(format!("{other:?}"))),
                }
            }
            Action::Table(number) => {
                if swap(&mut rig, &mut mirror, &tables[*number])? {
                    table = &tables[*number];
                }
            }
            Action::Stop => {
                let at = rig.accepted(&Command::Stop);
                mirror.acknowledge_stop(Stop::Normal, at)?;
            }
            Action::EmergencyStop => {
                let at = rig.accepted(&Command::EmergencyStop);
                mirror.acknowledge_stop(Stop::Emergency, at)?;
                rig.live_ms(40);
                rig.accepted(&Command::ClearFaults);
                rig.arm();
            }
            Action::Rest => rig.live_ms(60),
        }
        rig.live_blocks(*blocks);
    }
    let mut replayed = Vec::new();
    mirror.render(rig.device.now(), |_, codes| replayed.extend_from_slice(codes));
    prop_assert!(mirror.is_true());
    let difference = replayed.iter().zip(&rig.recording.codes).position(|(a, b)| a != b);
    prop_assert_eq!(difference, None, "the first code in which mirror and device differ");
    prop_assert_eq!(replayed.len(), rig.recording.codes.len());
    prop_assert_eq!(rig.status().counters.clips, 0);
    Ok(rig.recording.codes)
}

/// `tones` share out what most drives have of the headroom, and some have not.
fn level(level: f64, tones: usize) -> f64 {
    (level * 1.2 / tones.max(1) as f64).min(1.0)
}

/// The sum of the tones' amplitudes at their targets, of full scale: gain between two knots by the straight line, times
/// level and master. It is computed here on its own, so that it is not the device that judges itself.
fn sum(table: &Table, tones: &[(u8, f64, f64, u16)], master: i16) -> f64 {
    let last = table.knots.len() - 1;
    let full = f64::from(Gain::FULL.0);
    let gain = |position: f64| {
        let place = position * last as f64;
        let below = (place as usize).min(last.saturating_sub(1));
        let [a, b] = [below, below + 1].map(|knot| f64::from(table.knots[knot].gain.0) / full);
        a + (b - a) * (place - below as f64)
    };
    let sum: f64 =
        tones.iter().map(|&(_, position, share, _)| gain(position) * level(share, tones.len())).sum();
    sum * 10f64.powf(f64::from(master) / 2000.0)
}

fn random_drive(tones: &[(u8, f64, f64, u16)], master: i16, glide: u32, at: Option<u64>) -> Drive {
    Drive {
        tones: tones
            .iter()
            .map(|&(slot, position, share, phase)| {
                let mut tone = tone(slot, position, level(share, tones.len()));
                tone.phase = Phase(phase);
                tone
            })
            .collect(),
        master: CentiDecibel(master),
        glide,
        apply: at.map_or(Apply::Next, Apply::At),
    }
}

/// A chord of multiples that the table has, if it has any: as loud as phases at random may allow, or louder.
fn random_chord(
    table: &Table,
    period_log2: u8,
    tones: &[(f64, f64, u16)],
    glide: u32,
    at: Option<u64>,
) -> Chord {
    let steps = [table.knots[0].step, table.knots[table.knots.len() - 1].step].map(f64::from);
    let base = 2f64.powi(32 - i32::from(period_log2));
    let (low, high) = ((steps[0].min(steps[1]) / base).ceil(), (steps[0].max(steps[1]) / base).floor());
    let mut placed: Vec<(u16, f64, f64)> = tones
        .iter()
        .map(|&(place, share, phase)| {
            let harmonic = (low + place * (high - low).max(0.0)).round() as u16;
            (harmonic, share * (2.0 / tones.len() as f64).sqrt().min(1.0), f64::from(phase) / 65_536.0)
        })
        .collect();
    placed.sort_by_key(|tone| tone.0);
    placed.dedup_by_key(|tone| tone.0);
    Chord { glide, apply: at.map_or(Apply::Next, Apply::At), ..chord(period_log2, &placed) }
}

/// A comb of any multiples, with amplitudes that often fit.
fn random_comb(
    period_blocks: u16,
    highest: f64,
    tones: &[(f64, f64, u16)],
    glide: u32,
    at: Option<u64>,
) -> Comb {
    let highest = (f64::from(COMB_BLOCK) * f64::from(period_blocks) * highest).floor().clamp(1.0, 65_535.0);
    let mut placed: Vec<(u16, f64, f64)> = tones
        .iter()
        .map(|&(place, share, phase)| {
            let harmonic = (1.0 + place.min(1.0) * (highest - 1.0)).round() as u16;
            (harmonic, level(share, tones.len()), f64::from(phase) / 65_536.0)
        })
        .collect();
    placed.sort_by_key(|tone| tone.0);
    placed.dedup_by_key(|tone| tone.0);
    Comb { glide, apply: at.map_or(Apply::Next, Apply::At), ..comb(period_blocks, &placed) }
}

/// Whether the device has taken the table.
fn swap(rig: &mut Rig, mirror: &mut Mirror, table: &Table) -> Result<bool, TestCaseError> {
    if rig.send(&Command::TableBegin(table.header)) == Event::Refused(Refusal::Busy(Busy::TableInUse)) {
        return Ok(false);
    }
    for chunk in table.chunks() {
        rig.accepted(&Command::TableChunk(chunk));
    }
    match rig.send(&Command::TableCommit) {
        Event::Accepted(accepted) => {
            mirror.acknowledge_table(Arc::from(table.knots.as_slice()), accepted.at)?;
            Ok(true)
        }
        Event::Refused(Refusal::Headroom { .. } | Refusal::Busy(_)) => Ok(false),
        other => Err(TestCaseError::fail(format!("{other:?}"))),
    }
}
