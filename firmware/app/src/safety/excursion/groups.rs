//! The largest travel of each group of eight intervals of a table, so that a way is not walked knot by knot.
//!
//! A way that touches a group counts with all of it: a glide over a hundredth of the span is judged by up to seven
//! intervals beside it.

use slipline_protocol::limits::MAX_KNOTS;

const GROUP: usize = 8;

/// One table's groups. Interval `i` lies between the knots `i` and `i + 1`.
#[derive(Clone, Debug)]
pub(super) struct Groups([f32; MAX_KNOTS.div_ceil(GROUP)]);

impl Groups {
    /// No intervals.
    pub(super) const NONE: Self = Self([0.0; MAX_KNOTS.div_ceil(GROUP)]);

    /// Counts an interval in.
    pub(super) fn add(&mut self, interval: usize, travel: f32) {
        if let Some(largest) = self.0.get_mut(interval / GROUP) {
            *largest = largest.max(travel);
        }
    }

    /// The largest travel between the knots `first` and `last`, or more.
    pub(super) fn largest(&self, first: usize, last: usize) -> f32 {
        let groups = self.0.get(first / GROUP..last.div_ceil(GROUP).min(self.0.len()));
        groups.unwrap_or_default().iter().copied().fold(0.0, f32::max)
    }
}
