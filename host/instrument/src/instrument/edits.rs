//! Changes of the setup by every source, and what follows from them in the rooms.

use super::Instrument;
use super::desk::SetupChange;
use super::held_lines::HeldLines;
use crate::recording::Move;
use slipline_model::setup::BoundaryMode;
use slipline_model::setup::edit::{Edit, EditError};
use slipline_model::setup::undo::Gesture;
use slipline_plate::quantity::{show_length, show_place};
use std::sync::Arc;

/// A line that is farther off its place than this has moved, in metres: the smallest step of the arrow keys.
const MOVED_M: f64 = 1e-4;
/// A full scale that has changed by less than this share is not worth a message.
const SAME: f64 = 0.05;

impl Instrument {
    /// Applies a change by the user, records it for undo, and sends it at once if the plate is driven. Its remark or error is
    /// shown.
    pub fn edit(&mut self, edit: &Edit) {
        self.edit_for_user(self.desk.gesture(), edit, false);
    }

    /// Applies a change by any source; the newest change wins. It is sent only while the user has the plate
    /// driven, so no source but the user arms a device or drives again after a stop. Nothing is shown to the user: the source
    /// gets a remark if more was changed than it asked for.
    ///
    /// # Errors
    /// [`EditError`]: why the change is refused.
    pub fn edit_by(&mut self, gesture: Gesture, edit: &Edit) -> Result<Option<String>, EditError> {
        self.apply(gesture, edit, false)
    }

    /// Applies a change by the user's hand, by a drawing or otherwise, and shows its remark or error.
    fn edit_for_user(&mut self, gesture: Gesture, edit: &Edit, is_drawing: bool) {
        match self.apply(gesture, edit, is_drawing) {
            Ok(None) => {}
            Ok(Some(remark)) => self.out.post(remark),
            Err(error) => self.out.fail(slipline_link::capitalized(&error.to_string())),
        }
    }

    fn apply(
        &mut self,
        gesture: Gesture,
        edit: &Edit,
        is_drawing: bool,
    ) -> Result<Option<String>, EditError> {
        // These edits move the felt edges; the lines keep them.
        let moves_edges =
            matches!(edit, Edit::Level { .. } | Edit::Master(_) | Edit::Feeling(_) | Edit::Add { .. });
        let edges_m = if moves_edges { self.screen.edges_m(&self.desk, &self.drive) } else { Vec::new() };
        let table = self.drive.drive_table();
        let Some(change) = self.desk.edit(gesture, edit, &edges_m, table)? else { return Ok(None) };
        self.follow(&change, is_drawing);
        self.screen.keep_edges(edges_m);
        Ok(change.remark)
    }

    /// Has the rooms follow a change of the setup.
    fn follow(&mut self, change: &SetupChange, is_drawing: bool) {
        self.screen.use_setup(&self.desk, change, is_drawing);
        if change.has_new_plate {
            self.lab.use_plate(self.desk.plate(), &mut self.out);
        }
        self.drive.use_setup(self.desk.setup(), change.has_new_plate, is_drawing);
        if is_drawing {
            self.send_drawing();
        }
    }

    fn follow_if_changed(&mut self, change: Option<SetupChange>) {
        if let Some(change) = change {
            self.follow(&change, false);
        }
    }

    /// Moves the turning point of a slot to this place, in metres, without a step of undo.
    pub fn show_line(&mut self, slot: u8, position_m: f64) {
        let change = self.desk.show_line(slot, position_m);
        self.follow_if_changed(change);
    }

    /// Moves the line of a slot as a drag does, through these places in metres: a recording takes all of
    /// them, the plate the last.
    ///
    /// While the plate is measured, its lines stay where they are: nothing that is heard or felt would follow them.
    pub fn drag_line(&mut self, slot: u8, places_m: &[f64]) {
        if self.lab.is_measuring() {
            return;
        }
        let Some((&last_m, earlier_m)) = places_m.split_last() else { return };
        let (table, now_s) = (self.drive.drive_table(), self.attention.now_s);
        self.desk.note_moves(slot, earlier_m, table, now_s, &mut self.out);
        if let Some(edit) = self.desk.line_move(slot, last_m, table) {
            self.edit(&edit);
        }
        if self.desk.recorder().is_recording()
            && let Some(place_m) = self.line(slot).map(|line| line.place_m)
        {
            self.desk.note_move(slot, place_m, now_s, &mut self.out);
        }
    }

