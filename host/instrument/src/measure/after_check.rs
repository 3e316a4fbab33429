//! A measurement that begins only if quiet tones have told that the drive is on.

use super::drive_checking::DriveChecking;
use super::error::MeasureError;
use super::procedure::{Procedure, Step};
use slipline_link::{Outcome, Snapshot};

/// What the check is of the whole, in the progress.
const SHARE: f64 = 0.2;

/// A procedure after a check of the drive.
pub struct AfterCheck<P> {
    /// The check, until it has ended.
    checking: Option<DriveChecking>,
    /// What the check is of the whole.
    share: f64,
    procedure: P,
    /// Why the procedure does not begin.
    refused: Option<MeasureError>,
}

impl<P: Procedure> AfterCheck<P> {
    /// The procedure after this check; at once if there is none, because nothing is known of the drive.
    pub fn new(checking: Option<DriveChecking>, procedure: P) -> Self {
        let share = if checking.is_some() { SHARE } else { 0.0 };
        Self { checking, share, procedure, refused: None }
    }

    /// Whether the drive is being checked.
    #[must_use]
    pub const fn is_checking(&self) -> bool {
        self.checking.is_some()
    }
}

impl<P: Procedure> Procedure for AfterCheck<P> {
    type Found = P::Found;

    fn step(&mut self) -> Step {
        if let Some(checking) = &mut self.checking {
            let step = checking.step();
            if !matches!(step, Step::Ended) {
                return step;
            }
            self.refused = match self.checking.take().map(Procedure::finish) {
                Some(Ok(found)) if !found.check.is_on() => Some(MeasureError::NotOn(found.check)),
                Some(Err(error)) => Some(error),
                _ => None,
            };
        }
        if self.refused.is_some() { Step::Ended } else { self.procedure.step() }
    }

    fn take(&mut self, outcome: &Outcome) {
        match &mut self.checking {
            Some(checking) => checking.take(outcome),
            None => self.procedure.take(outcome),
        }
    }

    fn watch(&mut self, snapshot: &Snapshot) {
        match &mut self.checking {
            Some(checking) => checking.watch(snapshot),
            None => self.procedure.watch(snapshot),
        }
    }

    fn cancel(&mut self) {
        match &mut self.checking {
            Some(checking) => checking.cancel(),
            None => self.procedure.cancel(),
        }
    }

    fn progress(&self, now: u64) -> f64 {
        match &self.checking {
            Some(checking) => self.share * checking.progress(now),
            None => self.share + (1.0 - self.share) * self.procedure.progress(now),
        }
    }

    fn finish(self) -> Result<P::Found, MeasureError> {
        self.refused.map_or_else(|| self.procedure.finish(), Err)
    }
}
