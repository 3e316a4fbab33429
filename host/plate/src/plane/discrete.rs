//! The sheet divided into elements and polynomials: what the field and the reflection share.

use super::basis::Edges;
use super::error::PlaneError;
use super::fluid::{AirForces, Fluid};
use super::minimal_residual;
use super::outline::Outline;
use super::section::Section;
use super::setup::{End, Force, Setup};
use super::strip::{modulus, orders_of_edges, sheet, wave_impedance, width_numbers};
use super::system::{Mesh, System};
use crate::definition::impedance::Impedance;
use crate::definition::plate::Plate;
use crate::definition::source::EndSlope;
use crate::frequency::driven_end::film_rise;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Largest number of unknowns times the band's width squared: a few seconds of work.
const WORK_MAX: usize = 4_000_000_000;
/// Elements per width of a finger, which are as short for one width on both sides of it.
const ELEMENTS_PER_FINGER: i32 = 4;
/// Polynomials more that resolve the slope at edges that hardly turn: it is not built into those polynomials.
const ORDERS_OF_TURNING: usize = 2;
/// Most polynomials more that resolve a finger on a plate that is wide against it.
const FINGER_ORDERS_MAX: f64 = 12.0;

/// How finely a sheet is divided.
#[derive(Debug, Clone, Copy)]
pub(super) struct Resolution {
    /// Elements per wavelength 2 pi/K of the unbounded sheet.
    pub(super) elements_per_wavelength: f64,
    /// Polynomials beyond those that the frequency needs.
    pub(super) extra_orders: usize,
    /// Half of the rounded length between lead-in and taper, in half-widths.
    pub(super) rounding: f64,
    /// Panels of the air along and across, over those of `fluid.rs`.
    pub(super) panels: f64,
}

/// The meshed sheet with its loads and boundary conditions.
#[derive(Debug, Clone)]
pub(super) struct Discrete<'a> {
    plate: &'a Plate,
    frequency_hz: f64,
    setup: Setup,
    outline: Outline<'a>,
    pub(super) section: Section,
    pub(super) mesh: Mesh,
    /// D, or the tension per width.
    modulus: f64,
    /// [`super::section::Energy::level`] of the wave without loss and with the air of a free wave.
    pub(super) level: f64,
    /// See [`Resolution`].
    panels: f64,
}

impl<'a> Discrete<'a> {
    /// Divides the sheet from the start of the lead-in to `end_m`.
    ///
    /// # Errors
    /// [`PlaneError::TooFine`]; what is wrong with the setup.
    pub(super) fn new(
        plate: &'a Plate,
        frequency_hz: f64,
        setup: &Setup,
        outline: Outline<'a>,
        end_m: f64,
        resolution: Resolution,
    ) -> Result<Self, PlaneError> {
        setup.validate(plate)?;
        let (edges, energy, level) = sheet(plate, frequency_hz);
        let turns = setup.edge_compliance_m > 0.0;
        let edges = if turns { Edges::Turning } else { edges };
        let wavenumber = plate.wavenumber_squared(frequency_hz).sqrt();
        let start = -setup.lead_in_m();
        let mut places = outline.corners();
        places.extend([start, end_m]);
        // The field bends around the edges of the finger's patch, along x as across.
        let mut finger_orders = 0;
        if let Some(finger) = setup.finger {
            let reach = 3 * ELEMENTS_PER_FINGER;
            let share = |i: i32| f64::from(i) / f64::from(2 * ELEMENTS_PER_FINGER);
            places.extend((-reach..=reach).step_by(2).map(|i| finger.place_m + share(i) * finger.contact_m));
            let widths = 4.0 * outline.at(finger.place_m).value.exp() / finger.contact_m;
            finger_orders = widths.min(FINGER_ORDERS_MAX).ceil() as usize;
        }
        places.retain(|place| (start..=end_m).contains(place));
        places.sort_by(f64::total_cmp);

        // Polynomials that resolve what propagates across the width: pi/2 per wavelength, and a few more.
        let across = (0.5 * wavenumber * outline.at(0.0).value.exp()).ceil() as usize + 3;
        let orders_of_edges = orders_of_edges(plate) + if turns { ORDERS_OF_TURNING } else { 0 };
        let orders = across.saturating_add(resolution.extra_orders + finger_orders + orders_of_edges);
        let longest_m = TAU / wavenumber / resolution.elements_per_wavelength;
        let nodes = ((end_m - start) / longest_m) as usize + places.len();
        let unknowns = nodes.saturating_mul(2 * orders);
        let band = orders.saturating_mul(8);
        let most = WORK_MAX / band.saturating_mul(band);
        if unknowns > most {
            return Err(PlaneError::TooFine { frequency_hz, unknowns, most });
        }
        let section = Section::new(edges, energy, orders, width_numbers(plate));
        Ok(Self {
            plate,
            frequency_hz,
            setup: *setup,
            section: if turns { section.turning_by(setup.edge_compliance_m) } else { section },
            mesh: Mesh::new(&places, longest_m),
            outline,
            modulus: modulus(plate, frequency_hz),
            level,
            panels: resolution.panels,
        })
    }

