//! The frame of a plate: its mass, its first bending, and how far it moves beyond the boundary.
//!
//! The frame is cut twice from one sheet ([`crate::design`]) and bolted: a rectangle around the window, whose rim is all of it that
//! bends. The wave's momentum moves it: plate, air and exciter push on it with what accelerates them,
//!
//! ```text
//! q(x) = sigma omega_v^2 m W f,   m = integral of the width mode over its half-width: 4/pi, clamped 1.05
//! ```
//! with sigma omega_v^2 = omega^2 (sigma + mu) of a wave that has omega_v in a vacuum (`free_wave.rs`), and what moves with a
//! driven end, its mass at x = 0. A free frame is a uniform beam with free ends, of the frame's length l and mass M,
//!
//! ```text
//! u(x) = sum of phi_n(x) integral(phi_n q)/(M (omega_n^2 - omega^2 - j eta omega_n^2))
//! phi_0 = 1, phi_1 = sqrt 3 (1 - 2 s/l), omega = 0;   phi_2: 4.730^2/(2 pi l^2) sqrt(E/rho) h/sqrt 12
//! ```
//! with the loss factor of a bolted joint. These are estimates, good to a factor of two. A frame that is screwed to a table moves
//! with the mass of both and does not bend.

use super::drive::DriveEnd;
use super::frame::{DRIVE_GAP_M, Frame};
use super::model::Model;
use super::plate::Plate;
use super::source::{LeadIn, Source};
use num_complex::Complex64;
use std::f64::consts::{FRAC_2_PI, TAU};

/// Mean of the clamped width mode at its cut-off, 1 on the centre line: (tan p/p - tanh p/p)/(1/cos p - 1/cosh p), p = 2.365.
const CLAMPED_MEAN: f64 = 0.5232;
/// beta l of the first bending of a beam with free ends, and the weight of its odd part.
const FREE_FREE: (f64, f64) = (4.730_040_744_862_704, 0.982_502_214_576_238);
/// Loss factor of a bolted frame: Q = 20. No source: a round value.
const LOSS: f64 = 0.05;
/// Places beyond the boundary at which its motion is computed, less one.
const PLACES: u32 = 24;

/// How a frame moves at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FrameMotion {
    /// Largest amplitude beyond the boundary, metres.
    pub(crate) amplitude_m: f64,
    /// The mass at which it would move like that as a rigid body, kg.
    pub(crate) rigid_kg: f64,
}

impl Frame {
    /// From the frame's end at the drive to x = 0, and its whole length, metres.
    fn lengths_m(&self, plate: &Plate) -> (f64, f64) {
        let before = lead_in_m(plate) + DRIVE_GAP_M + self.rim_m;
        (before, before + plate.length_m() + self.rim_m)
    }

