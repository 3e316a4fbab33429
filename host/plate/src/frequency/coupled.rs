//! Several coupled width modes: a check of the one-mode equation.
//!
//! u(x, z) = sum g_n(x) phi_n, phi_n = W^(-1/2) cos(q_n z/W) with q_n = pi/2, 3 pi/2, .. solves
//! u_xx + u_zz + K^2 u = 0 with u = 0 on the edges when
//!
//! g'' + 2 A g' + B g + (K^2 - q^2/W^2) g = 0, A = (W'/W) a, B = (W'/W)' a - (W'/W)^2 d,
//!
//! a_mn = <phi_m, d phi_n/d ln W>, d_mn = <d phi_m/d ln W, d phi_n/d ln W>. The only approximation is the finite number
//! of modes. The one-mode equation neglects a and d. Bending with supported edges has the same equation with K = kb if
//! its evanescent wave is neglected.

use crate::definition::model::Model;
use crate::definition::plate::Plate;
use crate::frequency::driven_end::DrivenEnd;
use crate::frequency::error::RespondError;
use crate::frequency::respond::{POINTS_MIN, check_frequency};
use crate::quantity::OutOfRange;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::PI;

/// Largest number of coupled modes.
pub const COUPLED_MODES_MAX: usize = 8;
/// Largest number of points of a coupled solution; the work is proportional to it and to the cube of the number of
/// modes.
pub const COUPLED_POINTS_MAX: usize = 20_001;

/// Steady amplitudes of several coupled width modes.
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledResponse {
    /// Positions, metres: uniform from 0 to the plate's end.
    pub position_m: Vec<f64>,
    /// Amplitude of each mode (1, 3, 5, ..) on the centre line at each position, relative to the drive.
    pub modes: Vec<Vec<Complex64>>,
}

impl CoupledResponse {
    /// Displacement on the centre line at each position: the sum of all modes.
    pub fn centre_line(&self) -> Vec<Complex64> {
        (0..self.position_m.len()).map(|i| self.modes.iter().map(|mode| mode[i]).sum()).collect()
    }
}

/// Solves for the first `modes` (1 to 8) symmetric width modes together, on `points` (8 to 20 001) uniform points from
/// 0 to the plate's end. The drive has the shape of the first mode.
///
/// The error is of second order in the spacing of the points. A membrane in air has the wavenumber of its turning point all
/// along, without the law of the air along it. Returns `None` for clamped edges, whose modes are not
/// cosines, and for a thickness that changes.
///
/// # Errors
/// [`RespondError::OutOfRange`] for `points` or `modes`; [`RespondError::CannotEnter`] or [`RespondError::Frequency`]
/// for a frequency outside [`super::respond_range`].
pub fn respond_coupled(
    plate: &Plate,
    frequency_hz: f64,
    points: usize,
    modes: usize,
) -> Result<Option<CoupledResponse>, RespondError> {
    OutOfRange::check_count("points", points, POINTS_MIN..=COUPLED_POINTS_MAX)?;
    OutOfRange::check_count("modes", modes, 1..=COUPLED_MODES_MAX)?;
    check_frequency(plate, frequency_hz)?;
    if matches!(plate.spec().model, Model::BendingClamped(_)) || plate.is_graded() {
        return Ok(None);
    }
    Ok(Some(solve(plate, frequency_hz, points, modes)))
}

fn solve(plate: &Plate, frequency_hz: f64, points: usize, modes: usize) -> CoupledResponse {
    let step = plate.length_m() / (points - 1) as f64;
    let (a, d) = coupling(modes);
    let axial = plate.wavenumber_squared(frequency_hz) * plate.lossy(frequency_hz);
    let number: Vec<f64> = (0..modes).map(|n| PI * (n as f64 + 0.5)).collect();
    let complex = |matrix: &DMatrix<f64>, scale: f64| matrix.map(|value| Complex64::from(value * scale));
    // Coefficients of g[i-1] low + g[i] middle + g[i+1] high = 0 at one point.
    let rows = |i: usize| {
        let log = plate.width.at(i as f64 * step);
        let identity = DMatrix::<Complex64>::identity(modes, modes);
        let slope = complex(&a, log.slope * step);
        let mut middle =
            complex(&a, log.curvature * step * step) - complex(&d, log.slope * log.slope * step * step);
        for n in 0..modes {
            let barrier = (number[n] * (-log.value).exp()).powi(2);
            middle[(n, n)] += (axial - barrier) * (step * step) - 2.0;
        }
        (&identity - &slope, middle, identity + slope)
    };
    // From the plate's end toward the drive: g[i] = R[i] g[i-1]. Beyond the last point the modes decay independently.
    let last = points - 1;
    let end = plate.width.at(plate.length_m());
    let mut ratio = DMatrix::<Complex64>::zeros(modes, modes);
    for n in 0..modes {
        let decay = ((number[n] * (-end.value).exp()).powi(2) - axial).sqrt();
        ratio[(n, n)] = (-decay * step).exp();
    }
    let mut ratios = vec![ratio.clone(); points];
    for i in (1..=last).rev() {
        let (low, middle, high) = rows(i);
        let matrix = middle + high * &ratio;
        ratio = matrix.lu().solve(&(-low)).unwrap_or_else(|| DMatrix::zeros(modes, modes));
        ratios[i] = ratio.clone();
    }
    // At the driven end the first mode meets the condition of the plate's drive end; the others are zero.
    let root = |i: usize| (0.5 * (plate.width.at(0.0).value - plate.width.at(i as f64 * step).value)).exp();
    let mut start = DVector::<Complex64>::zeros(modes);
    start[0] = Complex64::ONE;
    let (first, second) = (&ratios[1] * &start, &ratios[2] * (&ratios[1] * &start));
    let f = [Complex64::ONE, first[0] * root(1), second[0] * root(2)];
    let slope = (-3.0 * f[0] + 4.0 * f[1] - f[2]) / (2.0 * step);
    let end = DrivenEnd::of(plate, frequency_hz);
    let scale = end.drive / (end.alpha * f[0] + end.beta * slope);
    let mut g = start * scale;
    let mut fields = vec![Vec::with_capacity(points); modes];
    for (i, ratio) in ratios.iter().enumerate() {
        if i > 0 {
            g = ratio * g;
        }
        for (field, value) in fields.iter_mut().zip(g.iter()) {
            field.push(value * root(i));
        }
    }
    CoupledResponse { position_m: (0..points).map(|i| i as f64 * step).collect(), modes: fields }
}

