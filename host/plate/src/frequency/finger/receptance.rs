//! Receptance of the plate under a small body, for every driven end at once.
//!
//! A body of mass m that stands on the plate moves by w/(1 - omega^2 m G), with the bare plate's motion w and the
//! receptance G = (mean motion under its contact)/(force, spread evenly over the contact), m/N. With the solutions r, which
//! decays beyond the turning point, and u, which any condition at x = 0 determines,
//!
//! ```text
//! G = N/S - <r l>/(W S0),   l = u - rho r,   rho = load(u)/load(r)
//! ```
//!
//! where load(p) is the driven end's condition alpha p(0) + beta p'(0), W the Wronskian of u and r, <> the mean over two
//! places of the contact (r at the farther, l at the nearer one), and N the waves that decay around the contact. A driven
//! end enters through rho alone.

use super::Finger;
use super::contact::{BANDS, COLUMNS, Contact, means_across, strip_half_width};
use super::touch::interpolated;
use crate::definition::plate::Plate;
use crate::frequency::numerov::{self, Grid};
use num_complex::Complex64;

/// G = `held` - rho `returned` at one place, m/N.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Receptance {
    pub(crate) held: Complex64,
    pub(crate) returned: Complex64,
}

/// The same at several places, with what a driven end needs for rho.
#[derive(Debug, Clone)]
pub(crate) struct Receptances {
    pub(crate) places: Vec<Receptance>,
    /// Value and derivative (1/m) at x = 0 of u and of r.
    pub(crate) starts: [[Complex64; 2]; 2],
}

/// The receptances of `plate` at `frequency_hz` under square contacts of side `width_m` at `places_m`. The plate's driven
/// end determines u.
pub(crate) fn receptances(
    grid: &Grid,
    plate: &Plate,
    places_m: &[f64],
    width_m: f64,
    frequency_hz: f64,
) -> Receptances {
    let bodies: Vec<Finger> = places_m
        .iter()
        .map(|&place_m| Finger { place_m, resistance_n_s_per_m: 0.0, mass_kg: 0.0, contact_m: width_m })
        .collect();
    let to_m = bodies.iter().map(|body| body.reach(plate).1).fold(0.0, f64::max);
    let (_, solutions) = numerov::solve_with_both(grid, plate, frequency_hz, to_m);
    let step_m = solutions.step_m;
    let per_force = -(solutions.wronskian * solutions.stiffness_n).inv();
    let of_body = |body: &Finger| {
        let contact = Contact::new(body, plate, frequency_hz);
        let at = |values: &[Complex64]| -> [Complex64; COLUMNS] {
            std::array::from_fn(|column| {
                let middle_m = 0.5 * (contact.column_m(column) + contact.column_m(column + 1));
                interpolated(values, step_m, middle_m)
            })
        };
        let (u, r) = (at(&solutions.left), at(&solutions.right));
        let half_width = strip_half_width(plate, body.place_m);
        let across = means_across(body.half_across(plate, body.place_m), half_width, 1);
        let share = across.iter().sum::<f64>() / BANDS as f64;
        let mut both = Complex64::ZERO;
        for near in 0..COLUMNS {
            both += u[near] * r[near] + 2.0 * u[near] * r[near + 1..].iter().sum::<Complex64>();
        }
        let cells = (COLUMNS * COLUMNS) as f64;
        let mean: Complex64 = r.iter().sum();
        let scale = per_force * share * share / cells;
        // The stiffness is proportional to the inverse square of a solution's weight.
        let weight = interpolated(&solutions.weight, step_m, body.place_m);
        let near = contact.receptance() * weight * weight / solutions.stiffness_n;
        Receptance { held: scale * both + near, returned: scale * mean * mean }
    };
    Receptances { places: bodies.iter().map(of_body).collect(), starts: solutions.starts }
}
