//! Statistics of a study's results.

use super::chunk::{Chunk, Status};
use super::spec::Spec;
use std::collections::BTreeMap;

/// Statistics of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// The mean.
    pub mean: f64,
    /// The standard deviation, by count - 1; `None` of a single number.
    pub standard_deviation: Option<f64>,
    /// The quantiles 0.05, 0.5 and 0.95, interpolated linearly between the numbers in order.
    pub quantiles: [f64; 3],
}

impl Statistics {
    /// The shares below the three quantiles.
    pub const SHARES: [f64; 3] = [0.05, 0.5, 0.95];

    /// Statistics of the finite ones among `values`; `None` if there are none.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        let mean = sorted.iter().sum::<f64>() / sorted.len() as f64;
        let squares: f64 = sorted.iter().map(|value| (value - mean).powi(2)).sum();
        let quantiles = Self::SHARES.map(|share| {
            let at = share * last as f64;
            let (left, right) = (sorted[at as usize], sorted[(at as usize + 1).min(last)]);
            left + (right - left) * at.fract()
        });
        let standard_deviation = (last > 0).then(|| (squares / last as f64).sqrt());
        Some(Self { mean, standard_deviation, quantiles })
    }
}

/// The results of a study, collected for their statistics.
#[derive(Clone, Debug)]
pub struct Summary {
    counts: BTreeMap<Status, u64>,
    /// By place.
    shifts_m: Vec<Vec<f64>>,
    levels_db: Vec<Vec<f64>>,
}

impl Summary {
    /// No results yet.
    #[must_use]
    pub fn new(spec: &Spec) -> Self {
        let none = vec![Vec::new(); spec.turning_point_m().len()];
        Self { counts: BTreeMap::new(), shifts_m: none.clone(), levels_db: none }
    }

    /// Adds the results of a range.
    pub fn add(&mut self, chunk: &Chunk) {
        for &status in &chunk.status {
            *self.counts.entry(status).or_default() += 1;
        }
        let places = self.shifts_m.len();
        let both = chunk.turning_point_shift_m.chunks(places).zip(chunk.level_db.chunks(places));
        for (shifts_m, levels_db) in both {
            self.shifts_m.iter_mut().zip(shifts_m).for_each(|(all, &shift_m)| all.push(shift_m));
            self.levels_db.iter_mut().zip(levels_db).for_each(|(all, &level_db)| all.push(level_db));
        }
    }

    /// The number of plates with this status.
    #[must_use]
    pub fn count(&self, status: Status) -> u64 {
        self.counts.get(&status).copied().unwrap_or(0)
    }

    /// Statistics of the shift, metres, and of the level, dB, at a place; `None` where no plate has a boundary.
    #[must_use]
    pub fn at_place(&self, place: usize) -> Option<[Statistics; 2]> {
        let of = |all: &[Vec<f64>]| all.get(place).and_then(|values| Statistics::of(values));
        Some([of(&self.shifts_m)?, of(&self.levels_db)?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_statistics_match_the_textbook() {
        let found = Statistics::of(&[4.0, f64::NAN, 1.0, 3.0, 2.0, 5.0]).unwrap();
        assert_eq!(found.mean, 3.0);
        assert!((found.standard_deviation.unwrap() - 2.5_f64.sqrt()).abs() < 1e-15);
        for (quantile, expected) in found.quantiles.into_iter().zip([1.2, 3.0, 4.8]) {
            assert!((quantile - expected).abs() < 1e-12, "{quantile}");
        }
        let one = Statistics { mean: 7.0, standard_deviation: None, quantiles: [7.0; 3] };
        assert_eq!(Statistics::of(&[7.0]), Some(one));
        assert_eq!(Statistics::of(&[f64::NAN]), None);
    }
}
