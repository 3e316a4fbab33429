//! What minor 2 adds: the chord, and what may be wrong with one.

use super::Example;
use heapless::Vec;
use slipline_protocol::command::{Apply, Chord, ChordTone};
use slipline_protocol::limits::MAX_HARMONIC;
use slipline_protocol::refusal::{Field, Refusal};
use slipline_protocol::units::{CentiDecibel, Level, Phase};
use slipline_protocol::{Command, Event};

/// The commands of minor 2.
pub(crate) fn commands() -> std::vec::Vec<Example<Command>> {
    let tones = [
        ChordTone { harmonic: 410, level: Level(30_000), phase: Phase(0) },
        ChordTone { harmonic: 451, level: Level(28_000), phase: Phase(16_384) },
    ];
    let chord = Chord {
        period_log2: 12,
        tones: Vec::from_slice(&tones).unwrap(),
        master: CentiDecibel(-150),
        glide: 4000,
        apply: Apply::Next,
    };
    let tone = ChordTone { harmonic: u16::MAX, level: Level(u16::MAX), phase: Phase(u16::MAX) };
    let largest = Chord {
        period_log2: u8::MAX,
        tones: Vec::from_slice(&[tone; 16]).unwrap(),
        master: CentiDecibel(i16::MIN),
        glide: u32::MAX,
        apply: Apply::At(u64::MAX),
    };
    let highest = ChordTone { harmonic: MAX_HARMONIC, ..tones[0] };
    let at_trigger = Chord {
        period_log2: 14,
        tones: Vec::from_slice(&[highest]).unwrap(),
        apply: Apply::AtTrigger,
        ..chord
    };
    let commands = [("chord", chord), ("chord-largest", largest), ("chord-at-trigger", at_trigger)];
    commands.map(|(label, chord)| (label.to_owned(), Command::Chord(chord))).into()
}

/// The events of minor 2.
pub(crate) fn events() -> std::vec::Vec<Example<Event>> {
    let out_of_range = |field| Refusal::OutOfRange { field, min: 7, max: 14, got: 15 };
    let refusals = [
        ("refused-peak", Refusal::Peak { peak_per_mille: 1213 }),
        ("refused-out-of-range-chord-period", out_of_range(Field::ChordPeriod)),
        ("refused-out-of-range-harmonic", out_of_range(Field::Harmonic)),
    ];
    refusals.map(|(label, refusal)| (label.to_owned(), Event::Refused(refusal))).into()
}
