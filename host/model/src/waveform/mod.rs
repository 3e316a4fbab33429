//! What the device sends: the mirror follows the journal of the link, and keeps the latest codes and their spectrum.

mod spectrum;

pub use spectrum::Line;

use crate::jobs::Task;
use slipline_link::BLOCK;
use slipline_link::Stop;
use slipline_link::mirror::Mirror;
use slipline_link::table::DeviceTable;
use slipline_link::{Acknowledged, Change, Snapshot};
use spectrum::Spectrum;
use std::collections::VecDeque;
use std::sync::Arc;

/// Seconds of codes that are kept: what a WAV holds.
const KEPT_S: f64 = 1.0;
/// Fewer codes than this are not shown.
const LEAST_CODES: usize = 2 * BLOCK;
/// Codes that the spectrum is made of, at most.
const SPECTRUM_CODES: usize = 1 << 18;
/// After a stop the device is silent within this many seconds: every ramp is shorter.
const SILENT_AFTER_S: f64 = 0.2;

/// A stretch of the codes the device sends.
#[derive(Clone, Debug)]
pub struct Window {
    /// Index of the first code.
    pub first: u64,
    /// Codes per second.
    pub sample_rate_hz: f64,
    /// The codes, 0..=4095, mid-scale 2048.
    pub codes: Arc<[u16]>,
}

/// Blocks between a table and the change after it, in codes: each is taken up at a block of its own.
const AHEAD: u64 = 8 * BLOCK as u64;

/// What is known of the drive.
#[derive(Clone, Debug, Default)]
pub struct Waveform {
    window: Option<Window>,
    spectrum: Arc<[Line]>,
    is_true: bool,
}

