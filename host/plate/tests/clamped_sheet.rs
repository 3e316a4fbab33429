//! The clamped bending plate in two dimensions: the thin-plate equation on the tapered domain, without any width
//! mode, against the one-mode theory.
//!
//! w'''' (biharmonic) - kb^4 w = 0 is solved by Galerkin's method on the mapped domain x, zeta = z/W(x) with trial
//! functions that are clamped on both edges, (1 - zeta^2)^2 P(zeta), times Legendre polynomials along x.

use nalgebra::{DMatrix, DVector};
use slipline_plate::{
    Bending, DriveEnd, Equation, Model, Plate, PlateSpec, Taper, TurningWidth, plane, preset, respond,
};
use std::f64::consts::{PI, TAU};

const HALF_WIDTH_M: f64 = 0.02;
const RATE_PER_M: f64 = 4.62;
const LENGTH_M: f64 = 0.29;
const ALONG: usize = 84;
const ACROSS: usize = 4;

fn gauss(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..8 {
                let (p, before) = (legendre(x, count + 1)[count].0, legendre(x, count)[count - 1].0);
                slope = n * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Legendre polynomials with first and second derivatives.
fn legendre(x: f64, count: usize) -> Vec<(f64, f64, f64)> {
    let mut rows = vec![(1.0, 0.0, 0.0), (x, 1.0, 0.0)];
    for n in 1..count.saturating_sub(1) {
        let (k, now, before) = (n as f64, rows[n], rows[n - 1]);
        let value = ((2.0 * k + 1.0) * x * now.0 - k * before.0) / (k + 1.0);
        rows.push((value, before.1 + (2.0 * k + 1.0) * now.0, before.2 + (2.0 * k + 1.0) * now.1));
    }
    rows.truncate(count);
    rows
}

/// (1 - zeta^2)^2 P_{2j}(zeta) with derivatives: clamped at zeta = +-1, even.
fn across(zeta: f64) -> Vec<(f64, f64, f64)> {
    let b = 1.0 - zeta * zeta;
    let bubble = (b * b, -4.0 * zeta * b, -4.0 * b + 8.0 * zeta * zeta);
    let p = legendre(zeta, 2 * ACROSS);
    (0..ACROSS)
        .map(|j| {
            let q = p[2 * j];
            (
                bubble.0 * q.0,
                bubble.1 * q.0 + bubble.0 * q.1,
                bubble.2 * q.0 + 2.0 * bubble.1 * q.1 + bubble.0 * q.2,
            )
        })
        .collect()
}

/// |w| on the centre line at `places` for a driven end held to the shape of the first trial function.
fn centre_line(kb4: f64, places: &[f64]) -> Vec<f64> {
    let size = ALONG * ACROSS;
    let (mut bend, mut mass) = (DMatrix::<f64>::zeros(size, size), DMatrix::<f64>::zeros(size, size));
    let across_nodes: Vec<_> =
        gauss(20).into_iter().map(|(zeta, weight)| (zeta, weight, across(zeta))).collect();
    for (xi, weight_x) in gauss(2 * ALONG + 10) {
        let x = 0.5 * LENGTH_M * (xi + 1.0);
        let width = HALF_WIDTH_M * (-RATE_PER_M * x).exp();
        let scale = 2.0 / LENGTH_M;
        let along: Vec<_> =
            legendre(xi, ALONG).into_iter().map(|(a, b, c)| (a, b * scale, c * scale * scale)).collect();
        for (zeta, weight_z, shapes) in &across_nodes {
            let weight = weight_x * weight_z * 0.5 * LENGTH_M * width;
            let d = RATE_PER_M;
            let (mut laplace, mut value) = (DVector::zeros(size), DVector::zeros(size));
            for (i, a) in along.iter().enumerate() {
                for (j, y) in shapes.iter().enumerate() {
                    // w_xx + w_zz with zeta_x = d zeta, zeta_z = 1/W.
                    let (f_zz, f_z) = (a.0 * y.2, a.0 * y.1);
                    laplace[i * ACROSS + j] = a.2 * y.0
                        + 2.0 * d * zeta * a.1 * y.1
                        + d * d * zeta * zeta * f_zz
                        + d * d * zeta * f_z
                        + f_zz / (width * width);
                    value[i * ACROSS + j] = a.0 * y.0;
                }
            }
            bend.ger(weight, &laplace, &laplace, 1.0);
            mass.ger(weight, &value, &value, 1.0);
        }
    }
    // The held end by Lagrange multipliers: sum over i of P_i(-1) a_ij = 1 for j = 0, else 0.
    let mut system = DMatrix::zeros(size + ACROSS, size + ACROSS);
    system.view_mut((0, 0), (size, size)).copy_from(&(bend - mass * kb4));
    let unit = kb4 * LENGTH_M * HALF_WIDTH_M;
    for i in 0..ALONG {
        let end = if i % 2 == 0 { unit } else { -unit };
        for j in 0..ACROSS {
            system[(i * ACROSS + j, size + j)] = end;
            system[(size + j, i * ACROSS + j)] = end;
        }
    }
    let mut right = DVector::zeros(size + ACROSS);
    right[size] = unit;
    let solution = system.lu().solve(&right).expect("not exactly at a resonance");
    let middle = across(0.0);
    places
        .iter()
        .map(|x| {
            let along = legendre(2.0 * x / LENGTH_M - 1.0, ALONG);
            let mut sum = 0.0;
            for (i, a) in along.iter().enumerate() {
                for (j, y) in middle.iter().enumerate() {
                    sum += solution[i * ACROSS + j] * a.0 * y.0;
                }
            }
            sum.abs()
        })
        .collect()
}

#[test]
fn the_clamped_taper_at_40_khz_peaks_where_the_one_mode_theory_says() {
    let bending = Bending {
        youngs_modulus_pa: 70e9,
        poisson_ratio: 0.33,
        density_kg_per_m3: 2700.0,
        thickness_m: 0.002,
        thick_plate: false,
    };
    let plate = Plate::new(PlateSpec {
        name: "clamped".to_owned(),
        taper: Taper::Exponential { half_width_m: HALF_WIDTH_M, rate_per_m: RATE_PER_M },
        length_m: LENGTH_M,
        model: Model::BendingClamped(bending.clone()),
        loss_factor: 0.0,
        turning_width: TurningWidth::Plain,
        drive_end: DriveEnd::Displacement,
        full_scale_m: 1e-6,
        span_start_m: 0.05,
        span_end_m: 0.2,
        ..preset("membrane").expect("a preset").spec().clone()
    })
    .expect("a valid plate");
    let kb2 = bending.wavenumber_squared(TAU * 40e3);
    let places: Vec<f64> = (0..=600).map(|i| 0.165 + 0.06 * f64::from(i) / 600.0).collect();
    let line = centre_line(kb2 * kb2, &places);
    let top = (0..line.len()).max_by(|&a, &b| line[a].total_cmp(&line[b])).expect("places");
    let theory =
        respond(&plate, 40e3, 801, Equation::Corrected).expect("enters").peak.expect("a peak").position_m;
    println!("2-D peak {:.2} mm, one mode {:.2} mm", places[top] * 1e3, theory * 1e3);
    assert!((theory - places[top]).abs() < 3e-4, "one mode: {theory}");
    assert!((places[top] - 0.1807).abs() < 4e-4, "two dimensions: {}", places[top]);
    let own =
        plane::respond(&plate, 40e3, 801, &plane::Setup::of(&plate)).expect("enters").peak.expect("a peak");
    assert!((places[top] - own.position_m).abs() < 1e-4, "the crate's own: {}", own.position_m);
}
