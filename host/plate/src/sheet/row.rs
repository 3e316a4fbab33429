//! Access to one row of an FDTD grid by station, independent of the order of its cells in memory.

use super::kernel::place;
use super::vector::LANES;

/// A row: station 0 is the driven column, the following stations are the cells inside the plate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<'a, T = f32> {
    lines: &'a [[T; LANES]],
    reach: usize,
}

impl<'a, T: Copy> Row<'a, T> {
    /// The first of `lines` has the driven column in its last lane; `reach` cells are inside the plate.
    pub(super) fn new(lines: &'a [[T; LANES]], reach: usize) -> Self {
        Self { lines, reach }
    }

    /// The number at a station; `None` beyond the last station.
    pub(super) fn get(self, station: usize) -> Option<T> {
        if station > self.reach {
            return None;
        }
        let (line, lane) = match station.checked_sub(1) {
            Some(cell) => place(cell),
            None => return Some(self.lines[0][LANES - 1]),
        };
        Some(self.lines[1 + line][lane])
    }

    /// The numbers of all stations, in their order.
    pub(super) fn numbers(self) -> impl Iterator<Item = T> + use<'a, T> {
        (0..=self.reach).map_while(move |station| self.get(station))
    }
}
