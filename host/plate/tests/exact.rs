//! The frequency-domain solver against the exact Bessel solution of the exponential taper.

use super::bessel::k_imaginary_scaled;
use slipline_plate::{
    Complex64, DriveEnd, Equation, Plate, TurningWidth, airy, preset, respond, respond_batch,
};
use std::f64::consts::{FRAC_PI_2, TAU};

fn k(nu: f64, s: f64) -> f64 {
    k_imaginary_scaled(Complex64::from(nu), s).re
}

/// nu, s at the peak, Airy's s at the peak, K(nu)/K(peak), ln(s at 10 %/s at the peak), first node.
const GOLDEN: [[f64; 6]; 7] = [
    [4.0, 2.775603613, 2.716401254, 0.61876553, 0.820102, 1.69540669],
    [5.0, 3.67043375, 3.617285167, 0.62500814, 0.709809, 2.42451286],
    [8.0, 6.425650716, 6.38276692, 0.63537447, 0.523459, 4.80239226],
    [10.0, 8.296819454, 8.257888475, 0.63923269, 0.452824, 6.4796836],
    [20.0, 17.83439188, 17.80507702, 0.64805357, 0.288081, 15.3428594],
    [50.0, 47.04174099, 47.0210312, 0.65483581, 0.157757, 43.4437136],
    [100.0, 96.26286611, 96.2467345, 0.65779235, 0.0997879, 91.6089208],
];

