//! The air's mass against closed forms and published numbers: discs, rectangles, an infinite wave, a strip, Lamb's
//! plate, the head of a kettledrum.

use super::super::discrete::Resolution;
use super::super::error::PlaneError;
use super::super::field::{Field, RESOLUTION};
use super::super::fluid::{AddedMass, Fluid};
use super::super::outline::Outline;
use super::super::panels::{Division, Kernel, Panel, panels};
use super::super::setup::Setup;
use super::fields::bessel;
use crate::{Air, AirMounting, Complex64, Faces, Gas, Plate, preset};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// M of a sheet of these panels in air of density 1 with the wavenumber `k`; in a baffle, on one face.
fn mass(kernel: Kernel, panels: Vec<Panel>, k: f64) -> AddedMass {
    AddedMass::new(&Fluid { kernel, density: 1.0, sound_speed: 1.0, gap_m: None }, panels, k)
}

/// Panels of a rectangle of length `length` and half-width 1, centred on 0.
fn rectangle(kernel: Kernel, length: f64, counts: (usize, usize)) -> Vec<Panel> {
    panels(kernel, &Outline::Uniform(0.0), (-0.5 * length, 0.5 * length), counts)
}

/// Panels of the disc of radius 1. Their chords enclose the disc's area.
fn disc(kernel: Kernel, rings: usize, sectors: usize) -> Vec<Panel> {
    let radii = match kernel {
        Kernel::Source => Division::equal(rings),
        Kernel::Jump => Division::chebyshev(rings),
    };
    let step = PI / sectors as f64;
    let bulge = (step / step.sin()).sqrt();
    let at = |r: f64, angle: f64| [r * angle.cos(), r * angle.sin()];
    let mut panels = Vec::new();
    for (ring, radii_of) in radii.edges.windows(2).enumerate() {
        let [inner, outer] = [radii_of[0] * bulge, radii_of[1] * bulge];
        for sector in 0..sectors {
            let [from, to] = [sector as f64 * step, (sector + 1) as f64 * step];
            let corners = [at(inner, from), at(outer, from), at(outer, to), at(inner, to)];
            let r = radii.centres[ring];
            let weight = r * radii.shares[ring] * step;
            panels.push(Panel::new(corners, at(r, 0.5 * (from + to)), Some(weight)));
        }
    }
    panels
}

/// Integral of v M w over both halves of the sheet.
fn form(mass: &AddedMass, v: &dyn Fn([f64; 2]) -> f64, w: &dyn Fn([f64; 2]) -> f64) -> Complex64 {
    let panels = mass.panels();
    let deflection = DVector::from_iterator(panels.len(), panels.iter().map(|panel| w(panel.centre).into()));
    let pressure = mass.pressure(deflection);
    panels.iter().zip(pressure.iter()).map(|(panel, p)| p * (2.0 * panel.weight * v(panel.centre))).sum()
}

/// Integral of v w.
fn overlap(panels: &[Panel], v: &dyn Fn([f64; 2]) -> f64, w: &dyn Fn([f64; 2]) -> f64) -> f64 {
    panels.iter().map(|panel| 2.0 * panel.weight * v(panel.centre) * w(panel.centre)).sum()
}

#[test]
fn a_rigid_disc_carries_8_3_rho_a3_on_each_face_in_a_baffle_and_on_both_without_one() {
    for kernel in [Kernel::Source, Kernel::Jump] {
        let found = form(&mass(kernel, disc(kernel, 11, 20), 0.0), &|_| 1.0, &|_| 1.0).re;
        // 8/(3 pi) rho a per area.
        assert!((found / (8.0 / 3.0) - 1.0).abs() < 5e-3, "{kernel:?}: {}", found / (8.0 / 3.0));
    }
}

/// Rayleigh: the impedance of a piston in a baffle is rho c A (R1 - j X1) with R1 = 1 - J1(2ka)/ka.
#[test]
fn a_piston_in_a_baffle_radiates_as_rayleigh_says() {
    for k in [0.3, 1.0, 2.0] {
        let found =
            form(&mass(Kernel::Source, disc(Kernel::Source, 10, 20), k), &|_| 1.0, &|_| 1.0).im * k / PI;
        let wanted = 1.0 - bessel(1, (2.0 * k).into(), -1.0).re / k;
        assert!((found / wanted - 1.0).abs() < 0.01, "{k}: {found} for {wanted}");
    }
}

