//! Random plates of every model, with every kind of driven end.

use slipline_plate::{
    Bending, DriveEnd, EndSlope, Impedance, LeadIn, Model, Plate, PlateSpec, Source, Taper, TurningWidth,
    preset,
};
use std::f64::consts::TAU;

/// The driven ends of membranes and shear waves, then those of bending.
const ENDS: [&[End]; 2] = [
    &[End::Displacement, End::Force, End::Resistance, End::Damper, End::Coil],
    &[
        End::Displacement,
        End::Force,
        End::Resistance,
        End::Slope(EndSlope::Free),
        End::Slope(EndSlope::Held),
        End::Coil,
        End::LeadIn,
    ],
];

/// A kind of driven end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    Displacement,
    Force,
    Resistance,
    /// A displacement with a condition for the slope.
    Slope(EndSlope),
    /// A source with a resistance alone.
    Damper,
    /// A source with resistance, mass and stiffness.
    Coil,
    /// A source with a lead-in.
    LeadIn,
}

/// Index of the model and kind of driven end of each plate, before they repeat: every model with each of its ends.
pub(crate) fn kinds() -> Vec<(usize, End)> {
    (0..4).flat_map(|model| ENDS[model / 2].iter().map(move |&end| (model, end))).collect()
}

/// Uniform numbers of a linear congruential generator (Knuth's MMIX).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn one_in(&mut self, count: f64) -> bool {
        self.between(0.0, count) < 1.0
    }
}

fn model(random: &mut Random, kind: usize) -> Model {
    let bending = |random: &mut Random| Bending {
        youngs_modulus_pa: 70e9,
        poisson_ratio: random.between(0.2, 0.4),
        density_kg_per_m3: 2700.0,
        thickness_m: random.log_between(5e-4, 4e-3),
        thick_plate: random.one_in(3.0),
    };
    match kind {
        0 => Model::Membrane {
            wave_speed_m_per_s: random.between(8.0, 20.0),
            tension_n_per_m: Some(random.log_between(40.0, 4000.0)),
            film: None,
        },
        1 => Model::ShearHorizontal {
            shear_modulus_pa: random.log_between(2e5, 2e6),
            density_kg_per_m3: 1000.0,
            thickness_m: Some(2e-3),
        },
        2 => Model::BendingSupported(bending(random)),
        _ => Model::BendingClamped(bending(random)),
    }
}

/// A taper of the half-width `half_width_m` at the drive and e^(-`exponents`) of it at the end: exponential, straight,
/// or with edges that bend inward or outward.
fn taper(random: &mut Random, number: usize, half_width_m: f64, exponents: f64, length_m: f64) -> Taper {
    match number % 4 {
        0 | 1 => Taper::Exponential { half_width_m, rate_per_m: exponents / length_m },
        2 => Taper::Linear { half_width_m, end_half_width_m: half_width_m * (-exponents).exp() },
        _ => {
            let bend = random.between(-0.6, 0.6);
            let point = |part: f64| {
                [part * length_m, half_width_m * (-exponents * (part + bend * part * (1.0 - part))).exp()]
            };
            Taper::Sampled { points: (0..=40).map(|i| point(f64::from(i) / 40.0)).collect() }
        }
    }
}

fn drive_end(random: &mut Random, plate: &Plate, end: End, at_frequency_hz: f64) -> Option<DriveEnd> {
    let impedance = plate.wave_impedance_n_s_per_m(at_frequency_hz)?;
    let omega = TAU * at_frequency_hz;
    let bends = plate.spec().model.bending().is_some();
    let soft = Source {
        impedance: Impedance::default(),
        at_frequency_hz,
        slope: bends.then_some(EndSlope::Free),
        lead_in: None,
    };
    Some(match end {
        End::Displacement => DriveEnd::Displacement,
        End::Force => DriveEnd::Force { at_frequency_hz },
        End::Resistance => DriveEnd::Resistance { ratio: random.log_between(0.5, 2.0), at_frequency_hz },
        End::Slope(slope) => DriveEnd::DisplacementAndSlope { slope },
        End::Damper => DriveEnd::Source(Source {
            impedance: Impedance::damper(random.log_between(0.7, 1.4) * impedance),
            ..soft
        }),
        End::Coil => DriveEnd::Source(Source {
            impedance: Impedance {
                resistance_n_s_per_m: random.log_between(0.2, 1.4) * impedance,
                mass_kg: random.between(0.0, 0.6) * impedance / omega,
                stiffness_n_per_m: random.between(0.0, 0.6) * impedance * omega,
            },
            slope: bends.then_some(if random.one_in(2.0) { EndSlope::Free } else { EndSlope::Held }),
            ..soft
        }),
        End::LeadIn => DriveEnd::Source(Source {
            lead_in: Some(LeadIn {
                length_m: random.between(3.0, 6.0) * plate.half_width_m(0.0),
                loss_factor: random.between(0.2, 0.4),
                end_resistance_n_s_per_m: 0.37 * impedance,
            }),
            ..soft
        }),
    })
}

/// A plate a few wavelengths long, whose edges converge slowly or fast; `None` if the numbers do not make a valid
/// plate.
pub(crate) fn plate(random: &mut Random, number: usize) -> Option<Plate> {
    let kinds = kinds();
    let (kind, end) = kinds[number % kinds.len()];
    let rate_per_m = random.between(3.0, 7.0);
    let slope = random.log_between(0.05, 2.5);
    let exponents = random.between(1.0, 1.6);
    let length_m = exponents / rate_per_m;
    let mut spec = PlateSpec {
        name: format!("plate {number}"),
        taper: taper(random, number, slope / rate_per_m, exponents, length_m),
        length_m,
        // The plain width has large errors on steep tapers, which its lights have to show.
        turning_width: if number % 2 == 1 { TurningWidth::Plain } else { TurningWidth::Arc },
        model: model(random, kind),
        loss_factor: random.log_between(0.002, 0.1),
        loss_tolerance: random.one_in(2.0).then(|| random.between(0.05, 1.0)),
        thickness: None,
        wave_speed_tolerance: 0.0,
        drive_end: DriveEnd::Displacement,
        actuator: None,
        harmonics: None,
        span_start_m: random.between(0.15, 0.5) * length_m,
        span_end_m: random.between(0.7, 0.95) * length_m,
        ..preset("membrane").expect("preset").spec().clone()
    };
    let still = Plate::new(spec.clone()).ok()?;
    let at_frequency_hz = still.frequency_for_boundary_hz(0.6 * length_m);
    spec.drive_end = drive_end(random, &still, end, at_frequency_hz)?;
    Plate::new(spec).ok()
}
