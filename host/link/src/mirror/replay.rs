//! The replay: follows the journal and keeps the latest codes that the device has sent.
//!
//! ```text
//! journal entries --> [ gap? ] --> Mirror --> the latest codes, and from which index on they are exact
//! ```
//! It is the only follower of the journal, so the waveform's display and `slipline verify` agree about the
//! codes, also where entries are missing or have no exact index:
//!
//! | event | index from which the codes are exact again |
//! |---|---|
//! | a step of the thermal fold-back was dropped or is not exact | the next known step, once the renderer has settled |
//! | entries of any kind were dropped, or the device stopped by itself | the next silence |
//! | a level hold began | the next silence |
//! | the mirror could not take a change | the next silence |

mod exactness;
mod history;
#[cfg(test)]
mod tests;

pub use history::DeviceHistory;

use super::Mirror;
use crate::journal::{Acknowledged, Change};
use exactness::Exactness;
use slipline_app::BLOCK;
use slipline_app::Stop;
use slipline_app::dds::bank::code::MID_SCALE;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::SampleIndex;
use std::collections::VecDeque;

/// After a stop the device is silent within this many seconds: every ramp is shorter.
const SILENT_AFTER_S: f64 = 0.2;
/// Samples between a table and the following change: each is taken up at a block of its own.
const AHEAD: u64 = 8 * BLOCK as u64;

/// Follows the journal of one device after another; keeps the latest codes.
///
/// ```
/// use slipline_link::mirror::replay::{DeviceHistory, Replay};
/// use slipline_link::simulator::loopback::Loopback;
/// use slipline_link::{DeviceTable, DriveRequest, Request, Sounding};
/// use std::sync::Arc;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut loopback = Loopback::connect(400_000)?;
/// let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
/// let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6)?;
/// loopback.perform(Request::Upload(Arc::new(table)), |_| ())?;
/// let began = loopback.perform(Request::Play(Sounding::Drive(DriveRequest::at(&[(0.05, 0.5)]))), |_| ())?;
/// loopback.pass(40_000, |_| ());
/// loopback.perform(Request::Refresh, |_| ())?;
///
/// let history = DeviceHistory::of(loopback.view()).ok_or("no status yet")?;
/// let mut replay = Replay::new(400_000);
/// replay.follow(&history);
/// let codes: Vec<u16> = replay.exact_codes(began, 20_000).ok_or("not exact")?.collect();
/// // Half of full scale, around mid-scale.
/// assert_eq!(codes.iter().max(), Some(&(2048 + 1023)));
/// # Ok(())
/// # }
/// ```
pub struct Replay {
    keep: usize,
    sample_rate_hz: u32,
    mirror: Option<Mirror>,
    /// The number of the latest entry replayed.
    latest: u64,
    /// The device ramps to silence from here, or is silent; `None` while tones may sound.
    silent_since: Option<SampleIndex>,
    exactness: Exactness,
    codes: VecDeque<u16>,
    /// Index at which the latest drive from silence begins.
    drive_began: SampleIndex,
    /// Index up to which the device's output is known.
    now: SampleIndex,
}

impl Replay {
    /// A replay that keeps this number of the latest codes. It knows no device yet.
    #[must_use]
    pub const fn new(keep: usize) -> Self {
        Self {
            keep,
            sample_rate_hz: 0,
            mirror: None,
            latest: 0,
            silent_since: None,
            exactness: Exactness::unknown(),
            codes: VecDeque::new(),
            drive_began: 0,
            now: 0,
        }
    }

