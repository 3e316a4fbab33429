//! Model of a sensor's signal: source impedance, actuator, gain and delay.
//!
//! With the rate sigma = -j omega and the dynamic stiffness D = s + R sigma + m sigma^2 of the source
//!
//! ```text
//! H = G e^(j omega tau) (p(x) + (e p(0) - e' l p'(0)) t(x)) / (A (F_p + D f(0))),   A = 1 + a1 sigma + a2 sigma^2
//! ```
//!
//! with the third width mode's amplitude e at the driven end over the first one's, the share e' of what the taper makes of it there, and
//! its wave t(x) (`third_mode.rs`). A scan leaves it out,
//!
//! so that e^(j omega tau) p(x)/H is linear in the eight products c_k = [1, a1, a2]/G and b_k of A and D, which a scan
//! solves. With D known it is linear in (1, a1, a2)/G, with A known in (1, R, m, s)/G.

use super::data::Datum;
use super::source_model::SourceModel;
use super::third_mode::{OF_A_BAR, front_m};
use crate::calibrate::fit::linear_least_squares::Columns;
use crate::calibrate::fit::response::plate_response::{PlateResponse, Units};
use crate::calibrate::fit::unknowns::HELD;
use crate::definition::Plate;
use crate::order;
use num_complex::Complex64;

/// Coordinates after resistance, mass and stiffness: a1, a2, gain, delay, the place of the driven end, metres, and the third width
/// mode's amplitude there, over the first one's and over what the taper makes of it.
pub(crate) const RISE: usize = 3;
pub(crate) const CURVE: usize = 4;
pub(crate) const GAIN: usize = 5;
pub(crate) const DELAY: usize = 6;
pub(crate) const END: usize = 7;
const THIRD: usize = 8;
const FORCED: usize = 9;
/// Number of coordinates of the source.
const COUNT: usize = 10;
/// Prior standard deviations of resistance, mass and stiffness, in units of the plate.
pub(crate) const OF_PLATE_SIZE: f64 = 3.0;
/// Prior standard deviations of a1 and a2: no resonance below a third of the band's middle.
pub(crate) const OF_ACTUATOR: f64 = 10.0;
/// Range of the delays in a scan, in periods of the highest frequency, and their step.
const DELAYS: (f64, f64) = (-2.0, 12.0);
const DELAY_STEP: f64 = 0.08;
/// Fraction of the rms |p(x)| below which the place counts as a node of the trial wave.
const NODE: f64 = 0.15;
/// Relative error of a response during the scan for the source.
const START_ERROR: f64 = 0.05;
/// Initial resistances, masses and stiffnesses.
pub(crate) const IMPEDANCES: [[f64; 3]; 5] =
    [[0.3, 0.1, 0.1], [1.0, 0.1, 0.1], [1.0, 0.8, 0.2], [1.0, 0.2, 0.8], [2.5, 1.0, 1.0]];
/// Largest initial coordinate.
const LARGEST: f64 = 20.0;
/// Starting points for one plate.
const STARTS: usize = 2;
/// Rounds of alternating fits of D and A.
const ROUNDS: usize = 12;

/// The model of a sensor's responses.
pub(crate) struct SensorSignal {
    units: Units,
    highest_hz: f64,
    /// Standard deviation of the driven end from where the equation has it, metres.
    end_m: f64,
    /// Standard deviation of the third width mode's amplitude at the driven end over the first one's.
    third: f64,
    /// The same of what the taper makes of it there, over `forced_m` p'(0).
    forced: f64,
}

impl SensorSignal {
    /// Of an end that moves in the shape of the first width mode.
    pub(crate) const fn new(units: Units, highest_hz: f64) -> Self {
        Self { units, highest_hz, end_m: HELD, third: HELD, forced: HELD }
    }

    /// Of an end of `plate` that moves in any shape up to that of a bar.
    pub(crate) fn of_any_end(self, plate: &Plate) -> Self {
        Self { end_m: front_m(plate), third: OF_A_BAR, forced: 1.0, ..self }
    }

    /// p at the sensor with what the third width mode adds to it.
    pub(crate) fn seen(answer: &PlateResponse, place: usize, source: &[f64]) -> Complex64 {
        let third = answer.third.get(place);
        let third =
            third.map_or(Complex64::ZERO, |[moved, forced]| source[THIRD] * moved + source[FORCED] * forced);
        answer.seen[place] + third
    }

    /// The delays of a scan, in units.
    fn delays(&self) -> impl Iterator<Item = f64> + use<> {
        let period = self.units.omega / self.highest_hz;
        let count = ((DELAYS.1 - DELAYS.0) / DELAY_STEP) as usize;
        (0..=count).map(move |i| (DELAYS.0 + i as f64 * DELAY_STEP) * period)
    }
}

/// A = 1 + a1 sigma + a2 sigma^2, from a1 on.
pub(crate) fn actuator(a: &[f64], rate: Complex64) -> Complex64 {
    1.0 + rate * (a[0] + rate * a[1])
}

/// e^(j omega tau) with the delay in units.
pub(crate) fn lag(answer: &PlateResponse, delay: f64) -> Complex64 {
    // rate = -j omega.
    (-answer.rate * delay).exp()
}

impl SourceModel for SensorSignal {
    fn deviations(&self) -> Vec<f64> {
        let mut deviations = vec![OF_PLATE_SIZE; COUNT];
        (deviations[RISE], deviations[CURVE]) = (OF_ACTUATOR, OF_ACTUATOR);
        (deviations[GAIN], deviations[DELAY]) = (f64::INFINITY, f64::INFINITY);
        deviations[END] = self.end_m;
        (deviations[THIRD], deviations[FORCED]) = (self.third, self.forced);
        deviations
    }

