//! The setup in the app: a change is made, noted for undo, predicted, and sent at once if the plate is driven.

use super::App;
use crate::edit::{self, Edit};
use crate::model::Setup;
use crate::picture::{Picture, steady_tones};
use std::sync::Arc;

impl App {
    /// Makes a change, notes it, and tells the device at once if the plate is driven.
    pub(super) fn edit(&mut self, edit: &Edit) {
        match edit::apply(&self.setup, edit) {
            Ok(next) if next == self.setup => {}
            Ok(mut next) => {
                if matches!(edit, Edit::Add { .. }) {
                    make_fit(&mut next);
                }
                self.history.note(&self.setup, edit, self.gesture);
                self.take(next);
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Takes another setup, from an edit or from the history.
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
            self.hearing.measured = None;
            self.table_asked = None;
            self.pilot.setup_replaced();
            self.ask_for_table();
        } else if self.pilot.may_drive(&self.snapshot) {
            self.send_drive();
        }
        self.predict();
    }

    /// The peak at level 1 and full master, in metres.
    pub(super) fn full_peak_m(&self) -> f64 {
        self.table.made().map_or_else(
            // Until the table is made: what the drive alone would give.
            || self.setup.plate.spec().full_scale_m,
            |made| made.drive_table.peak_at_full_scale_m,
        )
    }

    /// Solves for what the setup would sound.
    pub(super) fn predict(&mut self) {
        let tones = steady_tones(&self.setup, self.full_peak_m());
        self.predicted = Picture::solve(&self.setup.plate, &tones);
    }
}

/// Lowers the master until the tones fit the DAC wherever on the plate they are dragged: a place's gain is 1 at most.
fn make_fit(setup: &mut Setup) {
    let sum = setup.tones.iter().map(|tone| tone.level).sum::<f64>() * setup.master();
    if sum > 1.0 {
        setup.master_db = setup.fitting_master_db(sum);
    }
}
