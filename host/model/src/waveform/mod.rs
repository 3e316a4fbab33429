//! The device's output: the latest codes, replayed from the link's journal, and their spectrum.

mod spectrum;

pub use spectrum::{Line, level_at};

use crate::jobs::Task;
use slipline_link::BLOCK;
use slipline_link::mirror::replay::{DeviceHistory, Replay};
use spectrum::Spectrum;
use std::sync::Arc;

/// Duration of the codes that are kept, in seconds, as in a WAV file.
const KEPT_S: f64 = 1.0;
/// Codes that the replay keeps: this duration at the highest rate of a device, 1 MS/s.
const KEPT_CODES: usize = 1_000_000;
/// Smallest number of codes that is shown.
const LEAST_CODES: usize = 2 * BLOCK;
/// Largest number of codes of a spectrum.
const SPECTRUM_CODES: usize = 1 << 18;
/// Time of a drive between two spectra, in seconds: a spectrum is read, not watched like the codes, and is
/// the most expensive part.
const SPECTRUM_EACH_S: f64 = 0.1;

/// A stretch of the codes that the device sends.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct CodeWindow {
    /// Index of the first code.
    pub first: u64,
    /// Codes per second.
    pub sample_rate_hz: f64,
    /// The codes, 0..=4095, mid-scale 2048.
    pub codes: Arc<[u16]>,
}

/// Codes and spectrum of the drive.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Waveform {
    window: Option<CodeWindow>,
    spectrum: Arc<[Line]>,
    is_true: bool,
}

impl Waveform {
    /// The latest codes; `None` before the first drive.
    #[must_use]
    pub fn window(&self) -> Option<&CodeWindow> {
        self.window.as_ref()
    }

    /// The spectrum of the latest codes, rising in frequency.
    #[must_use]
    pub fn spectrum(&self) -> &[Line] {
        &self.spectrum
    }

    /// Whether every change since the drive began could be replayed.
    #[must_use]
    pub fn is_true(&self) -> bool {
        self.is_true
    }
}

/// Follow the journal up to now.
pub type WaveformJob = DeviceHistory;

/// Follows the journal.
pub struct WaveformFollower {
    replay: Replay,
    spectrum: Spectrum,
    /// The latest spectrum and the index of the code at which it ended.
    latest: Option<(u64, Arc<[Line]>)>,
}

impl Default for WaveformFollower {
    fn default() -> Self {
        Self { replay: Replay::new(KEPT_CODES), spectrum: Spectrum::default(), latest: None }
    }
}

impl WaveformFollower {
    /// Replays new entries and returns the device's present output.
    pub fn follow(&mut self, job: &WaveformJob) -> Waveform {
        self.replay.follow(job);
        let rate = f64::from(job.sample_rate_hz);
        let (first, codes) = self.replay.drive_codes();
        let too_old = codes.len().saturating_sub((KEPT_S * rate) as usize);
        let (first, codes) = (first + too_old as u64, codes.skip(too_old));
        let is_true = self.replay.exact_since().is_some_and(|since| since <= first);
        if self.replay.is_silent() || codes.len() < LEAST_CODES {
            return Waveform { is_true: self.replay.exact_since().is_some(), ..Waveform::default() };
        }
        let codes: Arc<[u16]> = codes.collect();
        let spectrum = self.spectrum_of(&codes, first + codes.len() as u64, rate);
        Waveform { window: Some(CodeWindow { first, sample_rate_hz: rate, codes }), spectrum, is_true }
    }

    /// The spectrum of the last of these codes; `end` is the index after the last.
    fn spectrum_of(&mut self, codes: &[u16], end: u64, rate: f64) -> Arc<[Line]> {
        let fresh = (SPECTRUM_EACH_S * rate) as u64;
        if let Some((at, lines)) = &self.latest
            && end.checked_sub(*at).is_some_and(|age| age < fresh)
        {
            return Arc::clone(lines);
        }
        let tail = &codes[codes.len().saturating_sub(SPECTRUM_CODES)..];
        let lines: Arc<[Line]> = self.spectrum.of(tail, rate).into();
        self.latest = Some((end, Arc::clone(&lines)));
        lines
    }
}

