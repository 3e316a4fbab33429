//! How soon one picture follows another.
//!
//! A mouse moves 125 times a second and more, and each move asks for a picture. On a graphics card that is cheap. Drawn by
//! the processor a picture takes tens of milliseconds of every core, and a drag would leave nothing to the rest of the
//! computer, this program's own link included. So a picture that took long is followed by a pause; moves that come in the
//! meantime are shown together. After a rest the first move is shown at once.

use std::time::{Duration, Instant};

/// Least time from the beginning of a picture to the beginning of the next: as often as a mouse moves.
const LEAST: Duration = Duration::from_millis(8);
/// The time from the beginning of a picture to the beginning of the next, over the time that it took.
const STRETCH: f64 = 1.9;
/// Most time from the beginning of a picture to the beginning of the next, if it did not take longer itself.
const MOST: Duration = Duration::from_millis(38);

/// Holds back the requests for a picture of windows that are named by `W`.
#[derive(Debug)]
pub(super) struct Pace<W> {
    /// Before this time there is no picture; `None` before the first.
    next: Option<Instant>,
    /// The window whose request was held back.
    held: Option<W>,
}

impl<W> Default for Pace<W> {
    fn default() -> Self {
        Self { next: None, held: None }
    }
}

impl<W: Copy> Pace<W> {
    /// Whether the request for a picture of `window` is granted; otherwise it is held back.
    pub(super) fn may_draw(&mut self, window: W, now: Instant) -> bool {
        let is_due = self.next.is_none_or(|next| now >= next);
        self.held = (!is_due).then_some(window);
        is_due
    }

    /// A picture was drawn.
    pub(super) fn drawn(&mut self, began: Instant, ended: Instant) {
        let took = ended.saturating_duration_since(began);
        self.held = None;
        self.next = Some(began + took.mul_f64(STRETCH).min(MOST).max(LEAST));
    }

    /// The window whose request was held back, if it is due now.
    pub(super) fn due(&mut self, now: Instant) -> Option<W> {
        self.held.filter(|_| self.next.is_none_or(|next| now >= next))
    }

    /// When the request that is held back is due.
    pub(super) fn waits_until(&self) -> Option<Instant> {
        self.held.and(self.next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(since: Instant, ms: u64) -> Instant {
        since + Duration::from_millis(ms)
    }

    #[test]
    fn a_picture_that_took_long_is_followed_by_a_pause_and_one_that_did_not_is_not() {
        let start = Instant::now();
        let mut pace = Pace::default();
        assert!(pace.may_draw('a', start), "the first at once");
        pace.drawn(start, after(start, 20));
        assert!(!pace.may_draw('a', after(start, 37)));
        assert_eq!((pace.due(after(start, 37)), pace.waits_until()), (None, Some(after(start, 38))));
        assert_eq!(pace.due(after(start, 38)), Some('a'));
        pace.drawn(after(start, 38), after(start, 39));
        assert_eq!((pace.due(after(start, 80)), pace.waits_until()), (None, None), "it was drawn");
        assert!(!pace.may_draw('a', after(start, 45)), "no more often than a mouse moves");
        assert!(pace.may_draw('a', after(start, 46)));
    }

    #[test]
    fn a_picture_that_takes_very_long_is_followed_by_the_next_at_once() {
        let start = Instant::now();
        let mut pace = Pace::default();
        pace.drawn(start, after(start, 200));
        assert!(pace.may_draw('a', after(start, 200)));
        pace.drawn(start, after(start, 30));
        assert!(!pace.may_draw('a', after(start, 37)), "up to the longest pause");
        assert!(pace.may_draw('a', after(start, 38)));
    }
}
