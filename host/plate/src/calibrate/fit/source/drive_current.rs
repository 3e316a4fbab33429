//! Model of the drive current: coil or piezo on a voltage source, plate unloaded.
//!
//! The plate and the mechanical impedance Z_m = R + m sigma + s/sigma of the moving part answer the force with
//!
//! ```text
//! M = Z/(Z_m + Z_p) = Z sigma f(0)/(F_p + D f(0))
//! ```
//!
//! and the current over the code is, but for a factor and a short delay,
//!
//! ```text
//! coil:   1/(A (b0 + b1 sigma + t M))    resistance, inductance, (force per current)^2
//! piezo:    (b0 + b1 sigma + t M)/A      leakage,    capacitance, (force per voltage)^2
//! ```
//!
//! with A = 1 + a1 sigma + a2 sigma^2 of the actuator of the plate file, which stands for the amplifier. Without A, q = 1/I or I
//! obeys q (F_p + D f(0)) = (b0 + b1 sigma)(F_p + D f(0)) + t Z sigma f(0), linear in R, m, s, in b0 and b1 and in four
//! products, and A makes that thirteen: what a scan solves. With R, m, s and A known it is linear in b0, b1, t.

use super::data::Datum;
use super::sensor_signal::{IMPEDANCES, OF_ACTUATOR, OF_PLATE_SIZE, actuator, lag};
use super::source_model::SourceModel;
use crate::calibrate::fit::linear_least_squares::Columns;
use crate::calibrate::fit::response::plate_response::{PlateResponse, dynamic_stiffness};
use num_complex::Complex64;

/// Coordinates beside resistance, mass and stiffness.
const BLOCKED: usize = 3;
const RISE: usize = 4;
const COUPLING: usize = 5;
const DELAY: usize = 6;
/// a1, and a2 after it.
pub(crate) const ACTUATOR: usize = 7;
/// Coordinates of the source.
const COUNT: usize = 9;
/// Standard deviation of the delay beforehand, radians in the middle of the band: the device states its own.
const OF_DELAY: f64 = 0.1;
/// Relative error of an answer while the source is looked for.
const START_ERROR: f64 = 0.02;
/// Actuators to begin with: resonances in units, with a quality each; and none.
const RESONANCES: [f64; 5] = [0.5, 0.7, 1.0, 1.4, 2.0];
const QUALITIES: [f64; 3] = [0.8, 1.7, 4.0];
/// Starts from one plate.
const STARTS: usize = 3;

/// The transducer from voltage to force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transducer {
    /// A voice coil at a voltage: resistance and inductance, and the voltage that its motion induces.
    Coil,
    /// A piezo at a voltage: a capacitance, and the current that its motion makes.
    Piezo,
}

/// The model of a drive current.
pub(crate) struct DriveCurrent {
    pub(crate) transducer: Transducer,
}

impl DriveCurrent {
    /// 1/I of a coil, I of a piezo: what is linear in b0, b1 and t. And the other way round.
    fn linear(&self, response: Complex64) -> Complex64 {
        match self.transducer {
            Transducer::Coil => response.inv(),
            Transducer::Piezo => response,
        }
    }

    /// The impedance that the electrical side adds to the moving part where the voltage is given, in units; none for a
    /// piezo.
    pub(crate) fn damping(&self, source: &[f64], rate: Complex64) -> Complex64 {
        match self.transducer {
            Transducer::Coil => source[COUPLING] / (source[BLOCKED] + rate * source[RISE]),
            Transducer::Piezo => Complex64::ZERO,
        }
    }

    /// The force per code, in any unit.
    fn force(&self, source: &[f64], rate: Complex64) -> Complex64 {
        let per_voltage = match self.transducer {
            Transducer::Coil => (source[BLOCKED] + rate * source[RISE]).inv(),
            Transducer::Piezo => Complex64::ONE,
        };
        per_voltage / actuator(&source[ACTUATOR..], rate)
    }

    /// The peak per code on a plate with this answer, in any unit.
    pub(crate) fn peak(&self, answer: &PlateResponse, source: &[f64]) -> f64 {
        let mechanical = dynamic_stiffness([source[0], source[1], source[2]], answer.rate);
        let stiffness = mechanical + answer.rate * self.damping(source, answer.rate);
        let load = answer.force + stiffness * answer.motion;
        answer.peak * (self.force(source, answer.rate) / load).norm()
    }

