//! Reflection of the driven end against the closed form of a strip with supported edges, and the tables of the physics
//! page.

use super::super::reflection;
use super::super::setup::{End, Force, Setup};
use super::aluminium;
use super::with_tension;
use crate::{Bending, EndSlope as Slope, Impedance, LeadIn, Plate, TurningWidth, preset};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

const J: Complex64 = Complex64::I;

/// A strip of half-width W between supported edges: w = f(x) cos(q z), q = pi/2W, with f'''' - 2 q^2 f'' + q^4 f = K^4 f.
struct Strip {
    bending: Bending,
    q: f64,
    width: f64,
    omega: f64,
    /// D (1 - j eta).
    stiffness: Complex64,
}

impl Strip {
    fn new(plate: &Plate, frequency_hz: f64, loss: f64) -> Self {
        let bending = plate.spec().model.bending().expect("bending").clone();
        let width = plate.half_width_m(0.0);
        let modulus = bending.stiffness_n_m() * Complex64::new(1.0, -loss);
        Self { bending, q: PI / (2.0 * width), width, omega: TAU * frequency_hz, stiffness: modulus }
    }

    /// The two roots g of f = e^(g x) into x > 0: the travelling wave (jk) and the near field (-gamma).
    fn roots(&self) -> [Complex64; 2] {
        let surface = self.bending.density_kg_per_m3 * self.bending.thickness_m;
        let square = (self.omega * self.omega * surface / self.stiffness).sqrt();
        let q2 = self.q * self.q;
        [J * (square - q2).sqrt(), -(square + q2).sqrt()]
    }

    /// Deflection, slope, moment and force of e^(g x), the last two as they act on the part at smaller x, over the
    /// whole width.
    fn state(&self, g: Complex64) -> [Complex64; 4] {
        let (nu, q2) = (self.bending.poisson_ratio, self.q * self.q);
        let d = self.stiffness * self.width;
        [Complex64::ONE, g, d * (g * g - nu * q2), -d * g * (g * g - (2.0 - nu) * q2)]
    }

    fn impedance(&self) -> f64 {
        let surface = self.bending.density_kg_per_m3 * self.bending.thickness_m;
        2.0 * self.width * self.roots()[0].im * (self.bending.stiffness_n_m() * surface).sqrt()
    }
}

/// The closed form of [`reflection`]: two waves in the plate, four in the lead-in, matched by deflection, slope, moment
/// and force.
fn closed_form(plate: &Plate, frequency_hz: f64, setup: &Setup) -> Complex64 {
    let strip = Strip::new(plate, frequency_hz, 0.0);
    let [jk, near] = strip.roots();
    let (into, from, near) = (strip.state(jk), strip.state(-jk), strip.state(near));
    let (dynamic, guided, held) = match setup.end {
        End::Displacement(slope) => (Complex64::ZERO, slope == Slope::Held, true),
        End::Source { impedance, slope, .. } => {
            let Impedance { resistance_n_s_per_m: r, mass_kg: m, stiffness_n_per_m: s } = impedance;
            let w = strip.omega;
            (Complex64::new(s - w * w * m, -w * r), slope == Slope::Held, false)
        }
        End::Damper { .. } => panic!("not used here"),
    };
    // Unknowns: r, near field, and four waves of the lead-in.
    let waves = setup.lead_in.map(|lead_in| {
        let lossy = Strip::new(plate, frequency_hz, lead_in.loss_factor);
        let states: Vec<(Complex64, [Complex64; 4])> =
            lossy.roots().iter().flat_map(|&g| [g, -g]).map(|g| (g, lossy.state(g))).collect();
        (lead_in, states)
    });
    let count = 2 + waves.as_ref().map_or(0, |(_, states)| states.len());
    let mut matrix = DMatrix::<Complex64>::zeros(count, count);
    let mut right = DVector::<Complex64>::zeros(count);
    let behind = waves.iter().flat_map(|(_, states)| states).enumerate();
    // The prescribed deflection, or the balance of forces; the held slope, or the balance of moments.
    let first = |[f, _, _, force]: [Complex64; 4]| if held { f } else { dynamic * f - force };
    let second = |[_, slope, moment, _]: [Complex64; 4]| if guided { slope } else { moment };
    for (column, state) in [into, near].into_iter().enumerate() {
        matrix[(0, column)] = first(state);
        matrix[(1, column)] = second(state);
    }
    right[0] = -first(from);
    right[1] = -second(from);
    for (wave, (_, state)) in behind {
        let at = 2 + wave;
        // At x = 0 the normal of the lead-in is +x.
        if !held {
            matrix[(0, at)] = state[3];
        }
        if !guided {
            matrix[(1, at)] = -state[2];
        }
        // Deflection and slope equal those of the plate.
        for row in [2, 3] {
            matrix[(row, at)] = state[row - 2];
        }
    }
    if let Some((lead_in, states)) = &waves {
        for row in [2, 3] {
            matrix[(row, 0)] = -into[row - 2];
            matrix[(row, 1)] = -near[row - 2];
            right[row] = from[row - 2];
        }
        let damper = -J * strip.omega * lead_in.end_resistance_n_s_per_m;
        for (wave, (g, state)) in states.iter().enumerate() {
            let there = (-g * lead_in.length_m).exp();
            matrix[(4, 2 + wave)] = there * state[2];
            matrix[(5, 2 + wave)] = there * (-state[3] + damper * state[0]);
        }
    }
    matrix.lu().solve(&right).expect("regular")[0]
}

