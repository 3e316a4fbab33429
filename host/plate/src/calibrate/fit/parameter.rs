//! Calibrated numbers by their names in a plate file, with their intervals.

pub(crate) use super::unknowns::INTERVAL;
use super::unknowns::{exponent_at, of_air_count, spec_at};
use crate::definition::{Air, Model, PlateSpec, Taper};

/// A calibrated number of the plate or of a sensor.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Parameter {
    /// Its name in the plate file: `model.wave_speed_m_per_s`; `place_m` for a sensor's.
    #[serde(with = "crate::static_text")]
    pub name: crate::StaticText,
    /// The best value, in the unit of its name.
    pub value: f64,
    /// Ends of the 95 % interval.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Parameter {
    /// A parameter with half of its interval.
    pub(crate) const fn about(name: &'static str, value: f64, half: f64) -> Self {
        Self { name, value, low: value - half, high: value + half }
    }
}

/// The plate's numbers by their names in the file, each from the ends of its coordinate's interval.
pub(crate) fn parameters_of_plate(
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
    best.iter()
        .enumerate()
        .map(|(i, &(name, value))| {
            let ends = [at_end(i, -1.0), at_end(i, 1.0)];
            Parameter { name, value, low: ends[0].min(ends[1]), high: ends[0].max(ends[1]) }
        })
        .collect()
}

/// The number that each coordinate moves, with its name in a plate file.
pub(crate) fn numbers(spec: &PlateSpec) -> Vec<(&'static str, f64)> {
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
    let air = spec.air.as_ref().and_then(Air::mounting);
    let of_air = air
        .into_iter()
        .flat_map(|it| [("air.coefficient", it.coefficient().0), ("air.distant_share", it.distant())]);
    let edge_give = ("edge_give_m", spec.edge_give_m.unwrap_or(0.0));
    let half_width = ("taper.half_width_m", half_width_m);
    let of_all = [speed, ("loss_factor", spec.loss_factor), taper, half_width, edge_give];
    let exponent = exponent_at(spec).map(|_| ("loss_exponent", spec.loss_exponent.unwrap_or(0.0)));
    of_all.into_iter().chain(of_air.take(of_air_count(spec))).chain(exponent).collect()
}
