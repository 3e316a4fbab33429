//! Compares a plate at one boundary in two dimensions with the one-mode equation, in the background.

use crate::jobs::Task;
use slipline_plate::plane::{self, Comparison, PlaneError, Setup};
use slipline_plate::{Equation, Finger, Plate, respond_touched};
use std::fmt::Write as _;
use std::sync::Arc;

/// Places along the plate: more than ten per wavelength, so that every node is found.
const POINTS: usize = 2049;
/// Largest shift of the peak that the sentence calls the same place, in metres.
const SAME_PLACE_M: f64 = 0.05e-3;
/// Largest difference of the level that the sentence calls the same, in dB.
const SAME_LEVEL_DB: f64 = 0.05;
/// Share of the one-mode equation in the progress.
const ONE_MODE_SHARE: f64 = 0.1;

/// A plate and a boundary to compute in two dimensions.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct PlaneJob {
    /// The plate.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub plate: Arc<Plate>,
    /// The boundary, in metres.
    pub boundary_m: f64,
    /// The finger on the plate.
    pub finger: Option<Finger>,
}

impl PartialEq for PlaneJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.plate, &other.plate)
            && self.boundary_m == other.boundary_m
            && self.finger == other.finger
    }
}

/// Differences between the field in two dimensions and that of the one-mode equation, or why it was not
/// computed.
pub type PlaneChecked = Result<Comparison, PlaneError>;

/// The work of the thread. A solution takes some milliseconds and cannot be interrupted; `None` if the task
/// was cancelled before or during it.
#[must_use]
pub fn work(job: PlaneJob, task: &Task) -> Option<PlaneChecked> {
    compare(&job, task).transpose()
}

fn compare(job: &PlaneJob, task: &Task) -> Result<Option<Comparison>, PlaneError> {
    let frequency_hz = job.plate.frequency_for_boundary_hz(job.boundary_m);
    let finger = job.finger.as_ref();
    let one_mode = respond_touched(&job.plate, finger, frequency_hz, POINTS, Equation::Corrected)?;
    if !task.report(ONE_MODE_SHARE) {
        return Ok(None);
    }
    let setup = Setup { finger: job.finger, ..Setup::of(&job.plate) };
    let two_dimensions = plane::respond(&job.plate, frequency_hz, POINTS, &setup)?;
    Ok(task.report(1.0).then(|| Comparison::of(&one_mode, &two_dimensions)))
}

/// The comparison in a sentence: place and level of the peak, and the nodes.
#[must_use]
pub fn sentence(differs: &Comparison) -> String {
    let mut text = match differs.peak_shift_m.zip(differs.level_db) {
        Some((shift_m, level_db)) => {
            format!("In two dimensions the peak is {} and {}", place_words(shift_m), level_words(level_db))
        }
        None => "One of the two fields has no peak, so place and level are not compared".to_owned(),
    };
    let nodes = |count: usize| if count == 1 { "1 node".to_owned() } else { format!("{count} nodes") };
    let [one_mode, two_dimensions] = differs.nodes;
    // Writing to a string cannot fail.
    let _ = if one_mode == two_dimensions {
        write!(text, "; both fields have {} before it.", nodes(one_mode))
    } else {
        write!(text, "; it has {} before it, where one dimension has {one_mode}.", nodes(two_dimensions))
    };
    text
}

fn place_words(shift_m: f64) -> String {
    let millimetres = 1e3 * shift_m.abs();
    match shift_m {
        shift_m if shift_m.abs() < SAME_PLACE_M => "at the same place (to 0.05 mm)".to_owned(),
        shift_m if shift_m < 0.0 => format!("{millimetres:.1} mm nearer to the drive"),
        _ => format!("{millimetres:.1} mm farther from the drive"),
    }
}

fn level_words(level_db: f64) -> String {
    let decibel = level_db.abs();
    match level_db {
        level_db if level_db.abs() < SAME_LEVEL_DB => "as high (to 0.05 dB)".to_owned(),
        level_db if level_db < 0.0 => format!("{decibel:.1} dB lower"),
        _ => format!("{decibel:.1} dB higher"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_level_and_nodes_are_printed_with_their_signs() {
        let described =
            |peak_shift_m, level_db, nodes| sentence(&Comparison { peak_shift_m, level_db, nodes });
        assert_eq!(
            described(Some(-1.24e-3), Some(0.36), [4, 5]),
            "In two dimensions the peak is 1.2 mm nearer to the drive and 0.4 dB higher; it has 5 nodes before it, \
             where one dimension has 4."
        );
        assert_eq!(
            described(Some(0.01e-3), Some(-2.0), [1, 1]),
            "In two dimensions the peak is at the same place (to 0.05 mm) and 2.0 dB lower; both fields have 1 node \
             before it."
        );
        assert!(described(None, None, [3, 3]).starts_with("One of the two fields has no peak"));
    }

    #[test]
    fn the_comparison_matches_the_two_solvers_at_the_boundarys_frequency_with_the_finger() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let hertz = plate.frequency_for_boundary_hz(0.18);
        for finger in [None, Some(Finger::firm(0.1))] {
            let job = PlaneJob { plate: Arc::clone(&plate), boundary_m: 0.18, finger };
            let done = work(job, &Task::default()).unwrap().unwrap();
            let one_mode =
                respond_touched(&plate, finger.as_ref(), hertz, POINTS, Equation::Corrected).unwrap();
            let setup = Setup { finger, ..Setup::of(&plate) };
            let two_dimensions = plane::respond(&plate, hertz, POINTS, &setup).unwrap();
            assert_eq!(done, Comparison::of(&one_mode, &two_dimensions));
        }
    }

    #[test]
    fn a_boundary_off_the_plate_has_a_reason_and_a_cancelled_task_no_result() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let job = |boundary_m| PlaneJob { plate: Arc::clone(&plate), boundary_m, finger: None };
        let reason = work(job(f64::NAN), &Task::default()).unwrap().unwrap_err();
        assert!(reason.to_string().contains("frequency"), "{reason}");
        let over = Task::default();
        over.end();
        assert!(work(job(0.18), &over).is_none());
    }
}
