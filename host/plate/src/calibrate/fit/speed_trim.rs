//! Tracking of a calibrated plate's wave speed, which temperature and tension change, and nothing else.
//!
//! At first one sensor measures as for a calibration. The widths and the place are those of the file, so speed, loss and
//! the source are found ([`super::one_sensor`]): what the speed is now, and a model M of the sensor's responses. Later a few
//! of the same tones suffice. Their phases against the first ones depend on the speed V e^d alone:
//!
//! ```text
//! arg H(f) - arg H0(f) = arg M(f; V e^d) - arg M(f; V)
//! ```
//! so that errors of M's phase and all delays cancel. The d of least squares is searched within 4 % (phases wrap); no result if
//! no d fits.

use super::acceptance::CHI2_PER_N_MAX;
use super::least_squares::minima;
use super::one_sensor::{check_source, fitted};
use super::pairs::{MODEL_ERROR, SAME};
use super::parameter::INTERVAL;
use super::response::plate_response::{Units, answers};
use super::response::sensor_body::weigh;
use super::response::wave::{FINE, points};
use super::result::Calibrated;
use super::source::data::{entering, of_deflection};
use super::source::sensor_signal::SensorSignal;
use super::source::source_model::SourceModel;
use super::unknowns::{Priors, SPEED, of_plate, spec_at, with_speed};
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::{MeasuredPoint, Measurement, SensorBody};
use crate::calibrate::measurement::signal;
use crate::definition::{Plate, limits};
use crate::order;
use num_complex::Complex64;

/// Prior deviation of the logarithm of the speed.
const SPEED_KNOWN: f64 = 0.03;
/// The knowledge of the loss, which depends on the temperature, too.
const LOSS_KNOWN: f64 = 0.3;
/// What is known of the widths over those of the file: they are those at which it was calibrated.
const WIDTHS_KNOWN: f64 = 1e-5;
/// The same of how far its edges give, metres.
const EDGE_GIVE_KNOWN_M: f64 = 1e-7;
/// The same of its air, which the calibration found.
const AIR_KNOWN: f64 = 1e-5;
/// Share of what a calibration leaves open of the widths that is left of the speed: their errors go together.
const OF_WIDTHS: f64 = 0.1;
/// Standard deviations by which a sensor may seem to stand beside its mark. More of it would be taken for another speed.
const ASIDE: f64 = 2.5;
/// How well a place is known at best, metres.
const PLACE_MIN_M: f64 = 2e-5;
/// Changes of the logarithm of the speed that are tried, to both sides, and the way between two of them.
const CHANGES: f64 = 0.04;
const CHANGE_STEP: f64 = 2.5e-4;
/// Halvings of that way.
const HALVINGS: usize = 10;
/// Fewest phases.
const PHASES_MIN: usize = 8;
/// A deviation of a phase, radians: a phase that is known worse is left out.
const BLURRED: f64 = 0.5;
/// Another change within this much chi^2 of the best is as good.
const AS_GOOD: f64 = 25.0;

/// What the wave speed is.
#[derive(Debug, Clone, PartialEq)]
pub struct Trimmed {
    /// The wave speed over the file's.
    pub share: f64,
    /// Ends of its 95 % interval.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// Sum of the squared residuals over their number; about 1 where one speed explains what was measured.
    pub chi2_per_n: f64,
    /// The plate of that speed, with the source and the gain that the first measurement found.
    pub plate: Plate,
}

/// The speed of one plate, from one sensor that stays in its place.
///
/// ```no_run
/// # use slipline_plate::calibrate::{Measurement, SpeedTrim};
/// # fn example(first: Measurement, later: Measurement) -> Result<(), Box<dyn std::error::Error>> {
/// # let calibrated = slipline_plate::preset("membrane").unwrap();
/// let trim = SpeedTrim::new(&calibrated, &first)?;
/// println!("{} times the speed of the file", trim.begin().share);
/// let now = trim.later(&later)?;
/// println!("now {} ({} to {})", now.share, now.low, now.high);
/// # Ok(()) }
/// ```
#[derive(Debug, Clone)]
pub struct SpeedTrim {
    plate: Plate,
    units: Units,
    /// The plate, the place and the source at the beginning.
    coordinates: Vec<f64>,
    first: Measurement,
    /// The plate with the source of the beginning.
    found: Calibrated,
    begin: Trimmed,
}

impl SpeedTrim {
    /// Refuses a plate that no measurement can trim.
    ///
    /// # Errors
    /// [`CalibrateError::NotCalibrated`] and [`CalibrateError::Plate`].
    pub fn check(plate: &Plate) -> Result<(), CalibrateError> {
        if plate.spec().calibration.is_none() {
            return Err(CalibrateError::NotCalibrated);
        }
        check_source(plate)
    }

