//! The mirror: computes every code that a device sends to its DAC, from the changes that the device has
//! acknowledged.
//!
//! The device states the index at which each change begins. The same changes at the same indices through the
//! same renderer give the same codes, bit for bit: the renderer computes with integers only, and one pure
//! function makes the program from the drive. The thermal fold-back changes only at the beginning of its
//! periods and is reported in the status, so it is replayed, too. The device's own stops (dead-man, faults)
//! are not replayed, because the beginning of their ramps is not reported. After one of them the mirror is
//! wrong until the device is silent and [`Mirror::silence`] is called.

pub mod replay;

pub use crate::chord::extent as chord_extent;

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;

use crate::played::Played;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use slipline_app::BLOCK;
use slipline_app::dds::lock_in;
use slipline_app::mailbox::Mailbox;
use slipline_app::planning::chord::ChordTones;
use slipline_app::planning::plan::Planner;
use slipline_app::slots::TableRef;
use slipline_app::{Renderer, Timing};
use slipline_protocol::table::Knot;
use slipline_protocol::units::SampleIndex;

/// How fast a device ramps to silence.
pub use slipline_app::Stop;

/// An accepted change that is still to be applied.
#[derive(Clone, Debug)]
enum Scheduled {
    Play(Played),
    Table(Arc<[Knot]>),
    Stop(Stop),
}

/// A change arrived too late to be mirrored: its index has been rendered already.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the change at sample {at} came after the mirror had gone on to {now}")]
pub struct TooLate {
    /// Where the change begins.
    pub at: SampleIndex,
    /// The mirror's next index.
    pub now: SampleIndex,
}

/// A renderer on the host, driven by the acknowledged changes.
///
/// ```
/// use slipline_link::mirror::Mirror;
/// use slipline_link::protocol::command::{Apply, Drive, Tone};
/// use slipline_link::protocol::units::{CentiDecibel, Level, Phase, Position};
/// use slipline_link::DeviceTable;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let table = DeviceTable::from_knots((0.0, 0.1), 400e3, [(30e3, 1.0), (20e3, 1.0)], 1e-6)?;
/// let tone = Tone { slot: 0, position: Position(32768), level: Level::FULL, phase: Phase(0) };
/// let drive = Drive {
///     tones: [tone].into_iter().collect(),
///     master: CentiDecibel(0),
///     glide: 2000,
///     apply: Apply::Next,
/// };
///
/// let mut mirror = Mirror::new(400_000, 0);
/// mirror.acknowledge_table(table.knots().into(), 0)?;
/// mirror.acknowledge_play(drive, 12_800)?;
/// let mut first_sound = None;
/// mirror.render(40_000, |first, codes| {
///     if codes.iter().any(|&code| code != 2048) {
///         first_sound.get_or_insert(first);
///     }
/// });
/// assert_eq!(first_sound, Some(12_800));
/// assert!(mirror.is_true());
/// # Ok(())
/// # }
/// ```
pub struct Mirror {
    timing: Timing,
    mailbox: Box<Mailbox<CriticalSectionRawMutex>>,
    renderer: Renderer,
    table: TableRef,
    changes: VecDeque<(SampleIndex, Scheduled)>,
    /// The thermal limits that will come into force, per mille, and the latest reported one.
    limits: VecDeque<(SampleIndex, u16)>,
    latest_limit: Option<u16>,
    has_rendered: bool,
    diverged: bool,
}

impl Mirror {
    /// A mirror of a device that is silent at an index (rounded down to a block) and has no table.
    #[must_use]
    pub fn new(sample_rate_hz: u32, index: SampleIndex) -> Self {
        let timing = Timing::at(sample_rate_hz);
        let mailbox = Box::<Mailbox<CriticalSectionRawMutex>>::default();
        // A mirror renders every accepted drive: the device has checked that it was armed.
        mailbox.arm_from(0);
        let renderer = Renderer::starting_at(timing, index);
        mailbox.begin_at(renderer.index());
        Self {
            timing,
            mailbox,
            renderer,
            table: TableRef::default(),
            changes: VecDeque::new(),
            limits: VecDeque::new(),
            latest_limit: None,
            has_rendered: false,
            diverged: false,
        }
    }

    /// The index of the next code.
    #[must_use]
    pub const fn now(&self) -> SampleIndex {
        self.renderer.index()
    }

    /// How the last block was rendered, for a [lock-in](slipline_app::dds::lock_in) on an input's
    /// response to it.
    #[must_use]
    pub fn played(&self) -> lock_in::Played {
        self.renderer.played()
    }

    /// Whether everything acknowledged so far could be replayed.
    #[must_use]
    pub const fn is_true(&self) -> bool {
        !self.diverged
    }