/// The matrices a and d by Simpson's rule over -1..1. The integrands are smooth: 2000 intervals leave only rounding
/// errors.
fn coupling(modes: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let intervals = 2000;
    let mut a = DMatrix::zeros(modes, modes);
    let mut d = DMatrix::zeros(modes, modes);
    for i in 0..=intervals {
        let zeta = -1.0 + 2.0 * f64::from(i) / f64::from(intervals);
        let simpson = if i == 0 || i == intervals { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        let weight = simpson * 2.0 / f64::from(intervals) / 3.0;
        let value = |n: usize| (PI * (n as f64 + 0.5) * zeta).cos();
        let change = |n: usize| {
            let q = PI * (n as f64 + 0.5);
            -0.5 * value(n) + q * zeta * (q * zeta).sin()
        };
        for m in 0..modes {
            for n in 0..modes {
                a[(m, n)] += weight * value(m) * change(n);
                d[(m, n)] += weight * change(m) * change(n);
            }
        }
    }
    (a, d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TurningWidth;
    use crate::definition::presets::preset;
    use crate::frequency::equation::Equation;
    use crate::frequency::respond::respond;

    #[test]
    fn the_coupling_of_different_modes_is_antisymmetric_and_of_a_mode_with_itself_none() {
        let (a, _) = coupling(6);
        for m in 0..6 {
            for n in 0..6 {
                assert!((a[(m, n)] + a[(n, m)]).abs() < 1e-6, "{m} {n}");
            }
        }
        assert!(a[(0, 1)].abs() > 0.1);
    }

    #[test]
    fn six_coupled_modes_confirm_the_gain_of_the_one_mode_equation_and_not_the_papers() {
        // The plain width: the arc moves the resonances of this end, and with them the gain near them, by 1 %.
        let plate = preset("al-bending-displacement").expect("a preset");
        let plate = plate.with_turning_width(TurningWidth::Plain);
        for frequency in [22e3, 31e3, 40e3] {
            let top = |field: &[Complex64]| field.iter().map(|f| f.norm()).fold(0.0, f64::max);
            let six = respond_coupled(&plate, frequency, 6001, 6).expect("enters").expect("cosines");
            let one = respond(&plate, frequency, 6001, Equation::Corrected).expect("enters");
            let paper = respond(&plate, frequency, 6001, Equation::Paper).expect("enters");
            let (six, one, paper) = (top(&six.modes[0]), top(&one.amplitude), top(&paper.amplitude));
            assert!((six / one - 1.0).abs() < 0.005, "{frequency}: {six} coupled, {one} alone");
            assert!(paper / six < 0.65, "{frequency}: {paper} by the paper's equation, {six} coupled");
        }
    }

    #[test]
    fn a_drive_of_the_first_shape_leaves_the_higher_modes_faint() {
        let plate = preset("membrane").expect("a preset");
        let response = respond_coupled(&plate, 150.0, 2001, 4).expect("enters").expect("cosines");
        let top = |field: &[Complex64]| field.iter().map(|f| f.norm()).fold(0.0, f64::max);
        assert!(top(&response.modes[1]) < 0.1 * top(&response.modes[0]), "{}", top(&response.modes[1]));
        assert!(top(&response.modes[1]) > 1e-4 * top(&response.modes[0]), "they are coupled");
        assert_eq!(response.centre_line().len(), 2001);
    }

    #[test]
    fn what_cannot_be_coupled_is_refused_or_left_out() {
        let plate = preset("membrane").expect("a preset");
        assert!(matches!(
            respond_coupled(&plate, 150.0, 2001, 0),
            Err(RespondError::OutOfRange(OutOfRange { field: "modes", .. }))
        ));
        assert!(matches!(
            respond_coupled(&plate, 150.0, 2, 3),
            Err(RespondError::OutOfRange(OutOfRange { field: "points", .. }))
        ));
        assert!(matches!(respond_coupled(&plate, 20.0, 2001, 3), Err(RespondError::CannotEnter { .. })));
        for frequency_hz in [f64::NAN, f64::INFINITY, -1.0, 1e6] {
            let refused = respond_coupled(&plate, frequency_hz, 2001, 3);
            assert!(matches!(refused, Err(RespondError::Frequency(_))), "{frequency_hz}: {refused:?}");
        }
        let mut spec = preset("al-bending-displacement").expect("a preset").spec().clone();
        spec.model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
        spec.span_end_m = 0.25;
        let clamped = Plate::new(spec).expect("a valid plate");
        assert_eq!(respond_coupled(&clamped, 30e3, 501, 3), Ok(None));
    }
}
