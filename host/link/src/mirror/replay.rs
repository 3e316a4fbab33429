//! The replay: follows the journal and keeps the latest codes that the device has sent.
//!
//! ```text
//! journal entries --> [ gap? ] --> Mirror --> the latest codes, and from which index on they are exact
//! ```
//! It is the only follower of the journal. What the waveform's display and `slipline verify` say of the codes therefore
//! agrees, also where entries are missing or name no exact index:
//!
//! | what happened | from where the codes are exact again |
//! |---|---|
//! | a step of the thermal fold-back was dropped or is not exact | the next known step, once the renderer has settled |
//! | entries of any kind were dropped, or the device stopped by itself | the next silence |
//! | the mirror could not take a change | the next silence |

use super::Mirror;
use crate::journal::{Acknowledged, Change};
use crate::snapshot::Snapshot;
use crate::table::DeviceTable;
use slipline_app::bank::BLOCK;
use slipline_app::bank::code::MID_SCALE;
use slipline_app::{Stop, Timing};
use slipline_protocol::units::SampleIndex;
use std::collections::VecDeque;
use std::sync::Arc;

/// After a stop the device is silent within this many seconds: every ramp is shorter.
const SILENT_AFTER_S: f64 = 0.2;
/// Samples between a table and the change after it: each is taken up at a block of its own.
const AHEAD: u64 = 8 * BLOCK as u64;
/// After a step of the thermal fold-back the renderer's amplitude is where the step leads within so many samples: it
/// moves from full scale to nothing in 65 blocks.
const FOLDBACK_SETTLES: u64 = 80 * BLOCK as u64;
/// What the link knows of a device's past: what a [`Replay`] goes by.
#[derive(Clone, Debug)]
pub struct DeviceHistory {
    /// The device's samples per second, in Hz.
    pub sample_rate_hz: u32,
    /// What it has agreed to.
    pub journal: Arc<VecDeque<Arc<Acknowledged>>>,
    /// The table that it is known to hold.
    pub table: Option<Arc<DeviceTable>>,
    /// The device has rendered up to here.
    pub now: SampleIndex,
    /// What the thermal fold-back leaves of every amplitude there, per mille.
    pub foldback_per_mille: u16,
}

impl DeviceHistory {
    /// The history of the device in a snapshot; `None` while no device has told its status.
    #[must_use]
    pub fn of(snapshot: &Snapshot) -> Option<Self> {
        let status = snapshot.status?;
        Some(Self {
            sample_rate_hz: snapshot.identity.as_ref()?.sample_rate_hz,
            journal: Arc::clone(&snapshot.journal),
            table: snapshot.confirmed_table.clone(),
            now: status.now,
            foldback_per_mille: status.foldback_per_mille,
        })
    }
}

/// How far the codes can be relied on.
#[derive(Clone, Copy, Debug)]
struct Exactness {
    /// They are exact from this index on, unless:
    since: SampleIndex,
    /// Something unknown sounds or has sounded: they are exact once the device is silent.
    misses_sound: bool,
    /// A step of the thermal fold-back is missing: they are exact once the present one is known.
    misses_foldback: bool,
}

impl Exactness {
    /// The device is known to be silent at `at`.
    fn silent(&mut self, at: SampleIndex) {
        self.misses_sound = false;
        self.since = self.since.max(at);
    }

    /// What the fold-back leaves is known from `at` on, but it was not before.
    fn foldback_known(&mut self, at: SampleIndex) {
        self.misses_foldback = false;
        self.since = self.since.max(at + FOLDBACK_SETTLES);
    }
}

/// Follows the journal of one device after the other; keeps the latest codes.
pub struct Replay {
    keep: usize,
    sample_rate_hz: u32,
    mirror: Option<Mirror>,
    /// The number of the latest entry that was taken.
    latest: u64,
    /// The device ramps to silence from here, or is silent; `None` while tones may sound.
    silent_since: Option<SampleIndex>,
    exactness: Exactness,
    codes: VecDeque<u16>,
    /// The latest drive out of silence begins here.
    drive_began: SampleIndex,
    /// The device has rendered up to here.
    now: SampleIndex,
}

impl Replay {
    /// A replay that keeps so many of the latest codes. It knows no device yet.
    #[must_use]
    pub const fn new(keep: usize) -> Self {
        Self {
            keep,
            sample_rate_hz: 0,
            mirror: None,
            latest: 0,
            silent_since: None,
            exactness: Exactness { since: 0, misses_sound: true, misses_foldback: false },
            codes: VecDeque::new(),
            drive_began: 0,
            now: 0,
        }
    }

