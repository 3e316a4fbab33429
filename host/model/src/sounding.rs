//! The device's present drive, by the link's journal.

use crate::field::steady_field::SteadyTone;
use slipline_link::DeviceTable;
use slipline_link::protocol::event::State;
use slipline_link::{Change, Played, Snapshot};
use std::sync::Arc;

/// The drive that the device has acknowledged and plays now.
#[derive(Clone, Debug)]
pub struct SoundingDrive {
    /// The number of the journal's entry.
    pub number: u64,
    /// The drive in the device's units.
    pub played: Played,
    /// The table by which it is played.
    pub table: Arc<DeviceTable>,
    /// Its tones, in physical units.
    pub tones: Vec<SteadyTone>,
    /// The index at which it began.
    pub began: u64,
    /// The index at which a drive's tones have reached their places and levels.
    pub reached: u64,
}

/// The drive, chord or comb that sounds; `None` when the device is silent or uses a table that this program does not know.
#[must_use]
pub fn sounding(snapshot: &Snapshot) -> Option<SoundingDrive> {
    let is_sounding = snapshot
        .drive
        .status
        .is_some_and(|status| matches!(status.state, State::Driving | State::Waiting | State::Armed));
    let table = snapshot.table.confirmed.as_ref().filter(|_| is_sounding && snapshot.is_connected())?;
    let mut latest = None;
    for entry in snapshot.record.journal.iter() {
        match &entry.change {
            Change::Play(played) => latest = Some((entry, played)),
            Change::Session | Change::Armed | Change::Disarmed | Change::Stop | Change::EmergencyStop => {
                latest = None;
            }
            Change::Hold | Change::Limit(_) => {}
            // The tones glide to the new table's places and gains.
            Change::Table(_) => latest = latest.map(|(_, played)| (entry, played)),
        }
    }
    let (entry, played) = latest.filter(|(_, played)| played.count() > 0)?;
    let tones = played.tones(table).into_iter().map(|tone| SteadyTone {
        slot: tone.slot,
        frequency_hz: tone.frequency_hz,
        peak_m: tone.peak_m,
    });
    let (number, reached) = (entry.number, entry.at.saturating_add(played.glide().into()));
    let (table, played) = (Arc::clone(table), played.clone());
    Some(SoundingDrive { number, tones: tones.collect(), table, played, began: entry.at, reached })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::simulation::device_table;
    use slipline_link::ChordRequest;
    use slipline_link::protocol::command::{Apply, Chord, ChordTone, Drive, Tone};
    use slipline_link::protocol::units::{CentiDecibel, Level, Phase, Position};
    use slipline_plate::DriveTable;

    #[test]
    fn a_chord_sounds_as_a_drive_of_the_same_frequencies_does() {
        let plate = slipline_plate::preset("al-bending").unwrap();
        let table = device_table(&DriveTable::build(&plate, 400e3, 65).unwrap()).unwrap();
        let position = Position(30_000);
        // The base frequency of the longest period: 24.4 Hz.
        let harmonic = (table.frequency_hz(position) / (400e3 / 16_384.0)).round() as u16;
        let (level, phase, master) = (Level(20_000), Phase(0), CentiDecibel(-300));
        let tone = Tone { slot: 0, position, level, phase };
        let tones = [tone].into_iter().collect();
        let drive = Played::from(Drive { tones, master, glide: 8000, apply: Apply::Next });
        let tones = [ChordTone { harmonic, level, phase }].into_iter().collect();
        let chord = Chord { period_log2: 14, tones, master, glide: 8000, apply: Apply::Next };
        let chord = Played::from(chord);
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
        let identity = identity.view().device.identity.clone().unwrap();
        let mut low = low.for_device(&identity, None).unwrap();
        low.tones.push(ChordTone { harmonic: 3, level, phase }).unwrap();
        assert!(Played::from(low).tones(&table).is_empty());
    }
}
