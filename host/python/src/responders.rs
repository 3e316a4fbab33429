//! The responders that a plate keeps from call to call: a grid takes as long as several fields.

use slipline_plate::{Plate, Responder};
use std::sync::{Mutex, PoisonError};

/// Most responders that are kept: one for each of two threads.
const KEPT_MAX: usize = 2;
/// Most points of one that is kept. With more its grids may take tens of megabytes.
const POINTS_MAX: usize = 4_001;

/// Responders that nobody uses now, the latest last, each with its number of points.
#[derive(Debug, Default)]
pub(crate) struct Responders(Mutex<Vec<(usize, Responder)>>);

impl Responders {
    /// What `act` does with a responder of this plate with this number of points, the same for all calls.
    pub(crate) fn with<R>(&self, plate: &Plate, points: usize, act: impl FnOnce(&mut Responder) -> R) -> R {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut free = lock();
        let known = free.iter().rposition(|(its, _)| *its == points);
        let kept = known.map(|known| free.remove(known).1);
        drop(free);
        let mut responder = kept.unwrap_or_else(|| Responder::new(plate, points));
        let result = act(&mut responder);
        if points <= POINTS_MAX {
            let mut free = lock();
            if free.len() == KEPT_MAX {
                free.remove(0);
            }
            free.push((points, responder));
        }
        result
    }
}
