//! The measurement of the drive's harmonics, as `slipline measure --harmonics` makes it. What ends a measurement ends it, too.

use super::rig::Awaiting;
use super::under_way::UnderWay;
use super::{Lab, Reach};
use crate::measure::{AfterCheck, HarmonicsPlan, MeasureError, MeasuringHarmonics};
use slipline_link::Severity;
use slipline_plate::Plate;
use std::sync::Arc;

/// Number of fundamentals.
const POINTS: usize = 8;

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

impl Lab {
    /// Starts the measurement at the place and level of the draft, or reports the obstacle.
    pub(super) fn begin_harmonics(&mut self, reach: &mut Reach<'_>) {
        let level = self.live.draft.level;
        let measuring = self.prepared(Awaiting::Harmonics, reach, |reach, inputs, table, sensor| {
            let plate = reach.desk.plate();
            let plan = HarmonicsPlan::new(plate, POINTS, level, reach.drive.sample_rate_hz())?;
            MeasuringHarmonics::new(plate, plan, table, sensor, inputs)
        });
        if let Some(measuring) = measuring {
            reach.drive.make_ready();
            let text = "Measuring the drive's harmonics.".to_owned();
            self.harmonics.under_way.begin(measuring, text, reach);
        }
    }
}