fn damper(plate: &Plate, frequency_hz: f64, ratio: f64, slope: Slope) -> Setup {
    let impedance = ratio * Strip::new(plate, frequency_hz, 0.0).impedance();
    Setup {
        end: End::Source {
            impedance: Impedance { resistance_n_s_per_m: impedance, ..Impedance::default() },
            force: Force::Constant(1.0),
            slope,
        },
        ..Setup::of(plate)
    }
}

fn close(found: Complex64, wanted: Complex64) -> bool {
    (found - wanted).norm() < 3e-4
}

#[test]
fn dampers_reflect_what_the_closed_form_and_the_physics_page_say() {
    let plate = aluminium(false, 0.0);
    for (slope, ratio, page) in [
        (Slope::Free, 1.0, [0.56, 0.57, 0.59]),
        (Slope::Free, 0.37, [0.34, 0.36, 0.38]),
        (Slope::Held, 0.74, [0.37, 0.38, 0.39]),
    ] {
        for (frequency_hz, page) in [20e3, 28e3, 40e3].into_iter().zip(page) {
            let setup = damper(&plate, frequency_hz, ratio, slope);
            let exact = closed_form(&plate, frequency_hz, &setup);
            let found = reflection(&plate, frequency_hz, &setup).unwrap();
            assert!(close(found, exact), "{slope:?} {ratio} {frequency_hz}: {found} {exact}");
            assert!((exact.norm() - page).abs() < 0.01, "{slope:?} {ratio} {frequency_hz}: {exact} {page}");
        }
    }
    // The source that absorbs the whole wave: (0.29 + 0.24 j) Z.
    let mut setup = damper(&plate, 28e3, 0.29, Slope::Free);
    if let End::Source { impedance, .. } = &mut setup.end {
        impedance.stiffness_n_per_m = 0.24 / 0.29 * impedance.resistance_n_s_per_m * TAU * 28e3;
    }
    assert!(reflection(&plate, 28e3, &setup).unwrap().norm() < 0.01);
}

