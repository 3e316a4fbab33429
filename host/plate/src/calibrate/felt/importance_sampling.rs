//! Adaptive importance sampling of the plates and drives that agree with few data.
//!
//! With a handful of data for eleven unknowns, least squares give one of many solutions that fit equally well. The best
//! estimate is the mean over all of them, each weighted by its likelihood. The first samples are drawn from the
//! prior. Where too few of them fit, up to six further stages draw from a normal distribution with the weighted mean
//! and covariance of the stage before, with a larger standard deviation (`WIDER`). The weight is prior x likelihood
//! over the density from which a sample was drawn, so the result does not depend on that density (Cappé, Douc,
//! Guillin, Marin and Robert 2008).
//!
//! A sample has two parts: an outer one that is costly to evaluate (the plate), and an inner one that is cheap (its
//! drive).

use crate::truth::Random;
use nalgebra::{SMatrix, SVector};

/// Coordinates of a sample.
pub(crate) const COUNT: usize = 11;
/// Coordinates of the outer part, which come first.
pub(crate) const OUTER: usize = 5;

pub(crate) type Coordinates = SVector<f64, COUNT>;
pub(crate) type Covariance = SMatrix<f64, COUNT, COUNT>;

/// Outer parts of a stage, and inner parts for each outer part.
const OUTERS: usize = 192;
const INNERS: usize = 192;
/// Largest number of stages.
const STAGES: usize = 7;
/// Effective numbers of samples and of outer parts required in a stage; with fewer, the likelihood is tempered by a
/// power below 1.
const EFFECTIVE: [f64; 2] = [250.0, 16.0];
/// Standard deviation of the proposal over that of the stage before.
const WIDER: f64 = 1.25;
/// Number of powers of the likelihood to try, from 1 downwards, and the ratio of two successive powers.
const POWERS: i32 = 40;
const POWER_STEP: f64 = 0.7;

/// The distribution to sample.
pub(crate) trait Target {
    /// Result of the computation that depends on the outer coordinates alone.
    type Outer;
    /// A random draw from the prior.
    fn draw(&self, random: &mut Random) -> Coordinates;
    /// Logarithm of the prior density, up to a constant.
    fn log_prior(&self, at: &Coordinates) -> f64;
    /// Evaluates the outer coordinates; `None` where they are not valid.
    fn outer(&self, at: &Coordinates) -> Option<Self::Outer>;
    /// Logarithm of the likelihood, up to a constant; `None` where it is zero.
    fn log_likelihood(&self, outer: &Self::Outer, at: &Coordinates) -> Option<f64>;
}

/// A sample with its normalised weight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) at: Coordinates,
    pub(crate) share: f64,
    /// Index of its outer part.
    pub(crate) outer: usize,
    log_prior_share: f64,
    log_likelihood: f64,
}

/// The posterior as weighted samples.
pub(crate) struct Samples {
    /// Samples of the last stage.
    pub(crate) samples: Vec<Sample>,
    pub(crate) mean: Coordinates,
    pub(crate) covariance: Covariance,
}

/// A normal distribution.
struct Normal {
    mean: Coordinates,
    /// Lower triangle: the outer part depends on the first coordinates alone.
    factor: Covariance,
}

impl Normal {
    fn wider(mean: Coordinates, covariance: &Covariance) -> Option<Self> {
        let covariance = covariance * (WIDER * WIDER) + Covariance::identity() * 1e-10;
        Some(Self { mean, factor: covariance.cholesky()?.l() })
    }

    fn at(&self, standard: &Coordinates) -> Coordinates {
        self.mean + self.factor * standard
    }

    fn log_density(&self, standard: &Coordinates) -> f64 {
        -0.5 * standard.norm_squared() - (0..COUNT).map(|i| self.factor[(i, i)].ln()).sum::<f64>()
    }
}

/// Samples `target`. `None` where no sample is possible.
pub(crate) fn sample(target: &impl Target, random: &mut Random) -> Option<Samples> {
    let mut normal: Option<Normal> = None;
    for stage in 1.. {
        let mut samples = drawn(target, normal.as_ref(), random);
        let power = weigh(&mut samples)?;
        let (mean, covariance) = moments(&samples);
        if stage == STAGES || power == 1.0 {
            return Some(Samples { samples, mean, covariance });
        }
        normal = Some(Normal::wider(mean, &covariance)?);
    }
    None
}

/// The samples of one stage, without weights.
fn drawn<T: Target>(target: &T, normal: Option<&Normal>, random: &mut Random) -> Vec<Sample> {
    let mut samples = Vec::with_capacity(OUTERS * INNERS);
    for number in 0..OUTERS {
        let mut drawn = draw(target, normal, random);
        let Some(outer) = target.outer(&drawn.0) else { continue };
        let first = drawn.1;
        for _ in 0..INNERS {
            let (at, standard) = drawn;
            if let Some(log_likelihood) = target.log_likelihood(&outer, &at) {
                let drawn_from =
                    normal.map_or_else(|| target.log_prior(&at), |normal| normal.log_density(&standard));
                samples.push(Sample {
                    at,
                    share: 0.0,
                    outer: number,
                    log_prior_share: target.log_prior(&at) - drawn_from,
                    log_likelihood,
                });
            }
            // The next inner part for the same outer part.
            let (next, mut next_standard) = draw(target, normal, random);
            drawn = match normal {
                Some(normal) => {
                    next_standard.fixed_rows_mut::<OUTER>(0).copy_from(&first.fixed_rows::<OUTER>(0));
                    (normal.at(&next_standard), next_standard)
                }
                None => {
                    let mut next = next;
                    next.fixed_rows_mut::<OUTER>(0).copy_from(&at.fixed_rows::<OUTER>(0));
                    (next, next_standard)
                }
            };
        }
    }
    samples
}

