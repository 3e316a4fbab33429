//! How long presses have waited for the frame that handles them. Two presses of STOP within a second are an emergency stop, and a
//! frame that comes late must not bring them closer together.

use std::cell::RefCell;
use std::rc::Rc;

/// The ages of the presses of STOP's keys and of the pointer that the present frame handles, in seconds, the oldest first. Clones
/// share them.
#[derive(Clone, Debug, Default)]
pub struct PressAges(Rc<RefCell<Vec<f64>>>);

impl PressAges {
    /// A frame begins, which handles presses of these ages.
    pub fn begin_frame(&self, ages_s: Vec<f64>) {
        self.0.replace(ages_s);
    }

    /// The age of the next press; 0 where it is not known.
    pub(super) fn take(&self) -> f64 {
        let mut ages_s = self.0.borrow_mut();
        if ages_s.is_empty() { 0.0 } else { ages_s.remove(0) }
    }
}
