//! The setup in the app: a change is applied, recorded for undo, predicted, and sent at once if the plate is
//! driven.

use super::Instrument;
use slipline_model::field::felt::Felt;
use slipline_model::field::line::{self, Holds, Line};
use slipline_model::field::steady_field::{SteadyField, steady_tones};
use slipline_model::setup::edit::{self, Edit};
use slipline_model::setup::{MAX_TONES, Setup};
use slipline_plate::DriveTable;
use slipline_plate::quantity::{show_place, ticks};
use std::sync::Arc;

impl Instrument {
    /// Applies a change, records it for undo, and sends it at once if the plate is driven.
    pub fn edit(&mut self, edit: &Edit) {
        match edit::apply(&self.setup, edit) {
            Ok(next) if next == self.setup => {}
            Ok(mut next) => {
                let made = self.screen_table().cloned();
                let table = made.as_deref().map(|made| &made.drive_table);
                if let Edit::Add { position_m } = *edit {
                    let told = [make_fit(&mut next), place_line(&mut next, position_m, table)];
                    let told: Vec<String> = told.into_iter().flatten().collect();
                    if !told.is_empty() {
                        self.notices.tell(told.join(" "));
                    }
                }
                // What these change moves the felt edges; the lines hold them.
                let wanted_m = self.wanted_m;
                let are_held = matches!(
                    edit,
                    Edit::Level { .. } | Edit::Master(_) | Edit::Feeling(_) | Edit::Add { .. }
                );
                if are_held {
                    next = line::held(next, |slot| wanted_m.get(usize::from(slot)).copied().flatten(), table);
                }
                self.history.note(&self.setup, edit, self.gesture);
                self.take(next);
                if are_held {
                    for (now_m, before_m) in self.wanted_m.iter_mut().zip(wanted_m) {
                        *now_m = before_m.or(*now_m);
                    }
                }
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Moves the line of the tone in a slot as the user's hand does: a recording takes the move.
    pub fn drag_line(&mut self, slot: u8, place_m: f64) {
        self.move_line(slot, place_m);
        self.note_move(self.attention.now_s, slot);
    }

    /// Moves the line of the tone in a slot to a place in metres, or as near to it as it can be.
    pub(crate) fn move_line(&mut self, slot: u8, place_m: f64) {
        if let Some(tone) = self.setup.tone(slot).filter(|_| place_m.is_finite()) {
            let position_m = line::turning_point_m(&self.setup, tone, self.drive_table(), place_m);
            self.edit(&Edit::Move { slot, position_m });
        }
    }

    /// Takes the setup of an undo or redo of the change with this name.
    pub(crate) fn step_back_or_forth(&mut self, name: Option<&'static str>, setup: Option<Setup>) {
        let Some(setup) = setup else { return };
        if name == Some(edit::SWITCH) {
            self.compare.undone(self.setup.clone());
        }
        self.take(setup);
    }

    /// Replaces the setup, after an edit, undo or redo.
    pub(crate) fn take(&mut self, next: Setup) {
        let is_new_plate = !Arc::ptr_eq(&self.setup.plate, &next.plate);
        let is_felt_anew = self.setup.feeling != next.feeling;
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
        self.remember_lines();
        if is_felt_anew {
            self.playback.feel(&self.setup.feeling);
        }
    }

    /// The felt edges that the lines show now are where the user wants them.
    pub(crate) fn remember_lines(&mut self) {
        self.wanted_m = [None; MAX_TONES];
        for line in self.lines.iter().filter(|line| line.holds == Holds::FeltEdge) {
            if let Some(wanted_m) = self.wanted_m.get_mut(usize::from(line.slot)) {
                *wanted_m = Some(line.place_m);
            }
        }
    }

    /// The line of the tone in a slot.
    pub fn line(&self, slot: u8) -> Option<&Line> {
        self.lines.iter().find(|line| line.slot == slot)
    }

    /// The places that the line of the selected tone can have, in metres.
    pub(crate) fn limits_m(&mut self) -> (f64, f64) {
        if let Some((slot, limits_m)) = self.limits_m
            && slot == self.selected
        {
            return limits_m;
        }
        let Some(tone) = self.setup.tone(self.selected) else { return self.setup.plate.span_m() };
        let limits_m = line::limits_m(&self.setup, tone, self.drive_table());
        self.limits_m = Some((self.selected, limits_m));
        limits_m
    }

    /// The peak at level 1 and full master, in metres; `None` until the plate's table is finished.
    pub fn full_peak_m(&self) -> Option<f64> {
        self.drive_table().map(|table| table.peak_at_full_scale_m)
    }

    /// The table of the setup's plate, once it is finished.
    pub(crate) fn drive_table(&self) -> Option<&DriveTable> {
        self.screen_table().map(|made| &made.drive_table)
    }

    /// Predicts the field of the setup, what is felt of it, and where its lines are.
    pub(crate) fn predict(&mut self) {
        let plate = &self.setup.plate;
        let table = self.drive_table();
        let tones = match self.chord() {
            Some(_) => steady_tones(&self.setup, table),
            None => steady_tones(&self.setup.without_chord(), table),
        };
        let alone = SteadyField::solve(plate, &tones);
        let known = table.map(|_| &alone);
        self.lines = line::lines(&self.setup, known);
        self.felt = known.map(|known| Felt::of(plate, &self.setup.feeling, known));
        self.limits_m = None;
        self.predicted = match self.finger() {
            None => alone,
            Some(finger) => SteadyField::solve_touched(plate, &tones, Some(&finger)),
        };
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

/// Puts the line of the tone that was added last at `place_m`, in metres. Returns the message to the user if it cannot be
/// there.
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
