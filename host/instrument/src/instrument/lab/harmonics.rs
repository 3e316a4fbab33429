//! The measurement of the drive's harmonics, as `slipline measure --harmonics` makes it. What ends a measurement ends it, too.

use super::Reach;
use super::under_way::UnderWay;
use crate::measure::{AfterCheck, MeasureError, MeasuringHarmonics};
use slipline_link::Severity;
use slipline_plate::Plate;
use std::sync::Arc;

/// Number of fundamentals.
pub(super) const POINTS: usize = 8;

/// The measurement of the drive's harmonics.
#[derive(Default)]
pub(super) struct Harmonics {
    pub(super) under_way: UnderWay<AfterCheck<MeasuringHarmonics>>,
    /// The plate with the measured harmonics, until it is in the setup.
    pub(super) found: Option<Arc<Plate>>,
}

impl Harmonics {
    /// Continues the measurement under way, and reports its end.
    pub(super) fn update(&mut self, reach: &mut Reach<'_>) {
        let Some((found, plate)) = self.under_way.turn(reach) else { return };
        let found = match found {
            Ok(found) => found,
            Err(MeasureError::Cancelled) => {
                return reach.out.post("The measurement was cancelled.".to_owned());
            }
            Err(error) => return reach.out.fail(format!("Not measured: {error}.")),
        };
        for sentence in found.warnings() {
            reach.drive.note(Severity::Warning, sentence);
        }
        match found.on(&plate) {
            Ok(measured) => {
                let each = found.words().into_iter().map(|(name, words)| format!("{name}: {words}"));
                let text = each.collect::<Vec<_>>().join(". ");
                reach.out.post(format!("{text}. The plate states them now; Undo takes it back."));
                self.found = Some(Arc::new(measured));
            }
            Err(error) => reach.out.fail(format!("Not measured: {error}.")),
        }
    }
}
