//! The air on the faces of the sheet: the forces by which it resists the sheet's motion.
//!
//! The velocity potential obeys the wave equation, so the pressure follows from the normal velocity of the whole sheet: by
//! the Rayleigh integral in a rigid baffle, by the jump across the sheet without one; see `panels.rs`. The forces are
//! -omega^2 M w with
//!
//! ```text
//! baffle      M = faces rho S          bare      M = rho H^-1          above a table      M = rho (H + H')^-1
//! ```
//! An endless plane wave of the wavenumber K far above the air's k has M = faces rho/K in both. Where k is not 0, M has an
//! imaginary part: the sound that leaves the sheet.
//!
//! With panels of [`Fluid::panel_m`] along and as many across as the deflection has polynomials, peaks are within 0.2 mm and
//! 0.05 dB of those with finer ones (`the_peaks_in_air_do_not_depend_on_the_panels`).

use super::basis::along;
use super::error::PlaneError;
use super::outline::Outline;
use super::panels::{Kernel, Panel, panels};
use super::section::Section;
use super::system::{Mesh, unknown};
use crate::definition::air::{Air, AirMounting};
use crate::special::gauss::gauss;
use nalgebra::{DMatrix, DVector, Dyn, LU};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Panels per wavelength of the sheet along x, in a baffle and in a bare frame.
const PER_WAVELENGTH: [f64; 2] = [24.0, 16.0];
/// The same where the air adds less than [`LIGHT`] of the inertia.
const PER_WAVELENGTH_LIGHT: f64 = 10.0;
const LIGHT: f64 = 0.02;
/// Places along a panel where its force acts.
const FORCES: usize = 3;
/// Most panels: half a minute of work for a bare frame, a few seconds in a baffle.
const PANELS_MAX: usize = 3000;

/// The air as its panels see it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fluid {
    pub(super) kernel: Kernel,
    /// Faces in a baffle times rho, or rho of a bare frame, kg/m^3.
    pub(super) density: f64,
    /// Speed of sound, m/s.
    pub(super) sound_speed: f64,
    /// Distance of a table below, metres: only of a bare frame.
    pub(super) gap_m: Option<f64>,
}

/// M of the panels.
pub(super) struct AddedMass {
    panels: Vec<Panel>,
    density: f64,
    operator: Operator,
}

enum Operator {
    Source(DMatrix<Complex64>),
    Jump(LU<Complex64, Dyn, Dyn>),
}

impl Fluid {
    /// The air of a plate; `None` where it has none, and where its plate file states a coefficient and not how the plate stands:
    /// there the sheet carries the mass of the law.
    pub(super) fn of(air: Option<Air>) -> Option<Self> {
        let Some(Air::Around { gas, mounting, gap_m }) = air else { return None };
        let (kernel, faces) = match mounting {
            AirMounting::Baffle { faces } => (Kernel::Source, faces.count()),
            AirMounting::BareFrame => (Kernel::Jump, 1.0),
            AirMounting::Unknown | AirMounting::Coefficient { .. } | AirMounting::Calibrated { .. } => {
                return None;
            }
        };
        let density = faces * gas.density_kg_per_m3();
        Some(Self { kernel, density, sound_speed: gas.sound_speed_m_per_s(), gap_m })
    }

    /// Length of the panels where the sheet's waves have the length `wavelength_m` and air adds the share `added` to its inertia.
    pub(super) fn panel_m(&self, wavelength_m: f64, added: f64) -> f64 {
        let [baffle, bare] = PER_WAVELENGTH;
        let per_wavelength = match self.kernel {
            _ if added < LIGHT => PER_WAVELENGTH_LIGHT,
            Kernel::Source => baffle,
            Kernel::Jump => bare,
        };
        wavelength_m / per_wavelength
    }
}

impl AddedMass {
    /// M of `panels` that were made for the same kernel, at the angular frequency `omega`.
    pub(super) fn new(fluid: &Fluid, panels: Vec<Panel>, omega: f64) -> Self {
        let k = omega / fluid.sound_speed;
        let table = fluid.gap_m.map(|gap_m| (gap_m, panels.iter().map(Panel::places).collect::<Vec<_>>()));
        let matrix = DMatrix::from_fn(panels.len(), panels.len(), |row, column| {
            let (panel, point) = (&panels[column], panels[row].centre);
            let below = table
                .as_ref()
                .map_or(Complex64::ZERO, |(gap_m, places)| panel.below(&places[column], point, k, *gap_m));
            panel.influence(fluid.kernel, point, k) + below
        });
        let operator = match fluid.kernel {
            Kernel::Source => Operator::Source(matrix),
            Kernel::Jump => Operator::Jump(matrix.lu()),
        };
        Self { panels, density: fluid.density, operator }
    }

