//! Drives that wait for the trigger input, and the journal while it is unknown whether they have begun.
//!
//! Only the device knows when the input rises. Its status reports that a drive waits. A drive that no longer
//! waits has begun or was dropped, and the device is asked which
//! ([`Command::Trigger`](slipline_protocol::Command::Trigger)). Changes accepted since then are held back
//! until the reply, so that the journal stays in the order of the indices.

use crate::journal::Change;
use slipline_protocol::event::TriggerReport;
use slipline_protocol::units::SampleIndex;

/// A change to be entered into the journal; the fields are those of
/// [`Acknowledged`](crate::journal::Acknowledged).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Held {
    pub(crate) at: SampleIndex,
    pub(crate) change: Change,
    pub(crate) is_exact: bool,
}

/// Drives and changes that are undecided.
#[derive(Debug, Default)]
pub(crate) struct Undecided {
    /// The accepted drives and chords, with the index from which a rise counts. Each has replaced the
    /// previous one, so only the last may still be waiting.
    drives: Vec<(SampleIndex, Change)>,
    held: Vec<Held>,
}

impl Undecided {
    /// Whether everything is decided.
    pub(crate) const fn is_empty(&self) -> bool {
        self.drives.is_empty()
    }

    /// Whether the device must be asked even while a drive waits: the previous one may have begun.
    pub(crate) const fn is_about_several(&self) -> bool {
        self.drives.len() > 1
    }

    /// A drive waits; a rise counts from this index on.
    pub(crate) fn wait(&mut self, from: SampleIndex, drive: Change) {
        self.drives.push((from, drive));
    }

    /// Keeps a change until earlier drives are decided.
    pub(crate) fn hold(&mut self, held: Held) {
        self.held.push(held);
    }

    /// A status reports that a drive waits: changes before that status precede the drive. Returns the entries
    /// for the journal.
    pub(crate) fn waits_still(&mut self) -> Vec<Held> {
        if self.is_about_several() { Vec::new() } else { std::mem::take(&mut self.held) }
    }

    /// The device has replied. Returns the entries for the journal, in the order of the indices.
    pub(crate) fn decide(&mut self, report: &TriggerReport) -> Vec<Held> {
        let mut decided = std::mem::take(&mut self.drives);
        if report.waits {
            self.drives.extend(decided.pop());
        }
        let mut entries = std::mem::take(&mut self.held);
        let last = report.began.and_then(|began| {
            decided.iter().rposition(|(from, _)| *from < began).map(|place| (began, place))
        });
        if let Some((at, place)) = last {
            let drive = decided.swap_remove(place).1;
            // It can no longer be found out whether earlier drives had begun.
            entries.push(Held { at, change: drive, is_exact: place == 0 });
        }
        entries.sort_by_key(|held| held.at);
        entries
    }

    /// The device is lost and cannot be asked. Returns the entries for the journal.
    pub(crate) fn give_up(&mut self) -> Vec<Held> {
        self.drives.clear();
        let held = std::mem::take(&mut self.held);
        held.into_iter().map(|held| Held { is_exact: false, ..held }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_protocol::command::{Apply, Drive};
    use slipline_protocol::units::CentiDecibel;

    fn drive(glide: u32) -> Change {
        let tones = heapless::Vec::new();
        let drive = Drive { tones, master: CentiDecibel(0), glide, apply: Apply::AtTrigger };
        Change::Play(drive.into())
    }

    fn held(at: SampleIndex, change: Change) -> Held {
        Held { at, change, is_exact: true }
    }

    #[test]
    fn a_drive_that_began_comes_before_the_stop_that_was_reported_first() {
        let mut undecided = Undecided::default();
        undecided.wait(1280, drive(2000));
        undecided.hold(held(6400, Change::Stop));
        let began = TriggerReport { waits: false, began: Some(2560) };
        let entries = undecided.decide(&began);
        assert_eq!(entries, [held(2560, drive(2000)), held(6400, Change::Stop)]);
        assert!(undecided.is_empty());
    }

    #[test]
    fn a_drive_that_was_dropped_leaves_no_trace_not_even_where_an_earlier_one_began() {
        for began in [None, Some(1280)] {
            let mut undecided = Undecided::default();
            undecided.wait(1280, drive(2000));
            undecided.hold(held(6400, Change::Stop));
            let entries = undecided.decide(&TriggerReport { waits: false, began });
            assert_eq!(entries, [held(6400, Change::Stop)], "{began:?}");
        }
    }

    #[test]
    fn the_first_of_two_drives_is_known_unless_the_second_has_begun() {
        let two = || {
            let mut undecided = Undecided::default();
            undecided.wait(1280, drive(2000));
            undecided.wait(6400, drive(3000));
            assert!(undecided.is_about_several() && undecided.waits_still().is_empty());
            undecided
        };
        let mut undecided = two();
        let entries = undecided.decide(&TriggerReport { waits: true, began: Some(2560) });
        assert_eq!(entries, [held(2560, drive(2000))]);
        assert!(!undecided.is_empty(), "the second waits");

        let entries = two().decide(&TriggerReport { waits: false, began: Some(7680) });
        let unsure = Held { is_exact: false, ..held(7680, drive(3000)) };
        assert_eq!(entries, [unsure], "the first may have begun before");
    }
}
