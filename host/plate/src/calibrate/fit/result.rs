//! An accepted fit as a plate file, with intervals and parameters.

use super::acceptance;
use super::gain::{self, Carried};
use super::least_squares::Fit;
use super::source::source_file::FittedSource;
use super::spread::Spread;
use super::unknowns::{HALF_WIDTH, LOSS, OF_PLATE, TAPER, spec_at};
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::Measurement;
use crate::definition::{Calibration, Model, Plate, PlateSpec, Taper, limits};
use crate::quantity::show_length;

/// Standard deviations of a 95 % interval.
pub(crate) const INTERVAL: f64 = 1.96;

/// A calibrated number of the plate or of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name in the plate file: `model.wave_speed_m_per_s`; `place_m` for a sensor's.
    pub name: &'static str,
    /// The best value, in the unit of its name.
    pub value: f64,
    /// Ends of the 95 % interval.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// The result of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// The plate with the measured numbers, their intervals and, where levels were measured, the measured gain.
    pub plate: Plate,
    /// The fitted parameters: the plate's, then the sensors' places.
    pub parameters: Vec<Parameter>,
    /// Sum of the squared residuals over their number; about 1 where the model fits to the noise.
    pub chi2_per_n: f64,
    /// Half of the 95 % interval of the boundary, metres: the largest over the span.
    pub boundary_tolerance_m: f64,
    /// Largest boundary shift over the span per metre of sensor misplacement, one number for each sensor. The measurement itself
    /// does not distinguish a small misplacement from a plate of another width.
    pub boundary_per_place: Vec<f64>,
    /// Half of the 95 % interval of the level of the peak, dB, for nine tenths of the frequencies: by noise in the
    /// measured gain, and by the fit on the way to the peak. Infinite where no levels were measured.
    pub level_tolerance_db: f64,
}

impl Calibrated {
    /// A sentence for a person on what no measurement shows: the boundary shift by a misplaced sensor.
    /// `None` without a sensor.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        let most = self.boundary_per_place.iter().copied().max_by(f64::total_cmp)?;
        let moved = show_length(1e-3 * most);
        Some(format!(
            "A sensor that stands 1.0 mm from its mark moves the boundary by up to {moved}, and nothing here shows it: measure its place again."
        ))
    }
}

/// A fit that is accepted.
pub(crate) struct AcceptedFit<'a> {
    pub(crate) nominal: &'a Plate,
    /// The plate of the fitted numbers, without the record of the calibration.
    pub(crate) fitted: Plate,
    pub(crate) fit: &'a Fit,
    pub(crate) chi2_per_n: f64,
    /// Standard deviations of all coordinates beforehand.
    pub(crate) deviations: &'a [f64],
    /// The sensors on the plate, whose places follow the plate's coordinates; none for a current.
    pub(crate) sensors: &'a [&'a Measurement],
    /// The measurement whose unit and hold the levels have.
    pub(crate) levels: &'a Measurement,
    /// The source, where it was fitted.
    pub(crate) source: Option<FittedSource>,
    /// Lowest and highest frequency of the fit, Hz.
    pub(crate) measured_hz: (f64, f64),
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

    /// Logarithms of the gains; without a sensor their mean is not measured, and adds nothing to the spread.
    fn levels(&self, coordinates: &[f64]) -> Option<Vec<f64>> {
        let carried = (self.carried)(coordinates)?;
        let mut levels: Vec<f64> = carried.iter().map(|carried| carried.peak.ln()).collect();
        if self.sensors.is_empty() {
            let mean = levels.iter().sum::<f64>() / levels.len() as f64;
            levels.iter_mut().for_each(|level| *level -= mean);
        }
        Some(levels)
    }

    /// The plate file, its intervals and the parameters, if the data carry them.
    pub(crate) fn finish(self) -> Result<Calibrated, CalibrateError> {
        let Self { nominal, fitted, fit, sensors, .. } = &self;
        let levels = |at: &[f64]| self.levels(at);
        let spread = Spread::of(fitted, fit, self.deviations, sensors.len(), &levels);
        let spread = spread.ok_or(CalibrateError::NoFit)?;
        let mut carried = (self.carried)(&fit.parameters).ok_or(CalibrateError::NoFit)?;
        carried.retain(|carried| carried.peak > 0.0);
        let levels_of = self.source.as_ref().map(|_| *nominal);
        let (correction, noise_db) = gain::correction(fitted, levels_of, self.levels, &carried)?;
        let boundary_m = self.scale() * spread.boundary_m;
        let level_db = (self.scale() * spread.level_db).hypot(noise_db);
        acceptance::check_carried(nominal, sensors, (boundary_m, level_db))?;
        acceptance::check_band(fitted, self.measured_hz.0, self.measured_hz.1)?;

        let half = |i: usize| self.half(i);
        let mut spec = fitted.spec().clone();
        let speed = INTERVAL * self.scale() * spread.speed;
        spec.wave_speed_tolerance = speed.min(limits::WAVE_SPEED_TOLERANCE.high);
        let loss = half(LOSS).exp() - 1.0;
        spec.loss_tolerance = Some(loss.min(limits::LOSS_TOLERANCE.high));
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
        for (i, sensor) in (OF_PLATE..).zip(*sensors) {
            parameters.push(Parameter::about("place_m", sensor.place_m + fit.parameters[i], half(i)));
        }
        parameters.extend(self.source.iter().flat_map(|source| source.parameters(half)));
        Ok(Calibrated {
            plate: Plate::new(spec)?,
            parameters,
            chi2_per_n: self.chi2_per_n,
            boundary_tolerance_m: INTERVAL * boundary_m,
            boundary_per_place: spread.boundary_per_place,
            level_tolerance_db: INTERVAL * level_db,
        })
    }
}

