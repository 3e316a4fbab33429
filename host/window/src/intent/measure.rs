//! The requests of the page of measurements.

/// A request of the page of measurements. Measurements are named by their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasureIntent {
    /// Choose one, and draw it.
    Choose(u64),
    /// Draw one, or draw it no more.
    Show(u64, bool),
    /// Remove one from the list.
    Remove(u64),
    /// Save one as CSV.
    Save(u64),
}
