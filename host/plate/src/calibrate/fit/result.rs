//! An accepted fit as a plate file, with intervals and parameters.

use super::acceptance;
use super::gain::{Carried, Levels};
use super::least_squares::Fit;
use super::parameter::{INTERVAL, Parameter, parameters_of_plate};
use super::source::sensor_signal::END;
use super::source::source_file::FittedSource;
use super::spread::Spread;
use super::unknowns::{EDGE_GIVE, HALF_WIDTH, HELD, LOSS, TAPER, exponent_at, of_plate, spec_at};
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::Measurement;
use crate::definition::{Calibration, Plate, limits};
use crate::quantity::number_format::significant;
use crate::quantity::show_length;

/// The most that the model misses of a plate in two dimensions where nothing is wrong, and the most chi^2 per answer that noise
/// alone makes.
const MISFIT_USUAL: f64 = 0.03;
const CHI2_USUAL: f64 = 1.5;

/// The result of a calibration.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Calibrated {
    /// The plate with the measured numbers, their intervals and, where levels were measured, the measured gain.
    #[serde(with = "crate::exchange::by_text")]
    pub plate: Plate,
    /// The fitted parameters: the plate's, then the sensors' places.
    pub parameters: Vec<Parameter>,
    /// Sum of the squared residuals over their number; about 1 where the model fits to the noise.
    pub chi2_per_n: f64,
    /// What the model misses of the sensors' signals beyond their noise: the relative model error with which `chi2_per_n`
    /// would be 1, 0 where the noise explains all. 0.015 is assumed; plates in two dimensions show 0.01 to 0.03.
    pub misfit: f64,
    /// Half of the 95 % interval of the boundary, metres: the largest over the span.
    pub boundary_tolerance_m: f64,
    /// Largest boundary shift over the span per metre of sensor misplacement, one number for each sensor. The measurement itself
    /// does not distinguish a small misplacement from a plate of another width.
    pub boundary_per_place: Vec<f64>,
    /// Half of the 95 % interval of the level of the peak, dB, the largest over the span: by noise and model error in the
    /// measured gain, and by the fit on the way to the peak. Of an uncalibrated sensor it is that of the level over its mean
    /// over the span.
    pub level_tolerance_db: f64,
}

impl Calibrated {
    /// A sentence for a person on what the model misses, and what to do about it.
    #[must_use]
    pub fn misfit_note(&self) -> String {
        let percent = significant(100.0 * self.misfit, 2);
        if self.misfit == 0.0 {
            return "The noise explains all that the model misses: a higher level or a longer measurement gives narrower intervals.".to_owned();
        }
        if self.misfit <= MISFIT_USUAL || self.chi2_per_n <= CHI2_USUAL {
            return format!("The model misses {percent} % of the signals: no more than of other plates.");
        }
        format!(
            "The model misses {percent} % of the signals, more than of other plates: does anything touch the plate, does an edge yield, or does a sensor stand so near to the driven end that it sees other waves?"
        )
    }

    /// A sentence for a person on what no measurement shows: the boundary shift by a misplaced sensor.
    /// `None` without a sensor.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        let most = self.boundary_per_place.iter().copied().max_by(f64::total_cmp)?;
        let moved = show_length(1e-3 * most);
        Some(format!(
            "A sensor that stands 1.0 mm from its mark moves the boundary by up to {moved}, and this fit cannot tell: measure its place again."
        ))
    }
}

/// A fit that is accepted.
pub(crate) struct AcceptedFit<'a> {
    pub(crate) nominal: &'a Plate,
    pub(crate) fit: &'a Fit,
    pub(crate) chi2_per_n: f64,
    pub(crate) misfit: f64,
    /// Standard deviations of all coordinates beforehand.
    pub(crate) deviations: &'a [f64],
    /// The sensors on the plate, whose places follow the plate's coordinates; none for a current.
    pub(crate) sensors: &'a [&'a Measurement],
    /// The measurement whose unit and hold the levels have.
    pub(crate) levels: &'a Measurement,
    /// The source, where it was fitted.
    pub(crate) source: Option<FittedSource>,
    pub(crate) frequencies_hz: &'a [f64],
    /// The gains at given coordinates, carried to the peak.
    pub(crate) carried: &'a dyn Fn(&[f64]) -> Option<Vec<Carried>>,
}

