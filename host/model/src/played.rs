//! What the device plays, in its own units: a drive by places of its table, or a chord or a comb by multiples of a base
//! frequency.

use slipline_link::DeviceTable;
use slipline_link::mirror::{Mirror, TooLate};
use slipline_link::protocol::command::{Chord, Comb, Drive};
use slipline_link::protocol::limits::COMB_BLOCK;
use slipline_link::protocol::units::{CentiDecibel, FinePosition, Gain, Level};
use std::sync::Arc;

/// What the device plays.
#[derive(Clone, Debug)]
pub enum Played {
    /// Tones of the table's places.
    Drive(Arc<Drive>),
    /// Tones that are multiples of one base frequency.
    Chord(Arc<Chord>),
    /// Tones that are multiples of one low base frequency, beyond the table's frequencies, too.
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

/// A level of the wire with a master level, 0..=1.
fn share(level: Level, master: CentiDecibel) -> f64 {
    f64::from(level.0) / f64::from(Level::FULL.0) * 10f64.powf(f64::from(master.0) / 2000.0)
}

/// The tones that a table has of these multiples (and shares) of the rate over a period in samples, each by slot, frequency,
/// place and share.
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
    /// Its tones with this table; a multiple that the table does not have is left out.
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
                let tones = drive.tones.iter();
                let played = |of: &slipline_link::protocol::command::Tone| {
                    let (hertz, place) = (table.frequency_hz(of.position), of.position.fine());
                    tone(of.slot, hertz, place, share(of.level, drive.master))
                };
                tones.map(played).collect()
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

    /// How long it takes to get there, in samples.
    #[must_use]
    pub fn glide(&self) -> u32 {
        match self {
            Self::Drive(drive) => drive.glide,
            Self::Chord(chord) => chord.glide,
            Self::Comb(comb) => comb.glide,
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

    /// Tells a mirror that the device plays it from `at` on.
    ///
    /// # Errors
    /// [`TooLate`].
    pub fn acknowledge(&self, mirror: &mut Mirror, at: u64) -> Result<(), TooLate> {
        match self {
            Self::Drive(drive) => mirror.acknowledge_drive(drive, at),
            Self::Chord(chord) => mirror.acknowledge_chord(chord, at),
            Self::Comb(comb) => mirror.acknowledge_comb(comb, at),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::simulation::device_table;
    use slipline_link::ChordRequest;
    use slipline_link::protocol::command::{Apply, ChordTone, Tone};
    use slipline_link::protocol::units::{Phase, Position};
    use slipline_plate::DriveTable;

    #[test]
    fn a_chord_sounds_as_a_drive_of_the_same_frequencies_does() {
        let plate = slipline_plate::preset("al-bending").unwrap();
        let table = device_table(&DriveTable::build(&plate, 400e3, 65).unwrap()).unwrap();
        let position = Position(30_000);
        // The longest period: 24.4 Hz.
        let harmonic = (table.frequency_hz(position) / (400e3 / 16_384.0)).round() as u16;
        let (level, phase, master) = (Level(20_000), Phase(0), CentiDecibel(-300));
        let tone = Tone { slot: 0, position, level, phase };
        let tones = [tone].into_iter().collect();
        let drive = Played::Drive(Arc::new(Drive { tones, master, glide: 8000, apply: Apply::Next }));
        let tones = [ChordTone { harmonic, level, phase }].into_iter().collect();
        let chord = Chord { period_log2: 14, tones, master, glide: 8000, apply: Apply::Next };
        let chord = Played::Chord(Arc::new(chord));
        let ([by_place], [by_multiple]) = (&drive.tones(&table)[..], &chord.tones(&table)[..]) else {
            panic!("one tone each")
        };
        assert!((by_place.frequency_hz - by_multiple.frequency_hz).abs() < 12.3);
        let near = |one: f64, other: f64| (one / other - 1.0).abs() < 0.01;
        assert!(near(by_place.amplitude, by_multiple.amplitude), "{by_place:?} {by_multiple:?}");
        assert!(near(by_place.peak_m, by_multiple.peak_m), "{by_place:?} {by_multiple:?}");
        assert!((by_multiple.frequency_hz / f64::from(harmonic) - 400e3 / 16_384.0).abs() < 1e-9);
        // A multiple below the table's lowest frequency.
        let low = ChordRequest::of(14, Vec::new());
        let identity = slipline_link::simulator::loopback::Loopback::connect(400_000).unwrap();
        let identity = identity.view().identity.clone().unwrap();
        let mut low = low.for_device(&identity, None).unwrap();
        low.tones.push(ChordTone { harmonic: 3, level, phase }).unwrap();
        assert!(Played::Chord(Arc::new(low)).tones(&table).is_empty());
    }
}
