//! Two touches: the wave speed and the threshold of feeling, from where a finger feels the edge.
//!
//! Without a sensor a person drags until the felt edge lies at a mark, twice or more. The felt edge at a frequency is
//! that of the plate's field with the told peak, see [`crate::feeling`]. Where it lies goes with the wave speed and with the
//! threshold over the true level: two unknowns, and two marks far apart tell them from each other. This gives places and no
//! levels.

use super::calibrated::{Parameter, numbers};
use super::error::CalibrateError;
use super::least_squares::{self, Problem, slope};
use super::refusal::{CHI2_PER_N_MAX, SPEED_MAX};
use super::unknowns::{OF_PLATE, Priors, SPEED, spec_at};
use crate::feeling::{Feeling, FeltEdge, FeltTone};
use crate::frequency::{Equation, Peak, respond_batch};
use crate::quantity::{OutOfRange, Range};
use crate::spec::{Calibration, DriveEnd, Plate, PlateSpec, limits};

/// Positions of a field. The edge lies between two of them.
const POINTS: usize = 601;
/// Standard deviation of the logarithm of the wave speed beforehand, at most: touches tell less than a sensor does.
const SPEED_KNOWN: f64 = 0.03;
/// Standard deviation of the logarithm of the threshold over the level, beforehand: fingers and sources differ.
const THRESHOLD: f64 = 1.5;
/// Wave speeds and thresholds at which the fit may start, as logarithms: `-at * step ..= at * step`.
const STARTS: [(i32, f64); 2] = [(6, 0.015), (6, 0.4)];
/// Ways over which derivatives are taken: so long that an edge moves by some micrometres.
const STEPS: [f64; 2] = [1e-4, 1e-3];
/// Least distance of the nearest and the farthest mark, in standard deviations of a mark.
const MARKS_APART: f64 = 10.0;

/// A felt edge at a mark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Where the edge is felt, metres from the driven end.
    pub mark_m: f64,
    /// Standard deviation of that, metres (1e-5 to 0.05); 0.002 for a fingertip.
    pub tolerance_m: f64,
    /// The tone's frequency, Hz.
    pub frequency_hz: f64,
}

/// What touches tell.
#[derive(Debug, Clone, PartialEq)]
pub struct Touched {
    /// The plate with the wave speed that puts the edges at their marks. Its levels are those of the file.
    pub plate: Plate,
    /// The feeling with the threshold that does.
    pub feeling: Feeling,
    /// Wave speed over the file's: value and the ends of its 95 % interval.
    pub speed: [f64; 3],
    /// Threshold over the level, over what was told of both: value and the ends of its 95 % interval.
    pub threshold: [f64; 3],
    /// Sum of the squared residuals over their number.
    pub chi2_per_n: f64,
    /// Both with their names in the plate file and in the feeling.
    pub parameters: Vec<Parameter>,
}

/// Calibrates the places of `plate` by felt edges of single tones whose peak is `peak_m` as the table tells it.
///
/// # Errors
/// [`CalibrateError`]: a number out of range, fewer than two marks or marks too close, or edges that no wave speed and
/// threshold give.
pub fn from_touches(
    plate: &Plate,
    touches: &[Touch],
    peak_m: f64,
    feeling: &Feeling,
    priors: &Priors,
) -> Result<Touched, CalibrateError> {
    priors.check()?;
    let feeling = feeling.checked()?;
    OutOfRange::check("peak_m", peak_m, Range::new(1e-12, 0.1, "m"))?;
    for touch in touches {
        OutOfRange::check("mark_m", touch.mark_m, Range::new(0.0, plate.length_m(), "m"))?;
        OutOfRange::check("tolerance_m", touch.tolerance_m, Range::new(1e-5, 0.05, "m"))?;
        OutOfRange::check("frequency_hz", touch.frequency_hz, limits::FREQUENCY)?;
    }
    check_marks(touches)?;
    let problem = Edges {
        nominal: plate.spec(),
        touches,
        peak_m,
        feeling,
        deviations: [priors.wave_speed.min(SPEED_KNOWN), THRESHOLD],
    };
    let start = problem.start().ok_or(CalibrateError::NoEdge)?;
    let fit = least_squares::fit(&problem, &start, 1e-4).ok_or(CalibrateError::NoEdge)?;
    let residuals = touches.len() as f64;
    let chi2_per_n = fit.chi2 / residuals;
    if chi2_per_n > CHI2_PER_N_MAX {
        return Err(CalibrateError::EdgesUnlike { chi2_per_n, most: CHI2_PER_N_MAX });
    }
    if fit.parameters[0].abs() > SPEED_MAX {
        return Err(CalibrateError::AnotherPlate { what: "wave speed", share: fit.parameters[0].exp() });
    }
    let half = |i: usize| 1.96 * chi2_per_n.max(1.0).sqrt() * fit.covariance[(i, i)].sqrt();
    let interval = |i: usize| [0.0, -half(i), half(i)].map(|way| (fit.parameters[i] + way).exp());
    let (speed, threshold) = (interval(0), interval(1));
    let name = numbers(plate.spec())[0].0;
    let [value, low, high] = speed.map(|speed| numbers(&problem.spec(speed.ln()))[0].1);
    let of_plate = Parameter { name, value, low, high };
    let [value, low, high] = threshold.map(|threshold| threshold * feeling.threshold);
    let of_finger = Parameter { name: "feeling.threshold", value, low, high };
    let mut spec = problem.spec(fit.parameters[0]);
    spec.wave_speed_tolerance = half(0).min(limits::WAVE_SPEED_TOLERANCE.high);
    spec.calibration = Some(Calibration {
        chi2_per_n,
        half_width_tolerance: (1.96 * priors.half_width).min(1.0),
        taper_tolerance: (1.96 * priors.taper).min(1.0),
        level_tolerance_db: None,
        source_tolerance: None,
        correction: None,
    });
    Ok(Touched {
        plate: Plate::new(spec)?,
        feeling: with_threshold(&feeling, fit.parameters[1]),
        speed,
        threshold,
        chi2_per_n,
        parameters: vec![of_plate, of_finger],
    })
}

