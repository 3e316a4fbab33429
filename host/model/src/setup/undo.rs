//! Undo and redo: the changes of each gesture, and the undone ones.

use crate::setup::Setup;
use crate::setup::edit::Edit;
use std::sync::Arc;

/// The largest number of steps kept for undo.
const DEPTH: usize = 200;

/// Source of a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditSource {
    /// The user's pointer and keys.
    User,
    /// The replay of a recorded drag.
    Recording,
    /// A program, by its name.
    Program(&'static str),
}

/// One gesture of a source. Its changes of one kind are one step of undo; for a source other than the user,
/// those of all tones together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gesture {
    /// Its source.
    pub source: EditSource,
    /// Its number within the source, for example that of the press of pointer or key.
    pub number: u64,
}

/// A gesture, and the name and the tone of its change.
type Key = (Gesture, &'static str, Option<u8>);

/// The change of a gesture.
#[derive(Clone, Debug)]
struct Step {
    /// The setup before and after it.
    from: Setup,
    to: Setup,
    name: &'static str,
    /// The gesture to which further changes belong, until its source begins another one or a change is
    /// undone.
    lasts: Option<Key>,
}

/// The steps that can be undone and redone.
#[derive(Debug, Default)]
pub struct History {
    past: Vec<Step>,
    future: Vec<Step>,
}

impl History {
    /// Records a change of the setup from `before` to `after`.
    pub fn note(&mut self, before: Setup, after: &Setup, edit: &Edit, gesture: Gesture) {
        self.future.clear();
        let slot = edit.slot().filter(|_| gesture.source == EditSource::User);
        let key = Some((gesture, edit.name(), slot));
        if let Some(step) = self.past.iter_mut().rev().find(|step| step.lasts == key) {
            // Undoing the gesture must keep the later changes of other sources.
            if before != step.to {
                step.from = with(&before, &step.to, &step.from);
            }
            step.to = after.clone();
            return;
        }
        let is_of_source = |lasts: &Key| lasts.0.source == gesture.source;
        self.past.iter_mut().for_each(|step| step.lasts = step.lasts.filter(|lasts| !is_of_source(lasts)));
        if self.past.len() == DEPTH {
            self.past.remove(0);
        }
        self.past.push(Step { from: before, to: after.clone(), name: edit.name(), lasts: key });
    }

    /// Undoes the latest gesture: takes the present setup and returns the one without it.
    pub fn undo(&mut self, present: &Setup) -> Option<Setup> {
        let step = self.past.pop()?;
        self.past.iter_mut().for_each(|step| step.lasts = None);
        let setup = with(present, &step.to, &step.from);
        self.future.push(Step { from: setup.clone(), to: present.clone(), name: step.name, lasts: None });
        Some(setup)
    }

    /// Redoes the latest undone gesture: takes the present setup and returns the one with it.
    pub fn redo(&mut self, present: &Setup) -> Option<Setup> {
        let step = self.future.pop()?;
        let setup = step.to.clone();
        self.past.push(Step { from: present.clone(), ..step });
        Some(setup)
    }

    /// The name of the change that undo would revert.
    #[must_use]
    pub fn undo_name(&self) -> Option<&'static str> {
        self.past.last().map(|step| step.name)
    }

    /// The name of the change that redo would repeat.
    #[must_use]
    pub fn redo_name(&self) -> Option<&'static str> {
        self.future.last().map(|step| step.name)
    }
}

/// The present setup, with the values of `to` wherever they differ from those of `from`.
fn with(present: &Setup, from: &Setup, to: &Setup) -> Setup {
    fn take<T: Copy + PartialEq>(value: &mut T, from: T, to: T) {
        if from != to {
            *value = to;
        }
    }
    if present == from {
        return to.clone();
    }
    let mut next = present.clone();
    take(&mut next.master_db, from.master_db, to.master_db);
    take(&mut next.glide_s, from.glide_s, to.glide_s);
    take(&mut next.boundary, from.boundary, to.boundary);
    take(&mut next.feeling, from.feeling, to.feeling);
    take(&mut next.chord_gain_db, from.chord_gain_db, to.chord_gain_db);
    let slots = |setup: &Setup| setup.tones.iter().map(|tone| tone.slot).collect::<Vec<u8>>();
    if !Arc::ptr_eq(&from.plate, &to.plate) || slots(from) != slots(to) {
        (next.plate, next.tones) = (Arc::clone(&to.plate), to.tones.clone());
        return next;
    }
    for tone in &mut next.tones {
        if let (Some(from), Some(to)) = (from.tone(tone.slot), to.tone(tone.slot)) {
            take(&mut tone.position_m, from.position_m, to.position_m);
            take(&mut tone.level, from.level, to.level);
            take(&mut tone.phase_turns, from.phase_turns, to.phase_turns);
        }
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::edit::apply;

    const fn user(number: u64) -> Gesture {
        Gesture { source: EditSource::User, number }
    }

    #[test]
    fn a_whole_drag_is_one_step_back_and_forth() {
        let first = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
        let mut history = History::default();
        let mut present = first.clone();
        for mm in [110, 115, 120] {
            let edit = Edit::Move { slot: 0, position_m: f64::from(mm) * 1e-3 };
            let next = apply(&present, &edit).unwrap();
            history.note(present, &next, &edit, user(7));
            present = next;
        }
        let moved = present.clone();
        let back = history.undo(&present).unwrap();
        assert_eq!(back, first);
        assert_eq!(history.undo_name(), None);
        assert_eq!(history.redo(&back).unwrap(), moved);
        // Another press of the pointer is another step.
        let edit = Edit::Move { slot: 0, position_m: 0.13 };
        history.note(moved.clone(), &apply(&moved, &edit).unwrap(), &edit, user(8));
        assert!(history.redo_name().is_none() && history.undo(&moved).is_some());
    }

    #[test]
    fn undo_takes_back_one_sources_gesture_and_leaves_what_another_changed_meanwhile() {
        let first = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
        let mut history = History::default();
        let mut present = first.clone();
        let score = Gesture { source: EditSource::Program("score"), number: 1 };
        let moves = [110, 115, 120].map(|mm| Edit::Move { slot: 0, position_m: f64::from(mm) * 1e-3 });
        let levels = [0.3, 0.2, 0.1].map(|level| Edit::Level { slot: 0, level });
        for (edit, level) in moves.iter().zip(&levels) {
            for (edit, gesture) in [(edit, score), (level, user(7))] {
                let next = apply(&present, edit).unwrap();
                history.note(present, &next, edit, gesture);
                present = next;
            }
        }
        // The user's gesture began later.
        let back = history.undo(&present).unwrap();
        assert_eq!((back.tones[0].position_m, back.tones[0].level), (0.12, first.tones[0].level));
        let all = history.undo(&back).unwrap();
        assert_eq!((&all, history.undo_name()), (&first, None));
        let again = history.redo(&all).unwrap();
        assert_eq!(history.redo(&again).unwrap(), present);
    }
}