impl Parameter {
    /// A parameter with half of its interval.
    pub(crate) const fn about(name: &'static str, value: f64, half: f64) -> Self {
        Self { name, value, low: value - half, high: value + half }
    }
}

/// The plate's numbers by their names in the file, each from the ends of its coordinate's interval.
fn parameters_of_plate(
    nominal: &PlateSpec,
    coordinates: &[f64],
    half: impl Fn(usize) -> f64,
) -> Vec<Parameter> {
    let best = numbers(&spec_at(nominal, coordinates));
    let at_end = |i: usize, side: f64| {
        let mut coordinates = coordinates.to_vec();
        coordinates[i] += side * half(i);
        numbers(&spec_at(nominal, &coordinates))[i].1
    };
    (0..OF_PLATE)
        .map(|i| {
            let (name, value) = best[i];
            let ends = [at_end(i, -1.0), at_end(i, 1.0)];
            Parameter { name, value, low: ends[0].min(ends[1]), high: ends[0].max(ends[1]) }
        })
        .collect()
}

/// The number that each coordinate moves, with its name in a plate file.
pub(crate) fn numbers(spec: &PlateSpec) -> [(&'static str, f64); OF_PLATE] {
    let speed = match &spec.model {
        Model::Membrane { wave_speed_m_per_s, .. } => ("model.wave_speed_m_per_s", *wave_speed_m_per_s),
        Model::ShearHorizontal { shear_modulus_pa, .. } => ("model.shear_modulus_pa", *shear_modulus_pa),
        Model::BendingSupported(bending) | Model::BendingClamped(bending) => {
            ("model.youngs_modulus_pa", bending.youngs_modulus_pa)
        }
    };
    let (taper, half_width_m) = match &spec.taper {
        Taper::Exponential { half_width_m, rate_per_m } => (("taper.rate_per_m", *rate_per_m), *half_width_m),
        Taper::Linear { half_width_m, end_half_width_m } => {
            (("taper.end_half_width_m", *end_half_width_m), *half_width_m)
        }
        Taper::Sampled { points } => {
            let width = |point: Option<&[f64; 2]>| point.map_or(f64::NAN, |point| point[1]);
            (("taper.points[last][1]", width(points.last())), width(points.first()))
        }
    };
    [speed, ("loss_factor", spec.loss_factor), taper, ("taper.half_width_m", half_width_m)]
}
