//! A measurement that begins only after a check with quiet tones has found that the drive is on.

use super::dialogue::Dialogue;
use super::drive_checking::DriveChecking;
use super::error::MeasureError;
use super::measuring::Measuring;
use super::procedure::{Evaluation, Procedure};
use slipline_plate::calibrate::Measurement;

/// Share of the check in the progress.
const SHARE: f64 = 0.2;

/// A procedure after a check of the drive.
pub struct AfterCheck<P> {
    checking: Option<DriveChecking>,
    procedure: P,
}

impl<P: Procedure> AfterCheck<P> {
    /// Runs the procedure after this check; at once without a check, where the drive circuit is not known.
    pub const fn new(checking: Option<DriveChecking>, procedure: P) -> Self {
        Self { checking, procedure }
    }
}

impl AfterCheck<Measuring> {
    /// Samples that it needs by its plan; the check's are estimated by its share.
    pub(crate) fn planned_samples(&self) -> f64 {
        let measured = self.procedure.planned_samples() as f64;
        if self.checking.is_some() { measured / (1.0 - SHARE) } else { measured }
    }

    /// A measurement at the frequencies of its plan, without measured values yet.
    pub(crate) fn planned(&self) -> Measurement {
        self.procedure.planned()
    }
}

impl<P: Procedure> Procedure for AfterCheck<P> {
    type Found = P::Found;

    async fn carry_out(self, dialogue: Dialogue) -> Result<Evaluation<P::Found>, MeasureError> {
        if let Some(checking) = self.checking {
            dialogue.part(0.0, SHARE, true);
            let found = checking.carry_out(dialogue.clone()).await?()?;
            if !found.check.is_on() {
                return Err(MeasureError::NotOn(found.check));
            }
            dialogue.part(SHARE, 1.0, false);
        }
        self.procedure.carry_out(dialogue).await
    }
}
