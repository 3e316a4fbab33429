//! The waves of a parallel strip: wavenumber, shape and impedance of its width modes, computed with the polynomials of
//! [`Section`].
//!
//! A wave w = p(z) e^(jkx) obeys (k^4 A + k^2 B + C) p = L M p with the forms of [`Section`] at W' = 0, where the level
//! L is K^4 in bending, K^2 (1 + s^2 K^2) in a film and K^2 otherwise; without bending A is zero. For a given k^2 this
//! is a symmetric eigenproblem. For a given frequency, k^2 of each mode is found by Newton's method, because the
//! derivative is known from the eigenvector.

use super::basis::Edges;
use super::section::{Energy, Section};
use crate::definition::log_width::LogWidth;
use crate::definition::model::Model;
use crate::definition::plate::Plate;
use crate::order;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Edges and energy of the sheet, and the [`Energy::level`] of its free wave at a frequency, without loss and with the
/// air.
pub(super) fn sheet(plate: &Plate, frequency_hz: f64) -> (Edges, Energy, f64) {
    let model = &plate.spec().model;
    let (edges, energy) = match (model, model.film(), model.film_square()) {
        (_, Some(film), Some(square)) => {
            (Edges::Clamped, Energy::Film { poisson_ratio: film.poisson_ratio, square })
        }
        (Model::Membrane { .. } | Model::ShearHorizontal { .. }, _, _) => (Edges::Supported, Energy::Tension),
        (Model::BendingSupported(bending), _, _) => {
            (Edges::Supported, Energy::Bending(bending.poisson_ratio))
        }
        (Model::BendingClamped(bending), _, _) => (Edges::Clamped, Energy::Bending(bending.poisson_ratio)),
    };
    (edges, energy, energy.level(plate.wavenumber_squared(frequency_hz)))
}

/// The numbers [q, r] of the first width mode at the driven end, for [`Section::new`].
pub(super) fn width_numbers(plate: &Plate) -> [f64; 2] {
    let number = plate.spec().model.width_number(1);
    plate.film_edge(0.0).map_or([number; 2], |edge| [edge.number, edge.outer])
}

/// The bending stiffness D in N m, or the tension per width in N/m (1 where the plate file does not state it).
///
/// Where shear and rotary inertia are included, D is the value at which a wave with Mindlin's K carries the true power:
/// rho h omega/(K^2 dK^2/d omega), which is D itself for a thin plate; omega is that of the same K in vacuum.
pub(super) fn modulus(plate: &Plate, frequency_hz: f64) -> f64 {
    let (model, width_mode) = (&plate.spec().model, plate.width_mode(1));
    let omega = TAU * plate.vacuum_frequency_hz(frequency_hz);
    let Ok(surface_density) = model.surface_density("an impedance") else { return 1.0 };
    if let Model::Membrane { tension_n_per_m: Some(tension), film: Some(_), .. } = model {
        return *tension;
    }
    match model.wave_speed_m_per_s() {
        Some(speed) => surface_density * speed * speed,
        None => {
            // The width mode's a K^2 and its derivative contain the factor a.
            let squares = width_mode.axial_squared(frequency_hz) * plate.axial_rise(frequency_hz);
            surface_density * omega * width_mode.slope.powi(2) / squares
        }
    }
}

/// One width mode of a strip at one frequency.
#[derive(Debug, Clone)]
pub(super) struct StripMode {
    /// k^2, 1/m^2; negative if the mode decays.
    pub(super) square: f64,
    /// Coefficients of the polynomials; 1 on the centre line.
    pub(super) shape: Vec<f64>,
    /// Derivative of the level (K^4 in bending) with respect to k^2.
    rise: f64,
    /// Integral of the shape's square over the width, metres.
    norm_m: f64,
}

impl StripMode {
    /// Impedance Z, N s/m, for a source that moves the mode at its centre line: a wave of amplitude A carries the power
    /// (1/2) Z omega^2 A^2.
    pub(super) fn impedance(&self, modulus: f64, omega: f64) -> f64 {
        // omega^2 = (modulus/surface density) x level, and Z = surface density x group speed x norm.
        modulus * self.rise * self.square.max(0.0).sqrt() * self.norm_m / omega
    }
}

