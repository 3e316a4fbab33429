//! Report of the thermal fold-back for the status: the factor in the present period and in those before it.

use slipline_protocol::limits::FOLDBACK_PERIODS;

/// The fold-back in force and the latest ones before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Foldback {
    /// In the present period, per mille.
    pub per_mille: u16,
    /// In the periods before it, the latest first.
    pub before_per_mille: [u16; FOLDBACK_PERIODS],
    /// How often it has changed; wraps.
    pub changes: u32,
}

impl Foldback {
    /// The first one, which counts as no change.
    #[must_use]
    pub const fn first(per_mille: u16) -> Self {
        Self { per_mille, before_per_mille: [per_mille; FOLDBACK_PERIODS], changes: 0 }
    }

    /// A new period begins.
    #[must_use]
    pub const fn next_period(self, per_mille: u16) -> Self {
        let [latest, earlier, _] = self.before_per_mille;
        let changes = if per_mille == self.per_mille { self.changes } else { self.changes.wrapping_add(1) };
        Self { per_mille, before_per_mille: [self.per_mille, latest, earlier], changes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periods_move_back_and_only_changes_count() {
        let foldback = [900, 900, 850, 860].into_iter().fold(Foldback::first(1000), Foldback::next_period);
        assert_eq!(foldback, Foldback { per_mille: 860, before_per_mille: [850, 900, 900], changes: 3 });
    }
}