impl AcceptedFit<'_> {
    /// Where the model misses more than the noise, the intervals grow with it.
    fn scale(&self) -> f64 {
        self.chi2_per_n.max(1.0).sqrt()
    }

    /// Half of the interval of a coordinate.
    fn half(&self, i: usize) -> f64 {
        INTERVAL * (self.scale() * self.fit.covariance[(i, i)].sqrt())
    }

    /// The plate file, its intervals and the parameters, if the data carry them.
    pub(crate) fn finish(self) -> Result<Calibrated, CalibrateError> {
        let Self { nominal, fit, sensors, .. } = self;
        let of_plate = of_plate(nominal.spec());
        let end = self.source.as_ref().and_then(|source| source.delay.map(|_| source.first + END));
        acceptance::check_coordinates(&fit.parameters, self.deviations, (of_plate, end), sensors)?;
        acceptance::check_air(nominal.spec(), &fit.parameters)?;
        // Without the record of the calibration.
        let spec = spec_at(nominal.spec(), &fit.parameters);
        let fitted = match &self.source {
            Some(source) => source.on(spec)?,
            None => Plate::new(spec)?,
        };
        let carried = (self.carried)(&fit.parameters).ok_or(CalibrateError::NoFit)?;
        let spread = Spread::of(&fitted, fit, self.deviations, sensors.len(), self.carried, &carried);
        let spread = spread.ok_or(CalibrateError::NoFit)?;
        let levels = Levels {
            plate: &fitted,
            nominal: self.source.as_ref().map(|_| nominal),
            sensor: self.levels,
            carried: &carried,
            slopes: &spread.slopes,
            fit,
            scale: self.scale(),
        };
        let (correction, level_db) = levels.correction()?;
        let boundary_m = self.scale() * spread.boundary_m;
        acceptance::check_carried(nominal, sensors, (boundary_m, level_db))?;
        acceptance::check_band(&fitted, self.frequencies_hz)?;
        if self.source.is_none() {
            let give_m = fitted.spec().edge_give_m.unwrap_or(0.0);
            let known_m = self.scale() * spread.of_known_edges_m;
            acceptance::check_clamped_edges(&fitted, (boundary_m, known_m), (give_m, self.half(EDGE_GIVE)))?;
        }

        let half = |i: usize| self.half(i);
        let mut spec = fitted.spec().clone();
        let speed = INTERVAL * self.scale() * spread.speed;
        spec.wave_speed_tolerance = speed.min(limits::WAVE_SPEED_TOLERANCE.high);
        let loss = half(LOSS).exp() - 1.0;
        spec.loss_tolerance = Some(loss.min(limits::LOSS_TOLERANCE.high));
        let edges_are_held = self.deviations[EDGE_GIVE] <= HELD;
        if !edges_are_held {
            spec.edge_give_tolerance_m = Some(half(EDGE_GIVE).min(limits::EDGE_GIVE_TOLERANCE.high));
        }
        if let Some(at) = exponent_at(nominal.spec()) {
            spec.loss_exponent_tolerance = Some(half(at).min(limits::LOSS_EXPONENT_TOLERANCE.high));
        }
        spec.calibration = Some(Calibration {
            chi2_per_n: self.chi2_per_n,
            half_width_tolerance: half(HALF_WIDTH).min(1.0),
            taper_tolerance: half(TAPER).min(1.0),
            level_tolerance_db: Some(INTERVAL * level_db)
                .filter(|db| limits::LEVEL_TOLERANCE_DB.contains(*db)),
            source_tolerance: self.source.as_ref().map(|source| source.tolerance(half)),
            correction: Some(correction),
        });
        let mut parameters = parameters_of_plate(nominal.spec(), &fit.parameters, half);
        if edges_are_held {
            parameters.remove(EDGE_GIVE);
        }
        for (i, sensor) in (of_plate..).zip(sensors) {
            parameters.push(Parameter::about("place_m", sensor.place_m + fit.parameters[i], half(i)));
        }
        parameters.extend(self.source.iter().flat_map(|source| source.parameters(half)));
        Ok(Calibrated {
            plate: Plate::new(spec)?,
            parameters,
            chi2_per_n: self.chi2_per_n,
            misfit: self.misfit,
            boundary_tolerance_m: INTERVAL * boundary_m,
            boundary_per_place: spread.boundary_per_place,
            level_tolerance_db: INTERVAL * level_db,
        })
    }
}
