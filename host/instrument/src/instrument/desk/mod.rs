//! The desk: the setup, its changes by every source, undo, the comparison of two setups, and the recorder of drags. It knows
//! neither a device nor a picture: what follows from a change is decided by the instrument.

mod replay;

pub use replay::DragRecorder;

use slipline_model::field::line::{self, Line};
use slipline_model::setup::compare::Compare;
use slipline_model::setup::edit::{self, Edit, EditError};
use slipline_model::setup::undo::{EditSource, Gesture, History};
use slipline_model::setup::{Setup, ToneSetup};
use slipline_plate::quantity::{show_place, ticks};
use slipline_plate::{DriveTable, Plate};
use std::sync::Arc;

/// The setup and what changes it.
pub struct Desk {
    setup: Setup,
    history: History,
    compare: Compare,
    recorder: DragRecorder,
    /// The slot of the tone that keys and fields change.
    selected: u8,
    /// Incremented with every press of pointer or key, so that a whole drag is one undo step.
    gesture: u64,
}

/// What a change of the setup has changed beside its tones.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct SetupChange {
    pub(crate) has_new_plate: bool,
    pub(crate) has_new_feeling: bool,
    /// What the source of the change must know: more was changed than it asked for.
    pub(crate) remark: Option<String>,
}

impl Desk {
    pub(crate) fn new(setup: Setup) -> Self {
        Self {
            selected: setup.tones.first().map_or(0, |tone| tone.slot),
            setup,
            history: History::default(),
            compare: Compare::default(),
            recorder: DragRecorder::default(),
            gesture: 0,
        }
    }

    /// The setup.
    #[must_use]
    pub const fn setup(&self) -> &Setup {
        &self.setup
    }

    pub(crate) const fn plate(&self) -> &Arc<Plate> {
        &self.setup.plate
    }

    pub(crate) const fn compare(&self) -> &Compare {
        &self.compare
    }

    /// The recorded drag.
    #[must_use]
    pub const fn recorder(&self) -> &DragRecorder {
        &self.recorder
    }

    /// The names of the changes that undo and redo would affect.
    pub(crate) fn undo_names(&self) -> (Option<&'static str>, Option<&'static str>) {
        (self.history.undo_name(), self.history.redo_name())
    }

    /// The slot of the selected tone.
    #[must_use]
    pub const fn selected(&self) -> u8 {
        self.selected
    }

    /// The selected tone.
    pub(crate) fn tone(&self) -> Option<&ToneSetup> {
        self.setup.tone(self.selected)
    }

    /// Selects the tone that keys and fields change.
    pub const fn select(&mut self, slot: u8) {
        self.selected = slot;
    }

    /// A press of pointer or key has begun another gesture; changes from now on are another undo step.
    pub const fn begin_gestures(&mut self, count: u64) {
        self.gesture += count;
    }

    /// The present gesture of the user.
    pub(crate) const fn gesture(&self) -> Gesture {
        Gesture { source: EditSource::User, number: self.gesture }
    }

    /// Applies a change and records it for undo; the lines of `edges_m` keep these felt edges, by slot and in metres. Returns
    /// `None` if nothing changes.
    ///
    /// # Errors
    /// [`EditError`]: why the change is refused.
    pub(crate) fn edit(
        &mut self,
        gesture: Gesture,
        edit: &Edit,
        edges_m: &[(u8, f64)],
        table: Option<&DriveTable>,
    ) -> Result<Option<SetupChange>, EditError> {
        let mut next = edit::apply(&self.setup, edit)?;
        if next == self.setup {
            return Ok(None);
        }
        let mut remarks = Vec::new();
        if let Edit::Add { position_m } = *edit {
            remarks.extend(make_fit(&mut next));
            remarks.extend(place_line(&mut next, position_m, table));
        }
        let (before, change) = self.replace(line::held(next, edges_m, table));
        self.history.note(before, &self.setup, edit, gesture);
        Ok(Some(SetupChange { remark: (!remarks.is_empty()).then(|| remarks.join(" ")), ..change }))
    }

    /// Moves the turning point of a slot to this place, in metres, without a step of undo. Returns `None` if nothing changes.
    pub(crate) fn show_line(&mut self, slot: u8, position_m: f64) -> Option<SetupChange> {
        let next = edit::apply(&self.setup, &Edit::Move { slot, position_m }).ok()?;
        (next != self.setup).then(|| self.replace(next).1)
    }

    /// The edit that shows the other of the two compared setups.
    pub(crate) fn switch(&mut self) -> Edit {
        self.compare.switch(&self.setup)
    }

    /// Undoes the latest change, if there is one.
    pub(crate) fn undo(&mut self) -> Option<SetupChange> {
        let name = self.history.undo_name();
        let setup = self.history.undo(&self.setup);
        self.step_to(name, setup)
    }

    /// Repeats the change that was undone last, if there is one.
    pub(crate) fn redo(&mut self) -> Option<SetupChange> {
        let name = self.history.redo_name();
        let setup = self.history.redo(&self.setup);
        self.step_to(name, setup)
    }

    /// Shows the setup of an undo or redo of the change with this name.
    fn step_to(&mut self, name: Option<&'static str>, setup: Option<Setup>) -> Option<SetupChange> {
        let (left, change) = self.replace(setup?);
        if name == Some(edit::SWITCH) {
            self.compare.undone(left);
        }
        Some(change)
    }

    /// Replaces the setup; returns the one before. A tone that was added is selected.
    fn replace(&mut self, next: Setup) -> (Setup, SetupChange) {
        let before = std::mem::replace(&mut self.setup, next);
        let added = self.setup.tones.iter().find(|tone| before.tone(tone.slot).is_none());
        let chosen = added.or_else(|| self.tone()).or_else(|| self.setup.tones.first());
        self.selected = chosen.map_or(0, |tone| tone.slot);
        let change = SetupChange {
            has_new_plate: !Arc::ptr_eq(&before.plate, &self.setup.plate),
            has_new_feeling: before.feeling != self.setup.feeling,
            remark: None,
        };
        (before, change)
    }

    /// The edit that moves the line of a slot to a place in metres, or as near to it as allowed.
    pub(crate) fn line_move(&self, slot: u8, place_m: f64, table: Option<&DriveTable>) -> Option<Edit> {
        let tone = self.setup.tone(slot).filter(|_| place_m.is_finite())?;
        let position_m = line::turning_point_m(&self.setup, tone, table, place_m);
        Some(Edit::Move { slot, position_m })
    }
}

/// Lowers the master until the tones fit the DAC even at the largest gain, 1, so that they can be dragged
/// anywhere. Returns the message to the source if the master was lowered.
fn make_fit(setup: &mut Setup) -> Option<String> {
    let sum = setup.tones.iter().map(|tone| tone.level).sum::<f64>() * setup.master();
    if sum <= 1.0 {
        return None;
    }
    setup.master_db = setup.fitting_master_db(sum);
    let (count, master) = (setup.tones.len(), ticks::label(setup.master_db, 0.1));
    Some(format!("Master lowered to {master} dB, so that {count} tones fit."))
}

/// Puts the line of the tone that was added last at `place_m`, in metres. Returns the message to the source if
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

#[cfg(test)]
mod tests;
