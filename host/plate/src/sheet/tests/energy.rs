//! The energy of the discrete sheet, which every step conserves exactly if nothing drives or damps the sheet.
//!
//! Leapfrog keeps E = 1/2 |v+ - v|^2_M/dt^2 + 1/2 v+ K v with the lumped mass M and the stiffness K of the grid's
//! links: multiply M (v+ - 2 v + v-)/dt^2 = -K v by (v+ - v-) and sum, K being symmetric. It is positive as long as
//! dt^2 K/M < 4, which is the stability limit.

use crate::sheet::Sheet;
use crate::sheet::air_wave::AirWave;
use crate::sheet::contact::Contact;
use crate::sheet::embedded_boundary::EmbeddedBoundary;
use crate::sheet::fdtd::FdtdGrid;
use crate::sheet::row::Row;
use std::cmp::Ordering;

impl Sheet {
    /// Energy per surface density, J/(kg/m^2): 1/2 integral of v_t^2 + c^2 (|grad v|^2 - a v^2) over the plate, and that of
    /// the mass of a finger on it; without air v is the displacement and a is 0.
    ///
    /// Without loss and with a held or free driven end it is constant except for rounding.
    pub(super) fn energy_j_per_kg_m2(&self) -> f64 {
        let (mirrored, step_s, wave) = (self.mirrored, self.step_s, &self.wave);
        let unit = energy(&self.fdtd, &self.edge, mirrored, step_s, wave, self.contact.as_ref());
        unit * self.full_scale_m.powi(2)
    }
}

/// Energy per surface density with v of the grid in its own unit: 1/2 integral of v_t^2 + c^2 (v_x^2 + v_z^2 - a v^2) over the
/// whole plate, m^2/s^2 times the unit squared; the mass of a finger moves with the plate.
fn energy(
    fdtd: &FdtdGrid,
    edge: &EmbeddedBoundary,
    mirrored: bool,
    step_s: f64,
    wave: &AirWave,
    contact: Option<&Contact>,
) -> f64 {
    let middle = if mirrored { 0 } else { edge.rows() - 1 };
    // The newest field and the one before it; zero outside the plate.
    let at = |row: Option<usize>, station: usize| match row {
        Some(row) if row < fdtd.rows() => {
            let value = |row: Row<'_>| row.get(station).map_or(0.0, f64::from);
            (value(fdtd.newest(row)), value(fdtd.row_before(row)))
        }
        _ => (0.0, 0.0),
    };
    let (mut moving, mut along, mut across, mut lifted) = (0.0, 0.0, 0.0, 0.0);
    for row in 0..fdtd.rows() {
        let from_centre = row.abs_diff(middle);
        let twins = if mirrored && row > 0 { 2.0 } else { 1.0 };
        // Links to the outer neighbours and their number; the centre line has one on each side.
        let outward: &[(Option<usize>, f64)] = match (mirrored, row.cmp(&middle)) {
            (true, _) => &[(Some(row + 1), 2.0)],
            (false, Ordering::Greater) => &[(Some(row + 1), 1.0)],
            (false, Ordering::Less) => &[(row.checked_sub(1), 1.0)],
            (false, Ordering::Equal) => &[(Some(row + 1), 1.0), (row.checked_sub(1), 1.0)],
        };
        for station in edge.stations(from_centre) {
            // The driven column is half a cell wide.
            let share = if station == 0 { 0.5 } else { 1.0 };
            let (new, old) = at(Some(row), station);
            let load =
                contact.map_or(0.0, |contact| contact.load(edge, station, from_centre, step_s, wave).mass);
            moving += twins * share * (1.0 + load) * (new - old).powi(2);
            lifted += twins * share * wave.lift_per_m2(station) * new * old;
            let (next_new, next_old) = at(Some(row), station + 1);
            along += twins * edge.along_link(station, from_centre) * (next_new - new) * (next_old - old);
            let weight = share * edge.across_link(station, from_centre);
            for &(other, count) in outward {
                let (other_new, other_old) = at(other, station);
                across += count * weight * (other_new - new) * (other_old - old);
            }
        }
    }
    let cell = edge.dx * edge.dz;
    let bent = along / edge.dx.powi(2) + across / edge.dz.powi(2) - lifted;
    let stiff = wave.speed_m_per_s.powi(2) * bent;
    0.5 * cell * (moving / step_s.powi(2) + stiff)
}
