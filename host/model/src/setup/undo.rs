//! Undo and redo: the setups that were, and those that were taken back.

use crate::setup::Setup;
use crate::setup::edit::Edit;

/// Setups one can go back to, at most.
const DEPTH: usize = 200;

/// What was, and what was undone.
#[derive(Debug, Default)]
pub struct History {
    past: Vec<(Setup, &'static str)>,
    future: Vec<(Setup, &'static str)>,
    /// The gesture, name and tone of the latest change: more of the same in one gesture is one step.
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

    /// The setup before the latest change, in exchange for the present one.
    pub fn undo(&mut self, present: &Setup) -> Option<Setup> {
        let (setup, name) = self.past.pop()?;
        self.future.push((present.clone(), name));
        self.latest = None;
        Some(setup)
    }

    /// The setup before the latest undo, in exchange for the present one.
    pub fn redo(&mut self, present: &Setup) -> Option<Setup> {
        let (setup, name) = self.future.pop()?;
        self.past.push((present.clone(), name));
        self.latest = None;
        Some(setup)
    }

    /// What undo would take back.
    #[must_use]
    pub fn undo_name(&self) -> Option<&'static str> {
        self.past.last().map(|(_, name)| *name)
    }

    /// What redo would do again.
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
