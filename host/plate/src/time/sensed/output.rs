//! One output: the coefficients that make a sensor's signal of the resonators' states.

use super::lanes::in_lanes;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Responses below this fraction of the largest in the band get the same absolute accuracy.
const FAINTEST: f64 = 1e-6;
/// Weight of the frequencies beyond the exact band.
const BEYOND: f64 = 0.003;
/// Final weight of the frequencies above all fields, and the octaves over which it rises to that: a steep fall would
/// delay the band, or add a maximum before the fall.
const FALLING: (f64, f64) = (1e-3, 2.0);
/// Frequencies at which the plate holds its drive, Hz, and their weight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Held {
    pub(super) low_hz: f64,
    pub(super) high_hz: f64,
    pub(super) weight: f64,
}

impl Held {
    /// No such frequencies.
    pub(super) const NOWHERE: Self = Self { low_hz: 0.0, high_hz: 0.0, weight: 0.0 };
}

/// Number of frequencies above all fields at which an output falls off.
const ABOVE: usize = 96;
/// Lowest of these frequencies over the end of the fields.
const FREE: f64 = 1.15;
/// Weight of the coefficients' own size against the error.
const RIDGE: f64 = 1e-10;

/// The signal Re(sum of c z) of the resonators' states z.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Output {
    pub(super) re: Vec<f64>,
    pub(super) im: Vec<f64>,
    pub(super) error: f64,
}

impl Output {
    /// The output with the amplitude per code of each goal at its frequency, Hz (in rising order). It must be exact
    /// between the frequencies `exact_hz`, and approximate where the drive is `held`. `advance` has the factors of
    /// the states per sample.
    ///
    /// Codes u = cos(theta n) give a state with the part g(theta) e^(-j theta n)/2 at this frequency, and its mirror
    /// image, so that the amplitude is (c g(theta) + c* g~(theta))/2 with g = 1/(1 - lambda e^(j theta)) and g~ the
    /// same with lambda*. It is linear in Re c and Im c. Each frequency counts relative to its own amplitude; above
    /// all goals the output must fall off, as behind the filter of an input. The remaining error in the exact band is
    /// [`Output::error`].
    pub(super) fn fit(
        mut goals: Vec<(f64, Complex64)>,
        exact_hz: (f64, f64),
        held: Held,
        advance: &[Complex64],
        sample_rate_hz: f64,
    ) -> Self {
        let is_exact = |hz: f64| hz >= exact_hz.0 && hz <= exact_hz.1;
        let inside = goals.iter().filter(|(hz, _)| is_exact(*hz));
        let largest = inside.map(|(_, goal)| goal.norm()).fold(0.0, f64::max);
        if !(largest > 0.0 && largest.is_finite()) {
            let silent = in_lanes(advance.iter().map(|_| 0.0));
            return Self { re: silent.clone(), im: silent, error: 0.0 };
        }
        let top_hz = goals.last().map_or(exact_hz.1, |(hz, _)| *hz);
        let octaves = (0.5 * sample_rate_hz / (FREE * top_hz)).log2().max(0.0);
        goals.extend((1..=ABOVE).map(|i| {
            let share = i as f64 / ABOVE as f64;
            (FREE * top_hz * (octaves * share).exp2(), Complex64::ZERO)
        }));
        let weight = |hz: f64, goal: Complex64| {
            if hz >= held.low_hz && hz <= held.high_hz {
                held.weight / goal.norm().max(FAINTEST * largest)
            } else if is_exact(hz) {
                1.0 / goal.norm().max(FAINTEST * largest)
            } else if hz <= top_hz {
                BEYOND / goal.norm().max(largest)
            } else {
                FALLING.0 * ((hz / top_hz).log2() / FALLING.1).min(1.0) / largest
            }
        };
        let (rows, columns) = (2 * goals.len(), 2 * advance.len());
        let mut basis = DMatrix::<f64>::zeros(rows + columns, columns);
        let mut data = DVector::<f64>::zeros(rows + columns);
        for (k, &(hz, goal)) in goals.iter().enumerate() {
            let turn = Complex64::cis(TAU * hz / sample_rate_hz);
            let weight = weight(hz, goal);
            for (i, lambda) in advance.iter().enumerate() {
                let (g, mirrored) = ((1.0 - lambda * turn).inv(), (1.0 - lambda.conj() * turn).inv());
                let of_re = 0.5 * weight * (g + mirrored);
                let of_im = 0.5 * weight * Complex64::I * (g - mirrored);
                basis[(2 * k, 2 * i)] = of_re.re;
                basis[(2 * k + 1, 2 * i)] = of_re.im;
                basis[(2 * k, 2 * i + 1)] = of_im.re;
                basis[(2 * k + 1, 2 * i + 1)] = of_im.im;
            }
            data[2 * k] = weight * goal.re;
            data[2 * k + 1] = weight * goal.im;
        }
        let size: Vec<f64> =
            basis.column_iter().map(|it| it.norm()).map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        for (column, size) in size.iter().enumerate() {
            basis.column_mut(column).unscale_mut(*size);
            basis[(rows + column, column)] = RIDGE;
        }
        let solver = basis.clone().qr();
        let mut solved = data.clone();
        solver.q_tr_mul(&mut solved);
        let mut solution = solved.rows(0, columns).into_owned();
        // The ridge keeps every pivot above zero, so a solution exists.
        solver.r().solve_upper_triangular_mut(&mut solution);
        let left = basis * &solution - data;
        let errors = goals.iter().enumerate().filter(|(_, (hz, _))| is_exact(*hz));
        let error = errors.map(|(k, _)| left[2 * k].hypot(left[2 * k + 1])).fold(0.0, f64::max);
        let part = |first: usize| (0..advance.len()).map(move |i| 2 * i + first);
        let value = |i: usize| solution[i] / size[i];
        Self { re: in_lanes(part(0).map(value)), im: in_lanes(part(1).map(value)), error }
    }

    /// The steady amplitude per code at `frequency_hz`.
    pub(super) fn steady(&self, advance: &[Complex64], frequency_hz: f64, sample_rate_hz: f64) -> Complex64 {
        let turn = Complex64::cis(TAU * frequency_hz / sample_rate_hz);
        let terms = advance.iter().zip(self.re.iter().zip(&self.im)).map(|(lambda, (re, im))| {
            let c = Complex64::new(*re, *im);
            0.5 * (c / (1.0 - lambda * turn) + c.conj() / (1.0 - lambda.conj() * turn))
        });
        terms.sum()
    }

    /// Largest error over the exact band, relative to the response at the same frequency (or to 1e-6 of the largest
    /// response, where that is larger).
    pub fn error(&self) -> f64 {
        self.error
    }
}
