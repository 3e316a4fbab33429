//! The calibration by felt edges: wave speed, drive and threshold of feeling without a sensor.
//!
//! A person drags until the felt edge lies at a mark, at two marks or more. The felt edge depends on the wave speed,
//! on the threshold over the level, and on the drive's response over frequency: a factor of ten in level moves it by
//! 70 mm on a membrane. Two or three marks do not determine all of these. The posterior is known, however: the plates
//! and drives near the file's, each weighted by the likelihood of its edges ([`super::importance_sampling`]). The
//! calibrated plate has the mean of their parameters, and its drive puts each edge at the mean of their edges, the
//! estimate of least mean square error. The spread of the samples gives the interval. The result determines places,
//! not levels.

use super::candidates::{Marked, Near, PlayedTone, THRESHOLD, THRESHOLD_KNOWN};
use super::importance_sampling::{Coordinates, Samples, sample};
use super::mean_edges::MeanEdges;
use super::touch::{self, Touch, TouchedDrive};
use crate::calibrate::error::CalibrateError;
use crate::calibrate::fit::acceptance::{CHI2_PER_N_MAX, SPEED_MAX};
use crate::calibrate::fit::parameter::{Parameter, numbers};
use crate::calibrate::fit::response::plate_response::takes_a_source;
use crate::calibrate::fit::unknowns::{EDGE_GIVE, HALF_WIDTH, LOSS, Priors, SPEED, TAPER};
use crate::definition::{Calibration, Impedance, Plate, limits};
use crate::feeling::Feeling;
use crate::truth::{DriveSpread, Random};

/// Largest prior standard deviation of the logarithm of the wave speed: touches determine it less than a sensor does.
const SPEED_KNOWN: f64 = 0.03;
/// Largest prior standard deviation of the logarithm of the loss factor, which touches hardly determine.
const LOSS_KNOWN: f64 = 0.5;
/// Largest half of the 95 % interval of the felt edge after a calibration, metres: beyond it the uncalibrated file is
/// as good.
const OPEN_MAX: f64 = 0.025;
/// Tones at which the calibrated edges are judged: their number, and the places of the first and the last in the
/// band, as fractions of its logarithm.
const JUDGED: (usize, f64, f64) = (9, 0.1, 0.9);
/// Seed of the random numbers: the same touches always give the same result.
const SEED: u64 = 12;
/// Largest plausible |ln| of the threshold over the stated one, in prior standard deviations: a factor of 20. Persons and
/// kinds of touch differ by a factor of 10 (PHYSICS.md, section 5), and levels by some.
const THRESHOLD_MAX: f64 = 2.0;
/// Half of a 95 % interval, in standard deviations.
const INTERVAL: f64 = 1.96;

/// A calibration by touches.
#[derive(Debug, Clone, PartialEq)]
pub struct Touched {
    /// The plate of mean parameters, with the drive that puts the edges at their means. Its levels are not measured.
    pub plate: Plate,
    /// The feeling with the threshold that belongs to it.
    pub feeling: Feeling,
    /// Wave speed over the file's: value and the ends of its 95 % interval.
    pub speed: [f64; 3],
    /// Threshold over the level, over the stated ones: value and the ends of its 95 % interval.
    pub threshold: [f64; 3],
    /// Half of the 95 % interval of the felt edge, metres: root mean square over the band.
    pub edge_tolerance_m: f64,
    /// Mean squared distance of the calibrated edges from their marks, with each square divided by its mark's
    /// variance.
    pub chi2_per_n: f64,
    /// Wave speed and threshold with their names in the plate file and in the feeling.
    pub parameters: Vec<Parameter>,
}