/// Coordinates, and the standard normal deviates from which they were made.
fn draw(target: &impl Target, normal: Option<&Normal>, random: &mut Random) -> (Coordinates, Coordinates) {
    match normal {
        Some(normal) => {
            let standard = Coordinates::from_fn(|_, _| random.normal());
            (normal.at(&standard), standard)
        }
        None => (target.draw(random), Coordinates::zeros()),
    }
}

/// Sets the weight of every sample, with the likelihood to the largest power up to 1 that leaves enough effective
/// samples.
fn weigh(samples: &mut [Sample]) -> Option<f64> {
    let most = |of: fn(&Sample) -> f64| samples.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    let (largest_prior, largest) = (most(|it| it.log_prior_share), most(|it| it.log_likelihood));
    let weight = |sample: &Sample, power: f64| {
        (sample.log_prior_share - largest_prior + power * (sample.log_likelihood - largest)).exp()
    };
    // The smaller of two ratios to the required numbers, of samples and of outer parts; from 1 on both suffice.
    let effective = |power: f64| {
        let (mut sum, mut squares, mut of_outer) = (0.0, 0.0, [0.0; OUTERS]);
        for sample in samples.iter() {
            let weight = weight(sample, power);
            sum += weight;
            squares += weight * weight;
            of_outer[sample.outer] += weight;
        }
        let of_outers = of_outer.iter().map(|weight| weight * weight).sum::<f64>();
        (sum * sum / squares / EFFECTIVE[0]).min(sum * sum / of_outers / EFFECTIVE[1])
    };
    // Samples of a narrow proposal represent a small power as badly as a large one, so the best power tried is kept.
    let mut best = (f64::NEG_INFINITY, 1.0);
    for step in 0..POWERS {
        let power = POWER_STEP.powi(step);
        let found = effective(power);
        if found > best.0 {
            best = (found, power);
        }
        if found >= 1.0 {
            break;
        }
    }
    let power = best.1;
    let weights: Vec<f64> = samples.iter().map(|sample| weight(sample, power)).collect();
    let sum: f64 = weights.iter().sum();
    samples.iter_mut().zip(weights).for_each(|(sample, weight)| sample.share = weight / sum);
    (sum.is_finite() && sum > 0.0).then_some(power)
}

fn moments(samples: &[Sample]) -> (Coordinates, Covariance) {
    let mut mean = Coordinates::zeros();
    samples.iter().for_each(|sample| mean += sample.at * sample.share);
    let mut covariance = Covariance::zeros();
    for sample in samples {
        let off = sample.at - mean;
        covariance.ger(sample.share, &off, &off, 1.0);
    }
    (mean, covariance)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An outer and an inner sum of coordinates are measured; all coordinates have a prior deviation of 1.
    struct Sums {
        values: [f64; 2],
        deviation: f64,
    }

    impl Target for Sums {
        type Outer = f64;

        fn draw(&self, random: &mut Random) -> Coordinates {
            Coordinates::from_fn(|_, _| random.normal())
        }

        fn log_prior(&self, at: &Coordinates) -> f64 {
            -0.5 * at.norm_squared()
        }

        fn outer(&self, at: &Coordinates) -> Option<f64> {
            Some(at[0] + at[1])
        }

        fn log_likelihood(&self, outer: &f64, at: &Coordinates) -> Option<f64> {
            let off = [outer - self.values[0], at[1] + at[7] - self.values[1]];
            Some(-0.5 * off.iter().map(|off| (off / self.deviation).powi(2)).sum::<f64>())
        }
    }

    #[test]
    fn a_linear_problem_has_the_mean_and_the_covariance_of_the_formula() {
        // Means of two or four prior deviations, measured to a third, a tenth and a fiftieth of a deviation.
        for (values, deviation) in [([1.0, -0.5], 0.3), ([2.0, 2.5], 0.1), ([0.3, -1.5], 0.02)] {
            let found = sample(&Sums { values, deviation }, &mut Random::new(3)).expect("samples");
            let rows = nalgebra::SMatrix::<f64, 2, COUNT>::from_fn(|row, i| match (row, i) {
                (0, 0 | 1) | (1, 1 | 7) => 1.0,
                _ => 0.0,
            });
            let of_data = rows * rows.transpose() + nalgebra::Matrix2::identity() * deviation * deviation;
            let gain = rows.transpose() * of_data.try_inverse().expect("regular");
            let mean = gain * nalgebra::Vector2::from(values);
            let covariance = Covariance::identity() - gain * rows;
            // Statistical error of a mean and of a deviation with at least 16 effective outer parts: of a deviation 1/sqrt(32), and
            // twice that over all coordinates.
            for i in 0..COUNT {
                let deviation = covariance[(i, i)].sqrt();
                assert!(
                    (found.mean[i] - mean[i]).abs() < 0.35 * deviation,
                    "{i}: {} {}",
                    found.mean[i],
                    mean[i]
                );
                let ratio = found.covariance[(i, i)].sqrt() / deviation;
                assert!((ratio - 1.0).abs() < 0.36, "{i}: {ratio}");
            }
            let whole: f64 = found.samples.iter().map(|sample| sample.share).sum();
            assert!((whole - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn data_that_cannot_be_have_no_samples() {
        assert!(sample(&Sums { values: [f64::NAN, 0.0], deviation: 1.0 }, &mut Random::new(1)).is_none());
    }
}