    /// Begins with what one sensor measured of a calibrated plate, at as many frequencies as a calibration needs.
    ///
    /// # Errors
    /// [`CalibrateError::NotCalibrated`], and those of [`crate::calibrate::from_one_sensor`]: a sensor at another place
    /// than stated, a finger on the plate, another plate.
    pub fn new(plate: &Plate, first: &Measurement) -> Result<Self, CalibrateError> {
        let Some(calibration) = &plate.spec().calibration else { return Err(CalibrateError::NotCalibrated) };
        let priors = Priors {
            wave_speed: SPEED_KNOWN,
            loss: LOSS_KNOWN,
            taper: WIDTHS_KNOWN,
            half_width: WIDTHS_KNOWN,
            edge_give_m: Some(EDGE_GIVE_KNOWN_M),
            air: Some(AIR_KNOWN),
        };
        let (mut found, fit) = fitted(plate, first, &priors, false)?;
        // Its widths are known as well as before.
        let mut spec = found.plate.spec().clone();
        spec.edge_give_tolerance_m = plate.spec().edge_give_tolerance_m;
        if let Some(found) = &mut spec.calibration {
            found.half_width_tolerance = calibration.half_width_tolerance;
            found.taper_tolerance = calibration.taper_tolerance;
        }
        found.plate = Plate::new(spec)?;
        let aside_m = fit.parameters[of_plate(plate.spec())];
        if aside_m.abs() > ASIDE * first.place_tolerance_m.max(PLACE_MIN_M) {
            let place_m = first.place_m;
            return Err(CalibrateError::Misplaced { place_m, found_m: place_m + aside_m });
        }
        let points = entering(plate, first)?;
        let units = Units::of(plate, &points).ok_or(CalibrateError::NoFit)?;
        let of_edges =
            plate.spec().edge_give_tolerance_m.unwrap_or(0.0) / plate.half_width_m(plate.span_m().1);
        let of_cut = calibration.half_width_tolerance.hypot(calibration.taper_tolerance);
        let of_widths = OF_WIDTHS * of_cut.hypot(of_edges) / INTERVAL;
        let of_answers = fit.covariance[(SPEED, SPEED)].sqrt() * found.chi2_per_n.max(1.0).sqrt();
        let deviation = of_answers.hypot(of_widths);
        let (speed, chi2_per_n) = (fit.parameters[SPEED], found.chi2_per_n);
        let begin = trimmed(&found.plate, speed, 0.0, deviation, chi2_per_n)?;
        let first = first.clone();
        Ok(Self { plate: plate.clone(), units, coordinates: fit.parameters, first, found, begin })
    }

    /// The speed at the beginning.
    #[must_use]
    pub const fn begin(&self) -> &Trimmed {
        &self.begin
    }