    /// Replays new entries, up to the index that the device has reached.
    pub fn follow(&mut self, history: &DeviceHistory) {
        if self.sample_rate_hz != history.sample_rate_hz {
            *self = Self { sample_rate_hz: history.sample_rate_hz, ..Self::new(self.keep) };
        }
        for (place, entry) in history.journal.iter().enumerate() {
            if self.mirror.is_none() {
                // The first entry of all has no predecessors; that of a session only needs the fold-back.
                let is_complete = entry.number == 1 || entry.change == Change::Session;
                self.begin(history, entry.at, is_complete);
                if entry.number != 1 {
                    self.exactness.misses_foldback = true;
                }
            } else if entry.number <= self.latest {
                continue;
            } else if entry.number > self.latest + 1 {
                self.miss(history, entry.at, place == 0);
            }
            self.take(entry);
            self.latest = entry.number;
        }
        // A stop that is not known yet may begin in the previous block.
        self.now = history.now.saturating_sub(BLOCK as u64);
        self.catch_up_foldback(history);
        let until = self.silent_from().map_or(self.now, |silent| silent.min(self.now));
        self.render(until);
    }

    /// The latest codes since the drive began, oldest first, with the index of the first one.
    pub fn drive_codes(&self) -> (SampleIndex, impl ExactSizeIterator<Item = u16>) {
        let (first, codes) = self.codes();
        let before = (self.drive_began.saturating_sub(first) as usize).min(codes.len());
        (first + before as u64, codes.range(before..).copied())
    }

    /// The latest codes, oldest first, with the index of the first one. After them the device is silent, if
    /// [`Replay::is_silent`].
    fn codes(&self) -> (SampleIndex, &VecDeque<u16>) {
        let next = self.mirror.as_ref().map_or(0, Mirror::now);
        (next.saturating_sub(self.codes.len() as u64), &self.codes)
    }

