//! The device's output in its own units: a drive by places of its table, or a chord or a comb by multiples of
//! a base frequency.

use crate::table::DeviceTable;
use slipline_protocol::command::{Apply, Chord, Comb, Drive, Tone};
use slipline_protocol::limits::COMB_BLOCK;
use slipline_protocol::units::{CentiDecibel, FinePosition, Gain, Level};
use std::sync::Arc;

/// The device's output.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Played {
    /// Tones at places of the table.
    Drive(Arc<Drive>),
    /// Tones that are multiples of one base frequency.
    Chord(Arc<Chord>),
    /// Tones that are multiples of one low base frequency, also beyond the table's frequencies.
    Comb(Arc<Comb>),
}

/// One tone of it, in physical units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlayedTone {
    /// The device's slot.
    pub slot: u8,
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Amplitude, as a share of the DAC's full scale.
    pub amplitude: f64,
    /// Its peak on the table's own plate, in metres.
    pub peak_m: f64,
}

impl From<Drive> for Played {
    fn from(drive: Drive) -> Self {
        Self::Drive(Arc::new(drive))
    }
}

impl From<Chord> for Played {
    fn from(chord: Chord) -> Self {
        Self::Chord(Arc::new(chord))
    }
}

impl From<Comb> for Played {
    fn from(comb: Comb) -> Self {
        Self::Comb(Arc::new(comb))
    }
}

/// The amplitude of a level with a master level, 0..=1.
fn share(level: Level, master: CentiDecibel) -> f64 {
    f64::from(level.0) / f64::from(Level::FULL.0) * 10f64.powf(f64::from(master.0) / 2000.0)
}

/// The tones of a table for these multiples (and shares) of the sample rate over a period in samples, each by
/// slot, frequency, place and share.
fn multiples(
    table: &DeviceTable,
    period: u32,
    tones: impl Iterator<Item = (u16, f64)>,
    tone: impl Fn(u8, f64, FinePosition, f64) -> PlayedTone,
) -> Vec<PlayedTone> {
    let turns = f64::from(period).recip();
    let base_hz = f64::from(table.header().sample_rate_hz) * turns;
    let tones = (0..).zip(tones).filter_map(|(slot, (harmonic, share))| {
        let place = table.place_of_turns(f64::from(harmonic) * turns)?;
        Some(tone(slot, f64::from(harmonic) * base_hz, place, share))
    });
    tones.collect()
}

impl Played {
    /// Its tones with this table; a multiple outside the table's frequencies is left out.
    #[must_use]
    pub fn tones(&self, table: &DeviceTable) -> Vec<PlayedTone> {
        let tone = |slot, frequency_hz, place: FinePosition, share: f64| PlayedTone {
            slot,
            frequency_hz,
            amplitude: share * f64::from(table.setting(place).gain.0) / f64::from(Gain::FULL.0),
            peak_m: share * table.peak_m(place),
        };
        match self {
            Self::Drive(drive) => {
                let played = |of: &Tone| {
                    let (hertz, place) = (table.frequency_hz(of.position), of.position.fine());
                    tone(of.slot, hertz, place, share(of.level, drive.master))
                };
                drive.tones.iter().map(played).collect()
            }
            Self::Chord(chord) => {
                let period = 1_u32 << chord.period_log2;
                let tones = chord.tones.iter().map(|of| (of.harmonic, share(of.level, chord.master)));
                multiples(table, period, tones, tone)
            }
            Self::Comb(comb) => {
                let period = COMB_BLOCK * u32::from(comb.period_blocks);
                let tones = comb.tones.iter().map(|of| (of.harmonic, share(of.level, comb.master)));
                multiples(table, period, tones, tone)
            }
        }
    }

    /// Duration of the change, in samples.
    #[must_use]
    pub fn glide(&self) -> u32 {
        match self {
            Self::Drive(drive) => drive.glide,
            Self::Chord(chord) => chord.glide,
            Self::Comb(comb) => comb.glide,
        }
    }

    /// When the change begins.
    #[must_use]
    pub fn apply(&self) -> Apply {
        match self {
            Self::Drive(drive) => drive.apply,
            Self::Chord(chord) => chord.apply,
            Self::Comb(comb) => comb.apply,
        }
    }

    /// Number of its tones.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Drive(drive) => drive.tones.len(),
            Self::Chord(chord) => chord.tones.len(),
            Self::Comb(comb) => comb.tones.len(),
        }
    }
}
