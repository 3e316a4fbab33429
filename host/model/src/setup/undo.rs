//! Undo and redo: the earlier setups, and the ones that were undone.

use crate::setup::Setup;
use crate::setup::edit::Edit;

/// The most setups that are kept for undo.
const DEPTH: usize = 200;

/// The earlier setups and the undone ones.
#[derive(Debug, Default)]
pub struct History {
    past: Vec<(Setup, &'static str)>,
    future: Vec<(Setup, &'static str)>,
    /// The gesture, name and tone of the latest change: equal changes in one gesture count as one step.
    latest: Option<(u64, &'static str, Option<u8>)>,
}

impl History {
    /// Notes the setup as it was before a change. `gesture` is the number of the press (of pointer or key) that the
    /// change belongs to: a whole drag is one step.
    pub fn note(&mut self, before: &Setup, edit: &Edit, gesture: u64) {
        let key = (gesture, edit.name(), edit.slot());
        self.future.clear();
        if self.latest == Some(key) {
            return;
        }
        self.latest = Some(key);
        if self.past.len() == DEPTH {
            self.past.remove(0);
        }
        self.past.push((before.clone(), edit.name()));
    }

    /// Undoes the latest change: takes the present setup and returns the one before.
    pub fn undo(&mut self, present: &Setup) -> Option<Setup> {
        let (setup, name) = self.past.pop()?;
        self.future.push((present.clone(), name));
        self.latest = None;
        Some(setup)
    }

    /// Redoes the latest undone change: takes the present setup and returns the one that was undone.
    pub fn redo(&mut self, present: &Setup) -> Option<Setup> {
        let (setup, name) = self.future.pop()?;
        self.past.push((present.clone(), name));
        self.latest = None;
        Some(setup)
    }

    /// The name of the change that undo would undo.
    #[must_use]
    pub fn undo_name(&self) -> Option<&'static str> {
        self.past.last().map(|(_, name)| *name)
    }

    /// The name of the change that redo would redo.
    #[must_use]
    pub fn redo_name(&self) -> Option<&'static str> {
        self.future.last().map(|(_, name)| *name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::edit::apply;
    use std::sync::Arc;

    #[test]
    fn a_whole_drag_is_one_step_back_and_forth() {
        let first = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
        let mut history = History::default();
        let mut present = first.clone();
        for mm in [110, 115, 120] {
            let edit = Edit::Move { slot: 0, position_m: f64::from(mm) * 1e-3 };
            history.note(&present, &edit, 7);
            present = apply(&present, &edit).unwrap();
        }
        let moved = present.clone();
        let back = history.undo(&present).unwrap();
        assert_eq!(back, first);
        assert_eq!(history.undo_name(), None);
        assert_eq!(history.redo(&back).unwrap(), moved);
        // Another press of the pointer is another step.
        history.note(&moved, &Edit::Move { slot: 0, position_m: 0.13 }, 8);
        assert!(history.redo_name().is_none() && history.undo(&moved).is_some());
    }
}