/// Width mode `number` (0 is the first even one, 1 the second) of a strip of half-width W at this [`Energy::level`].
///
/// `None` if it decays faster than e^(-x/W).
pub(super) fn mode(section: &Section, log_half_width: f64, level: f64, number: usize) -> Option<StripMode> {
    let orders = section.orders;
    let width = log_half_width.exp();
    let mut form = section.form();
    section.fill(LogWidth { value: log_half_width, slope: 0.0, curvature: 0.0 }, &mut form);
    let matrix = |values: &[f64]| DMatrix::from_row_slice(orders, orders, values);
    let [[c, _, fb], [_, ss, _], [_, _, a]] =
        form.terms.each_ref().map(|row| row.each_ref().map(|t| matrix(t)));
    // f'' = -k^2 f and f' = jk f.
    let b = ss - &fb - fb.transpose();
    let mass = matrix(&section.mass) * width;
    let root = mass.cholesky()?;
    let inverse = root.l().try_inverse()?;
    let turned = |matrix: &DMatrix<f64>| &inverse * matrix * inverse.transpose();
    let (a, b, c) = (turned(&a), turned(&b), turned(&c));

    let slowest = -width.powi(-2);
    let start = section.energy.squared(level);
    let mut square = start;
    for _ in 0..60 {
        let eigen = (&a * (square * square) + &b * square + &c).symmetric_eigen();
        let mut ranked: Vec<usize> = (0..orders).collect();
        order::sort_by(&mut ranked, |&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
        let at = *ranked.get(number)?;
        let vector: DVector<f64> = eigen.eigenvectors.column(at).into();
        let rise = 2.0 * square * vector.dot(&(&a * &vector)) + vector.dot(&(&b * &vector));
        let step = (level - eigen.eigenvalues[at]) / rise;
        // The level is a convex function of k^2, so Newton's method from above does not overshoot.
        square += step;
        if square.is_nan() || square < slowest {
            return None;
        }
        // After so small a step the next one would be below rounding.
        if step.abs() <= 1e-8 * start {
            let raw = inverse.transpose() * vector;
            let centre: f64 = raw.iter().zip(section.values(0.0)).map(|(share, value)| share * value).sum();
            return Some(StripMode {
                square,
                shape: raw.iter().map(|share| share / centre).collect(),
                rise,
                norm_m: centre.powi(-2),
            });
        }
    }
    None
}

/// The wave impedance Z of the first width mode at x = 0, N s/m (per N/m of tension where the tension is not known); 0
/// below the cut-off. For clamped edges it follows from the exact dispersion relation.
///
/// It is Z of [`Plate::wave_impedance_n_s_per_m`], to which the ratio of a resistance in a plate file refers: the wave
/// has the wavenumber of the turning width and moves the whole half-width. For a film it is the resistance that matches
/// its end by the one-mode equation.
pub(super) fn wave_impedance(plate: &Plate, frequency_hz: f64) -> f64 {
    let (edges, energy, level) = sheet(plate, frequency_hz);
    if let Energy::Film { .. } = energy {
        return plate.matching_resistance_n_s_per_m(frequency_hz).unwrap_or(f64::NAN);
    }
    let section = Section::new(edges, energy, ORDERS_OF_A_MODE, width_numbers(plate));
    let turning_half_width_m = plate.turning_half_width_m(0.0);
    let moved = plate.half_width_m(0.0) / turning_half_width_m;
    mode(&section, turning_half_width_m.ln(), level, 0)
        .map_or(0.0, |mode| moved * mode.impedance(modulus(plate, frequency_hz), TAU * frequency_hz))
}

/// k^2 of the first width mode in a strip as wide as the plate at `x`, without loss, 1/m^2; `None` if it decays faster
/// than e^(-x/W).
pub(crate) fn wavenumber_squared(plate: &Plate, x: f64, frequency_hz: f64) -> Option<f64> {
    let (edges, energy, _) = sheet(plate, frequency_hz);
    let level = energy.level(plate.wavenumber_squared(frequency_hz) * plate.width_mode(1).local(x));
    let orders = ORDERS_OF_A_MODE + orders_of_edges(plate);
    let section = Section::new(edges, energy, orders, width_numbers(plate));
    mode(&section, plate.edges.at(x).value, level, 0).map(|mode| mode.square)
}

/// Number of polynomials for the first width mode alone.
const ORDERS_OF_A_MODE: usize = 7;
/// Additional polynomials over the square root of W/s for the edges of a film: the zeros of Legendre polynomials are
/// densest there.
const ORDERS_OF_EDGES: f64 = 2.0;

/// Number of additional polynomials that resolve the bending of a film at its edges.
pub(super) fn orders_of_edges(plate: &Plate) -> usize {
    let widths = plate.spec().model.film_square().map(|square| plate.half_width_m(0.0) / square.sqrt());
    widths.map_or(0, |widths| (ORDERS_OF_EDGES * widths.sqrt()).ceil() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::special::gauss::gauss;

    const W: f64 = 0.02;

    fn section(edges: Edges, orders: usize) -> Section {
        Section::new(edges, Energy::Bending(0.33), orders, [2.365_020_372_431_352; 2])
    }

    #[test]
    fn a_clamped_strip_obeys_the_exact_dispersion_relation() {
        // K over that of the cut-off, and k over that of the law near the cut-off, from the physics page.
        for (ratio, page) in [(1.005, 0.995), (1.05, 0.957), (1.22, 0.879), (1.41, 0.839), (2.0, 0.788)] {
            let (q, squared) = (2.365_020_372_431_352, (2.365_020_372_431_352 * ratio / W).powi(2));
            let found = mode(&section(Edges::Clamped, 9), W.ln(), squared * squared, 0).unwrap();
            let (inner, outer) = (W * W * (squared - found.square), W * W * (squared + found.square));
            let (p, r) = (inner.sqrt(), outer.sqrt());
            let residual = p * p.tan() + r * r.tanh();
            assert!(residual.abs() < 1e-4, "{ratio}: {residual}");
            let near_cut_off = 1.818_58 * (squared - (q / W).powi(2));
            assert!(((found.square / near_cut_off).sqrt() - page).abs() < 1.5e-3, "{ratio}");
        }
    }

    #[test]
    fn a_strip_whose_edges_turn_cuts_off_where_a_clamped_one_does_that_is_wider_by_their_compliance() {
        for compliance_m in [1e-5, 1e-4, 4e-4, 1e-3] {
            let section = section(Edges::Turning, 12).turning_by(compliance_m);
            // tan p + tanh p = -2 p c/W: the moment D w_zz at the edge turns it by w_z = -c w_zz.
            let residual = |p: f64| p.tan() + p.tanh() + 2.0 * p * compliance_m / W;
            let (mut low, mut high) = (1.6, 2.365_020_372_431_352);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if residual(middle) < 0.0 { low = middle } else { high = middle }
            }
            let at_cut_off = mode(&section, W.ln(), (low / W).powi(4), 0).unwrap();
            assert!(at_cut_off.square.abs() < 1e-5 * (low / W).powi(2), "{compliance_m}: {at_cut_off:?}");
            // That of a clamped strip of the half-width W + c, to the first order.
            let wider = 2.365_020_372_431_352 / (1.0 + compliance_m / W);
            let second = (compliance_m / W).powi(2);
            assert!((low / wider - 1.0).abs() < 3.0 * second, "{compliance_m}: {low} {wider}");
        }
    }

    #[test]
    fn a_strip_of_a_film_obeys_the_exact_dispersion_relation_and_carries_its_power() {
        let (edge_m, width_m): (f64, f64) = (2e-3, 0.02);
        let energy = Energy::Film { poisson_ratio: 0.38, square: edge_m * edge_m };
        let film = Section::new(Edges::Clamped, energy, 12, [1.7, 10.1]);
        // K over the cut-off of the membrane, well above that of the film.
        for ratio in [1.2, 1.5, 2.5] {
            let squared = (ratio * std::f64::consts::FRAC_PI_2 / width_m).powi(2);
            let at = |squared: f64| mode(&film, width_m.ln(), energy.level(squared), 0).unwrap();
            let found = at(squared);
            let (a, b) = ((squared - found.square).sqrt(), (squared + found.square + edge_m.powi(-2)).sqrt());
            let residual = a * (a * width_m).tan() / (b * (b * width_m).tanh()) + 1.0;
            assert!(residual.abs() < 2e-4, "{ratio}: {residual}");
            // T (1 + 2 s^2 K^2) W_f k/omega with the turning half-width W_f of the film.
            let k = found.square.sqrt();
            let turning_m = std::f64::consts::FRAC_PI_2 / a;
            let wanted = 10.0 * (1.0 + 2.0 * edge_m * edge_m * squared) * turning_m * k / 900.0;
            let impedance = found.impedance(10.0, 900.0);
            assert!((impedance / wanted - 1.0).abs() < 0.01, "{ratio}: {impedance} {wanted}");
        }
    }

    #[test]
    fn the_impedance_matches_the_power_flow() {
        let (squared, step, omega) = (300.0_f64.powi(2), 1e-4, 1e5);
        for edges in [Edges::Supported, Edges::Clamped] {
            let section = section(edges, 9);
            let at = |squared: f64| mode(&section, W.ln(), squared * squared, 0).unwrap();
            let k = |squared: f64| at(squared).square.sqrt();
            let (inner, outer) = (squared - at(squared).square, squared + at(squared).square);
            let (p, r) = (W * inner.sqrt(), W * outer.sqrt());
            let shape = |b: f64| match edges {
                Edges::Supported => (p * b).cos(),
                Edges::Clamped | Edges::Turning => (p * b).cos() - (r * b).cosh() / r.cosh() * p.cos(),
            };
            let square = |(b, weight): (f64, f64)| 2.0 * W * weight * (shape(b) / shape(0.0)).powi(2);
            let norm: f64 = gauss(30).into_iter().map(square).sum();
            // omega = a K^2 with a = sqrt(D/sigma): Z = sigma (d omega/d k) norm = (D/omega) K^2 (d(K^2)/d k) norm.
            let slope = 2.0 * step * squared / (k(squared * (1.0 + step)) - k(squared * (1.0 - step)));
            let wanted = 50.0 / omega * squared * slope * norm;
            let found = at(squared).impedance(50.0, omega);
            assert!((found / wanted - 1.0).abs() < 1e-5, "{edges:?}: {found} {wanted}");
        }
        // 2 W k sqrt(D sigma) between supported edges, D = 50, sigma = D K^4/omega^2.
        let exact =
            2.0 * W * (squared - (std::f64::consts::PI / (2.0 * W)).powi(2)).sqrt() * 50.0 * squared / omega;
        let found = mode(&section(Edges::Supported, 9), W.ln(), squared * squared, 0).unwrap();
        assert!((found.impedance(50.0, omega) / exact - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_impedance_of_an_end_is_the_one_that_a_plate_file_means() {
        // On al-sh the edges meet the driven end at 43 degrees, so arc and half-width differ by a fifth.
        for (name, hz) in [("membrane-heavy", 150.0), ("al-sh", 9e3), ("al-bending", 28e3)] {
            let mut spec = crate::preset(name).unwrap().spec().clone();
            if let Model::ShearHorizontal { thickness_m, .. } = &mut spec.model {
                *thickness_m = Some(2e-3);
            }
            let plate = Plate::new(spec).unwrap();
            let wanted = plate.wave_impedance_n_s_per_m(hz).unwrap();
            let found = wave_impedance(&plate, hz);
            assert!((found / wanted - 1.0).abs() < 1e-4, "{name}: {found} for {wanted}");
        }
    }

    #[test]
    fn an_evanescent_mode_is_left_out() {
        let section = section(Edges::Supported, 6);
        let squared: f64 = 1.3 * (std::f64::consts::PI / (2.0 * W)).powi(2);
        assert!(mode(&section, W.ln(), squared * squared, 0).is_some_and(|mode| mode.square > 0.0));
        assert!(mode(&section, W.ln(), squared * squared, 1).is_none());
    }
}
