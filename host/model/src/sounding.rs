//! What the device sounds now, by the link's journal.

use crate::field::steady_field::SteadyTone;
use crate::played::Played;
use slipline_link::protocol::event::State;
use slipline_link::table::DeviceTable;
use slipline_link::{Change, Snapshot};
use std::sync::Arc;

/// The drive that the device has acknowledged and plays now.
#[derive(Clone, Debug)]
pub struct SoundingDrive {
    /// The number of the journal's entry.
    pub number: u64,
    /// What is played, in the device's units.
    pub played: Played,
    /// The table with which it is played.
    pub table: Arc<DeviceTable>,
    /// Its tones, in physical units.
    pub tones: Vec<SteadyTone>,
    /// The index at which a drive's tones have reached their places and levels.
    pub reached: u64,
}

/// The drive, chord or comb that sounds; `None` when the device is silent or uses a table that this program does not know.
#[must_use]
pub fn sounding(snapshot: &Snapshot) -> Option<SoundingDrive> {
    let is_sounding = snapshot
        .status
        .is_some_and(|status| matches!(status.state, State::Driving | State::Waiting | State::Armed));
    let table = snapshot.confirmed_table.as_ref().filter(|_| is_sounding && snapshot.is_connected())?;
    let mut latest = None;
    for entry in snapshot.journal.iter() {
        match &entry.change {
            Change::Drive(drive) => latest = Some((entry, Played::Drive(Arc::clone(drive)))),
            Change::Chord(chord) => latest = Some((entry, Played::Chord(Arc::clone(chord)))),
            Change::Comb(comb) => latest = Some((entry, Played::Comb(Arc::clone(comb)))),
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
    Some(SoundingDrive { number, tones: tones.collect(), table: Arc::clone(table), played, reached })
}