/// Calibrates the places of `plate` by felt edges of single tones. Takes some tenths of a second; seconds for a plate
/// with clamped edges.
///
/// # Errors
/// [`CalibrateError`]: a number out of range; fewer than two marks, or marks too close; edges that no plate and drive
/// near the file's can have, or that leave the felt edge undetermined.
pub fn from_touches(
    plate: &Plate,
    touches: &[Touch],
    feeling: &Feeling,
    drive: TouchedDrive,
    priors: &Priors,
) -> Result<Touched, CalibrateError> {
    priors.check()?;
    let feeling = feeling.checked()?;
    touch::check(plate, touches)?;
    let spread = match drive {
        TouchedDrive::AsStated => None,
        TouchedDrive::Unknown => {
            takes_a_source(plate.spec())?;
            Some(DriveSpread::of(plate))
        }
    };
    let mut deviations = priors.deviations(plate.spec());
    deviations[SPEED] = deviations[SPEED].min(SPEED_KNOWN);
    deviations[LOSS] = deviations[LOSS].min(LOSS_KNOWN);
    let highest_hz = touches.iter().map(|touch| touch.frequency_hz).fold(plate.band_hz().1, f64::max);
    let near = Near::new(plate, feeling, spread, deviations, highest_hz);
    let tones = touched_tones(&near, touches);
    let judged = judged_tones(&near, touches);
    let marked = Marked { near, touches, tones };
    let samples = sample(&marked, &mut Random::new(SEED)).ok_or(CalibrateError::NoEdge)?;
    let edges = MeanEdges::new(&marked, &judged, &samples).ok_or(CalibrateError::NoEdge)?;
    let at = edges.likeliest().ok_or(CalibrateError::NoEdge)?;
    let chi2_per_n = edges.chi2_per_n(&at).ok_or(CalibrateError::NoEdge)?;
    if chi2_per_n > CHI2_PER_N_MAX {
        return Err(CalibrateError::EdgesUnlike { chi2_per_n, most: CHI2_PER_N_MAX });
    }
    let posterior = Posterior { marked: &marked, samples: &samples, at, chi2_per_n };
    let [share, ..] = posterior.interval(SPEED, deviations[SPEED]);
    if share.ln().abs() > SPEED_MAX {
        return Err(CalibrateError::AnotherPlate { what: "wave speed", share });
    }
    let [share, ..] = posterior.interval(THRESHOLD, THRESHOLD_KNOWN);
    if share.ln().abs() > THRESHOLD_MAX * THRESHOLD_KNOWN {
        let most = (THRESHOLD_MAX * THRESHOLD_KNOWN).exp();
        return Err(CalibrateError::ImplausibleFeeling { share, most });
    }
    let edge_tolerance_m = INTERVAL * edges.deviation_m();
    if edge_tolerance_m > OPEN_MAX {
        return Err(CalibrateError::EdgesOpen { edge_m: edge_tolerance_m, most_m: OPEN_MAX });
    }
    posterior.touched(priors, edge_tolerance_m)
}

fn played(near: &Near<'_>, peaks: &[(f64, f64)]) -> Vec<PlayedTone> {
    let amplitudes = near.amplitudes(peaks);
    let tone = |(&(frequency_hz, _), amplitude)| PlayedTone { frequency_hz, amplitude };
    peaks.iter().zip(amplitudes).map(tone).collect()
}

fn touched_tones(near: &Near<'_>, touches: &[Touch]) -> Vec<PlayedTone> {
    let peaks: Vec<(f64, f64)> = touches.iter().map(|touch| (touch.frequency_hz, touch.peak_m)).collect();
    played(near, &peaks)
}

/// Tones over the band, at the level of the touched ones.
fn judged_tones(near: &Near<'_>, touches: &[Touch]) -> Vec<PlayedTone> {
    let (low_hz, high_hz) = near.nominal.band_hz();
    let (count, first, last) = JUDGED;
    let peak_m = (touches.iter().map(|touch| touch.peak_m.ln()).sum::<f64>() / touches.len() as f64).exp();
    let share = |i: usize| first + (last - first) * i as f64 / (count - 1) as f64;
    let peaks: Vec<(f64, f64)> =
        (0..count).map(|i| (low_hz * (high_hz / low_hz).powf(share(i)), peak_m)).collect();
    played(near, &peaks)
}

/// The calibrated plate among the samples, with its intervals.
struct Posterior<'a> {
    marked: &'a Marked<'a>,
    samples: &'a Samples,
    /// The calibrated plate.
    at: Coordinates,
    chi2_per_n: f64,
}

