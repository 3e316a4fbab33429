//! Mean edge positions over all sampled plates, and the plate that reproduces them.

use super::candidates::{Felt, Marked, PlayedTone};
use super::importance_sampling::{Coordinates, OUTER, Sample, Samples};
use crate::calibrate::fit::least_squares::{self, Problem, STEPS_MAX, slope};
use crate::feeling::FeltEdge;

/// Deviation of a calibrated edge from the mean edge that is negligible, metres: the least scale of a residual.
const EDGE_M: f64 = 5e-4;
/// Least weight of a sample that is evaluated, and least weight of all samples with an edge for a tone to have a mean
/// edge.
const LEAST_SHARE: f64 = 1e-9;
const EDGE_SHARE: f64 = 0.2;
/// Weight of the residuals of the drive's coordinates, relative to those of the edges.
const DRIVE_WEIGHT: f64 = 0.2;
/// Step of a coordinate for a difference quotient.
const STEP: f64 = 1e-3;

/// Mean edge positions, and the plate of the mean whose drive reproduces them.
pub(crate) struct MeanEdges<'a> {
    marked: &'a Marked<'a>,
    mean: Coordinates,
    deviations: Coordinates,
    /// The judged tones, then the touched ones, on the plate of the mean.
    felt: Vec<Felt>,
    judged: usize,
    /// Mean and standard deviation of the edge of each tone, metres; `None` where too few samples have an edge.
    edges_m: Vec<Option<[f64; 2]>>,
}

impl<'a> MeanEdges<'a> {
    pub(crate) fn new(marked: &'a Marked<'a>, judged: &[PlayedTone], samples: &Samples) -> Option<Self> {
        let near = &marked.near;
        let tones = [judged, &marked.tones].concat();
        // For each tone: the weight of the samples with an edge on the plate, and the weighted sums of the edge and
        // of its square.
        let mut sums = vec![[0.0; 3]; tones.len()];
        for of_one in samples.samples.chunk_by(|a, b| a.outer == b.outer) {
            let weighty = |sample: &&Sample| sample.share > LEAST_SHARE;
            if !of_one.iter().any(|sample| weighty(&sample)) {
                continue;
            }
            let felt = near.felt(&of_one[0].at, &tones)?;
            for sample in of_one.iter().filter(weighty) {
                for (sum, edge) in sums.iter_mut().zip(near.edges(&felt, &sample.at)) {
                    let FeltEdge::At(place_m) = edge else { continue };
                    sum[0] += sample.share;
                    sum[1] += sample.share * place_m;
                    sum[2] += sample.share * place_m * place_m;
                }
            }
        }
        let edge = |&[share, sum, squares]: &[f64; 3]| {
            let mean_m = sum / share;
            (share > EDGE_SHARE).then(|| [mean_m, (squares / share - mean_m * mean_m).max(0.0).sqrt()])
        };
        let mean = samples.mean;
        Some(Self {
            marked,
            mean,
            deviations: samples.covariance.diagonal().map(f64::sqrt),
            felt: near.felt(&mean, &tones)?,
            judged: judged.len(),
            edges_m: sums.iter().map(edge).collect(),
        })
    }

    /// Root mean square of the standard deviations of the judged edges, metres.
    pub(crate) fn deviation_m(&self) -> f64 {
        let judged: Vec<f64> = self.edges_m[..self.judged].iter().flatten().map(|edge| edge[1]).collect();
        (judged.iter().map(|deviation| deviation * deviation).sum::<f64>() / judged.len() as f64).sqrt()
    }

    fn with_drive(&self, drive: &[f64]) -> Coordinates {
        let mut at = self.mean;
        at.as_mut_slice()[OUTER..].copy_from_slice(drive);
        at
    }

    pub(crate) fn likeliest(&self) -> Option<Coordinates> {
        let fit = least_squares::fit(self, &self.mean.as_slice()[OUTER..], 1e-3, STEPS_MAX)?;
        Some(self.with_drive(&fit.parameters))
    }

    pub(crate) fn chi2_per_n(&self, at: &Coordinates) -> Option<f64> {
        let touches = self.marked.touches;
        let chi2 = self.marked.log_likelihood_of(&self.felt[self.judged..], at)? * -2.0;
        Some(chi2 / touches.len() as f64)
    }
}

impl Problem for MeanEdges<'_> {
    fn residuals(&self, drive: &[f64]) -> Option<Vec<f64>> {
        let at = self.with_drive(drive);
        let places_m = self.marked.near.places_m(&self.felt, &at);
        let off = |(place_m, edge): (f64, &Option<[f64; 2]>)| {
            edge.map(|[mean_m, deviation_m]| (place_m - mean_m) / deviation_m.max(EDGE_M))
        };
        let mut residuals: Vec<f64> = places_m.into_iter().zip(&self.edges_m).filter_map(off).collect();
        residuals.extend(
            (OUTER..at.len()).map(|i| DRIVE_WEIGHT * (at[i] - self.mean[i]) / self.deviations[i].max(STEP)),
        );
        Some(residuals)
    }

    fn slopes(&self, drive: &[f64], _: &[f64]) -> Option<Vec<Vec<f64>>> {
        let column = |i: usize| {
            let side = |step: f64| {
                let mut beside = drive.to_vec();
                beside[i] += step;
                self.residuals(&beside)
            };
            Some(slope(&side(STEP)?, &side(-STEP)?, 2.0 * STEP))
        };
        (0..drive.len()).map(column).collect()
    }
}
