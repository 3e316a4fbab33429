//! The displacement over the plate's surface, for the colours of window and figure: from the 2-D sheet if it
//! runs, else from the modal lines.

use crate::field::sheet::Frame;
use crate::field::steady_field::{POINTS, SteadyField, interpolate};
use slipline_plate::quantity::ticks::round_step;
use slipline_plate::{Complex64, Model, Plate};
use std::f64::consts::TAU;

/// The state of the plate, and whether its largest or its present displacement is shown.
#[derive(Clone, Copy, Debug)]
pub struct Wave<'a> {
    /// The plate.
    pub plate: &'a Plate,
    /// The steady field of its tones; `None` at rest.
    pub sounding: Option<&'a SteadyField>,
    /// The sheet, if the wave is taken from it.
    pub sheet: Option<&'a Frame>,
    /// Whether the largest displacement is shown, not the present one.
    pub is_largest: bool,
    /// Seconds of slow motion so far.
    pub time_s: f64,
}

/// The slow-motion factor, a round number, so that one period of the slowest tone takes about 1.5 s.
#[must_use]
pub fn slow_factor(steady: &SteadyField) -> f64 {
    let slowest = steady.tones.iter().map(|wave| wave.tone.frequency_hz).fold(f64::INFINITY, f64::min);
    if slowest.is_finite() { round_step(slowest * 1.2) } else { 1.0 }
}

/// The displacement of a [`Wave`] everywhere on the plate.
pub struct DisplacementMap<'a> {
    wave: Wave<'a>,
    /// On the centre line, at [`POINTS`] places; empty if unused.
    centre_m: Vec<f64>,
}

/// A line along the plate at a constant share of the half-width.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Its place across the plate over the half-width there, -1..=1.
    pub beta: f64,
    /// Displacement in the first width mode: 1 on the centre line.
    shape: f64,
}

/// A line across the plate, with the values that are constant along it.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    x_m: f64,
    /// Half the plate's width there, in metres.
    pub half_width_m: f64,
    /// Displacement on the centre line by the modal lines, in metres.
    centre_m: f64,
}

impl<'a> DisplacementMap<'a> {
    /// The surface of this wave.
    #[must_use]
    pub fn new(wave: Wave<'a>) -> Self {
        let centre_m = match wave.sounding {
            Some(steady) if wave.sheet.is_none() => centre(steady, &wave),
            _ => Vec::new(),
        };
        Self { wave, centre_m }
    }

    /// A row across the plate, at this share of the half-width.
    #[must_use]
    pub fn row(&self, beta: f64) -> Row {
        Row { beta, shape: mode_shape(&self.wave.plate.spec().model, beta) }
    }

    /// The column at a place from the driven end, in metres.
    #[must_use]
    pub fn column(&self, x_m: f64) -> Column {
        let plate = self.wave.plate;
        let centre_m = match self.centre_m.as_slice() {
            [] => 0.0,
            centre_m => interpolate(centre_m, x_m / plate.length_m()),
        };
        Column { x_m, half_width_m: plate.half_width_m(x_m), centre_m }
    }

    /// The column at this share (0..=1) of the plate's length.
    #[must_use]
    pub fn column_at(&self, share: f64) -> Column {
        self.column(share * self.wave.plate.length_m())
    }

    /// The displacement where a column and a row cross, in metres; 0 at rest.
    #[must_use]
    pub fn at(&self, column: &Column, row: &Row) -> f64 {
        match self.wave.sheet {
            _ if self.wave.sounding.is_none() => 0.0,
            Some(sheet) => {
                let (x_m, z_m) = (column.x_m, row.beta * column.half_width_m);
                if self.wave.is_largest { sheet.largest_m(x_m, z_m) } else { sheet.now_m(x_m, z_m) }
            }
            None => column.centre_m * row.shape,
        }
    }
}

fn centre(steady: &SteadyField, wave: &Wave<'_>) -> Vec<f64> {
    if wave.is_largest {
        return steady.bound_m.clone();
    }
    let factor = slow_factor(steady);
    let mut centre_m = vec![0.0; POINTS];
    for tone in &steady.tones {
        let turn = Complex64::cis(-TAU * tone.tone.frequency_hz / factor * wave.time_s);
        for (value, amplitude) in centre_m.iter_mut().zip(&tone.wave) {
            *value += (amplitude * turn).re;
        }
    }
    centre_m
}

/// Displacement across the plate at beta = z/W, -1..=1, for the first width mode: 1 on the centre line.
pub(crate) fn mode_shape(model: &Model, beta: f64) -> f64 {
    match model {
        Model::BendingClamped(_) => {
            // First mode of a beam with both ends clamped: q = 2.36502 solves tan q + tanh q = 0.
            let q = 2.365_02f64;
            let at = |beta: f64| (q * beta).cosh() / q.cosh() - (q * beta).cos() / q.cos();
            at(beta) / at(0.0)
        }
        Model::Membrane { .. } | Model::ShearHorizontal { .. } | Model::BendingSupported(_) => {
            (std::f64::consts::FRAC_PI_2 * beta).cos()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::steady_field::SteadyTone;

    #[test]
    fn the_wave_is_still_at_the_fixed_edges_and_full_on_the_centre_line() {
        for preset in slipline_plate::presets() {
            let plate = slipline_plate::preset(preset.name).unwrap();
            let model = &plate.spec().model;
            assert!((mode_shape(model, 0.0) - 1.0).abs() < 1e-9);
            assert!(mode_shape(model, 1.0).abs() < 1e-4 && mode_shape(model, -1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn the_wave_stays_within_its_largest_and_rest_is_flat() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let frequency_hz = plate.frequency_for_boundary_hz(0.18);
        let steady = SteadyField::solve(&plate, &[SteadyTone { slot: 0, frequency_hz, peak_m: 1e-4 }]);
        let wave =
            |sounding, is_largest| Wave { plate: &plate, sounding, sheet: None, is_largest, time_s: 0.7 };
        let (now, largest) = (
            DisplacementMap::new(wave(Some(&steady), false)),
            DisplacementMap::new(wave(Some(&steady), true)),
        );
        let rest = DisplacementMap::new(wave(None, true));
        for i in 0..=50 {
            let x_m = plate.length_m() * f64::from(i) / 50.0;
            let row = now.row(0.4);
            let column = now.column(x_m);
            assert!(now.at(&column, &row).abs() <= largest.at(&largest.column(x_m), &row) + 1e-12);
            assert_eq!(rest.at(&rest.column(x_m), &row), 0.0);
        }
        let peak_m = steady.tones[0].peak_position_m.unwrap();
        assert!((largest.at(&largest.column(peak_m), &largest.row(0.0)) / 1e-4 - 1.0).abs() < 0.02);
    }
}