    /// What no measurement shows: how far a sensor beside its mark took the boundary at the beginning.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        self.found.caution()
    }

    /// How far that is for each metre, at most over the span.
    #[must_use]
    pub fn boundary_per_place(&self) -> f64 {
        self.found.boundary_per_place.first().copied().unwrap_or(0.0)
    }

    /// The speed at a later measurement by the same sensor at the same place, at frequencies of the first one: eight and
    /// more, of which 16 over the band suffice.
    ///
    /// # Errors
    /// [`CalibrateError`]: too few frequencies, another sensor, nothing but noise, or phases that one speed does not explain.
    pub fn later(&self, later: &Measurement) -> Result<Trimmed, CalibrateError> {
        signal::check_sensor(&self.plate, later)?;
        let is_other = later.place_m != self.first.place_m
            || later.sensor != self.first.sensor
            || later.body() != self.first.body();
        if is_other {
            let (place_m, begin_m) = (later.place_m, self.first.place_m);
            return Err(CalibrateError::AnotherSensor { place_m, begin_m });
        }
        let phases = self.phases(later)?;
        let chi2 = |change: f64| self.chi2(&phases, change).unwrap_or(f64::INFINITY);
        let count = (2.0 * CHANGES / CHANGE_STEP).round() as usize;
        let change = |i: usize| -CHANGES + i as f64 * CHANGE_STEP;
        let along: Vec<f64> = (0..=count).map(|i| chi2(change(i))).collect();
        let mut valleys: Vec<(f64, f64)> = minima(&along).map(|(i, _)| bottom(&chi2, change(i))).collect();
        order::sort_by(&mut valleys, |a, b| a.1.total_cmp(&b.1));
        let Some(&(best, least)) = valleys.first() else { return Err(CalibrateError::NoFit) };
        let chi2_per_n = least / (phases.len() - 1) as f64;
        if chi2_per_n > CHI2_PER_N_MAX {
            return Err(CalibrateError::PhasesUnlike { chi2_per_n, most: CHI2_PER_N_MAX });
        }
        let speed = self.coordinates[SPEED];
        let as_good = |(_, chi2): &&(f64, f64)| *chi2 < least + AS_GOOD * chi2_per_n.max(1.0);
        if let Some((other, _)) = valleys.iter().skip(1).find(as_good) {
            let shares = [(speed + best).exp(), (speed + other).exp()];
            return Err(CalibrateError::Ambiguous { shares });
        }
        // chi^2 rises by 1 in one standard deviation.
        let rise = (chi2(best + CHANGE_STEP) + chi2(best - CHANGE_STEP) - 2.0 * least).max(1e-9);
        let of_phases = CHANGE_STEP * (2.0 / rise).sqrt() * chi2_per_n.max(1.0).sqrt();
        let of_begin = 0.5 * (self.begin.high / self.begin.low).ln() / INTERVAL;
        trimmed(&self.found.plate, speed + best, best, of_phases.hypot(of_begin), chi2_per_n)
    }

    /// The change of each tone's phase, with its variance, at the frequencies of both measurements.
    fn phases(&self, later: &Measurement) -> Result<Vec<Phase>, CalibrateError> {
        let mut found = Vec::new();
        let same =
            |a: &MeasuredPoint, b: &MeasuredPoint| (a.frequency_hz / b.frequency_hz - 1.0).abs() <= SAME;
        let first = entering(&self.plate, &self.first)?;
        let frequencies_hz: Vec<f64> = first.iter().map(|point| point.frequency_hz).collect();
        let model = self.model(&frequencies_hz, 0.0).ok_or(CalibrateError::NoFit)?;
        let data = of_deflection(&first, &self.first, self.units);
        let usual = (model.iter().map(Complex64::norm_sqr).sum::<f64>() / model.len() as f64).sqrt();
        for ((before, datum), model) in first.iter().zip(&data).zip(&model) {
            let Some(now) = later.points.iter().find(|now| same(now, before)) else { continue };
            // Beside a node the model misses a share of the wave, not of what is left of it.
            let missed = MODEL_ERROR * (usual / datum.response.norm()).max(1.0);
            let deviation = before.noise / before.response.norm();
            let deviation = deviation.hypot(now.noise / now.response.norm()).hypot(missed);
            if deviation < BLURRED {
                found.push(Phase {
                    frequency_hz: before.frequency_hz,
                    turned: Complex64::cis(now.response.arg() - before.response.arg() + model.arg()),
                    deviation,
                });
            }
        }
        if found.len() < PHASES_MIN {
            return Err(CalibrateError::FewFrequencies { count: found.len(), least: PHASES_MIN });
        }
        Ok(found)
    }

    fn chi2(&self, phases: &[Phase], change: f64) -> Option<f64> {
        let frequencies_hz: Vec<f64> = phases.iter().map(|phase| phase.frequency_hz).collect();
        let model = self.model(&frequencies_hz, change)?;
        let residual = |(phase, model): (&Phase, &Complex64)| {
            ((phase.turned * model.conj()).arg() / phase.deviation).powi(2)
        };
        Some(phases.iter().zip(&model).map(residual).sum())
    }

    /// What the sensor shows at these frequencies when the speed has changed by e^`change` since the beginning.
    fn model(&self, frequencies_hz: &[f64], change: f64) -> Option<Vec<Complex64>> {
        let mut coordinates = self.coordinates.clone();
        coordinates[SPEED] += change;
        let nominal = self.plate.spec();
        let spec = spec_at(nominal, &coordinates);
        let highest_hz = self.first.points.last()?.frequency_hz;
        let count = points(nominal, highest_hz, FINE);
        let of_plate = of_plate(nominal);
        let place_m = self.first.place_m + coordinates[of_plate];
        let mut answers =
            answers(&spec, count, self.units, self.first.sensor, &[place_m], frequencies_hz, false)?;
        let mut of_source = of_plate + 1;
        if let Some(body) = self.first.body() {
            let mass_kg = body.mass_kg * coordinates[of_source].exp();
            weigh(&mut answers, &spec, count, self.units, (SensorBody { mass_kg, ..body }, place_m))?;
            of_source += 1;
        }
        let source = SensorSignal::new(self.units, highest_hz);
        let seen = |answer| source.response(answer, 0, &coordinates[of_source..]);
        Some(answers.iter().map(seen).collect())
    }
}

/// A tone's phase now, and its standard deviation.
struct Phase {
    frequency_hz: f64,
    /// The model's phase at the beginning with the change since then, as a number of length 1.
    turned: Complex64,
    deviation: f64,
}

/// The lowest place of a valley about `middle`, and what is left there.
fn bottom(chi2: &impl Fn(f64) -> f64, mut middle: f64) -> (f64, f64) {
    let (mut here, mut way) = (chi2(middle), CHANGE_STEP);
    for _ in 0..HALVINGS {
        way *= 0.5;
        for side in [middle - way, middle + way] {
            let there = chi2(side);
            if there < here {
                (here, middle) = (there, side);
            }
        }
    }
    (middle, here)
}

/// The plate whose speed is `change` (a logarithm) beside that of `plate`, and `speed` beside that of the file.
fn trimmed(
    plate: &Plate,
    speed: f64,
    change: f64,
    deviation: f64,
    chi2_per_n: f64,
) -> Result<Trimmed, CalibrateError> {
    let half = INTERVAL * deviation;
    let mut spec = spec_at(plate.spec(), &with_speed(change, 0.0));
    spec.wave_speed_tolerance = (half.exp() - 1.0).min(limits::WAVE_SPEED_TOLERANCE.high);
    let [low, high] = [speed - half, speed + half].map(f64::exp);
    Ok(Trimmed { share: speed.exp(), low, high, chi2_per_n, plate: Plate::new(spec)? })
}
