//! How long presses have waited for the frame that handles them. Two presses of STOP within a second are an emergency stop, and a
//! frame that comes late must not bring them closer together.

use std::cell::RefCell;
use std::rc::Rc;

/// The ages of the presses of STOP's keys and of the pointer that the present frame handles, in seconds, the oldest first. Clones
/// share them.
#[derive(Clone, Debug, Default)]
pub struct PressAges(Rc<RefCell<Ages>>);

#[derive(Debug, Default)]
struct Ages {
    waiting_s: Vec<f64>,
    /// Of the press that is handled now.
    present_s: f64,
}

impl PressAges {
    /// A frame begins, which handles presses of these ages.
    pub fn begin_frame(&self, ages_s: Vec<f64>) {
        self.0.borrow_mut().waiting_s = ages_s;
    }

    /// The next event is handled, which may be a press.
    pub(super) fn begin_event(&self, is_press: bool) {
        let mut ages = self.0.borrow_mut();
        ages.present_s = if !is_press || ages.waiting_s.is_empty() { 0.0 } else { ages.waiting_s.remove(0) };
    }

    /// The age of the press that is handled now; 0 where it is not known.
    pub(super) fn present_s(&self) -> f64 {
        self.0.borrow().present_s
    }
}
