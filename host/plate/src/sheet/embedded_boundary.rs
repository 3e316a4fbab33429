//! The plate's edge as a boundary embedded in the grid.
//!
//! Grid points closer to the edge than half a cell count as edge (v = 0). So the outermost point inside is 0.5 to 1.5
//! cells from the edge, and its link to the edge has the weight 1/(that distance) instead of 1. This changes only the
//! diagonal of the symmetric stiffness matrix and keeps its row sums below the bound 4/dx^2 + 4/dz^2 of a uniform
//! grid. The scheme is therefore stable up to the Courant number of a uniform grid for every shape of the edge, and
//! its error is of second order (Gibou et al. 2002, J. Comput. Phys. 176, 205).

use super::air_wave::Stations;
use crate::definition::plate::Plate;

/// Decay, in nepers, between the last turning point and the end of the grid: a wave reflected there returns with
/// e^-12.
const BEYOND_EXPONENTS: f64 = 6.0;

/// The plate on a grid of stations along x (0 = the driven column) and rows z = j dz from the centre line.
#[derive(Debug, Clone)]
pub(super) struct EmbeddedBoundary {
    pub(super) dx: f64,
    pub(super) dz: f64,
    /// Number of stations inside the plate in each row, without station 0; it never increases from row to row.
    pub(super) reach: Vec<usize>,
    /// Half-width at each station.
    half_width: Vec<f64>,
    /// Position x where each row meets the edge, metres.
    row_end: Vec<f64>,
}

impl EmbeddedBoundary {
    /// `along` cells on the plate's length and `across` cells on the half-width at the driven end.
    pub(super) fn new(plate: &Plate, along: usize, across: usize) -> Self {
        let dx = plate.length_m() / along as f64;
        let dz = plate.half_width_m(0.0) / across as f64;
        let end = station_of_end(plate, along, dx, dz);
        // The grid ends at a fixed edge one cell beyond its last station.
        let half_width: Vec<f64> = (0..end).map(|station| plate.half_width_m(station as f64 * dx)).collect();
        let rows = across.max(1);
        let reach = (0..rows)
            .map(|row| half_width.iter().skip(1).take_while(|w| **w - row as f64 * dz >= 0.5 * dz).count())
            .collect();
        let far = end as f64 * dx;
        let row_end = (0..rows)
            .map(|row| if row == 0 { far } else { plate.width.place_of((row as f64 * dz).ln()).min(far) })
            .collect();
        Self { dx, dz, reach, half_width, row_end }
    }

    /// Its stations along the plate.
    pub(super) fn along(&self) -> Stations {
        Stations { step_m: self.dx, count: self.half_width.len() }
    }

    /// Rows on one side of the centre line, the centre line included.
    pub(super) fn rows(&self) -> usize {
        self.reach.len()
    }

    /// Half-width at a station, metres.
    pub(super) fn half_width_m(&self, station: usize) -> f64 {
        self.half_width[station]
    }

    /// Number of cells of `row` whose neighbours are all inside, so that they have the common weights.
    pub(super) fn plain(&self, row: usize) -> usize {
        let farther = self.reach.get(row + 1).copied().unwrap_or(0);
        farther.min(self.reach[row].saturating_sub(1))
    }

    /// Weight of the link from `station` of `row` to the next station.
    pub(super) fn along_link(&self, station: usize, row: usize) -> f64 {
        if station < self.reach[row] {
            return 1.0;
        }
        1.0 / ((self.row_end[row] - station as f64 * self.dx) / self.dx).max(0.5)
    }

    /// Weight of the link from `row` to the next row outward, at `station`.
    pub(super) fn across_link(&self, station: usize, row: usize) -> f64 {
        let inside = match self.reach.get(row + 1) {
            Some(&reach) => station <= reach,
            None => false,
        };
        if inside {
            return 1.0;
        }
        1.0 / (self.half_width[station] / self.dz - row as f64).clamp(0.5, 1.5)
    }

    /// Stations of `row` inside the plate, the driven column included.
    #[cfg(test)]
    pub(super) fn stations(&self, row: usize) -> std::ops::RangeInclusive<usize> {
        0..=self.reach[row]
    }
}

/// The first station beyond the grid. The taper is continued beyond the plate's end, as in the frequency domain, until
/// the wave of the highest frequency has decayed or the plate is narrower than the grid can resolve.
fn station_of_end(plate: &Plate, along: usize, dx: f64, dz: f64) -> usize {
    let width_mode = plate.width_mode(1);
    let axial = width_mode.axial_squared(plate.band_hz().1);
    let mut exponents = 0.0;
    for station in 0..2 * along {
        let x = station as f64 * dx;
        exponents += (width_mode.width_term(x) - axial).max(0.0).sqrt() * dx;
        let gone = x > 0.98 * plate.width.reach_m() || plate.half_width_m(x) < dz;
        if station > along && (exponents > BEYOND_EXPONENTS || gone) {
            return station;
        }
    }
    2 * along
}
