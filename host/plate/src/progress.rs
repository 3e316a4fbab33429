//! How far a long computation has come, and whether anybody still wants it.

use thiserror::Error;

/// A computation was given up before it was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("stopped before it was done")]
pub struct Stopped;

/// Progress of a long computation, reported to the caller that waits for it.
pub struct Progress<'a> {
    /// Takes the share done, 0 to 1; false ends the computation.
    tell: &'a mut dyn FnMut(f64) -> bool,
    from: f64,
    to: f64,
}

impl<'a> Progress<'a> {
    /// `tell` takes the share done (0 to 1, never falling) a few hundred times and says whether to go on.
    pub fn new(tell: &'a mut dyn FnMut(f64) -> bool) -> Self {
        Self { tell, from: 0.0, to: 1.0 }
    }

    /// The part of this computation that lies between two shares of it, as a computation of its own.
    pub fn part(&mut self, from: f64, to: f64) -> Progress<'_> {
        let whole = self.to - self.from;
        Progress { from: self.from + from * whole, to: self.from + to * whole, tell: &mut *self.tell }
    }

    /// Reports that `share` (0 to 1) of this part is done.
    ///
    /// # Errors
    /// [`Stopped`] when the caller does not want the result any more.
    pub fn at(&mut self, share: f64) -> Result<(), Stopped> {
        let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
        if (self.tell)(self.from + share * (self.to - self.from)) { Ok(()) } else { Err(Stopped) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_parts_cover_their_stretch_and_a_no_ends_it() {
        let mut told = Vec::new();
        let mut tell = |share: f64| {
            told.push((100.0 * share).round());
            share < 0.7
        };
        let mut whole = Progress::new(&mut tell);
        let mut half = whole.part(0.0, 0.5);
        assert_eq!(half.at(1.0), Ok(()));
        assert_eq!(half.part(0.5, 1.0).at(0.5), Ok(()));
        assert_eq!(whole.at(0.8), Err(Stopped));
        assert_eq!(told, [50.0, 38.0, 80.0]);
    }
}
