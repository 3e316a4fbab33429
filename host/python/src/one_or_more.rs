//! A number, or a series of numbers.

use pyo3::prelude::*;

/// An argument that is a number or a series of numbers.
#[derive(Clone, Debug, FromPyObject)]
pub(crate) enum OneOrMore {
    // First: numpy makes a number of an array of one.
    More(Vec<f64>),
    One(f64),
}

impl OneOrMore {
    /// Its numbers.
    pub(crate) fn numbers(self) -> Vec<f64> {
        match self {
            Self::One(number) => vec![number],
            Self::More(numbers) => numbers,
        }
    }
}