    /// The pressure on the sheet over -omega^2, kg/m^2, where the centres of the panels are deflected by `deflection`.
    pub(super) fn pressure(&self, deflection: DVector<Complex64>) -> DVector<Complex64> {
        let pressure = match &self.operator {
            Operator::Source(matrix) => matrix * deflection,
            // H is regular; if rounding says otherwise the sheet's equations are not solved.
            Operator::Jump(factored) => {
                let nan = || DVector::from_element(self.panels.len(), Complex64::from(f64::NAN));
                factored.solve(&deflection).unwrap_or_else(nan)
            }
        };
        pressure * Complex64::from(self.density)
    }

    pub(super) fn panels(&self) -> &[Panel] {
        &self.panels
    }
}

/// Unknowns with their shares.
type Shares = Vec<(usize, f64)>;

/// How a panel hangs on the unknowns of the sheet.
struct Link {
    /// What deflects its centre.
    deflects: Shares,
    /// What a pressure on it acts on. It is spread over the panel's length: a force at its centre would bend the sheet there
    /// by a ripple that moves a flat peak by tenths of a millimetre.
    resisted: Shares,
}

/// The air's forces on the unknowns of a sheet.
pub(super) struct AirForces {
    mass: AddedMass,
    links: Vec<Link>,
    unknowns: usize,
    omega_squared: f64,
}

impl AirForces {
    /// The panels on the sheet of `section`, `mesh` and `outline`, with panels of about the length `panel_m` in `rows`
    /// between centre line and edge, at the angular frequency `omega`.
    ///
    /// # Errors
    /// [`PlaneError::TooManyPanels`].
    pub(super) fn new(
        fluid: &Fluid,
        (section, mesh, outline): (&Section, &Mesh, &Outline<'_>),
        (panel_m, rows): (f64, usize),
        omega: f64,
    ) -> Result<Self, PlaneError> {
        let ends = (mesh.nodes[0], mesh.nodes[mesh.elements()]);
        let columns = ((ends.1 - ends.0) / panel_m).ceil().max(1.0) as usize;
        let count = columns.saturating_mul(rows);
        if count > PANELS_MAX {
            let frequency_hz = omega / TAU;
            return Err(PlaneError::TooManyPanels { frequency_hz, panels: count, most: PANELS_MAX });
        }
        let panels = panels(fluid.kernel, outline, ends, (columns, rows));
        let links = panels.iter().map(|panel| Link::new(section, mesh, outline, panel)).collect();
        let unknowns = 2 * section.orders * mesh.nodes.len();
        let mass = AddedMass::new(fluid, panels, omega);
        Ok(Self { mass, links, unknowns, omega_squared: omega * omega })
    }

    /// omega^2 M of the deflection that the unknowns describe.
    pub(super) fn of(&self, unknowns: &[Complex64]) -> Vec<Complex64> {
        let deflection = |link: &Link| -> Complex64 {
            link.deflects.iter().map(|&(at, share)| unknowns[at] * share).sum()
        };
        let deflections = DVector::from_iterator(self.links.len(), self.links.iter().map(deflection));
        let pressures = self.mass.pressure(deflections);
        let mut forces = vec![Complex64::ZERO; self.unknowns];
        for ((link, panel), pressure) in self.links.iter().zip(self.mass.panels()).zip(pressures.iter()) {
            // Twice: for the mirror image.
            let force = pressure * (2.0 * panel.weight * self.omega_squared);
            for &(at, share) in &link.resisted {
                forces[at] += force * share;
            }
        }
        forces
    }
}

impl Link {
    fn new(section: &Section, mesh: &Mesh, outline: &Outline<'_>, panel: &Panel) -> Self {
        let [x, z] = panel.centre;
        let values = section.values(z / outline.at(x).value.exp());
        let at = |x: f64, factor: f64| -> Shares {
            let (element, t) = mesh.locate(x);
            let (_, h) = mesh.element(element);
            let cubics = along(t, h, mesh.unit_m);
            let share = |number: usize, order: usize| {
                (unknown(section, element, number, order), factor * cubics[number][0] * values[order])
            };
            (0..4)
                .flat_map(|number| (0..section.orders).map(move |order| (number, order)))
                .map(|(number, order)| share(number, order))
                .collect()
        };
        let (from, to) = panel.extent();
        let resisted = gauss(FORCES).into_iter().flat_map(|(t, weight)| at(from + t * (to - from), weight));
        Self { deflects: at(x, 1.0), resisted: resisted.collect() }
    }
}