    /// Switches to the other of the two compared setups.
    pub fn switch_setups(&mut self) {
        let edit = self.desk.switch();
        self.edit(&edit);
    }

    /// Undoes the latest change.
    pub fn undo(&mut self) {
        let change = self.desk.undo();
        self.follow_if_changed(change);
    }

    /// Repeats the change that was undone last.
    pub fn redo(&mut self) {
        let change = self.desk.redo();
        self.follow_if_changed(change);
    }

    /// Moves the lines to where the recording has them at this time, in seconds; a replay goes on from there.
    pub fn seek(&mut self, time_s: f64) {
        let moves = self.desk.seek(time_s);
        self.make_moves(moves.into_iter().flatten());
    }

    /// Makes the moves of a replay that are due now.
    pub(super) fn replay(&mut self) {
        let due = self.desk.due_moves(self.attention.now_s, self.drive.is_wanted(), &mut self.out);
        self.make_moves(due.into_iter().flatten());
    }

    /// Makes these moves, as a part of the present replay.
    fn make_moves(&mut self, moves: impl Iterator<Item = Move>) {
        let gesture = self.desk.replay_gesture();
        for step in moves {
            if let Some(edit) = self.desk.line_move(step.slot, step.place_m, self.drive.drive_table()) {
                self.edit_for_user(gesture, &edit, false);
            }
        }
    }

    /// Puts the tones of a drawing into the setup, as a part of its latest stroke.
    pub(super) fn follow_drawing(&mut self, gesture: Gesture, edit: &Edit) {
        self.note_turning_points();
        self.edit_for_user(gesture, edit, true);
    }

    /// Sends the newest tones of a drawing, once the time for them has come.
    pub(super) fn send_drawing(&mut self) {
        let is_driven = self.drive.may_play();
        if self.screen.is_drawing_due(self.attention.now_s, is_driven, &mut self.out) {
            self.drive.play(self.desk.setup());
        }
    }

    /// Puts the computed texture into the setup.
    pub fn play_texture(&mut self) {
        let Some(made) = self.screen.made_texture().cloned() else { return };
        self.note_turning_points();
        self.edit(&made.edit());
        let gain_db = made.chord_gain_db().unwrap_or(0.0);
        let plays_chord = self.drive.chord(self.desk.setup()).is_some();
        if gain_db > 0.1 && self.drive.snapshot().is_connected() && !plays_chord {
            let text = format!("This device plays no chords: the texture is {gain_db:.1} dB quieter on it.");
            self.out.post(text);
        }
    }

    /// Says that a texture moves the lines to turning points, if they are elsewhere.
    fn note_turning_points(&mut self) {
        if self.desk.setup().boundary != BoundaryMode::TurningPoint {
            let text = "The lines are at turning points now: no tone of a texture has a felt edge of its own. \
                        Undo, or \"Line at\" on the page Boundary, takes it back.";
            self.out.post(text.to_owned());
        }
    }
}

/// Calibrated plates.
impl Instrument {
    /// Moves the tones to where the lines keep their places, now that the calibrated plate's table is finished. It says how far a
    /// level moves this plate, if the file said something else, and which line could not stay.
    pub(super) fn hold_lines(&mut self) {
        let is_in_use = |held: &HeldLines| Arc::ptr_eq(&held.plate, self.desk.plate());
        let Some(held) = self.calibrated.held.take().filter(is_in_use) else { return };
        let mut said = Vec::new();
        if let (Some(before_m), Some(now_m)) = (held.full_peak_m, self.drive.full_peak_m())
            && (now_m / before_m - 1.0).abs() > SAME
        {
            let (now, before) = (show_length(now_m), show_length(before_m));
            said.push(format!(
                "At level 1 the calibrated plate moves by {now}, not by {before} as its file said."
            ));
        }
        let count = held.edges_m.len();
        for (slot, place_m) in held.edges_m {
            let table = self.drive.drive_table();
            if let Some(Edit::Move { position_m, .. }) = self.desk.line_move(slot, place_m, table) {
                self.show_line(slot, position_m);
            }
            let Some(now_m) = self.line(slot).map(|line| line.place_m) else { continue };
            if (now_m - place_m).abs() > MOVED_M {
                let (before, now) = (show_place(place_m), show_place(now_m));
                let whose = if count > 1 { format!(" of tone {}", slot + 1) } else { String::new() };
                said.push(format!("The line{whose} cannot stay at {before}: it is at {now}."));
            }
        }
        if !said.is_empty() {
            self.out.post(said.join(" "));
        }
    }
}