    /// A drive, a chord or a comb was accepted and begins at `at`. A chord's peak is not checked again.
    ///
    /// # Errors
    /// [`TooLate`]; the mirror is not true from then on.
    pub fn acknowledge_play(&mut self, played: impl Into<Played>, at: SampleIndex) -> Result<(), TooLate> {
        self.acknowledge(at, Scheduled::Play(played.into()))
    }

    /// A table was swapped in at `at`, by a commit or because the device held it already.
    ///
    /// # Errors
    /// [`TooLate`]; the mirror is not true from then on.
    pub fn acknowledge_table(&mut self, knots: Arc<[Knot]>, at: SampleIndex) -> Result<(), TooLate> {
        self.acknowledge(at, Scheduled::Table(knots))
    }

    /// A ramp to silence began at `at`: a stop, a disarm or a new session ([`Stop::Normal`]), or an emergency
    /// stop. At a block's first sample, the block was rendered with it; later in a block, the ramp began in a
    /// block that had been rendered already.
    ///
    /// # Errors
    /// [`TooLate`]; the mirror is not true from then on.
    pub fn acknowledge_stop(&mut self, stop: Stop, at: SampleIndex) -> Result<(), TooLate> {
        // An accepted drive that had not begun is dropped, as in the device; a table stays in force.
        self.changes.retain(|(begins, change)| *begins < at || !matches!(change, Scheduled::Play(_)));
        self.acknowledge(at, Scheduled::Stop(stop))
    }

    /// The device's thermal limit is `per_mille` from `at` on:
    /// [`limit_since`](slipline_app::Timing::limit_since) the status that reports it. A mirror that has
    /// rendered nothing yet begins with it.
    ///
    /// # Errors
    /// [`TooLate`]; the mirror is not true from then on.
    pub fn acknowledge_limit(&mut self, per_mille: u16, at: SampleIndex) -> Result<(), TooLate> {
        if self.latest_limit.replace(per_mille) == Some(per_mille) {
            return Ok(());
        }
        self.limits.push_back((at, per_mille));
        let now = self.now();
        let is_late = at < now && self.has_rendered;
        self.diverged |= is_late;
        if is_late { Err(TooLate { at, now }) } else { Ok(()) }
    }

    fn acknowledge(&mut self, at: SampleIndex, change: Scheduled) -> Result<(), TooLate> {
        let now = self.now();
        if at < now {
            self.diverged = true;
            return Err(TooLate { at, now });
        }
        let place = self.changes.partition_point(|(other, _)| *other <= at);
        self.changes.insert(place, (at, change));
        Ok(())
    }

    /// The device is known to be silent at `index` (rounded down to a block): the mirror moves there, keeps
    /// its table, and is exact again. Pending drives and stops are dropped; a table stays in force.
    pub fn silence(&mut self, index: SampleIndex) {
        let held: Arc<[Knot]> =
            (0..self.table.knots).map(|index| self.mailbox.slots().knot(self.table.slot, index)).collect();
        let mut table = (!held.is_empty()).then_some(held);
        let mut later = VecDeque::new();
        for (at, change) in std::mem::take(&mut self.changes) {
            match change {
                Scheduled::Table(knots) if at <= index => table = Some(knots),
                Scheduled::Table(_) => later.push_back((at, change)),
                Scheduled::Play(_) | Scheduled::Stop(_) => {}
            }
        }
        let limit = self.latest_limit;
        *self = Self::new(self.timing.sample_rate_hz, index);
        self.latest_limit = limit;
        self.limits.extend(limit.map(|per_mille| (self.now(), per_mille)));
        self.changes = later;
        if let Some(knots) = table {
            self.changes.push_front((self.now(), Scheduled::Table(knots)));
        }
    }

    /// Renders whole blocks up to `until` (rounded down); `sink` receives each with the index of its first
    /// code.
    pub fn render(&mut self, until: SampleIndex, mut sink: impl FnMut(SampleIndex, &[u16; BLOCK])) {
        let mut codes = [0; BLOCK];
        while self.now().saturating_add(BLOCK as u64) <= until {
            let first = self.now();
            while self.changes.front().is_some_and(|(at, _)| *at <= first) {
                if let Some((_, change)) = self.changes.pop_front() {
                    self.apply(change);
                }
            }
            while let Some((_, limit)) = self.limits.pop_front_if(|(at, _)| *at <= first) {
                self.mailbox.set_limit(limit);
            }
            self.has_rendered = true;
            // The mirror does not see the keep-alives, so its own dead-man must never act.
            self.mailbox.feed();
            self.renderer.render(&self.mailbox, &mut codes);
            self.revise(&mut codes);
            sink(first, &codes);
        }
    }

    /// Applies a stop within the block rendered last: the device had rendered it before the stop arrived.
    fn revise(&mut self, codes: &mut [u16; BLOCK]) {
        let next = self.now();
        let within =
            |(at, change): &mut (SampleIndex, Scheduled)| *at < next && matches!(change, Scheduled::Stop(_));
        while let Some((_, Scheduled::Stop(stop))) = self.changes.pop_front_if(within) {
            self.mailbox.stop_at_once(stop);
            let revised = self.renderer.revise(&self.mailbox, codes, |_| Ok::<(), Infallible>(()));
            self.diverged |= revised != Ok(true);
        }
    }