impl Waveform {
    /// The latest codes; `None` before anything was driven.
    #[must_use]
    pub fn window(&self) -> Option<&Window> {
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
#[derive(Clone, Debug)]
pub struct WaveformJob {
    sample_rate_hz: u32,
    journal: Arc<VecDeque<Arc<Acknowledged>>>,
    /// The table the device is known to hold.
    table: Option<Arc<DeviceTable>>,
    /// The device has rendered up to here.
    now: u64,
}

impl WaveformJob {
    /// What the device has agreed to and how far it has come. `None` while there is no device.
    #[must_use]
    pub fn of(snapshot: &Snapshot) -> Option<Self> {
        let sample_rate_hz = snapshot.identity.as_ref()?.sample_rate_hz;
        Some(Self {
            sample_rate_hz,
            journal: Arc::clone(&snapshot.journal),
            table: snapshot.confirmed_table.clone(),
            now: snapshot.status?.now,
        })
    }
}

/// Follows the journal.
#[derive(Default)]
pub struct WaveformFollower {
    mirror: Option<Mirror>,
    sample_rate_hz: u32,
    /// The latest entry that was taken.
    latest: u64,
    /// Whether tones may sound, and since when they do not.
    silent_since: Option<u64>,
    codes: VecDeque<u16>,
    spectrum: Spectrum,
}

impl WaveformFollower {
    /// Replays what is new and returns what the device sends now.
    pub fn follow(&mut self, job: &WaveformJob) -> Waveform {
        // Entries fall off the journal's front; a thermal limit may also go from its middle, which does no harm.
        if let Some(oldest) = job.journal.front().filter(|oldest| oldest.number > self.latest + 1)
            && self.mirror.is_some()
        {
            self.begin(job, oldest.at);
            if let Some(mirror) = &mut self.mirror {
                mirror.distrust();
            }
        }
        for entry in job.journal.iter() {
            if self.mirror.is_some() && entry.number <= self.latest {
                continue;
            }
            self.take(job, entry);
        }
        let Some(mirror) = &mut self.mirror else { return Waveform::default() };
        let rate = f64::from(self.sample_rate_hz);
        let is_silent =
            self.silent_since.is_some_and(|since| job.now > since + (SILENT_AFTER_S * rate) as u64);
        if is_silent {
            // Nothing sounds: nothing is rendered until something does.
            return Waveform { is_true: mirror.is_true(), ..Waveform::default() };
        }
        render(mirror, &mut self.codes, job.now, rate);
        if self.codes.len() < LEAST_CODES {
            return Waveform { is_true: mirror.is_true(), ..Waveform::default() };
        }
        let first = mirror.now() - self.codes.len() as u64;
        let codes: Arc<[u16]> = self.codes.iter().copied().collect();
        let tail = &codes[codes.len().saturating_sub(SPECTRUM_CODES)..];
        let spectrum = self.spectrum.of(tail, rate).into();
        Waveform {
            window: Some(Window { first, sample_rate_hz: rate, codes }),
            spectrum,
            is_true: mirror.is_true(),
        }
    }

    /// Begins anew at `at`, as if the device were silent, with the table it is known to hold.
    fn begin(&mut self, job: &WaveformJob, at: u64) {
        self.sample_rate_hz = job.sample_rate_hz;
        self.codes.clear();
        self.silent_since = Some(at);
        let mut mirror = Mirror::new(job.sample_rate_hz, at.saturating_sub(AHEAD));
        if let Some(table) = &job.table {
            // Nothing has been rendered: it cannot come too late.
            let _ = mirror.acknowledge_table(table.knots().into(), mirror.now());
            mirror.render(at, |_, _| {});
        }
        self.mirror = Some(mirror);
    }

    fn take(&mut self, job: &WaveformJob, entry: &Acknowledged) {
        self.latest = entry.number;
        let rate = f64::from(job.sample_rate_hz);
        if let Some(mirror) = self.mirror.as_mut().filter(|_| entry.change == Change::Session) {
            // The device is silent, and may still hold its table.
            mirror.silence(entry.at);
            self.codes.clear();
            self.silent_since = Some(entry.at);
        }
        if self.mirror.is_none() || self.sample_rate_hz != job.sample_rate_hz {
            self.begin(job, entry.at);
        }
        let Some(mirror) = &mut self.mirror else { return };
        // A change that came too late, or that the renderer cannot take, shows in `Mirror::is_true`.
        let _ = match &entry.change {
            Change::Drive(drive) => {
                if let Some(since) = self.silent_since.take()
                    && entry.at > since + (SILENT_AFTER_S * rate) as u64
                {
                    go_silently(mirror, entry.at);
                    self.codes.clear();
                }
                mirror.acknowledge_drive(drive, entry.at)
            }
            Change::Table(table) => {
                if self.silent_since.is_some() {
                    go_silently(mirror, entry.at);
                }
                let taken = mirror.acknowledge_table(table.knots().into(), entry.at);
                if self.silent_since.is_some() {
                    // Taken up at once, so that a leap over silence finds it.
                    mirror.render(entry.at + BLOCK as u64, |_, _| {});
                }
                taken
            }
            Change::Stop | Change::Disarmed | Change::EmergencyStop => {
                let kind = if entry.change == Change::EmergencyStop { Stop::Emergency } else { Stop::Normal };
                self.silent_since.get_or_insert(entry.at);
                mirror.acknowledge_stop(kind, entry.at)
            }
            Change::Limit(per_mille) => mirror.acknowledge_limit(*per_mille, entry.at),
            Change::Session | Change::Armed => Ok(()),
        };
        if !entry.is_exact {
            mirror.distrust();
        }
    }
}

/// Leaps over silence: to just before `at`, so that the table is in place when the change at `at` comes.
fn go_silently(mirror: &mut Mirror, at: u64) {
    mirror.silence(at.saturating_sub(AHEAD));
    mirror.render(at, |_, _| {});
}

fn render(mirror: &mut Mirror, codes: &mut VecDeque<u16>, until: u64, rate: f64) {
    let kept = (KEPT_S * rate) as usize;
    mirror.render(until, |_, block| {
        codes.extend(block);
        if codes.len() > kept {
            codes.drain(..codes.len() - kept);
        }
    });
}

/// The work of the thread that follows.
pub fn work() -> impl FnMut(WaveformJob, &Task) -> Option<Waveform> + Send {
    let mut follower = WaveformFollower::default();
    // A job is short, and the next one needs what this one did: it is never given up.
    move |job, _| Some(follower.follow(&job))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::simulation::table_for;
    use crate::field::time_domain::tests::one_tone;
    use slipline_link::protocol::units::Position;
    use slipline_plate::preset;

    fn drive() -> Change {
        Change::Drive(Arc::new(one_tone(0, Position(20_000), 2000)))
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