fn check_marks(touches: &[Touch]) -> Result<(), CalibrateError> {
    let (mut near, mut far, mut tolerance_m) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for touch in touches {
        (near, far) = (near.min(touch.mark_m), far.max(touch.mark_m));
        tolerance_m = tolerance_m.max(touch.tolerance_m);
    }
    let apart_m = (far - near).max(0.0);
    let least_m = MARKS_APART * tolerance_m;
    if touches.len() < 2 || apart_m < least_m {
        return Err(CalibrateError::CloseMarks { count: touches.len(), apart_m, least_m });
    }
    Ok(())
}

/// The feeling whose thresholds are `exp(logarithm)` times as high.
fn with_threshold(feeling: &Feeling, logarithm: f64) -> Feeling {
    let mut feeling = *feeling;
    feeling.threshold *= logarithm.exp();
    feeling.friction.scale_m *= logarithm.exp();
    feeling
}

/// Wave speed and threshold, as logarithms over what was told.
struct Edges<'a> {
    nominal: &'a PlateSpec,
    touches: &'a [Touch],
    peak_m: f64,
    feeling: Feeling,
    deviations: [f64; 2],
}

impl Edges<'_> {
    fn spec(&self, speed: f64) -> PlateSpec {
        let mut coordinates = [0.0; OF_PLATE];
        coordinates[SPEED] = speed;
        spec_at(self.nominal, &coordinates)
    }

    /// The field of each touch with the told peak, as mean squares.
    fn squares(&self, plate: &Plate) -> Option<Vec<Vec<f64>>> {
        let frequencies_hz: Vec<f64> = self.touches.iter().map(|touch| touch.frequency_hz).collect();
        let fields = respond_batch(plate, &frequencies_hz, POINTS, Equation::Corrected).ok()?;
        let squares = fields.iter().zip(&frequencies_hz).map(|(field, &frequency_hz)| {
            let scale = self.peak_m / Peak::of(field, plate, frequency_hz)?.amplitude;
            Some(field.iter().map(|f| 0.5 * (f * scale).norm_sqr()).collect())
        });
        squares.collect()
    }

    /// The felt edges less their marks, over the marks' deviations, for thresholds of these logarithms; then what was
    /// known beforehand.
    fn at_thresholds(&self, speed: f64, thresholds: &[f64]) -> Option<Vec<Option<Vec<f64>>>> {
        let end = PlateSpec { drive_end: DriveEnd::Displacement, ..self.spec(speed) };
        let plate = Plate::new(end).ok()?;
        let squares = self.squares(&plate)?;
        let at = |&threshold: &f64| {
            let feeling = with_threshold(&self.feeling, threshold);
            let edge = |(touch, squares): (&Touch, &Vec<f64>)| {
                let tone = FeltTone { frequency_hz: touch.frequency_hz, squares };
                match Feeling::edge(&plate, &feeling.strength(&plate, &[tone])) {
                    FeltEdge::At(place_m) => Some((place_m - touch.mark_m) / touch.tolerance_m),
                    FeltEdge::PlateEnd | FeltEdge::Nowhere => None,
                }
            };
            let mut residuals: Vec<f64> =
                self.touches.iter().zip(&squares).map(edge).collect::<Option<_>>()?;
            residuals.extend([speed / self.deviations[0], threshold / self.deviations[1]]);
            Some(residuals)
        };
        Some(thresholds.iter().map(at).collect())
    }

    /// The best of a grid of starts.
    fn start(&self) -> Option<[f64; 2]> {
        let [speeds, thresholds] = STARTS
            .map(|(most, step)| -> Vec<f64> { (-most..=most).map(|at| f64::from(at) * step).collect() });
        let mut best: Option<(f64, [f64; 2])> = None;
        for &speed in &speeds {
            let Some(found) = self.at_thresholds(speed, &thresholds) else { continue };
            for (&threshold, residuals) in thresholds.iter().zip(found) {
                let chi2 = residuals.map(|residuals| residuals.iter().map(|r| r * r).sum::<f64>());
                if let Some(chi2) = chi2.filter(|chi2| best.is_none_or(|(least, _)| *chi2 < least)) {
                    best = Some((chi2, [speed, threshold]));
                }
            }
        }
        best.map(|(_, at)| at)
    }
}

impl Problem for Edges<'_> {
    fn residuals(&self, at: &[f64]) -> Option<Vec<f64>> {
        self.at_thresholds(at[0], &at[1..]).and_then(|found| found.into_iter().next().flatten())
    }

    fn slopes(&self, at: &[f64], _: &[f64]) -> Option<Vec<Vec<f64>>> {
        let column = |i: usize| {
            let side = |step: f64| {
                let mut beside = at.to_vec();
                beside[i] += step;
                self.residuals(&beside)
            };
            Some(slope(&side(STEPS[i])?, &side(-STEPS[i])?, 2.0 * STEPS[i]))
        };
        (0..STEPS.len()).map(column).collect()
    }
}