    /// Replays what is new, up to the index that the device has reached.
    pub fn follow(&mut self, history: &DeviceHistory) {
        if self.sample_rate_hz != history.sample_rate_hz {
            *self = Self { sample_rate_hz: history.sample_rate_hz, ..Self::new(self.keep) };
        }
        for (place, entry) in history.journal.iter().enumerate() {
            if self.mirror.is_none() {
                // Nothing stands before the first entry of all; before a session's, only the fold-back does.
                let is_complete = entry.number == 1 || entry.change == Change::Session;
                self.begin(history, entry.at, is_complete);
                self.exactness.misses_foldback = entry.number != 1;
            } else if entry.number <= self.latest {
                continue;
            } else if entry.number > self.latest + 1 {
                self.miss(history, entry.at, place == 0);
            }
            self.take(entry);
            self.latest = entry.number;
        }
        self.now = history.now;
        self.catch_up_foldback(history.foldback_per_mille);
        let until = self.silent_from().map_or(self.now, |silent| silent.min(self.now));
        self.render(until);
    }

    /// The latest codes since the drive began, oldest first, with the index of the first one.
    pub fn drive_codes(&self) -> (SampleIndex, impl ExactSizeIterator<Item = u16>) {
        let (first, codes) = self.codes();
        let before = (self.drive_began.saturating_sub(first) as usize).min(codes.len());
        (first + before as u64, codes.range(before..).copied())
    }

    /// The latest codes, oldest first, with the index of the first one. Behind them there is silence, if
    /// [`Replay::is_silent`].
    fn codes(&self) -> (SampleIndex, &VecDeque<u16>) {
        let next = self.mirror.as_ref().map_or(0, Mirror::now);
        (next.saturating_sub(self.codes.len() as u64), &self.codes)
    }

