//! The fields of a table's tones on a plate.

use super::error::TextureError;
use super::nnls::Columns;
use crate::definition::plate::Plate;
use crate::frequency::equation::Equation;
use crate::frequency::numerov::{self, Grid};
use crate::table::DriveTable;
use num_complex::Complex64;

/// Number of places along the plate at which a texture is fitted, uniform from 0 to the plate's end.
pub const PLACES: usize = 201;

/// The tones of a table, and the field of each.
pub struct Palette<'a> {
    plate: &'a Plate,
    table: &'a DriveTable,
    grid: Grid,
    /// Grid points from one place to the next.
    stride: usize,
}

impl<'a> Palette<'a> {
    /// The tones of `table` on `plate`; the table was made for this plate or for a similar one.
    pub fn new(plate: &'a Plate, table: &'a DriveTable) -> Self {
        let highest_hz = table.frequency_hz(table.span_m().1);
        let step_m = plate.length_m() / (PLACES - 1) as f64;
        let stride = numerov::refinement(plate, highest_hz, step_m);
        let grid = Grid::new(plate, Equation::Corrected, PLACES, stride);
        Self { plate, table, grid, stride }
    }

    /// The plate.
    pub fn plate(&self) -> &'a Plate {
        self.plate
    }

    /// The table.
    pub fn table(&self) -> &'a DriveTable {
        self.table
    }

    /// Position of each place, metres from the driven end.
    pub fn places_m(&self) -> Vec<f64> {
        let step_m = self.plate.length_m() / (PLACES - 1) as f64;
        (0..PLACES).map(|place| place as f64 * step_m).collect()
    }

    /// The mean square displacement at each place for a tone of level 1 with its turning point at each of `positions_m`
    /// (in the table's span, metres); one column per tone, in units of the table's peak at full scale, squared.
    ///
    /// # Errors
    /// [`TextureError::Silent`] if a field is not finite, because the plate's loss or its actuator leaves no amplitude.
    pub fn squares(&self, positions_m: &[f64]) -> Result<Columns, TextureError> {
        let mut columns = Columns::new(PLACES);
        self.each_field(positions_m, |field, scale| {
            columns.push(field.iter().map(|f| 0.5 * (f * scale).norm_sqr()));
        });
        if columns.iter().flatten().all(|value| value.is_finite()) {
            Ok(columns)
        } else {
            Err(TextureError::Silent)
        }
    }

    /// The complex displacement f of each tone of [`Palette::squares`] at each place, in units of the table's peak at
    /// full scale; the displacement at the time t is Re(f e^(-j omega t)).
    ///
    /// # Errors
    /// As [`Palette::squares`].
    pub(super) fn fields(&self, positions_m: &[f64]) -> Result<Vec<Vec<Complex64>>, TextureError> {
        let mut fields: Vec<Vec<Complex64>> = Vec::new();
        self.each_field(positions_m, |field, scale| fields.push(field.iter().map(|f| f * scale).collect()));
        if fields.iter().flatten().all(|value| value.is_finite()) {
            Ok(fields)
        } else {
            Err(TextureError::Silent)
        }
    }

    /// Calls `visit` with each tone's field over the driven end's displacement, and with [`Palette::scale`].
    fn each_field(&self, positions_m: &[f64], mut visit: impl FnMut(&[Complex64], Complex64)) {
        let frequencies: Vec<f64> = positions_m.iter().map(|&x| self.table.frequency_hz(x)).collect();
        numerov::solve_each_apart(&self.grid, self.plate, &frequencies, self.stride, |number, field| {
            visit(field, self.scale(positions_m[number]));
        });
    }

    /// Displacement of the driven end for a tone of level 1, over the table's peak at full scale.
    fn scale(&self, position_m: f64) -> Complex64 {
        self.table.driven_end_m(self.plate, position_m) / self.table.peak_at_full_scale_m()
    }
}
