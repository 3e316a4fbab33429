//! The contact of a finger on the grid: mass and resistance that the cells under it have besides the sheet's own.
//!
//! The finger resists locally with the impedance per area (R - j omega m)/a^2, so under it
//! (1 + m') v_tt + (r + r') v_t = c^2 (v_xx + v_zz) with m' = m/(sigma a^2), r' = R/(sigma a^2) and the sheet's mass per
//! area sigma. In air c is slower than the sheet's V in a vacuum, and both are over the inertia of c and the power weight Omega of
//! the place: m' and r' times c^2/(V^2 Omega).
//! A cell that the contact covers in part has that share of both. More mass than the sheet's own only makes
//! the step of the grid safer, and the resistance is taken in the middle of the step, so the scheme stays stable for
//! every finger.

use super::air_wave::AirWave;
use super::embedded_boundary::EmbeddedBoundary;
use super::kernel::place;
use super::vector::Line;
use crate::definition::plate::Plate;
use crate::frequency::{Finger, RespondError};
use std::ops::Range;

/// A finger's contact with a plate.
#[derive(Debug, Clone)]
pub(super) struct Contact {
    along_m: Range<f64>,
    /// How far it reaches to each side of the centre line, metres, where the plate is that wide.
    half_across_m: f64,
    /// m', the finger's mass per area over the sheet's.
    mass: f64,
    /// r', 1/s.
    damping_per_s: f64,
    /// V, the wave speed of the sheet without air.
    vacuum_m_per_s: f64,
}

/// What a finger adds to a point of the grid: to 1 of the sheet's own mass, and to r dt/2 of its loss.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Load {
    pub(super) mass: f64,
    pub(super) loss: f64,
}

impl Contact {
    pub(super) fn new(plate: &Plate, finger: &Finger) -> Result<Self, RespondError> {
        finger.check(plate)?;
        let density = plate.spec().model.surface_density("a finger").map_err(RespondError::Unstated)?;
        let per_area = 1.0 / (density * finger.contact_m.powi(2));
        let (begins_m, ends_m) = finger.reach(plate);
        Ok(Self {
            along_m: begins_m..ends_m,
            half_across_m: 0.5 * finger.contact_m,
            mass: finger.mass_kg * per_area,
            damping_per_s: finger.resistance_n_s_per_m * per_area,
            vacuum_m_per_s: plate.spec().model.wave_speed_m_per_s().unwrap_or(f64::NAN),
        })
    }

    /// The load on a point `row` rows from the centre line, for steps of `step_s`.
    pub(super) fn load(
        &self,
        edge: &EmbeddedBoundary,
        station: usize,
        row: usize,
        step_s: f64,
        wave: &AirWave,
    ) -> Load {
        let (x, z) = (station as f64 * edge.dx, row as f64 * edge.dz);
        // The driven column has half a cell on the plate.
        let cell_x = (if station == 0 { x } else { x - 0.5 * edge.dx })..x + 0.5 * edge.dx;
        let across_m = self.half_across_m.min(edge.half_width_m(station));
        let share = covered(&cell_x, &self.along_m)
            * covered(&(z - 0.5 * edge.dz..z + 0.5 * edge.dz), &(-across_m..across_m));
        let slower = wave.speed_m_per_s / (self.vacuum_m_per_s * wave.root_weight(station));
        let share = share * slower.powi(2);
        Load { mass: share * self.mass, loss: 0.5 * share * self.damping_per_s * step_s }
    }
}

/// The share of `cell` that `patch` covers.
fn covered(cell: &Range<f64>, patch: &Range<f64>) -> f64 {
    let both = cell.end.min(patch.end) - cell.start.max(patch.start);
    (both / (cell.end - cell.start)).clamp(0.0, 1.0)
}

/// The cells under a finger in the order of the grid's rows. They take the update of all cells, whose own mass is 1 and
/// whose loss is r dt/2, with another past field before it and scaled after it:
///
/// v+ = share ((own v + ..) - past (v- + past_more v- - now v)), which is the update with the finger's mass and loss.
#[derive(Debug, Clone, Default)]
pub(super) struct TouchedCells {
    cells: Vec<TouchedCell>,
    /// The cells of each row in `cells`.
    rows: Vec<Range<usize>>,
}

#[derive(Debug, Clone, Copy)]
struct TouchedCell {
    /// Line, counted from the first line of the row's first chunk, and lane.
    line: usize,
    lane: usize,
    past_more: f32,
    now: f32,
    share: f32,
}

impl TouchedCells {
    /// The cells of rows with the loads `load(row, cell)`, the rows being `reach` cells long. `loss` is r dt/2 of the
    /// sheet.
    pub(super) fn new(reach: &[usize], loss: f64, load: impl Fn(usize, usize) -> Load) -> Self {
        let mut touched = Self::default();
        for (row, &reach) in reach.iter().enumerate() {
            let begins = touched.cells.len();
            let loads = (0..reach).map(|cell| (cell, load(row, cell)));
            touched.cells.extend(loads.filter(|(_, load)| *load != Load::default()).map(|(cell, load)| {
                let (line, lane) = place(cell);
                TouchedCell {
                    line,
                    lane,
                    past_more: ((load.mass - load.loss) / (1.0 - loss)) as f32,
                    now: (2.0 * load.mass / (1.0 - loss)) as f32,
                    share: ((1.0 + loss) / (1.0 + loss + load.mass + load.loss)) as f32,
                }
            }));
            touched.rows.push(begins..touched.cells.len());
        }
        touched
    }

    /// Before the update of a row: `past` and `now` begin at its first chunk.
    #[inline(always)]
    pub(super) fn before(&self, row: usize, past: &mut [Line], now: &[Line]) {
        for cell in self.of(row) {
            let (now, past) = (now[cell.line][cell.lane], &mut past[cell.line][cell.lane]);
            *past = (*past + cell.past_more * *past) - cell.now * now;
        }
    }

    /// After the update of a row: `next` begins at its first chunk.
    #[inline(always)]
    pub(super) fn after(&self, row: usize, next: &mut [Line]) {
        for cell in self.of(row) {
            next[cell.line][cell.lane] *= cell.share;
        }
    }

    #[inline(always)]
    fn of(&self, row: usize) -> &[TouchedCell] {
        self.rows.get(row).map_or(&[], |cells| &self.cells[cells.clone()])
    }
}
