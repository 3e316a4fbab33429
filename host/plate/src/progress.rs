//! Progress of a long computation, and its cancellation.

use thiserror::Error;

/// The caller stopped a computation before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error, serde::Serialize, serde::Deserialize)]
#[error("stopped before it was done")]
pub struct Stopped;

/// Progress of a long computation, reported to the caller that waits for it.
pub struct Progress<'a> {
    /// Takes the fraction done, 0 to 1; false ends the computation. `None` where nobody watches.
    report: Option<&'a mut dyn FnMut(f64) -> bool>,
    from: f64,
    to: f64,
}

impl<'a> Progress<'a> {
    /// `report` takes the fraction done (0 to 1, never falling) a few hundred times and returns whether to continue.
    pub fn new(report: &'a mut dyn FnMut(f64) -> bool) -> Self {
        Self { report: Some(report), from: 0.0, to: 1.0 }
    }

    /// For a computation that nobody watches or cancels.
    #[must_use]
    pub const fn unwatched() -> Self {
        Self { report: None, from: 0.0, to: 1.0 }
    }

    /// The part of this computation between two fractions of it, as a computation of its own.
    pub fn part(&mut self, from: f64, to: f64) -> Progress<'_> {
        let whole = self.to - self.from;
        let report = self.report.as_mut().map(|report| &mut **report as &mut dyn FnMut(f64) -> bool);
        Progress { from: self.from + from * whole, to: self.from + to * whole, report }
    }

    /// Reports that the fraction `share` (0 to 1) of this part is done.
    ///
    /// # Errors
    /// [`Stopped`] when the caller no longer needs the result.
    pub fn at(&mut self, share: f64) -> Result<(), Stopped> {
        let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
        let Some(report) = &mut self.report else { return Ok(()) };
        if report(self.from + share * (self.to - self.from)) { Ok(()) } else { Err(Stopped) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_parts_cover_their_stretch_and_a_no_ends_it() {
        let mut reports = Vec::new();
        let mut report = |share: f64| {
            reports.push((100.0 * share).round());
            share < 0.7
        };
        let mut whole = Progress::new(&mut report);
        let mut half = whole.part(0.0, 0.5);
        assert_eq!(half.at(1.0), Ok(()));
        assert_eq!(half.part(0.5, 1.0).at(0.5), Ok(()));
        assert_eq!(whole.at(0.8), Err(Stopped));
        assert_eq!(reports, [50.0, 38.0, 80.0]);
    }
}