    fn counts_third_mode(&self) -> bool {
        self.third > HELD
    }

    fn response(&self, answer: &PlateResponse, place: usize, source: &[f64]) -> Complex64 {
        let load = answer.load_of_end([source[0], source[1], source[2]], source[END]);
        source[GAIN] * lag(answer, source[DELAY]) * Self::seen(answer, place, source)
            / (load * actuator(&source[RISE..], answer.rate))
    }

    fn suited(&self, data: &[Datum], answers: &[PlateResponse], model_error: f64) -> Option<f64> {
        let weighed = Weighed::new(data, answers, model_error);
        let columns = weighed.columns::<8>(answers, |answer| {
            std::array::from_fn(|k| match k {
                0..3 => answer.force * answer.rate.powi(k as i32),
                _ => answer.motion * answer.rate.powi(k as i32 - 3),
            })
        })?;
        let left = |delay: f64| columns.solve(&weighed.delayed(answers, delay)).1;
        self.delays().map(left).min_by(f64::total_cmp)
    }

    fn starts(&self, data: &[Datum], answers: &[PlateResponse]) -> Vec<Vec<f64>> {
        let weighed = Weighed::new(data, answers, START_ERROR);
        let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
        for impedance in IMPEDANCES {
            let best = self.delays().filter_map(|delay| {
                let mut source = vec![0.0; COUNT];
                source[..3].copy_from_slice(&impedance);
                source[DELAY] = delay;
                let left = weighed.suit_actuator(answers, &mut source)?;
                // Too long a delay is fitted by an unstable actuator (negative a1 or a2): such a start is left out.
                (source[RISE] >= 0.0 && source[CURVE] >= 0.0).then_some((left, source))
            });
            let Some((mut left, mut source)) = best.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            for _ in 0..ROUNDS {
                let mut next = source.clone();
                let rest = weighed
                    .suit_impedance(answers, &mut next)
                    .and_then(|()| weighed.suit_actuator(answers, &mut next));
                match rest.filter(|rest| *rest < left) {
                    Some(rest) => (left, source) = (rest, next),
                    None => break,
                }
            }
            found.push((left, source));
        }
        order::sort_by(&mut found, |a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, source)| source).take(STARTS).collect()
    }
}

/// The equations of a scan, H A load/G = e^(j omega tau) p(x), with their weights: a response counts by its relative
/// error, and less where the trial wave has a node.
struct Weighed {
    /// p(x) times its weight.
    wanted: Vec<Complex64>,
    /// H times its weight.
    responses: Vec<Complex64>,
}

impl Weighed {
    fn new(data: &[Datum], answers: &[PlateResponse], model_error: f64) -> Self {
        let size = |answer: &PlateResponse| answer.force.norm().hypot(answer.motion.norm());
        let per_force = |answer: &PlateResponse| (answer.seen[0].norm() / size(answer)).powi(2);
        let usual = (answers.iter().map(per_force).sum::<f64>() / answers.len() as f64).sqrt();
        let weight = |(datum, answer): (&Datum, &PlateResponse)| {
            (datum.relative(model_error) * answer.seen[0].norm().max(NODE * usual * size(answer))).recip()
        };
        let weights: Vec<f64> = data.iter().zip(answers).map(weight).collect();
        let wanted = answers.iter().zip(&weights).map(|(answer, w)| answer.seen[0] * w).collect();
        let responses = data.iter().zip(&weights).map(|(datum, w)| datum.response * w).collect();
        Self { wanted, responses }
    }

    /// Equations with the columns `of` at each frequency.
    fn columns<const N: usize>(
        &self,
        answers: &[PlateResponse],
        of: impl Fn(&PlateResponse) -> [Complex64; N],
    ) -> Option<Columns> {
        let mut columns = vec![Vec::new(); N];
        for (answer, response) in answers.iter().zip(&self.responses) {
            for (column, value) in columns.iter_mut().zip(of(answer)) {
                column.push(value * response);
            }
        }
        Columns::new(columns)
    }

    /// Fits the impedance to the actuator of `source`.
    fn suit_impedance(&self, answers: &[PlateResponse], source: &mut [f64]) -> Option<()> {
        let columns = self.columns(answers, |answer| {
            let a = actuator(&source[RISE..], answer.rate);
            let moved = answer.motion * a;
            [answer.force * a, moved * answer.rate, moved * answer.rate * answer.rate, moved]
        })?;
        let (x, _) = columns.solve(&self.delayed(answers, source[DELAY]));
        for i in 0..3 {
            source[i] = (x[i + 1] / x[0]).clamp(0.0, LARGEST);
        }
        x.iter().all(|x| x.is_finite()).then_some(())
    }

    /// Fits the actuator and the gain to the impedance of `source`; returns the sum of the squared residuals.
    fn suit_actuator(&self, answers: &[PlateResponse], source: &mut [f64]) -> Option<f64> {
        let impedance = [source[0], source[1], source[2]];
        let columns = self.columns(answers, |answer| {
            let load = answer.load(impedance);
            [load, load * answer.rate, load * answer.rate * answer.rate]
        })?;
        let (x, left) = columns.solve(&self.delayed(answers, source[DELAY]));
        for i in 0..2 {
            source[RISE + i] = (x[i + 1] / x[0]).clamp(-LARGEST, LARGEST);
        }
        source[GAIN] = x[0].recip();
        x.iter().all(|x| x.is_finite() && *x != 0.0).then_some(left)
    }

    /// The right-hand side with a delay.
    fn delayed(&self, answers: &[PlateResponse], delay: f64) -> Vec<Complex64> {
        answers.iter().zip(&self.wanted).map(|(answer, wanted)| lag(answer, delay) * wanted).collect()
    }
}
