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
    /// By result and place.
    numbers: Vec<Vec<Vec<f64>>>,
}

impl Summary {
    /// No results yet.
    #[must_use]
    pub fn new(spec: &Spec) -> Self {
        let none = vec![Vec::new(); spec.turning_point_m().len()];
        Self { counts: BTreeMap::new(), numbers: vec![none; spec.results().len()] }
    }

    /// Adds the results of a range.
    pub fn add(&mut self, chunk: &Chunk) {
        for &status in &chunk.status {
            *self.counts.entry(status).or_default() += 1;
        }
        for (all, numbers) in self.numbers.iter_mut().zip(&chunk.results) {
            for plate in numbers.chunks(all.len()) {
                all.iter_mut().zip(plate).for_each(|(all, &number)| all.push(number));
            }
        }
    }

    /// The number of plates with this status.
    #[must_use]
    pub fn count(&self, status: Status) -> u64 {
        self.counts.get(&status).copied().unwrap_or(0)
    }

    /// Statistics of a result, by its number in [`Spec::results`], at a place; `None` where no plate has a number.
    #[must_use]
    pub fn of(&self, result: usize, place: usize) -> Option<Statistics> {
        Statistics::of(self.numbers.get(result)?.get(place)?)
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