impl Posterior<'_> {
    /// Half of the 95 % interval of a coordinate, wider where chi^2/n exceeds 1.
    fn half(&self, i: usize, scale: f64) -> f64 {
        INTERVAL * self.chi2_per_n.max(1.0).sqrt() * scale * self.samples.covariance[(i, i)].sqrt()
    }

    /// Value and interval of a quantity whose logarithm is `scale` times a coordinate.
    fn interval(&self, i: usize, scale: f64) -> [f64; 3] {
        let (value, mean, half) = (scale * self.at[i], scale * self.samples.mean[i], self.half(i, scale));
        [value, value.min(mean - half), value.max(mean + half)].map(f64::exp)
    }

    /// Halves of the intervals of the source's resistance, mass and stiffness.
    fn source_tolerance(&self) -> Option<Impedance> {
        let source = self.marked.near.drive.as_ref()?.source?;
        let (mut mean, mut square) = ([0.0; 3], [0.0; 3]);
        for sample in &self.samples.samples {
            let impedance = self.marked.near.drive_at(&sample.at).impedance;
            for i in 0..impedance.len() {
                mean[i] += sample.share * impedance[i];
                square[i] += sample.share * impedance[i] * impedance[i];
            }
        }
        let half = |i: usize| INTERVAL * (square[i] - mean[i] * mean[i]).max(0.0).sqrt();
        Some(source.with([0, 1, 2].map(half)).impedance)
    }

    fn touched(&self, priors: &Priors, edge_tolerance_m: f64) -> Result<Touched, CalibrateError> {
        let near = &self.marked.near;
        let nominal = near.nominal.spec();
        let speed = self.interval(SPEED, near.deviations[SPEED]);
        let threshold = self.interval(THRESHOLD, THRESHOLD_KNOWN);
        let mut spec = near.spec_at(&self.at);
        spec.wave_speed_tolerance =
            self.half(SPEED, near.deviations[SPEED]).min(limits::WAVE_SPEED_TOLERANCE.high);
        let loss = self.half(LOSS, near.deviations[LOSS]).exp() - 1.0;
        spec.loss_tolerance = Some(loss.min(limits::LOSS_TOLERANCE.high));
        let edge_give_m = self.half(EDGE_GIVE, near.deviations[EDGE_GIVE]);
        spec.edge_give_tolerance_m = Some(edge_give_m.min(limits::EDGE_GIVE_TOLERANCE.high));
        // A drive as stated keeps the measured levels of the calibration before.
        let before = nominal.calibration.as_ref().filter(|_| near.drive.is_none());
        spec.calibration = Some(Calibration {
            chi2_per_n: self.chi2_per_n,
            half_width_tolerance: self.half(HALF_WIDTH, priors.half_width).min(1.0),
            taper_tolerance: self.half(TAPER, priors.taper).min(1.0),
            level_tolerance_db: before.and_then(|it| it.level_tolerance_db),
            source_tolerance: self.source_tolerance().or_else(|| before.and_then(|it| it.source_tolerance)),
            correction: before.and_then(|it| it.correction.clone()),
        });
        let name = numbers(nominal)[SPEED].0;
        let mut beside = self.at;
        let [value, low, high] = speed.map(|speed| {
            beside[SPEED] = speed.ln() / near.deviations[SPEED];
            numbers(&near.plate_at(&beside))[SPEED].1
        });
        let of_plate = Parameter { name, value, low, high };
        let [value, low, high] = threshold.map(|threshold| threshold * near.feeling.threshold);
        let of_finger = Parameter { name: "feeling.threshold", value, low, high };
        Ok(Touched {
            plate: Plate::new(spec)?,
            feeling: with_threshold(&near.feeling, threshold[0]),
            speed,
            threshold,
            edge_tolerance_m,
            chi2_per_n: self.chi2_per_n,
            parameters: vec![of_plate, of_finger],
        })
    }
}

/// The feeling with its thresholds multiplied by `factor`.
fn with_threshold(feeling: &Feeling, factor: f64) -> Feeling {
    let mut feeling = *feeling;
    feeling.threshold *= factor;
    feeling.friction.scale_m *= factor;
    feeling
}
