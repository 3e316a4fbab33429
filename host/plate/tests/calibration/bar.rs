//! A membrane whose driven end is moved by a bar, by coupled width modes: u(x, z) = sum g_n(x) phi_n,
//! phi_n = W^(-1/2) cos(q_n z/W) with q_n = pi/2, 3 pi/2, .. solves u_xx + u_zz + K^2 u = 0 with u = 0 on the edges when
//!
//! g'' + 2 A g' + B g + (K^2 - q^2/W^2) g = 0, A = (W'/W) a, B = (W'/W)' a - (W'/W)^2 d,
//!
//! a_mn = <phi_m, d phi_n/d ln W>, d_mn = <d phi_m/d ln W, d phi_n/d ln W>. The only approximation is the finite number of
//! modes.
//!
//! The bar moves the whole width uniformly, so it excites all symmetric width modes: with
//! 1 = sum of c_n cos(q_n z/W), c_n = 2 sin(q_n)/q_n, the third mode has a third of the first mode's amplitude. The
//! chain before the bar is a common factor.

use nalgebra::{DMatrix, DVector};
use slipline_plate::{Complex64, EndSlope, Model, Plate, Taper, plane};
use std::f64::consts::{PI, TAU};

const MODES: usize = 5;
const INTERVALS: usize = 2000;

/// The centre line on `points` uniform places per unit displacement of the bar.
pub(crate) fn field(plate: &Plate, frequency_hz: f64, points: usize) -> Vec<Complex64> {
    let spec = plate.spec();
    let Model::Membrane { wave_speed_m_per_s, .. } = spec.model else { panic!("a membrane") };
    let axial = (TAU * frequency_hz / wave_speed_m_per_s).powi(2) * Complex64::new(1.0, spec.loss_factor);
    let step = plate.length_m() / (points - 1) as f64;
    let (a, d) = coupling();
    // W'/W and its derivative.
    let law = |x: f64| match spec.taper {
        Taper::Exponential { rate_per_m, .. } => (-rate_per_m, 0.0),
        Taper::Linear { half_width_m, end_half_width_m } => {
            let slope = (end_half_width_m - half_width_m) / plate.length_m() / plate.half_width_m(x);
            (slope, -slope * slope)
        }
        Taper::Sampled { .. } => panic!("a law"),
    };
    let barrier = |n: usize, x: f64| (PI * (n as f64 + 0.5) / plate.half_width_m(x)).powi(2);
    let complex = |matrix: &DMatrix<f64>, scale: f64| matrix.map(|value| Complex64::from(value * scale));
    // From the narrow end, beyond which the modes decay independently: g[i] = R[i] g[i - 1].
    let decay = |n: usize| (-(Complex64::from(barrier(n, plate.length_m())) - axial).sqrt() * step).exp();
    let mut ratios = vec![DMatrix::from_diagonal(&DVector::from_fn(MODES, |n, _| decay(n)))];
    for i in (1..points - 1).rev() {
        let x = i as f64 * step;
        let (slope, curvature) = law(x);
        let identity = DMatrix::<Complex64>::identity(MODES, MODES);
        let sided = complex(&a, slope * step);
        let mut middle = complex(&a, curvature * step * step) - complex(&d, (slope * step).powi(2));
        for n in 0..MODES {
            middle[(n, n)] += (axial - barrier(n, x)) * (step * step) - 2.0;
        }
        let matrix = middle + (&identity + &sided) * &ratios[ratios.len() - 1];
        ratios.push(matrix.lu().solve(&(sided - identity)).expect("regular"));
    }
    // phi_n = W^(-1/2) cos(q_n z/W).
    let width = |x: f64| plate.half_width_m(x).sqrt();
    let bar = |n: usize| {
        let q = PI * (n as f64 + 0.5);
        Complex64::from(2.0 * q.sin() / q * width(0.0))
    };
    let mut g = DVector::from_fn(MODES, |n, _| bar(n));
    let mut field = vec![g.sum() / width(0.0)];
    for (i, ratio) in ratios.iter().rev().enumerate() {
        g = ratio * g;
        field.push(g.sum() / width((i + 1) as f64 * step));
    }
    field
}

/// The integrals over the width of phi_m dphi_n/d ln W, and of the product of both derivatives, times W.
fn coupling() -> (DMatrix<f64>, DMatrix<f64>) {
    let (mut a, mut d) = (DMatrix::zeros(MODES, MODES), DMatrix::zeros(MODES, MODES));
    for i in 0..INTERVALS {
        let b = (i as f64 + 0.5) / INTERVALS as f64;
        let mode = |n: usize| {
            let q = PI * (n as f64 + 0.5);
            ((q * b).cos(), q * b * (q * b).sin() - 0.5 * (q * b).cos())
        };
        for m in 0..MODES {
            for n in 0..MODES {
                let ((value, change), (_, other)) = (mode(m), mode(n));
                a[(m, n)] += 2.0 * value * other / INTERVALS as f64;
                d[(m, n)] += 2.0 * change * other / INTERVALS as f64;
            }
        }
    }
    (a, d)
}

/// Far from the bar, its field is that of an end that moves in the shape of the first mode, as the plane solves it.
#[test]
fn far_from_the_bar_its_field_matches_the_first_mode() {
    let plate = slipline_plate::preset("membrane").expect("a preset");
    let at = |hz: f64, share: f64| {
        let (bar, first) = (field(&plate, hz, 1201), first_mode(&plate, hz));
        let i = (share * 1200.0) as usize;
        (bar[i] / first[i]).norm()
    };
    // 110 Hz: the third mode turns before the driven end, the first at 130 mm.
    let ratios = [0.2, 0.25, 0.33].map(|share| at(110.0, share));
    let middle = ratios[1];
    assert!(ratios.iter().all(|ratio| (ratio / middle - 1.0).abs() < 0.05), "{ratios:?}");
    assert!((at(110.0, 0.005) / middle - 1.0).abs() > 0.1, "the third mode is present near the bar");
}

#[cfg(test)]
fn first_mode(plate: &Plate, frequency_hz: f64) -> Vec<Complex64> {
    let setup = plane::Setup { end: plane::End::Displacement(EndSlope::Free), ..plane::Setup::of(plate) };
    plane::respond(plate, frequency_hz, 1201, &setup).expect("enters").amplitude
}
