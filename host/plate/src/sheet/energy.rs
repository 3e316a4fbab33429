//! The energy of the discrete sheet, which a step conserves exactly when nothing drives or damps it.
//!
//! Leapfrog keeps E = 1/2 |v+ - v|^2_M/dt^2 + 1/2 v+ K v with the lumped mass M and the stiffness K of the grid's
//! links: multiply M (v+ - 2 v + v-)/dt^2 = -K v by (v+ - v-) and sum, K being symmetric. It is positive as long as
//! dt^2 K/M < 4, which is the stability limit.

use super::lattice::Lattice;
use super::outline::Outline;

/// Energy per surface density with v in the lattice's own unit: 1/2 integral of v_t^2 + c^2 (v_x^2 + v_z^2) over the
/// whole plate, m^2/s^2 times the unit squared.
pub(super) fn energy(lattice: &Lattice, outline: &Outline, mirrored: bool, step_s: f64, speed: f64) -> f64 {
    let side = outline.rows();
    let rows = lattice.rows();
    // Row number in the lattice -> distance from the centre line in rows.
    let distance = |row: usize| if mirrored { row } else { row.abs_diff(side - 1) };
    let at = |fields: (&[f32], &[f32]), station: usize| {
        (f64::from(fields.0[station]), f64::from(fields.1[station]))
    };
    let (mut moving, mut along, mut across) = (0.0, 0.0, 0.0);
    for row in 0..rows {
        let fields = (lattice.row(row), lattice.row_before(row));
        let outward = if mirrored { Some(row + 1) } else { (distance(row) + 1 < side).then_some(row + 1) };
        let next = outward.filter(|&next| next < rows).map(|next| (lattice.row(next), lattice.row_before(next)));
        let from_centre = distance(row);
        let twin = if mirrored && row > 0 { 2.0 } else { 1.0 };
        for station in outline.stations(from_centre) {
            let half = if station == 0 { 0.5 } else { 1.0 };
            let (new, old) = at(fields, station);
            moving += twin * half * (new - old).powi(2);
            // The link to the next station, or to the edge where that is outside.
            let (next_new, next_old) =
                if station < outline.reach[from_centre] { at(fields, station + 1) } else { (0.0, 0.0) };
            along += twin * outline.along_link(station, from_centre) * (next_new - new) * (next_old - old);
            // The link outward; the centre line of a half sheet has two, and so has every other row's twin.
            let weight = outline.across_link(station, from_centre);
            let link = |(a_new, a_old): (f64, f64)| weight * (a_new - new) * (a_old - old);
            if mirrored {
                let other = next.filter(|next| station < next.0.len()).map_or((0.0, 0.0), |next| at(next, station));
                across += 2.0 * half * link(other);
            } else if row + 1 >= side {
                let other = next.filter(|next| station < next.0.len()).map_or((0.0, 0.0), |next| at(next, station));
                across += half * link(other);
            }
            if !mirrored && row < side {
                // The lower side: outward is the row before.
                let other = row
                    .checked_sub(1)
                    .map(|before| (lattice.row(before), lattice.row_before(before)))
                    .filter(|before| station < before.0.len())
                    .map_or((0.0, 0.0), |before| at(before, station));
                across += half * link(other);
            }
        }
    }
    let cell = outline.dx * outline.dz;
    let stiff = speed * speed * (along / outline.dx.powi(2) + across / outline.dz.powi(2));
    0.5 * cell * (moving / step_s.powi(2) + stiff)
}