    /// Whether the device has been silent longer than any ramp lasts.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.silent_from().is_some_and(|silent| self.now > silent)
    }

    /// The index from which all codes equal those of the device; `None` while they may differ.
    #[must_use]
    pub fn exact_since(&self) -> Option<SampleIndex> {
        self.exactness.since().filter(|_| self.mirror.as_ref().is_some_and(Mirror::is_true))
    }

    /// The codes of a window that the device has sent; `None` if they are not all exact, or no longer kept.
    pub fn exact_codes(&self, from: SampleIndex, count: u32) -> Option<impl Iterator<Item = u16>> {
        let end = from.checked_add(u64::from(count))?;
        let (first, codes) = self.codes();
        let rendered = first + codes.len() as u64;
        let is_known = end <= rendered || (end <= self.now && self.is_silent());
        let is_exact = self.exact_since().is_some_and(|since| since <= from);
        // After the codes there is silence, so a window may also begin there.
        let is_kept = from >= first;
        (is_known && is_exact && is_kept).then(|| {
            (from..end).map(move |index| codes.get((index - first) as usize).copied().unwrap_or(MID_SCALE))
        })
    }

    /// Begins at `at`, with the table that the device is known to hold.
    fn begin(&mut self, history: &DeviceHistory, at: SampleIndex, is_silent: bool) {
        self.codes.clear();
        self.drive_began = at;
        self.silent_since = is_silent.then_some(at);
        self.exactness = Exactness::beginning(at, is_silent);
        let mut mirror = Mirror::new(self.sample_rate_hz, at.saturating_sub(AHEAD));
        if let Some(table) = &history.table {
            // No block has been rendered, so it cannot be too late.
            let _ = mirror.acknowledge_table(table.knots().into(), mirror.now());
            mirror.render(at, |_, _| {});
        }
        self.mirror = Some(mirror);
    }

    /// Entries are missing. Those dropped at the journal's front may have been of any kind; elsewhere only
    /// steps of the thermal fold-back are dropped.
    fn miss(&mut self, history: &DeviceHistory, at: SampleIndex, at_front: bool) {
        if at_front {
            self.begin(history, at, false);
        } else {
            self.exactness.misses_foldback = true;
        }
    }

    /// A step of the fold-back was missed: the status reports the present value.
    fn catch_up_foldback(&mut self, history: &DeviceHistory) {
        let Some(mirror) = self.mirror.as_mut().filter(|_| self.exactness.misses_foldback) else { return };
        let since = Timing::at(self.sample_rate_hz).limit_since(history.now).max(mirror.now());
        // It begins with the mirror's next block at the earliest, so it cannot be too late.
        let _ = mirror.acknowledge_limit(history.foldback_per_mille, since);
        self.exactness.foldback_known(since);
    }

    fn take(&mut self, entry: &Acknowledged) {
        let sounds = matches!(entry.change, Change::Play(_));
        let has_skipped = (sounds || matches!(entry.change, Change::Table(_))) && self.skip_silence(entry.at);
        let Some(mirror) = &mut self.mirror else { return };
        if sounds && self.silent_since.take().is_some_and(|_| has_skipped) {
            self.drive_began = entry.at;
        }
        // A change that is too late, or that the renderer refuses, shows in `Mirror::is_true`.
        let _ = match &entry.change {
            Change::Session => {
                // The device is silent, and may still hold its table.
                mirror.silence(entry.at);
                self.codes.clear();
                self.drive_began = entry.at;
                self.silent_since = Some(entry.at);
                self.exactness.silent(entry.at);
                Ok(())
            }
            Change::Armed | Change::Hold => Ok(()),
            Change::Play(played) => mirror.acknowledge_play(played.clone(), entry.at),
            Change::Table(table) => mirror.acknowledge_table(table.knots().into(), entry.at),
            Change::Stop | Change::Disarmed => {
                self.silent_since.get_or_insert(entry.at);
                mirror.acknowledge_stop(Stop::Normal, entry.at)
            }
            Change::EmergencyStop => {
                self.silent_since.get_or_insert(entry.at);
                mirror.acknowledge_stop(Stop::Emergency, entry.at)
            }
            Change::Limit(per_mille) => mirror.acknowledge_limit(*per_mille, entry.at),
        };
        match (&entry.change, entry.is_exact) {
            (Change::Limit(_), is_exact) => {
                if self.exactness.misses_foldback || !is_exact {
                    self.exactness.foldback_known(entry.at);
                }
            }
            (Change::Hold, _) | (_, false) => self.exactness.misses_sound = true,
            (_, true) => {}
        }
    }

    /// The index from which the device is silent, if the latest change is a stop.
    fn silent_from(&self) -> Option<SampleIndex> {
        let ramp = (SILENT_AFTER_S * f64::from(self.sample_rate_hz)) as u64;
        self.silent_since.map(|since| since.saturating_add(ramp).next_multiple_of(BLOCK as u64))
    }

    /// If the device is known to be silent before the change at `at`, the mirror restarts there: hours of
    /// silence need not be rendered, and earlier unknown codes no longer matter. Returns whether it is silent.
    fn skip_silence(&mut self, at: SampleIndex) -> bool {
        let Some(silent) = self.silent_from().filter(|silent| silent.saturating_add(AHEAD) < at) else {
            return false;
        };
        self.render(silent);
        let Some(mirror) = &mut self.mirror else { return false };
        let rendered = mirror.now();
        let target = at - AHEAD;
        if target >= rendered {
            if self.exactness.misses_sound || !mirror.is_true() {
                self.exactness.silent(silent.max(rendered));
            }
            mirror.silence(target);
            let skipped = (mirror.now() - rendered).min(self.keep as u64) as usize;
            self.codes.extend(std::iter::repeat_n(MID_SCALE, skipped));
            // No block is rendered yet: a step of the fold-back in this silence may be reported only after
            // the change.
        }
        true
    }

    fn render(&mut self, until: SampleIndex) {
        let Some(mirror) = &mut self.mirror else { return };
        let (codes, keep) = (&mut self.codes, self.keep);
        mirror.render(until, |_, block| {
            codes.extend(block);
            if codes.len() > keep {
                codes.drain(..codes.len() - keep);
            }
        });
        // Inexact codes are dropped as soon as exact ones exist.
        if mirror.is_true()
            && let Some(since) = self.exactness.since()
        {
            let first = mirror.now() - codes.len() as u64;
            let stale = since.saturating_sub(first).min(codes.len() as u64);
            codes.drain(..stale as usize);
        }
    }
}