    /// b0, b1, t for the R, m, s of `source`, and the sum of the squares that they leave.
    fn suit_electrics(&self, data: &[Datum], answers: &[PlateResponse], to: &mut [f64]) -> Option<f64> {
        let source = &*to;
        let weighed = |of: &dyn Fn(&PlateResponse) -> Complex64| {
            let each = |(datum, answer): (&Datum, &PlateResponse)| {
                let plain = self.linear(datum.response * actuator(&source[ACTUATOR..], answer.rate));
                of(answer) / (plain * datum.relative(START_ERROR))
            };
            data.iter().zip(answers).map(each).collect::<Vec<Complex64>>()
        };
        let impedance = [source[0], source[1], source[2]];
        let columns = Columns::new(vec![
            weighed(&|_| Complex64::ONE),
            weighed(&|answer| answer.rate),
            weighed(&|answer| motional(answer, impedance)),
        ])?;
        let wanted = data.iter().map(|datum| Complex64::from(datum.relative(START_ERROR).recip()));
        let (x, left) = columns.solve(&wanted.collect::<Vec<_>>());
        to[BLOCKED..=COUPLING].copy_from_slice(&x);
        x.iter().all(|x| x.is_finite()).then_some(left)
    }
}

/// Z/(Z_m + Z_p).
fn motional(answer: &PlateResponse, impedance: [f64; 3]) -> Complex64 {
    answer.rate * answer.motion / answer.load(impedance)
}

impl SourceModel for DriveCurrent {
    fn deviations(&self) -> Vec<f64> {
        let mut deviations = vec![f64::INFINITY; COUNT];
        deviations[..3].fill(OF_PLATE_SIZE);
        deviations[DELAY] = OF_DELAY;
        deviations[ACTUATOR..].fill(OF_ACTUATOR);
        deviations
    }

    fn response(&self, answer: &PlateResponse, _: usize, source: &[f64]) -> Complex64 {
        let motion = source[COUPLING] * motional(answer, [source[0], source[1], source[2]]);
        let electric = source[BLOCKED] + source[RISE] * answer.rate + motion;
        self.linear(electric) * lag(answer, source[DELAY]) / actuator(&source[ACTUATOR..], answer.rate)
    }

    const ALL: bool = true;

    fn suited(&self, data: &[Datum], answers: &[PlateResponse], model_error: f64) -> Option<f64> {
        let mut columns = vec![Vec::new(); 13];
        let mut wanted = Vec::with_capacity(data.len());
        for (datum, answer) in data.iter().zip(answers) {
            let q = self.linear(datum.response);
            let size = answer.force.norm().hypot(answer.motion.norm());
            let weight = (q.norm() * size * datum.relative(model_error)).recip();
            let (force, motion) = (answer.force * weight, answer.motion * weight);
            let power = |k: usize| answer.rate.powi(k as i32);
            // A is on the side of q for a piezo, on the other for a coil.
            let terms: [Complex64; 13] = match self.transducer {
                Transducer::Coil => std::array::from_fn(|k| match k {
                    0..3 => -q * motion * power(k),
                    3..7 => force * power(k - 3),
                    _ => motion * power(k - 7),
                }),
                Transducer::Piezo => std::array::from_fn(|k| match k {
                    0..5 => -q * motion * power(k),
                    5..7 => -q * force * power(k - 4),
                    7..9 => force * power(k - 7),
                    _ => motion * power(k - 9),
                }),
            };
            for (column, term) in columns.iter_mut().zip(terms) {
                column.push(term);
            }
            wanted.push(q * force);
        }
        Some(Columns::new(columns)?.solve(&wanted).1)
    }

    fn starts(&self, data: &[Datum], answers: &[PlateResponse]) -> Vec<Vec<f64>> {
        let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
        let resonators =
            RESONANCES.iter().flat_map(|f0| QUALITIES.map(|q| [(f0 * q).recip(), (f0 * f0).recip()]));
        for actuator in resonators.chain([[0.0, 0.0]]) {
            for impedance in IMPEDANCES {
                let mut source = vec![0.0; COUNT];
                source[..3].copy_from_slice(&impedance);
                source[ACTUATOR..].copy_from_slice(&actuator);
                let left = self.suit_electrics(data, answers, &mut source);
                found.extend(left.map(|left| (left, source)));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, source)| source).take(STARTS).collect()
    }
}