fn bisect(mut low: f64, mut high: f64, rises: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if rises(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn k_of_imaginary_order_has_its_golden_peaks_levels_and_nodes() {
    for [nu, peak, airy_peak, at_turning_point, tenth, node] in GOLDEN {
        let slope = |s: f64| {
            let h = 0.004 * nu.cbrt();
            (k(nu, s + 2.0 * h) - 8.0 * k(nu, s + h) + 8.0 * k(nu, s - h) - k(nu, s - 2.0 * h)) / (12.0 * h)
        };
        let found_peak = bisect(0.97 * peak, 1.03 * peak, slope);
        assert!((found_peak / peak - 1.0).abs() < 1e-9, "nu {nu}: peak {found_peak}");
        let top = k(nu, peak);
        assert!((k(nu, nu) / top - at_turning_point).abs() < 2e-8, "nu {nu}: {}", k(nu, nu) / top);
        let found_tenth = bisect(nu, 4.0 * nu, |s| 0.1 - k(nu, s) / top);
        assert!(((found_tenth / peak).ln() - tenth).abs() < 1e-6, "nu {nu}: {}", (found_tenth / peak).ln());
        let found_node = bisect(0.98 * node, 1.02 * node, |s| k(nu, s));
        assert!((found_node / node - 1.0).abs() < 3e-9, "nu {nu}: node {found_node}");
        // Airy's peak in the variable s: K_{i nu}(s) is proportional to Ai((s - nu)/(nu/2)^(1/3)).
        let airy = nu - airy::PEAK_OFFSET * (0.5 * nu).cbrt();
        assert!((airy / airy_peak - 1.0).abs() < 2e-8, "nu {nu}: Airy {airy}");
    }
}

#[test]
fn the_quadrature_solves_its_differential_equation() {
    // s^2 K'' + s K' + (nu^2 - s^2) K = 0, for real and for complex order.
    for nu in [Complex64::from(4.0), Complex64::from(60.0), Complex64::new(20.0, 0.4)] {
        for part in [0.4, 0.8, 1.0, 1.3] {
            let s = part * nu.re;
            let h = 2e-3 * s / nu.re.sqrt();
            let value = |i: f64| k_imaginary_scaled(nu, s + i * h);
            let second = (-value(-2.0) + 16.0 * value(-1.0) - 30.0 * value(0.0) + 16.0 * value(1.0)
                - value(2.0))
                / (12.0 * h * h);
            let first = (value(-2.0) - 8.0 * value(-1.0) + 8.0 * value(1.0) - value(2.0)) / (12.0 * h);
            let residual = second * (s * s) + first * s + (nu * nu - s * s) * value(0.0);
            let size = nu.norm_sqr() * k_imaginary_scaled(nu, 0.95 * nu.re).norm();
            assert!(residual.norm() / size < 1e-6, "nu {nu}, s {s}: {}", residual.norm() / size);
        }
    }
}

/// The exact amplitude on an exponential taper for the membrane, SH or supported model, at every `stride`-th of the
/// solver's points.
fn exact(plate: &Plate, frequency: f64, points: usize, stride: usize, equation: Equation) -> Vec<Complex64> {
    let spec = plate.spec();
    let d = -plate.narrowing_per_m(0.0);
    let half_width = plate.half_width_m(0.0);
    let lossy = Complex64::new(1.0, plate.wave_loss());
    let axial = spec.model.wavenumber_squared(TAU * frequency) * lossy;
    let quarter = if equation == Equation::Corrected { 0.25 } else { 0.0 };
    let nu = (axial / (d * d) - quarter).sqrt();
    let s = |x: f64| FRAC_PI_2 / (half_width * d) * (d * x).exp();
    let lift = |x: f64| if equation == Equation::Corrected { (0.5 * d * x).exp() } else { 1.0 };
    let f = |x: f64| k_imaginary_scaled(nu, s(x)) * lift(x);
    let h = 1e-4 * plate.length_m();
    let slope = (f(-2.0 * h) - 8.0 * f(-h) + 8.0 * f(h) - f(2.0 * h)) / (12.0 * h);
    let j = Complex64::I;
    let k0 = |f: f64| (spec.model.wavenumber_squared(TAU * f) - (FRAC_PI_2 / half_width).powi(2)).sqrt();
    let scale = match spec.drive_end {
        DriveEnd::Displacement => 1.0 / f(0.0),
        DriveEnd::DisplacementAndSlope { .. } | DriveEnd::Source(_) => unreachable!("no preset here has one"),
        DriveEnd::Force { at_frequency_hz } => -k0(at_frequency_hz) / slope,
        DriveEnd::Resistance { ratio, at_frequency_hz } => {
            let a = j * ratio * k0(at_frequency_hz) * frequency / at_frequency_hz;
            2.0 * a / (slope + a * f(0.0))
        }
    };
    (0..points)
        .step_by(stride)
        .map(|i| f(plate.length_m() * i as f64 / (points - 1) as f64) * scale)
        .collect()
}

fn worst(found: &[Complex64], stride: usize, exact: &[Complex64]) -> f64 {
    let top = exact.iter().map(|f| f.norm()).fold(0.0, f64::max);
    found.iter().step_by(stride).zip(exact).map(|(a, b)| (a - b).norm() / top).fold(0.0, f64::max)
}

fn with(plate: &Plate, loss: f64, end: DriveEnd) -> Plate {
    let mut spec = plate.spec().clone();
    spec.loss_factor = loss;
    spec.drive_end = end;
    spec.turning_width = TurningWidth::Plain;
    Plate::new(spec).expect("a valid variation")
}

#[test]
fn the_response_is_exact_to_1e_6_at_2000_points_with_and_without_loss_and_for_every_drive_end() {
    for (name, frequencies) in
        [("al-bending", vec![20e3, 40e3]), ("membrane", vec![104.0, 219.0]), ("al-sh", vec![20e3])]
    {
        let base = preset(name).expect("a preset");
        let middle = frequencies[0];
        let ends = [
            DriveEnd::Displacement,
            DriveEnd::Force { at_frequency_hz: middle },
            DriveEnd::Resistance { ratio: 0.7, at_frequency_hz: middle },
        ];
        for end in ends {
            for loss in [0.0, 0.002, 0.1] {
                let plate = with(&base, loss, end);
                for &frequency in &frequencies {
                    for equation in [Equation::Corrected, Equation::Paper] {
                        let found = respond(&plate, frequency, 2000, equation).expect("enters").amplitude;
                        let wanted = exact(&plate, frequency, 2000, 41, equation);
                        let error = worst(&found, 41, &wanted);
                        assert!(
                            error < 1e-6,
                            "{name} {end:?} loss {loss} {frequency} Hz {equation:?}: {error:.2e}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_bare_grid_converges_with_the_fourth_order() {
    let plate = with(&preset("al-bending").expect("a preset"), 0.01, DriveEnd::Displacement);
    let frequency = 30e3;
    let error = |points: usize| {
        let found = respond_batch(&plate, &[frequency], points, Equation::Corrected).expect("enters");
        let stride = (points - 1) / 50;
        worst(&found[0], stride, &exact(&plate, frequency, points, stride, Equation::Corrected))
    };
    let (coarse, middle, fine) = (error(301), error(601), error(1201));
    for ratio in [coarse / middle, middle / fine] {
        assert!(
            (ratio.log2() - 4.0).abs() < 0.25,
            "order {}: {coarse:.2e} {middle:.2e} {fine:.2e}",
            ratio.log2()
        );
    }
}