    fn apply(&mut self, change: Scheduled) {
        let at = self.now();
        let view = self.mailbox.view();
        let mut planner =
            Planner { slots: self.mailbox.slots(), timing: &self.timing, is_stopped: &mut || false };
        let planned = match change {
            Scheduled::Stop(stop) => {
                self.mailbox.stop(stop);
                return;
            }
            Scheduled::Play(Played::Drive(drive)) => planner.drive(&drive, at, self.table, &view.motion),
            Scheduled::Play(Played::Chord(chord)) => {
                let mut tones = ChordTones::NONE;
                planner
                    .place_chord(&chord, self.table, &mut tones)
                    .and_then(|()| planner.chord(&tones, at, chord.glide, self.table, &view.motion))
            }
            Scheduled::Play(Played::Comb(comb)) => {
                let mut tones = ChordTones::NONE;
                planner
                    .place_comb(&comb, self.table, &mut tones)
                    .and_then(|()| planner.chord(&tones, at, comb.glide, self.table, &view.motion))
            }
            Scheduled::Table(knots) => {
                let slot = self.table.slot.other();
                let mut count = 0;
                for &knot in knots.iter() {
                    self.mailbox.write_knot(slot, count, knot);
                    count += 1;
                }
                self.table = TableRef { slot, knots: count };
                planner.swap(at, self.table, &view.motion)
            }
        };
        let published = planned.map(|program| self.mailbox.publish(&program, &view));
        self.diverged |= !matches!(published, Ok(Ok(())));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_protocol::command::{Apply, Drive, Tone};
    use slipline_protocol::units::{CentiDecibel, Gain, Level, Phase, Position};

    /// One tone at full level.
    fn one_tone(slot: u8, position: Position, glide: u32) -> Drive {
        let tone = Tone { slot, position, level: Level::FULL, phase: Phase(0) };
        Drive { tones: [tone].into_iter().collect(), master: CentiDecibel(0), glide, apply: Apply::Next }
    }

    fn knots() -> Arc<[Knot]> {
        (0..5u32).map(|i| Knot { step: 100_000_000 + i * 1_000_000, gain: Gain::FULL }).collect()
    }

    fn drive() -> Drive {
        one_tone(1, Position(9), 2000)
    }

    fn peak(mirror: &mut Mirror, until: SampleIndex) -> u16 {
        let mut peak = 0;
        mirror.render(until, |_, codes| {
            peak = codes.iter().map(|code| code.abs_diff(2048)).max().unwrap_or(0).max(peak);
        });
        peak
    }

    #[test]
    fn a_change_that_comes_too_late_is_reported_and_a_known_silence_makes_the_mirror_true_again() {
        let mut mirror = Mirror::new(400_000, 1_000_000);
        mirror.acknowledge_table(knots(), mirror.now()).unwrap();
        assert_eq!(peak(&mut mirror, 1_010_000), 0);
        let now = mirror.now();
        assert_eq!(mirror.acknowledge_play(drive(), now - 128), Err(TooLate { at: now - 128, now }));
        assert!(!mirror.is_true());
        mirror.silence(2_000_000);
        assert!(mirror.is_true());
        mirror.acknowledge_play(drive(), 2_000_000 / 128 * 128 + 1280).unwrap();
        assert_eq!(peak(&mut mirror, 2_000_000), 0);
        assert_eq!(peak(&mut mirror, 2_010_000), 2047, "the table was kept");
        assert!(mirror.is_true());
    }

    #[test]
    fn a_stop_drops_the_drive_that_had_not_begun_and_a_mirror_needs_no_host_that_keeps_alive() {
        let mut mirror = Mirror::new(400_000, 0);
        mirror.acknowledge_table(knots(), 0).unwrap();
        mirror.acknowledge_play(drive(), 12_800).unwrap();
        mirror.acknowledge_stop(Stop::Normal, 6400).unwrap();
        assert_eq!(peak(&mut mirror, 20_000), 0);
        mirror.acknowledge_play(drive(), 25_600).unwrap();
        assert_eq!(peak(&mut mirror, 30_000), 2047);
        mirror.render(1_000_000, |_, _| {});
        assert_eq!(peak(&mut mirror, 1_010_000), 2047);
        assert!(mirror.is_true());
    }

    #[test]
    fn a_drive_without_a_table_is_not_true() {
        let mut mirror = Mirror::new(400_000, 0);
        mirror.acknowledge_play(drive(), 0).unwrap();
        assert_eq!(peak(&mut mirror, 10_000), 0);
        assert!(!mirror.is_true());
    }
}
