//! The setup in the app: a change is applied, recorded for undo, predicted, and sent at once if the plate is
//! driven.

use super::App;
use slipline_model::field::steady_field::{SteadyField, steady_tones};
use slipline_model::setup::Setup;
use slipline_model::setup::edit::{self, Edit};
use slipline_plate::quantity::{show_place, ticks};
use std::sync::Arc;

impl App {
    /// Applies a change, records it for undo, and sends it at once if the plate is driven.
    pub(super) fn edit(&mut self, edit: &Edit) {
        match edit::apply(&self.setup, edit) {
            Ok(next) if next == self.setup => {}
            Ok(mut next) => {
                if let Edit::Add { position_m } = *edit {
                    let told = [moved_into_span(&next, position_m), make_fit(&mut next)];
                    let told: Vec<String> = told.into_iter().flatten().collect();
                    if !told.is_empty() {
                        self.notices.tell(told.join(" "));
                    }
                }
                self.history.note(&self.setup, edit, self.gesture);
                self.take(next);
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Replaces the setup, after an edit, undo or redo.
    pub(super) fn take(&mut self, next: Setup) {
        let is_new_plate = !Arc::ptr_eq(&self.setup.plate, &next.plate);
        let added = next.tones.iter().find(|tone| self.setup.tone(tone.slot).is_none()).map(|tone| tone.slot);
        self.setup = next;
        if let Some(slot) = added {
            self.selected = slot;
        } else if self.setup.tone(self.selected).is_none() {
            self.selected = self.setup.tones.first().map_or(0, |tone| tone.slot);
        }
        if is_new_plate {
            self.playback.measured = None;
            self.end_trace();
            self.table_asked = None;
            self.autopilot.setup_replaced();
            self.ask_for_table();
        } else if self.autopilot.may_drive(&self.snapshot) {
            self.send_drive();
        }
        self.predict();
    }

    /// The peak at level 1 and full master, in metres; `None` until the plate's table is finished.
    pub(super) fn full_peak_m(&self) -> Option<f64> {
        self.screen_table().map(|made| made.drive_table.peak_at_full_scale_m)
    }

    /// Predicts the field of the setup.
    pub(super) fn predict(&mut self) {
        // While the height is not known, the shape is drawn with unit height.
        let tones = steady_tones(&self.setup, self.full_peak_m().unwrap_or(1.0));
        self.predicted = SteadyField::solve_touched(&self.setup.plate, &tones, self.finger().as_ref());
    }
}

/// Lowers the master until the tones fit the DAC even at the largest gain, which is 1, so that they can be dragged
/// anywhere. Returns the message to the user if the master was lowered.
fn make_fit(setup: &mut Setup) -> Option<String> {
    let sum = setup.tones.iter().map(|tone| tone.level).sum::<f64>() * setup.master();
    if sum <= 1.0 {
        return None;
    }
    setup.master_db = setup.fitting_master_db(sum);
    let (count, master) = (setup.tones.len(), ticks::label(setup.master_db, 0.1));
    Some(format!("Master lowered to {master} dB, so that {count} tones fit."))
}

/// The message about an added tone if its requested place, in metres, was outside the span.
fn moved_into_span(setup: &Setup, asked_m: f64) -> Option<String> {
    let tone = setup.tones.last().filter(|tone| tone.position_m != asked_m)?;
    let (start, end) = setup.plate.span_m();
    let (number, place) = (tone.slot + 1, show_place(tone.position_m));
    let (start, end) = (show_place(start), show_place(end));
    Some(format!("Tone {number} is at {place}: the span is {start} to {end}."))
}