/// The work of the following thread.
pub fn work() -> impl FnMut(WaveformJob, &Task) -> Option<Waveform> + Send {
    let mut follower = WaveformFollower::default();
    // A job is short, and the next one depends on its result, so it is never cancelled.
    move |job, _| Some(follower.follow(&job))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::simulation::table_for;
    use crate::field::time_domain::tests::one_tone;
    use slipline_link::protocol::units::Position;
    use slipline_link::{Acknowledged, Change};
    use slipline_plate::preset;

    fn drive() -> Change {
        Change::Play(one_tone(0, Position(20_000), 2000).into())
    }

    fn job(entries: &[(u64, u64, Change)], now: u64) -> WaveformJob {
        let entry = |(number, at, change): &(u64, u64, Change)| {
            Arc::new(Acknowledged { number: *number, at: *at, change: change.clone(), is_exact: true })
        };
        let plate = preset("membrane").unwrap();
        WaveformJob {
            sample_rate_hz: 400_000,
            journal: Arc::new(entries.iter().map(entry).collect()),
            table: Some(table_for(&plate, 400_000).unwrap().1),
            now,
            foldback_per_mille: 1000,
        }
    }

    #[test]
    fn entries_that_were_missed_cost_the_trust_until_the_next_silence_but_not_the_table() {
        let mut follower = WaveformFollower::default();
        let start = [(1, 12_800, Change::Session), (2, 25_600, drive())];
        let waveform = follower.follow(&job(&start, 128_000));
        assert!(waveform.is_true() && waveform.window().is_some());

        let later = [(40, 256_000, Change::Stop)];
        assert!(!follower.follow(&job(&later, 260_000)).is_true());

        let later = [(40, 256_000, Change::Stop), (41, 512_000, drive())];
        let waveform = follower.follow(&job(&later, 640_000));
        assert!(waveform.is_true());
        assert!(waveform.window().unwrap().codes.iter().any(|&code| code > 2500), "the table was kept");
    }

    #[test]
    fn a_spectrum_is_a_tenth_of_a_second_old_at_most_and_none_outlives_its_drive() {
        let mut follower = WaveformFollower::default();
        let start = [(1, 12_800, Change::Session), (2, 25_600, drive())];
        let mut at = |journal: &[(u64, u64, Change)], now: u64| {
            Arc::clone(&follower.follow(&job(journal, now)).spectrum)
        };
        let first = at(&start, 128_000);
        assert!(Arc::ptr_eq(&first, &at(&start, 128_000 + 39_000)));
        let second = at(&start, 128_000 + 41_000);
        assert!(!Arc::ptr_eq(&first, &second));

        let stopped = [start[0].clone(), start[1].clone(), (3, 256_000, Change::Stop)];
        assert!(at(&stopped, 400_000).is_empty());
        let again = [start.to_vec(), vec![stopped[2].clone(), (4, 409_600, drive())]].concat();
        let new = at(&again, 416_000);
        assert!(!new.is_empty() && !Arc::ptr_eq(&new, &second));
    }

    #[test]
    fn a_stop_of_the_devices_own_costs_the_trust_until_the_next_silence() {
        let mut follower = WaveformFollower::default();
        let drive_and_stop = [(1, 12_800, Change::Session), (2, 25_600, drive()), (3, 200_000, Change::Stop)];
        let mut own = job(&drive_and_stop, 204_800);
        Arc::make_mut(Arc::make_mut(&mut own.journal).back_mut().unwrap()).is_exact = false;
        assert!(follower.follow(&job(&drive_and_stop[..2], 128_000)).is_true());
        assert!(!follower.follow(&own).is_true());

        Arc::make_mut(&mut own.journal).extend(job(&[(4, 512_000, drive())], 0).journal.iter().cloned());
        let waveform = follower.follow(&WaveformJob { now: 640_000, ..own });
        assert!(waveform.is_true() && waveform.window().is_some());
    }

    #[test]
    fn thermal_limits_that_were_dropped_are_no_loss() {
        let mut follower = WaveformFollower::default();
        let start = [(1, 12_800, Change::Session), (2, 25_600, drive())];
        follower.follow(&job(&start, 128_000));
        let later = [start[0].clone(), start[1].clone(), (9, 131_072, Change::Limit(900))];
        let waveform = follower.follow(&job(&later, 256_000));
        assert!(waveform.is_true() && waveform.window().is_some());
    }
}