/// The added mass of rectangular plates that move along their normal: C (pi/4) rho a^2 b with the shorter side a (DNV
/// RP-H103, appendix A).
#[test]
fn a_rigid_rectangle_without_a_baffle_carries_the_published_mass() {
    for (ratio, published) in [(1.0, 0.579), (2.0, 0.757), (4.0, 0.872)] {
        let panels = rectangle(Kernel::Jump, 2.0 * ratio, (24, 8));
        let found = form(&mass(Kernel::Jump, panels, 0.0), &|_| 1.0, &|_| 1.0).re;
        let coefficient = found / (0.25 * PI * 4.0 * 2.0 * ratio);
        assert!((coefficient / published - 1.0).abs() < 5e-3, "{ratio}: {coefficient}");
    }
}

/// A packet of waves K = 18 that decays before the edges carries 1/sqrt(K^2 - k^2) per face in both mountings. Its
/// spectrum has a variance of 9/2 in x and in z, which adds a relative (9/4)/K^2.
#[test]
fn a_wave_far_from_the_edges_carries_rho_over_k() {
    let wave = |[x, z]: [f64; 2]| (18.0 * x).cos() * (-4.5 * (x * x + z * z)).exp();
    for (kernel, faces) in [(Kernel::Source, 1.0), (Kernel::Jump, 2.0)] {
        for k in [0.0, 6.0] {
            let mass = mass(kernel, rectangle(kernel, 2.4, (96, 8)), k);
            let found = form(&mass, &wave, &wave) / overlap(mass.panels(), &wave, &wave);
            let wanted = faces / f64::sqrt(324.0 - k * k) * (1.0 + 2.25 / 324.0);
            assert!((found / wanted - 1.0).norm() < 0.02, "{kernel:?} {k}: {found} for {wanted}");
        }
    }
}

/// The half-wave across a long strip without a baffle: 2 alpha rho/K with alpha = 1.342, from the potential on the
/// strip as a sum of sines (see `BARE_FRAME`).
#[test]
fn a_half_wave_across_a_long_bare_strip_carries_1_342_of_a_plane_wave() {
    let k = 0.5 * PI;
    let panels = rectangle(Kernel::Jump, 40.0, (80, 6));
    let shape = |[_, z]: [f64; 2]| (k * z).cos();
    let middle = |[x, z]: [f64; 2]| if x.abs() < 4.0 { (k * z).cos() } else { 0.0 };
    let mass = mass(Kernel::Jump, panels, 0.0);
    let alpha = form(&mass, &middle, &shape).re / overlap(mass.panels(), &middle, &shape) * k / 2.0;
    assert!((alpha / 1.342_45 - 1.0).abs() < 5e-3, "{alpha}");
}

/// Lamb (1920), "On the vibrations of an elastic plate in contact with water": a clamped disc in a baffle with the shape
/// (1 - r^2)^2 carries 0.6689 rho a on one face.
#[test]
fn the_clamped_disc_carries_what_lamb_says() {
    let shape = |[x, z]: [f64; 2]| (1.0 - x * x - z * z).powi(2);
    let mass = mass(Kernel::Source, disc(Kernel::Source, 10, 16), 0.0);
    let found = form(&mass, &shape, &shape).re / overlap(mass.panels(), &shape, &shape);
    assert!((found / 0.6689 - 1.0).abs() < 5e-3, "{found}");
}