    /// Whether the device has been silent for so long that every ramp is over.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.silent_from().is_some_and(|silent| self.now > silent)
    }

    /// The index from which the codes are those of the device, every one of them; `None` while they may differ.
    #[must_use]
    pub fn exact_since(&self) -> Option<SampleIndex> {
        let Exactness { since, misses_sound, misses_foldback } = self.exactness;
        let is_true = self.mirror.as_ref().is_some_and(Mirror::is_true);
        (is_true && !misses_sound && !misses_foldback).then_some(since)
    }

    /// The codes of a window that the device has sent; `None` if they are not all known exactly, or not kept any more.
    pub fn exact_codes(&self, from: SampleIndex, count: u32) -> Option<impl Iterator<Item = u16>> {
        let end = from.checked_add(u64::from(count))?;
        let (first, codes) = self.codes();
        let rendered = first + codes.len() as u64;
        let is_known = end <= rendered || (end <= self.now && self.is_silent());
        let is_exact = self.exact_since().is_some_and(|since| since <= from);
        // Behind the codes there is silence, so a window may also begin there.
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
        self.exactness = Exactness { since: at, misses_sound: !is_silent, misses_foldback: !is_silent };
        let mut mirror = Mirror::new(self.sample_rate_hz, at.saturating_sub(AHEAD));
        if let Some(table) = &history.table {
            // Nothing has been rendered: it cannot come too late.
            let _ = mirror.acknowledge_table(table.knots().into(), mirror.now());
            mirror.render(at, |_, _| {});
        }
        self.mirror = Some(mirror);
    }

    /// Entries are missing. Those that left the journal's front may have been anything; within it only steps of the
    /// thermal fold-back are ever dropped.
    fn miss(&mut self, history: &DeviceHistory, at: SampleIndex, at_front: bool) {
        if at_front {
            self.begin(history, at, false);
        } else {
            self.exactness.misses_foldback = true;
        }
    }

    /// A step of the fold-back was missed: the status tells what is in force now.
    fn catch_up_foldback(&mut self, per_mille: u16) {
        let Some(mirror) = self.mirror.as_mut().filter(|_| self.exactness.misses_foldback) else { return };
        let since = Timing::at(self.sample_rate_hz).limit_since(self.now).max(mirror.now());
        // It begins with the mirror's next block at the earliest: it cannot come too late.
        let _ = mirror.acknowledge_limit(per_mille, since);
        self.exactness.foldback_known(since);
    }

    fn take(&mut self, entry: &Acknowledged) {
        let has_skipped =
            matches!(entry.change, Change::Drive(_) | Change::Table(_)) && self.skip_silence(entry.at);
        let Some(mirror) = &mut self.mirror else { return };
        // A change that comes too late, or that the renderer cannot take, shows in `Mirror::is_true`.
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
            Change::Armed => Ok(()),
            Change::Drive(drive) => {
                if self.silent_since.take().is_some_and(|_| has_skipped) {
                    self.drive_began = entry.at;
                }
                mirror.acknowledge_drive(drive, entry.at)
            }
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
            (_, true) => {}
            (_, false) => self.exactness.misses_sound = true,
        }
    }

    /// The index from which the device is silent, if a stop stands.
    fn silent_from(&self) -> Option<SampleIndex> {
        let ramp = (SILENT_AFTER_S * f64::from(self.sample_rate_hz)) as u64;
        self.silent_since.map(|since| since.saturating_add(ramp).next_multiple_of(BLOCK as u64))
    }

    /// If the device is known to be silent before the change at `at`, the mirror begins anew there: hours of silence
    /// need not be rendered, and whatever was unknown before is over. Returns whether it is.
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
            // The table is taken up before the change.
            self.render(at);
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
        // What was not exact goes as soon as there is something that is.
        let Exactness { since, misses_sound, misses_foldback } = self.exactness;
        if mirror.is_true() && !misses_sound && !misses_foldback {
            let first = mirror.now() - codes.len() as u64;
            let stale = since.saturating_sub(first).min(codes.len() as u64);
            codes.drain(..stale as usize);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_protocol::command::{Apply, Drive, Tone};
    use slipline_protocol::units::{CentiDecibel, Level, Phase, Position};

    const RATE_HZ: u32 = 400_000;

    fn drive(position: u16) -> Change {
        let tone = Tone { slot: 0, position: Position(position), level: Level::FULL, phase: Phase(0) };
        let tones = [tone].into_iter().collect();
        let drive = Drive { tones, master: CentiDecibel(0), glide: 2000, apply: Apply::Next };
        Change::Drive(Arc::new(drive))
    }

    fn table() -> Arc<DeviceTable> {
        let knots = (0..65).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
        Arc::new(DeviceTable::from_knots((0.1, 0.2), f64::from(RATE_HZ), knots, 1e-6).unwrap())
    }

    fn history(entries: &[(u64, u64, Change)], now: u64) -> DeviceHistory {
        let entry = |(number, at, change): &(u64, u64, Change)| {
            Arc::new(Acknowledged { number: *number, at: *at, change: change.clone(), is_exact: true })
        };
        let journal = Arc::new(entries.iter().map(entry).collect());
        let foldback_per_mille = 1000;
        DeviceHistory { sample_rate_hz: RATE_HZ, journal, table: Some(table()), now, foldback_per_mille }
    }

    /// A replay that has followed these entries, up to `now`.
    fn followed(entries: &[(u64, u64, Change)], now: u64) -> Replay {
        let mut replay = Replay::new(RATE_HZ as usize);
        replay.follow(&history(entries, now));
        replay
    }

    /// Whether all codes that are kept are exact.
    fn is_exact(replay: &Replay) -> bool {
        replay.exact_since().is_some_and(|since| since <= replay.codes().0)
    }

    #[test]
    fn after_missing_entries_the_codes_are_exact_from_the_next_silence_and_the_table_is_kept() {
        let mut replay = followed(&[(1, 12_800, Change::Session), (2, 25_600, drive(20_000))], 128_000);
        assert!(is_exact(&replay));
        replay.follow(&history(&[(40, 256_000, Change::Stop)], 260_000));
        assert!(!is_exact(&replay));
        let later = [(40, 256_000, Change::Stop), (41, 512_000, drive(20_000))];
        replay.follow(&history(&later, 640_000));
        assert!(is_exact(&replay));
        assert!(replay.codes().1.iter().any(|&code| code > 2500), "the table was kept");
    }

    #[test]
    fn a_drive_after_missing_entries_is_not_exact_while_an_unknown_drive_may_sound() {
        let mut replay = followed(&[(1, 12_800, Change::Session)], 128_000);
        // Entry 2 may have been a drive: this one is then a glide from tones that nobody knows.
        replay.follow(&history(&[(3, 512_000, drive(20_000))], 640_000));
        assert_eq!(replay.exact_since(), None);
        assert!(replay.exact_codes(600_000, 1000).is_none());
    }

    #[test]
    fn a_stop_of_the_devices_own_makes_the_codes_inexact_until_the_next_silence() {
        let entries = [(1, 12_800, Change::Session), (2, 25_600, drive(20_000)), (3, 200_000, Change::Stop)];
        let mut replay = followed(&entries[..2], 128_000);
        let mut own = history(&entries, 204_800);
        Arc::make_mut(Arc::make_mut(&mut own.journal).back_mut().unwrap()).is_exact = false;
        replay.follow(&own);
        assert!(!is_exact(&replay));
        Arc::make_mut(&mut own.journal)
            .extend(history(&[(4, 512_000, drive(20_000))], 0).journal.iter().cloned());
        replay.follow(&DeviceHistory { now: 640_000, ..own });
        assert!(is_exact(&replay) && !replay.codes().1.is_empty());
    }

    #[test]
    fn dropped_steps_of_the_fold_back_cost_only_the_codes_before_the_next_one() {
        let start = [(1, 12_800, Change::Session), (2, 25_600, drive(20_000))];
        let mut replay = followed(&start, 128_000);
        let later = [start[0].clone(), start[1].clone(), (9, 131_072, Change::Limit(900))];
        replay.follow(&history(&later, 256_000));
        assert!(is_exact(&replay) && !replay.codes().1.is_empty());
        assert_eq!(replay.exact_since(), Some(131_072 + FOLDBACK_SETTLES));
    }

    #[test]
    fn codes_over_a_skipped_silence_are_those_of_a_mirror_that_renders_all_of_it() {
        let entries = [
            (1, 12_800, Change::Session),
            (2, 25_600, drive(20_000)),
            (3, 102_400, Change::Stop),
            (4, 307_200, drive(50_000)),
        ];
        // Followed at once, and entry by entry as they come.
        let mut in_steps = Replay::new(RATE_HZ as usize);
        for (count, now) in [(1, 20_000), (2, 90_000), (3, 110_000), (3, 300_000), (4, 384_000)] {
            in_steps.follow(&history(&entries[..count], now));
        }
        let at_once = followed(&entries, 384_000);
        let mut mirror = Mirror::new(RATE_HZ, 12_800);
        mirror.acknowledge_table(table().knots().into(), 12_800).unwrap();
        for (_, at, change) in &entries {
            match change {
                Change::Drive(drive) => mirror.acknowledge_drive(drive, *at).unwrap(),
                Change::Stop => mirror.acknowledge_stop(Stop::Normal, *at).unwrap(),
                _ => {}
            }
        }
        let mut whole = Vec::new();
        mirror.render(384_000, |_, codes| whole.extend_from_slice(codes));
        let window = |from: u64, count: u32| whole[(from - 12_800) as usize..][..count as usize].to_vec();
        for replay in [&at_once, &in_steps] {
            for (from, count) in [(20_000, 90_000), (90_001, 250_000), (190_000, 7), (300_000, 80_000)] {
                let codes: Vec<u16> = replay.exact_codes(from, count).unwrap().collect();
                assert!(codes == window(from, count), "{count} from {from}");
            }
            assert!(replay.exact_codes(383_000, 2000).is_none(), "not sent yet");
        }
    }

    #[test]
    fn a_table_that_comes_during_a_silence_is_in_force_after_it() {
        // Soon after the session's beginning, and long after it.
        for at in [25_600, 92_800, 93_440, 400_000] {
            let entries =
                [(1, 12_800, Change::Session), (2, at, Change::Table(table())), (3, 600_064, drive(20_000))];
            let mut replay = Replay::new(RATE_HZ as usize);
            for (count, now) in [(1, 20_000), (2, 420_096), (3, 700_032)] {
                replay.follow(&DeviceHistory { table: None, ..history(&entries[..count], now) });
            }
            assert!(is_exact(&replay), "{at}");
            assert!(replay.codes().1.iter().any(|&code| code > 2500), "{at}");
        }
    }

    #[test]
    fn silence_is_known_without_being_rendered() {
        let replay = followed(&[(1, 12_800, Change::Session)], 400_000_000);
        assert!(replay.is_silent());
        let mut codes = replay.exact_codes(399_000_000, 1000).unwrap();
        assert!(codes.all(|code| code == MID_SCALE));
    }
}