    /// The unknowns where the sheet is driven with 1 and clamped at its far end.
    ///
    /// # Errors
    /// [`PlaneError::TooManyPanels`] and [`PlaneError::AirNotSolved`], both of a plate in air.
    pub(super) fn solve(&self) -> Result<Vec<Complex64>, PlaneError> {
        let Self { plate, frequency_hz, section, mesh, outline, .. } = self;
        let equations = |wave_loss, level| {
            let mut system = self.equations(wave_loss, 1.0, level);
            system.clamp(mesh.elements());
            system
        };
        // With the mass of the free wave everywhere: all there is without air, or where only its coefficient is stated.
        let free = equations(plate.sheet_loss_at(*frequency_hz), self.level);
        let Some(fluid) = Fluid::of(plate.spec().air) else { return Ok(free.solve()) };
        let omega = TAU * frequency_hz;
        let added = (plate.vacuum_frequency_hz(*frequency_hz) / frequency_hz).powi(2) - 1.0;
        let wavelength_m = TAU / plate.wavenumber_squared(*frequency_hz).sqrt();
        let panel_m = fluid.panel_m(wavelength_m, added) / self.panels;
        let rows = (section.orders as f64 * self.panels).ceil() as usize;
        let air = AirForces::new(&fluid, (section, mesh, outline), (panel_m, rows), omega)?;
        let dry = section.energy.level(plate.spec().model.wavenumber_squared(omega));
        let sheet = equations(plate.stiffness_loss_at(*frequency_hz), dry);
        // Little is left after the free wave's mass is taken out.
        let free = free.matrix.factor();
        let balance = |unknowns: &[Complex64]| {
            let mut forces = air.of(unknowns);
            sheet.condition(&mut forces);
            let mut rest = sheet.matrix.times(unknowns);
            rest.iter_mut().zip(&forces).for_each(|(rest, force)| *rest -= force);
            free.solve(&mut rest);
            rest
        };
        let mut right = sheet.right.clone();
        free.solve(&mut right);
        minimal_residual::solve(balance, &right)
            .ok_or(PlaneError::AirNotSolved { frequency_hz: *frequency_hz })
    }

    /// Stiffness and inertia of the sheet with this loss of the wave (see [`Plate::wave_loss`]) and this K^4 or K^2, the
    /// lead-in, the finger, and the driven end with a drive of `drive`. The far end is free.
    pub(super) fn equations(&self, wave_loss: f64, drive: f64, level: f64) -> System<'_> {
        let Self { plate, setup, .. } = self;
        let omega = TAU * self.frequency_hz;
        let is_bending = plate.spec().model.bending().is_some();
        // K^2 -> K^2 (1 + j eta), as in the one-mode equation, by a modulus that is 1/(1 + j eta) of the one without
        // loss; its square in bending, where K^2 is proportional to the root of the modulus.
        let compliance = Complex64::new(1.0, wave_loss).powi(if is_bending { 2 } else { 1 });
        let in_plate = self.modulus / compliance;
        // A loss layer has the usual E (1 - j eta): the two differ by eta^2, which counts only here.
        let in_lead_in =
            self.modulus * Complex64::new(1.0, setup.lead_in.map_or(0.0, |lead_in| -lead_in.loss_factor));
        // Where only the air's coefficient is stated its mass changes along a membrane, and the power beside the plate stands for
        // more of the plate. D is proportional to the third power of the thickness, the mass per area to the first.
        let mode = plate.width_mode(1);
        let air = mode.air(self.frequency_hz).filter(|_| Fluid::of(plate.spec().air).is_none());
        let loss = plate.stiffness_loss_at(self.frequency_hz);
        let along = |x: f64| {
            let across = mode.width_term(x);
            air.map(|air| (air.at(across), air.weight_from_end(across, x)))
        };
        let stiffness = |x: f64| match along(x) {
            _ if x < 0.0 => in_lead_in,
            Some((here, power)) => self.modulus * power / Complex64::new(1.0, loss / here.weight),
            None => in_plate * plate.thickness_ratio(x).powi(3),
        };
        let inertia = |x: f64| match along(x) {
            Some((here, power)) => self.modulus * power * self.section.energy.level(here.wavenumber_squared),
            None => self.modulus * level * plate.thickness_ratio(x.max(0.0)),
        };
        let mut system = System::new(&self.section, &self.mesh, &self.outline, stiffness, inertia);
        if let Some(finger) = setup.finger {
            let per_area = finger.impedance().dynamic_stiffness(omega) / finger.contact_m.powi(2);
            system.cover(&self.outline, finger.place_m, 0.5 * finger.contact_m, per_area);
        }
        if let Some(lead_in) = setup.lead_in {
            system.resist(0, Impedance::damper(lead_in.end_resistance_n_s_per_m).dynamic_stiffness(omega));
        }

        let node = self.mesh.node_at(0.0);
        // A film's end moves by more than its wave, see `driven_end/one_mode.rs`.
        let rise = |frequency_hz| film_rise(plate, frequency_hz).unwrap_or(1.0);
        let impedance = |frequency_hz| wave_impedance(plate, frequency_hz);
        // Only bending has a condition on the slope.
        let guided = |slope| slope == EndSlope::Held && is_bending;
        let narrowing = self.outline.at(0.0).slope;
        match setup.end {
            End::Displacement(slope) => {
                if guided(slope) {
                    system.guide(node, narrowing);
                }
                system.hold(node, drive);
            }
            End::Source { impedance: resisting, force, slope } => {
                let force = match force {
                    Force::Constant(force) => force,
                    Force::OfWave { multiple, at_frequency_hz } => {
                        multiple * TAU * at_frequency_hz * impedance(at_frequency_hz) * rise(at_frequency_hz)
                    }
                };
                system.resist(node, resisting.dynamic_stiffness(omega));
                system.push(node, (drive * force).into());
                if guided(slope) {
                    system.guide(node, narrowing);
                }
            }
            End::Damper { ratio, at_frequency_hz } => {
                let damper = Impedance::damper(ratio * impedance(at_frequency_hz));
                let force = damper.dynamic_stiffness(omega);
                system.resist(node, force);
                system.push(node, 2.0 * drive * force);
            }
        }
        system
    }
}
