//! Playback of a setup: as the sum of its tones, or as a chord, whose tones are multiples of one base
//! frequency and whose loudness is limited by its peak.

use crate::setup::{Setup, edit};
use slipline_link::protocol::command::Apply;
use slipline_link::{ChordRequest, DeviceTable, HarmonicRequest, Refusal, Snapshot, Sounding};
use slipline_plate::order;
use slipline_plate::texture::CHORD_PERIOD;

/// Largest distance of a tone's frequency from a multiple, as a share of the base frequency: it covers the
/// rounding of a place on the wire.
const OFF: f64 = 0.25;

/// The request that plays a setup on the device of a snapshot, which holds this table of the setup's plate:
/// the setup's chord if it has one that the device can play, otherwise its tones.
///
/// # Errors
/// What the device would refuse of the chord at any master level.
pub fn sounding(
    setup: &Setup,
    chord: Option<ChordRequest>,
    table: &DeviceTable,
    snapshot: &Snapshot,
) -> Result<Sounding, Refusal> {
    match (chord.filter(|_| snapshot.can_play_chords()), &snapshot.device.identity) {
        (Some(chord), Some(identity)) => {
            Ok(Sounding::Chord(chord.fitted(identity, table, snapshot.linear_share())?))
        }
        _ => Ok(Sounding::Drive(edit::drive(setup))),
    }
}

/// The chord of a setup on a device with this table. `None` if the setup is not a chord, or if a tone is not
/// a multiple of the sample rate over [`CHORD_PERIOD`], for example because the device has another sample
/// rate.
#[must_use]
pub fn chord_of(setup: &Setup, table: &DeviceTable) -> Option<ChordRequest> {
    setup.chord_gain_db?;
    let louder = setup.chord_factor();
    let base_hz = f64::from(table.header().sample_rate_hz) / f64::from(CHORD_PERIOD);
    let mut tones = setup
        .tones
        .iter()
        .map(|tone| {
            let multiple = table.frequency_hz(table.position(tone.position_m)?) / base_hz;
            let harmonic = multiple.round();
            ((multiple - harmonic).abs() <= OFF).then_some(HarmonicRequest {
                harmonic: harmonic as u16,
                level: (tone.level * louder).min(1.0),
                phase_turns: tone.phase_turns,
            })
        })
        .collect::<Option<Vec<_>>>()?;
    order::sort_by_key(&mut tones, |tone| tone.harmonic);
    let is_rising = tones.is_sorted_by(|one, other| one.harmonic < other.harmonic);
    is_rising.then_some(ChordRequest {
        period_log2: CHORD_PERIOD.ilog2() as u8,
        tones,
        master_db: setup.master_db,
        glide_s: setup.glide_s,
        apply: Apply::Next,
    })
}