    /// Its own mass, kg: the rectangle of the drawing less the window.
    pub(crate) fn mass_kg(&self, plate: &Plate) -> f64 {
        const STEPS: u32 = 200;
        let (_, length_m) = self.lengths_m(plate);
        let wide_m = plate.cut_half_width_m(0.0);
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS) * plate.length_m();
        let taper: f64 = (0..STEPS).map(|i| 2.0 * plate.cut_half_width_m(place(i))).sum();
        let window =
            taper * plate.length_m() / f64::from(STEPS) + 2.0 * wide_m * (lead_in_m(plate) + DRIVE_GAP_M);
        (2.0 * (wide_m + self.rim_m) * length_m - window) * self.thickness_m * self.density_kg_per_m3
    }

    /// Its first bending with free ends, Hz.
    pub(crate) fn first_bending_hz(&self, plate: &Plate) -> f64 {
        let (_, length_m) = self.lengths_m(plate);
        let speed = (self.youngs_modulus_pa / self.density_kg_per_m3).sqrt();
        FREE_FREE.0.powi(2) / (TAU * length_m * length_m) * speed * self.thickness_m / 12.0_f64.sqrt()
    }

    /// How far it moves from `from_m` on, where the plate moves by `amplitude` (metres, at places uniform from 0 to its end) at
    /// `frequency_hz`. `None` where the plate file does not state the mass of the plate.
    pub(crate) fn motion(
        &self,
        plate: &Plate,
        frequency_hz: f64,
        amplitude: &[Complex64],
        from_m: f64,
    ) -> Option<FrameMotion> {
        let surface_density = plate.spec().model.surface_density("a frame").ok()?;
        let mean = match plate.spec().model {
            Model::BendingClamped(_) => CLAMPED_MEAN,
            _ => FRAC_2_PI,
        };
        let (before_m, length_m) = self.lengths_m(plate);
        let omega = TAU * frequency_hz;
        let vacuum = TAU * plate.vacuum_frequency_hz(frequency_hz);
        let step_m = plate.length_m() / (amplitude.len().max(2) - 1) as f64;
        let push = |i: usize| {
            let x = i as f64 * step_m;
            let ends = if i == 0 || i + 1 == amplitude.len() { 0.5 } else { 1.0 };
            let area = 2.0 * mean * plate.half_width_m(x) * step_m * ends;
            amplitude[i] * (surface_density * vacuum * vacuum * area)
        };
        let moving_kg = match plate.spec().drive_end {
            DriveEnd::Source(Source { impedance, .. }) => impedance.mass_kg,
            _ => 0.0,
        };
        let of_end = amplitude.first()? * (moving_kg * omega * omega);
        let share = |x: f64| (x + before_m) / length_m;
        let force = |shape: fn(f64) -> f64| {
            let along: Complex64 =
                (0..amplitude.len()).map(|i| push(i) * shape(share(i as f64 * step_m))).sum();
            along + of_end * shape(share(0.0))
        };
        let own_kg = self.mass_kg(plate);
        let mass_kg = own_kg + self.table_mass_kg;
        let inertia = -omega * omega * mass_kg;
        let whole = force(|_| 1.0);
        if self.table_mass_kg > 0.0 {
            let amplitude_m = (whole / inertia).norm();
            return Some(FrameMotion { amplitude_m, rigid_kg: mass_kg });
        }
        let bending = TAU * self.first_bending_hz(plate);
        let stiff = Complex64::new(bending * bending - omega * omega, -LOSS * bending * bending) * own_kg;
        let (tilt, bend) = (force(tilting), force(bending_shape));
        let at = |x: f64| {
            let s = share(x);
            ((whole + tilt * tilting(s)) / inertia + bend * bending_shape(s) / stiff).norm()
        };
        let places =
            (0..=PLACES).map(|i| from_m + (plate.length_m() - from_m) * f64::from(i) / f64::from(PLACES));
        let amplitude_m = places.map(at).fold(0.0, f64::max);
        // As a rigid body of this mass.
        let rigid_kg = whole.norm() / (omega * omega * amplitude_m.max(f64::MIN_POSITIVE));
        Some(FrameMotion { amplitude_m, rigid_kg })
    }
}

/// The shape of the tilt over the share of the frame's length, of the mean square 1.
fn tilting(s: f64) -> f64 {
    3.0_f64.sqrt() * (1.0 - 2.0 * s)
}

/// The shape of the first bending with free ends, of the mean square 1.
fn bending_shape(s: f64) -> f64 {
    let (beta, odd) = FREE_FREE;
    let t = beta * s;
    t.cosh() + t.cos() - odd * (t.sinh() + t.sin())
}

