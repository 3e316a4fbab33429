//! Time-domain lines that are built once for a plate, not for every move of a drag.

use slipline_plate::{Plate, TimeDomainLine};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Number of lines kept: for each of two plates that of the envelope, and that for the settling of the sheet.
const KEPT: usize = 4;

struct Built {
    plate: Arc<Plate>,
    rate_hz: f64,
    points: usize,
    line: TimeDomainLine,
}

/// The lines that were built last, oldest first.
static BUILT: Mutex<Vec<Built>> = Mutex::new(Vec::new());

fn built() -> MutexGuard<'static, Vec<Built>> {
    // Each line in it is complete at any time, even after a panic.
    BUILT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A line at rest, as [`TimeDomainLine::new`] builds it; `None` if the plate has none at this rate.
pub(super) fn line_at_rest(plate: &Arc<Plate>, rate_hz: f64, points: usize) -> Option<TimeDomainLine> {
    let is_it = |it: &&Built| it.rate_hz == rate_hz && it.points == points && it.plate == *plate;
    if let Some(found) = built().iter().find(is_it) {
        return Some(found.line.clone());
    }
    // Built without the lock, so that no other thread waits.
    let line = TimeDomainLine::new(plate, rate_hz, points).ok()?;
    let mut built = built();
    if built.len() >= KEPT {
        built.remove(0);
    }
    built.push(Built { plate: Arc::clone(plate), rate_hz, points, line: line.clone() });
    Some(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest displacement after some time at full scale.
    fn swung(mut line: TimeDomainLine) -> Vec<f32> {
        line.push(&[1.0; 20_000]);
        line.envelope().maximum_m().to_vec()
    }

    #[test]
    fn a_kept_line_is_at_rest_and_that_of_its_plate_rate_and_places() {
        let [membrane, rubber] =
            ["membrane", "paper-rubber"].map(|name| Arc::new(slipline_plate::preset(name).unwrap()));
        let cases =
            [(&membrane, 400e3, 64), (&membrane, 200e3, 64), (&rubber, 400e3, 64), (&membrane, 400e3, 65)];
        for _ in 0..3 {
            for (plate, rate_hz, points) in cases {
                let kept = line_at_rest(plate, rate_hz, points).unwrap();
                let new = TimeDomainLine::new(plate, rate_hz, points).unwrap();
                assert_eq!(swung(kept), swung(new));
            }
        }
        let again = |rate_hz| swung(line_at_rest(&membrane, rate_hz, 64).unwrap());
        assert_eq!(again(400e3), again(400e3), "what was done with the first changes nothing of the second");
        assert!(line_at_rest(&membrane, 1.0, 64).is_none());
    }
}
