//! The latch of faults, which keeps the first one and its time.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use slipline_protocol::event::{Fault, Faults};
use slipline_protocol::units::SampleIndex;

/// All faults since they were last cleared, and the first of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultLatch {
    set: Faults,
    first: Option<(Fault, SampleIndex)>,
}

impl FaultLatch {
    /// No fault.
    #[must_use]
    pub const fn new() -> Self {
        Self { set: Faults::NONE, first: None }
    }

    /// The same and one more.
    #[must_use]
    pub const fn with(self, fault: Fault, at: SampleIndex) -> Self {
        let first = match self.first {
            None => Some((fault, at)),
            first => first,
        };
        Self { set: self.set.with(fault), first }
    }

    /// Clears all faults but `standing`, those whose cause is still there.
    #[must_use]
    pub fn cleared(self, standing: Faults) -> Self {
        let set = Faults(self.set.0 & standing.0);
        let first = match self.first {
            Some((fault, at)) if set.contains(fault) => Some((fault, at)),
            // The first fault is cleared: the lowest one left takes its place, with the time of the first.
            Some((_, at)) => set.iter().next().map(|fault| (fault, at)),
            None => None,
        };
        Self { set, first }
    }

    /// All latched faults.
    #[must_use]
    pub const fn set(self) -> Faults {
        self.set
    }

    /// The first one and when it was.
    #[must_use]
    pub const fn first(self) -> Option<(Fault, SampleIndex)> {
        self.first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_cause_stays_the_first_until_it_is_cleared() {
        let latch =
            FaultLatch::new().with(Fault::Overheat, 7).with(Fault::HostLost, 9).with(Fault::Overheat, 11);
        assert_eq!(latch.first(), Some((Fault::Overheat, 7)));
        assert!(latch.set().contains(Fault::HostLost) && latch.set().contains(Fault::Overheat));
        let left = latch.cleared(Faults::NONE.with(Fault::Overheat));
        assert_eq!(
            (left.set(), left.first()),
            (Faults::NONE.with(Fault::Overheat), Some((Fault::Overheat, 7)))
        );
        let both = latch.set();
        assert_eq!(latch.cleared(both), latch);
        let later = FaultLatch::new().with(Fault::HostLost, 7).with(Fault::Overheat, 9);
        assert_eq!(later.cleared(both), later, "the first stays the first, whatever its number");
        assert_eq!(latch.cleared(Faults::NONE), FaultLatch::new());
    }
}
