//! The cost of a sheet, computed before the sheet is built.

use super::air_wave::{AirWave, WAVENUMBER_ERROR_MAX};
use super::distant_air;
use super::embedded_boundary::EmbeddedBoundary;
use super::grid::{CELLS_MAX, SheetError, SheetGrid};
use super::source::{DriveCondition, StepRatio};
use crate::definition::actuator::{Actuator, Resonator};
use crate::definition::model::Model;
use crate::definition::plate::Plate;
use crate::quantity::{Count, Counted, WrongCount};

/// Courant number of the step; the limit of stability is 1.
const COURANT: f64 = 0.99;

/// The work of a sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Cells that a step updates.
    pub cells: usize,
    /// Steps per second of plate time.
    pub step_rate_hz: f64,
    /// Largest relative error of the wavenumber in air, at any place that a wave reaches: from the lower frequency of
    /// [`SheetGrid::air_at_hz`] to the higher, or in the whole band of the plate. In a baffle it includes the air's coupling
    /// between distant places, as the error that would move a peak as far. 0 without air. Air adds neither cells nor steps.
    pub wavenumber_error: f64,
}

impl Cost {
    /// Cell updates per second of plate time; one processor core does about 1e9 per second.
    pub fn updates_per_second(&self) -> f64 {
        self.cells as f64 * self.step_rate_hz
    }
}

/// The grid of a sheet in metres, and the length of its steps.
pub(super) struct Layout {
    pub(super) edge: EmbeddedBoundary,
    pub(super) ratio: StepRatio,
    pub(super) step_s: f64,
    pub(super) wave: AirWave,
    pub(super) wavenumber_error: f64,
    /// Whether one half is computed and mirrored at the centre line.
    pub(super) mirrored: bool,
    /// The condition at the driven end.
    pub(super) condition: DriveCondition,
    /// The actuator's resonance before it.
    pub(super) resonator: Option<Resonator>,
}

impl Layout {
    pub(super) fn new(plate: &Plate, sample_rate_hz: f64, grid: &SheetGrid) -> Result<Self, SheetError> {
        let model = &plate.spec().model;
        let Some(speed_m_per_s) = model.wave_speed_m_per_s() else {
            let name = plate.name().to_owned();
            return Err(match model {
                Model::Membrane { .. } => SheetError::Film { plate: name },
                _ => SheetError::Bends { plate: name },
            });
        };
        let condition = DriveCondition::of(plate)?;
        let resonator = plate.spec().actuator.as_ref().and_then(Actuator::resonator).copied();
        grid.validate(sample_rate_hz)?;
        let cells = 2 * grid.along * grid.across;
        WrongCount::check("the grid", cells, Count::at_most(CELLS_MAX, Counted::Cells))?;
        let edge = EmbeddedBoundary::new(plate, grid.along, grid.across);
        let band_hz = grid.air_at_hz.unwrap_or_else(|| plate.band_hz());
        let wave = AirWave::of(plate, band_hz, edge.along());
        let wavenumber_error =
            wave.error_between(plate, band_hz) + distant_air::error_between(plate, band_hz);
        // Between two tones that are stated there may be none.
        let error = match grid.air_at_hz {
            Some((low_hz, high_hz)) => [low_hz, high_hz]
                .map(|tone_hz| wave.error_at(plate, tone_hz) + distant_air::error_at(plate, tone_hz))
                .into_iter()
                .fold(0.0, f64::max),
            None => wavenumber_error,
        };
        if error > WAVENUMBER_ERROR_MAX {
            return Err(SheetError::Air { plate: plate.name().to_owned(), error });
        }
        // In air the wave of the sheet is slower.
        let longest = COURANT / (speed_m_per_s * (edge.dx.powi(-2) + edge.dz.powi(-2)).sqrt());
        let ratio = StepRatio::new(sample_rate_hz, longest)?;
        let mirrored = !grid.whole && grid.drive.is_symmetric();
        Ok(Self {
            step_s: ratio.step_s(sample_rate_hz),
            edge,
            ratio,
            wave,
            wavenumber_error,
            mirrored,
            condition,
            resonator,
        })
    }

    fn cost(&self) -> Cost {
        let half: usize = self.edge.reach.iter().map(|reach| reach + 1).sum();
        let centre = self.edge.reach.first().map_or(0, |reach| reach + 1);
        let cells = if self.mirrored { half } else { 2 * half - centre };
        Cost { cells, step_rate_hz: 1.0 / self.step_s, wavenumber_error: self.wavenumber_error }
    }
}

impl SheetGrid {
    /// The work of a sheet on this grid, without building the sheet.
    ///
    /// # Errors
    /// [`SheetError`] as [`super::Sheet::new`].
    pub fn cost(&self, plate: &Plate, sample_rate_hz: f64) -> Result<Cost, SheetError> {
        Ok(Layout::new(plate, sample_rate_hz, self)?.cost())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Sheet;
    use super::*;
    use crate::definition::presets::preset;

    #[test]
    fn the_reported_cost_matches_the_sheet_that_is_built() {
        for (name, whole) in [("membrane", false), ("membrane", true), ("al-sh", false)] {
            let plate = preset(name).expect("a preset");
            let grid = SheetGrid { whole, ..SheetGrid::coarse(&plate) };
            let cost = grid.cost(&plate, 400e3).expect("no bending");
            let sheet = Sheet::new(&plate, 400e3, grid).expect("no bending");
            assert_eq!(cost.cells, sheet.cells(), "{name} {whole}");
            assert_eq!(cost.updates_per_second(), sheet.updates_per_second(), "{name} {whole}");
        }
        let bending = preset("al-bending").expect("a preset");
        let refused = SheetGrid::coarse(&bending).cost(&bending, 400e3);
        assert!(matches!(refused, Err(SheetError::Bends { .. })));
    }
}
