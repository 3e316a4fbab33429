//! The validity lights of a plate at a boundary, computed in the background.

use crate::jobs::Task;
use slipline_plate::check::{CheckError, Checker, Conditions, Report};
use slipline_plate::{Plate, Progress};
use std::sync::Arc;

/// A plate and a boundary to check.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct CheckJob {
    /// The plate.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub plate: Arc<Plate>,
    /// The boundary, in metres.
    pub boundary_m: f64,
    /// Rate, level and the other tones.
    pub conditions: Conditions,
}

impl PartialEq for CheckJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.plate, &other.plate)
            && self.boundary_m == other.boundary_m
            && self.conditions == other.conditions
    }
}

/// The result of a check.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Checked {
    /// The plate and boundary that were checked.
    pub job: CheckJob,
    /// The lights, or the reason why there are none.
    pub report: Result<Report, CheckError>,
}

/// The work of the check thread. It keeps the checker of the latest plate, so that a new boundary on the same
/// plate costs less.
pub fn work() -> impl FnMut(CheckJob, &Task) -> Option<Checked> + Send {
    let mut kept: Option<(Arc<Plate>, Checker)> = None;
    move |job, task| {
        let report = check(&mut kept, &job, task);
        let is_stopped = matches!(report, Err(CheckError::Stopped(_)));
        (!is_stopped).then_some(Checked { job, report })
    }
}

fn check(
    kept: &mut Option<(Arc<Plate>, Checker)>,
    job: &CheckJob,
    task: &Task,
) -> Result<Report, CheckError> {
    let conditions = job.conditions.clone();
    match kept {
        Some((plate, checker)) if Arc::ptr_eq(plate, &job.plate) => {
            checker.set_conditions(conditions)?;
            checker.at(job.boundary_m)
        }
        _ => {
            let mut go_on = |share| task.report(share);
            let checker = Checker::watched(&job.plate, conditions, &mut Progress::new(&mut go_on))?;
            let (_, checker) = kept.insert((Arc::clone(&job.plate), checker));
            checker.at(job.boundary_m)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plate_that_is_kept_gives_the_same_lights_as_a_fresh_one() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let job = |boundary_m: f64, level: f64| CheckJob {
            plate: Arc::clone(&plate),
            boundary_m,
            conditions: Conditions { level, ..Conditions::default() },
        };
        let task = Task::default();
        let mut kept = work();
        kept(job(0.12, 1.0), &task).unwrap();
        let again = kept(job(0.2, 0.3), &task).unwrap().report.unwrap();
        let fresh = work()(job(0.2, 0.3), &task).unwrap().report.unwrap();
        assert_eq!(again, fresh);
        assert!(kept(job(9.0, 1.0), &task).unwrap().report.unwrap_err().to_string().contains("boundary"));
    }
}