#[test]
fn lead_ins_reflect_what_the_closed_form_and_the_physics_page_say() {
    let plate = aluminium(false, 0.0);
    let strip = Strip::new(&plate, 28e3, 0.0);
    let page = [
        (0.1, [(0.64, 0.23), (0.53, 0.19), (0.34, 0.12), (0.21, 0.07)]),
        (0.2, [(0.42, 0.16), (0.29, 0.11), (0.13, 0.05), (0.06, 0.03)]),
        (0.3, [(0.29, 0.12), (0.17, 0.08), (0.07, 0.04), (0.04, 0.04)]),
    ];
    for (loss_factor, lengths) in page {
        for (length_m, (free, damped)) in [0.04, 0.06, 0.1, 0.15].into_iter().zip(lengths) {
            for (ratio, page) in [(0.0, free), (0.37, damped)] {
                let end_resistance_n_s_per_m = ratio * strip.impedance();
                let setup = Setup {
                    lead_in: Some(LeadIn { length_m, loss_factor, end_resistance_n_s_per_m }),
                    ..damper(&plate, 28e3, 0.0, Slope::Free)
                };
                let frequency = |i: u32| 19.4e3 * (40.0_f64 / 19.4).powf(f64::from(i) / 100.0);
                let exact = |i| closed_form(&plate, frequency(i), &setup);
                let largest = (0..=100).map(|i| exact(i).norm()).fold(0.0, f64::max);
                assert!((largest - page).abs() < 0.01, "{loss_factor} {length_m} {ratio}: {largest} {page}");
                if length_m == 0.06 {
                    let found = reflection(&plate, frequency(70), &setup).unwrap();
                    assert!(close(found, exact(70)), "{loss_factor} {ratio}: {found} {}", exact(70));
                }
            }
        }
    }
}

#[test]
fn every_driven_end_in_bending_matches_the_closed_form() {
    let plate = aluminium(false, 0.0);
    let z = Strip::new(&plate, 28e3, 0.0).impedance();
    let lead_in = LeadIn { length_m: 0.05, loss_factor: 0.15, end_resistance_n_s_per_m: 0.6 * z };
    let impedance =
        Impedance { resistance_n_s_per_m: 0.3 * z, mass_kg: 1e-3, stiffness_n_per_m: 0.4 * z * TAU * 28e3 };
    for slope in [Slope::Free, Slope::Held] {
        let source = End::Source { impedance, force: Force::Constant(1.0), slope };
        for end in [End::Displacement(slope), source] {
            for lead_in in [None, Some(lead_in)] {
                let setup = Setup { end, lead_in, ..Setup::of(&plate) };
                let exact = closed_form(&plate, 28e3, &setup);
                let found = reflection(&plate, 28e3, &setup).unwrap();
                assert!(close(found, exact), "{setup:?}: {found} {exact}");
            }
        }
    }
}

#[test]
fn a_membrane_reflects_what_differs_from_its_impedance() {
    let plate = with_tension(&preset("membrane").unwrap(), 40.0);
    let (frequency_hz, tension) = (140.0, 40.0);
    let omega = TAU * frequency_hz;
    let k = ((omega / 12.0).powi(2) - (PI / 0.1_f64).powi(2)).sqrt();
    let z = tension * 0.05 * k / omega;
    let impedance = Impedance { resistance_n_s_per_m: 0.1, mass_kg: 1e-4, stiffness_n_per_m: 30.0 };
    let setup = Setup {
        end: End::Source { impedance, force: Force::Constant(1.0), slope: Slope::Held },
        ..Setup::of(&plate)
    };
    let source = Complex64::new(0.1, 30.0 / omega - omega * 1e-4);
    let found = reflection(&plate, frequency_hz, &setup).unwrap();
    assert!(close(found, (z - source) / (z + source)), "{found}");
    // The file's ratio refers to Z with the turning width, which on a straight strip is the half-width.
    let straight = plate.with_turning_width(TurningWidth::Plain);
    let matched = reflection(&straight, frequency_hz, &Setup::of(&straight)).unwrap();
    assert!(matched.norm() < 3e-4, "the preset's damper: {matched}");
}

#[test]
fn a_held_end_of_a_clamped_strip_returns_the_whole_wave() {
    let plate = aluminium(true, 0.0);
    // Above 37 kHz a second even width mode also propagates and carries a part of the power.
    for frequency_hz in [20e3, 30e3] {
        for slope in [Slope::Free, Slope::Held] {
            let setup = Setup { end: End::Displacement(slope), ..Setup::of(&plate) };
            let found = reflection(&plate, frequency_hz, &setup).unwrap();
            assert!((found.norm() - 1.0).abs() < 1e-3, "{frequency_hz} {slope:?}: {found} {}", found.norm());
        }
    }
}
