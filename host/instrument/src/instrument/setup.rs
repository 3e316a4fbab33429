//! The setup in the app: a change is applied, recorded for undo, predicted, and sent at once if the plate is
//! driven.

use super::Instrument;
use slipline_model::field::line::{self, Line};
use slipline_model::setup::Setup;
use slipline_model::setup::edit::{self, Edit};
use slipline_model::setup::undo::{EditSource, Gesture};
use slipline_plate::DriveTable;
use slipline_plate::quantity::{show_place, ticks};
use std::sync::Arc;

impl Instrument {
    /// Applies a change by the user, records it for undo, and sends it at once if the plate is driven.
    pub fn edit(&mut self, edit: &Edit) {
        self.edit_by(Gesture { source: EditSource::User, number: self.gesture }, edit);
    }

    /// Applies a change by any source; the newest change wins. It is sent only while the user has the plate
    /// driven, so no source but the user arms a device or drives again after a stop.
    pub fn edit_by(&mut self, gesture: Gesture, edit: &Edit) {
        match edit::apply(&self.setup, edit) {
            Ok(next) if next == self.setup => {}
            Ok(mut next) => {
                let made = self.screen_table().cloned();
                let table = made.as_deref().map(|made| &made.drive_table);
                if let Edit::Add { position_m } = *edit {
                    let remarks = [make_fit(&mut next), place_line(&mut next, position_m, table)];
                    let remarks: Vec<String> = remarks.into_iter().flatten().collect();
                    if !remarks.is_empty() {
                        self.notices.post(remarks.join(" "));
                    }
                }
                // These edits move the felt edges; the lines keep them.
                let mut edges_m = Vec::new();
                if matches!(edit, Edit::Level { .. } | Edit::Master(_) | Edit::Feeling(_) | Edit::Add { .. })
                {
                    let slots = self.setup.tones.iter().map(|tone| tone.slot);
                    edges_m = slots.filter_map(|slot| Some((slot, self.edge_m(slot)?))).collect();
                    next = line::held(next, &edges_m, table);
                }
                self.history.note(&self.setup, &next, edit, gesture);
                self.take(next);
                self.edges_m = edges_m;
            }
            Err(error) => self.fail(slipline_link::capitalized(&error.to_string())),
        }
    }

    /// Moves the turning point of a slot to this place, in metres, without a step of undo.
    pub fn show_line(&mut self, slot: u8, position_m: f64) {
        match edit::apply(&self.setup, &Edit::Move { slot, position_m }) {
            Ok(next) if next != self.setup => self.take(next),
            Ok(_) | Err(_) => {}
        }
    }

    /// Moves the line of a slot as a drag does, through these places in metres: a recording takes all of
    /// them, the plate the last.
    pub fn drag_line(&mut self, slot: u8, places_m: &[f64]) {
        let Some((&last_m, earlier_m)) = places_m.split_last() else { return };
        if let Some(tone) = self.setup.tone(slot).filter(|_| self.recorder.is_recording()) {
            let (low_m, high_m) = line::limits_m(&self.setup, tone, self.drive_table());
            for place_m in earlier_m.iter().filter(|place_m| place_m.is_finite()) {
                self.note_move(slot, place_m.max(low_m).min(high_m));
            }
        }
        if let Some(edit) = self.line_move(slot, last_m) {
            self.edit(&edit);
        }
        if self.recorder.is_recording()
            && let Some(line) = self.line(slot)
        {
            self.note_move(slot, line.place_m);
        }
    }

    /// The edit that moves the line of a slot to a place in metres, or as near to it as allowed.
    pub(crate) fn line_move(&self, slot: u8, place_m: f64) -> Option<Edit> {
        let tone = self.setup.tone(slot).filter(|_| place_m.is_finite())?;
        let position_m = line::turning_point_m(&self.setup, tone, self.drive_table(), place_m);
        Some(Edit::Move { slot, position_m })
    }

    /// Applies the setup of an undo or redo of the change with this name.
    pub(crate) fn step_back_or_forth(&mut self, name: Option<&'static str>, setup: Option<Setup>) {
        let Some(setup) = setup else { return };
        if name == Some(edit::SWITCH) {
            self.compare.undone(self.setup.clone());
        }
        self.take(setup);
    }

    /// Replaces the setup, after an edit, undo or redo.
    pub(crate) fn take(&mut self, next: Setup) {
        let is_drawn = self.brush.takes_change();
        let is_new_plate = !Arc::ptr_eq(&self.setup.plate, &next.plate);
        let is_felt_anew = self.setup.feeling != next.feeling;
        let added = next.tones.iter().find(|tone| self.setup.tone(tone.slot).is_none()).map(|tone| tone.slot);
        self.setup = next;
        self.edges_m.clear();
        self.forget_prediction();
        if let Some(slot) = added {
            self.selected = slot;
        } else if self.setup.tone(self.selected).is_none() {
            self.selected = self.setup.tones.first().map_or(0, |tone| tone.slot);
        }
        if is_new_plate {
            self.playback.measured = None;
            self.end_trace();
            self.renew_truth();
            self.table_asked = None;
            self.autopilot.setup_replaced();
            self.ask_for_table();
        } else if is_drawn {
            self.send_drawing();
        } else if self.autopilot.may_drive(&self.snapshot) {
            self.send_drive();
        }
        if is_felt_anew {
            self.playback.feel(&self.setup.feeling);
        }
    }
}

/// Lowers the master until the tones fit the DAC even at the largest gain, 1, so that they can be dragged
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

/// Puts the line of the tone that was added last at `place_m`, in metres. Returns the message to the user if
/// that place is not allowed.
fn place_line(setup: &mut Setup, place_m: f64, table: Option<&DriveTable>) -> Option<String> {
    let tone = *setup.tones.last()?;
    let position_m = line::turning_point_m(setup, &tone, table, place_m);
    setup.tones.last_mut()?.position_m = position_m;
    let there = Line::of(setup, setup.tones.last()?, table);
    // The smallest step of the arrow keys.
    if (there.place_m - place_m).abs() < 1e-4 {
        return None;
    }
    let (low_m, high_m) = line::limits_m(setup, &tone, table);
    let (number, place) = (tone.slot + 1, show_place(there.place_m));
    let (low, high) = (show_place(low_m), show_place(high_m));
    Some(format!("Tone {number} is at {place}: a line can be at {low} to {high}."))
}