/// The head of a 65 cm kettledrum without its kettle: the frequencies of the modes with 1 to 5 nodal diameters over
/// the first are 1, 1.48, 1.92, 2.36, 2.78 (Rossing 1982, "Acoustics of timpani"); in vacuum 1, 1.34, 1.67, 1.98,
/// 2.29. The ratios do not depend on the tension. The head is polyester of 0.19 mm, 0.262 kg/m^2; its stiffness is
/// neglected.
#[test]
fn a_bare_kettledrum_head_has_the_ratios_that_rossing_measured() {
    const ROOTS: [[f64; 3]; 5] = [
        [3.831_71, 7.015_59, 10.173_47],
        [5.135_62, 8.417_24, 11.619_84],
        [6.380_16, 9.761_02, 13.015_20],
        [7.588_34, 11.064_71, 14.372_54],
        [8.771_48, 12.338_60, 15.700_17],
    ];
    // Density of the air times the radius, over the head's mass per area.
    let load = 1.2 * 0.325 / 0.262;
    let mass = mass(Kernel::Jump, disc(Kernel::Jump, 11, 20), 0.0);
    let lowest: Vec<f64> = (1..)
        .zip(&ROOTS)
        .map(|(diameters, roots)| {
            let shape = |root: f64| {
                move |[x, z]: [f64; 2]| {
                    let radial = bessel(diameters, (root * x.hypot(z)).into(), -1.0).re;
                    radial * (f64::from(diameters) * z.atan2(x)).cos()
                }
            };
            let shapes = roots.map(shape);
            // (stiffness) = omega^2 (own mass + air), for unit mass per area, tension and radius.
            let stiffness: [f64; 3] =
                std::array::from_fn(|i| roots[i].powi(2) * overlap(mass.panels(), &shapes[i], &shapes[i]));
            let scaled = DMatrix::from_fn(3, 3, |i, j| {
                let own = if i == j { stiffness[i] / roots[i].powi(2) } else { 0.0 };
                let air =
                    0.5 * (form(&mass, &shapes[i], &shapes[j]) + form(&mass, &shapes[j], &shapes[i])).re;
                (own + load * air) / (stiffness[i] * stiffness[j]).sqrt()
            });
            scaled.symmetric_eigenvalues().max().sqrt().recip()
        })
        .collect();
    for (found, published) in lowest.iter().zip([1.0, 1.48, 1.92, 2.36, 2.78]) {
        let ratio = found / lowest[0];
        assert!((ratio / published - 1.0).abs() < 0.045, "{ratio} for {published}");
    }
}

#[test]
fn the_peaks_in_air_do_not_depend_on_the_panels() {
    let fine = Resolution { panels: 1.5, ..RESOLUTION };
    for (mounting, place_m) in
        [(AirMounting::Baffle { faces: Faces::Two }, 0.2), (AirMounting::BareFrame, 0.12)]
    {
        let mut spec = preset("membrane").unwrap().spec().clone();
        spec.air = Some(Air::Around { gas: Gas::ROOM, mounting, gap_m: None });
        let plate = Plate::new(spec).unwrap();
        let frequency_hz = plate.frequency_for_boundary_hz(place_m);
        let peak = |resolution| {
            let field = Field::solve_with(&plate, frequency_hz, &Setup::of(&plate), resolution).unwrap();
            field.centre_line(801).unwrap().peak.unwrap()
        };
        let (coarse, fine) = (peak(RESOLUTION), peak(fine));
        let level_db = 20.0 * (coarse.amplitude / fine.amplitude).log10();
        assert!((coarse.position_m - fine.position_m).abs() < 2e-4, "{mounting:?}: {coarse:?} {fine:?}");
        assert!(level_db.abs() < 0.05, "{mounting:?}: {level_db} dB");
    }
}

#[test]
fn air_on_too_many_panels_is_refused_by_their_number() {
    let mut spec = preset("membrane").unwrap().spec().clone();
    spec.air = Some(Air::ROOM);
    let plate = Plate::new(spec).unwrap();
    let frequency_hz = 0.99 * crate::respond_range(&plate).high;
    let error = Field::solve(&plate, frequency_hz, &Setup::of(&plate)).unwrap_err();
    assert!(
        matches!(error, PlaneError::TooManyPanels { panels, most: 3000, .. } if panels > 3000),
        "{error}"
    );
    let text = error.to_string();
    assert!(text.starts_with("panels of the air at ") && text.ends_with(": must be at most 3000"), "{text}");
}