/// Length of the lead-in behind the drive, metres; 0 if there is none.
fn lead_in_m(plate: &Plate) -> f64 {
    match plate.spec().drive_end {
        DriveEnd::Source(Source { lead_in: Some(LeadIn { length_m, .. }), .. }) => length_m,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::presets::preset;
    use crate::definition::spec::PlateSpec;
    use crate::frequency::{Equation, respond};
    use std::f64::consts::PI;

    /// Two sheets of 5 mm.
    fn frame(youngs_modulus_pa: f64, density_kg_per_m3: f64) -> Frame {
        Frame { youngs_modulus_pa, density_kg_per_m3, thickness_m: 0.01, rim_m: 0.02, table_mass_kg: 0.0 }
    }

    /// 22.37/(2 pi l^2) sqrt(E/rho) h/sqrt 12 by hand: the frame is 0.015 + 0.02 + 0.32 + 0.02 = 0.375 m long.
    #[test]
    fn the_first_bending_is_that_of_a_free_beam() {
        let plate = preset("latex-membrane").expect("a preset");
        for (youngs_modulus_pa, density, hz) in [(70e9, 2700.0, 372.2), (3.2e9, 1190.0, 119.9)] {
            let found = frame(youngs_modulus_pa, density).first_bending_hz(&plate);
            assert!((found / hz - 1.0).abs() < 2e-3, "{found} {hz}");
        }
    }

    #[test]
    fn the_shapes_of_a_free_beam_are_orthogonal_and_of_the_mean_square_1() {
        let mean =
            |of: fn(f64) -> f64| (0..2000).map(|i| of((f64::from(i) + 0.5) / 2000.0)).sum::<f64>() / 2000.0;
        for (found, wanted) in [
            (mean(|s| tilting(s).powi(2)), 1.0),
            (mean(|s| bending_shape(s).powi(2)), 1.0),
            (mean(bending_shape), 0.0),
            (mean(|s| tilting(s) * bending_shape(s)), 0.0),
        ] {
            assert!((found - wanted).abs() < 1e-3, "{found} {wanted}");
        }
    }

    /// The mass of the drawing's rectangle (0.375 m x 0.14 m) less the window, whose taper has the area
    /// 2 W0 (1 - e^(-d L))/d.
    #[test]
    fn the_mass_is_that_of_the_drawing() {
        let plate = preset("latex-membrane").expect("a preset");
        let taper = 2.0 * 0.05 * (1.0 - (-4.62_f64 * 0.32).exp()) / 4.62;
        let wanted = (0.375 * 0.14 - taper - 0.1 * 0.015) * 0.01 * 680.0;
        let found = frame(8e9, 680.0).mass_kg(&plate);
        assert!((found / wanted - 1.0).abs() < 1e-4, "{found} {wanted}");
    }

    /// Screwed to a table, frame and plate keep their momentum: M u = -integral of sigma w, computed here from the field alone. A free
    /// frame that is much lighter and bends far above the tone moves by that times what its tilt adds, 1 to 4 times.
    #[test]
    fn a_frame_moves_by_the_momentum_of_the_plate() {
        let preset = preset("membrane-heavy").expect("a preset");
        let mut stands = frame(8e9, 680.0);
        stands.table_mass_kg = 3.0;
        let plate = Plate::new(PlateSpec { frame: Some(stands), ..preset.spec().clone() }).expect("valid");
        let hz = plate.frequency_for_boundary_hz(0.16);
        let response = respond(&plate, hz, 2001, Equation::Corrected).expect("enters");
        let metres: Vec<Complex64> = response.amplitude.iter().map(|f| f * 1e-4).collect();
        let step_m = 0.32 / 2000.0;
        let momentum: Complex64 = metres
            .iter()
            .enumerate()
            .map(|(i, f)| f * (400.0 / 144.0 * 4.0 / PI * 0.05 * (-4.62 * i as f64 * step_m).exp() * step_m))
            .sum();
        let mass_kg = stands.mass_kg(&plate) + 3.0;
        let moves = stands.motion(&plate, hz, &metres, 0.16).expect("a mass");
        assert!((moves.amplitude_m / (momentum.norm() / mass_kg) - 1.0).abs() < 2e-3, "{moves:?}");
        assert!((moves.rigid_kg / mass_kg - 1.0).abs() < 1e-12);
        // Stiff enough that its bending lies at 20 times the tone.
        let free = frame(1e13, 680.0).motion(&plate, hz, &metres, 0.16).expect("a mass").amplitude_m;
        let share = free * frame(1e13, 680.0).mass_kg(&plate) / momentum.norm();
        assert!((0.5..4.0).contains(&share), "{share}");
    }
}
