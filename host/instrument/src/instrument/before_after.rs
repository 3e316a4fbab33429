//! The plate as its file had it before the latest calibration, and the calibrated one: one is on the screen, the other is one
//! call away.

use super::Instrument;
use super::held_lines::HeldLines;
use slipline_model::setup::edit::Edit;
use slipline_plate::Plate;
use std::sync::Arc;

/// Which plate of a calibration is on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationSide {
    /// The plate as its file had it.
    Before,
    /// The calibrated plate.
    After,
}

/// The latest calibration that was used.
#[derive(Default)]
pub(super) struct Calibrated {
    plates: Option<BeforeAfter>,
    /// Lines that keep their places on the plate that was turned to, until its table is finished.
    pub(super) held: Option<HeldLines>,
}

/// The two plates of a calibration.
struct BeforeAfter {
    before: Arc<Plate>,
    after: Arc<Plate>,
}

impl BeforeAfter {
    /// Which of the two this plate is; `None` for any other, also for one of the two with another number.
    fn side(&self, plate: &Arc<Plate>) -> Option<CalibrationSide> {
        if Arc::ptr_eq(plate, &self.before) {
            return Some(CalibrationSide::Before);
        }
        Arc::ptr_eq(plate, &self.after).then_some(CalibrationSide::After)
    }
}

impl Instrument {
    /// Which plate of the latest calibration is on the screen, if one is.
    pub(super) fn calibration_side(&self) -> Option<CalibrationSide> {
        self.calibrated.plates.as_ref()?.side(self.desk.plate())
    }

    /// Uses a plate that was calibrated on the present one; the lines keep their felt edges.
    pub(super) fn use_calibrated(&mut self, after: Arc<Plate>) {
        let before = Arc::clone(self.desk.plate());
        self.turn_to_plate(&after, self.drive.full_peak_m());
        self.calibrated.plates = Some(BeforeAfter { before, after });
    }

    /// Shows the plate as it was before the latest calibration, or the calibrated one again; the lines keep their felt edges. A
    /// step of undo, as any change of the plate.
    pub fn show_before_or_after(&mut self) {
        if self.lab.is_measuring() {
            let text = "The plate is being measured: cancel that or press STOP first.";
            // It would go with the next tones that are measured if it were of the device's state.
            return self.out.post(text.to_owned());
        }
        let other = self.calibrated.plates.as_ref().and_then(|pair| {
            Some(match pair.side(self.desk.plate())? {
                CalibrationSide::Before => (&pair.after, "After the calibration."),
                CalibrationSide::After => {
                    (&pair.before, "Before the calibration: the plate as its file has it.")
                }
            })
        });
        let Some((plate, text)) = other else {
            return self.out.post("Nothing to compare: no calibrated plate is in use.".to_owned());
        };
        let plate = Arc::clone(plate);
        self.turn_to_plate(&plate, None);
        self.out.post(text.to_owned());
    }

    /// Puts a plate in the setup that describes the same actual plate; the lines keep their felt edges. `said_peak_m` is the peak
    /// at level 1, in metres, that the plate before states, if the user is to be informed of another one.
    fn turn_to_plate(&mut self, plate: &Arc<Plate>, said_peak_m: Option<f64>) {
        let edges_m = self.screen.edges_m(&self.desk, &self.drive);
        self.edit(&Edit::Plate(Arc::clone(plate)));
        self.screen.keep_edges(edges_m.clone());
        self.calibrated.held =
            Some(HeldLines { plate: Arc::clone(plate), edges_m, full_peak_m: said_peak_m });
    }
}
