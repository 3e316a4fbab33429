//! The plate in two dimensions, in the time domain: the scalar wave equation on the tapered plate, driven by DAC codes.
//!
//! ```text
//!  codes -> mean or hold per step (curves of the drive: filter, spline) -> actuator -> driven column -> FDTD grid (rows x stations) -> field, envelope
//! ```
//!
//! v_tt + r v_t = c^2 (v_xx + v_zz), v = 0 at z = +-W(x), on a uniform grid with an embedded boundary; a finger adds
//! mass and resistance where it lies. This is the model of a stretched membrane and of the shear-horizontal wave, with
//! all width modes and their coupling. The air that a membrane carries adds a term a(x) v, which makes the wavenumber along the
//! plate that of the tones that sound ([`SheetGrid::at_tones`]). Bending has another equation (dispersive, of fourth
//! order), which only [`crate::TimeDomainLine`] solves.

mod air_wave;
mod band;
mod block;
mod contact;
mod cost;
mod distant_air;
mod drive;
mod embedded_boundary;
mod fdtd;
mod grid;
mod halo;
mod kernel;
#[cfg(test)]
mod naive;
mod record;
mod row;
mod scheme;
mod source;
#[cfg(test)]
mod tests;
mod tiling;
mod vector;

pub use cost::Cost;
pub use fdtd::FdtdGrid;
pub use grid::{DriveShape, EnvelopeScope, SheetError, SheetGrid};

use crate::definition::plate::Plate;
use crate::frequency::Finger;
use air_wave::AirWave;
use contact::Contact;
use cost::Layout;
use drive::CurvedDrive;
use embedded_boundary::EmbeddedBoundary;
use scheme::Scheme;
use source::{DriveCondition, Source};
use std::f64::consts::TAU;
use std::iter::repeat;

/// Steps that are collected before the grid advances; more if a single code gives more steps.
const STEPS_AT_ONCE: usize = 4096;

/// The largest and the root-mean-square displacement since the last reset.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetEnvelope {
    /// Number of recorded steps.
    pub steps: u64,
    /// Largest |v| in metres: one number per station if only the centre line is recorded, else row by row as
    /// [`Sheet::field_m`].
    pub maximum_m: Vec<f32>,
    /// Root mean square of v in metres, in the order of `maximum_m`.
    pub rms_m: Vec<f32>,
}

/// What the scheme of a sheet was made from.
#[derive(Debug)]
struct Tuning {
    plate: Plate,
    grid: SheetGrid,
    condition: DriveCondition,
}

/// A tapered plate in two dimensions in the time domain.
///
/// ```
/// use slipline_plate::{Sheet, SheetGrid, preset};
///
/// let plate = preset("membrane").unwrap();
/// let mut sheet = Sheet::new(&plate, 400e3, SheetGrid::new(64, 8)).unwrap();
/// sheet.push(&[1.0; 4000]);
/// let mut centre_line = vec![0.0; sheet.positions_m().len()];
/// sheet.centre_line_m(&mut centre_line);
/// assert!(centre_line.iter().any(|displacement_m| *displacement_m != 0.0));
/// ```
#[derive(Debug)]
pub struct Sheet {
    fdtd: FdtdGrid,
    edge: EmbeddedBoundary,
    contact: Option<Contact>,
    source: Source,
    mirrored: bool,
    positions_m: Vec<f64>,
    widths_m: Vec<f64>,
    step_s: f64,
    wave: AirWave,
    /// The coefficients of the wave in air, for a plate that carries air.
    tuning: Option<Box<Tuning>>,
    full_scale_m: f64,
    scope: EnvelopeScope,
    recorded_since: u64,
    steps: Vec<f32>,
}

impl Sheet {
    /// A sheet at rest, driven by codes of `sample_rate_hz` (1000 to 1e8, and at least a millionth of the step rate
    /// that the grid needs).
    ///
    /// # Errors
    /// [`SheetError::Bends`] for a plate in bending, [`SheetError::Film`] for a stiff film, [`SheetError::Air`] for one whose wavenumber in air the sheet would miss
    /// by more than 1 %, [`SheetError::OutOfRange`] for a field of `grid` or the sample rate,
    /// [`SheetError::TooBig`] for more than 2^23 cells. With a measured actuator or a calibrated drive,
    /// [`SheetError::SampleRate`] for a rate that does not carry the plate's band and [`SheetError::Drive`] for a curve
    /// that changes too fast with the frequency; such a sheet is driven within the plate's band alone, as a
    /// [`crate::TimeDomainLine`].
    pub fn new(plate: &Plate, sample_rate_hz: f64, grid: SheetGrid) -> Result<Self, SheetError> {
        Self::touched(plate, None, sample_rate_hz, grid)
    }

    /// As [`Sheet::new`], with a finger that rests on the sheet where there is one: its impedance acts everywhere in its contact, as in
    /// [`crate::plane`]. A cell that the contact covers in part has that part of it.
    ///
    /// # Errors
    /// As [`Sheet::new`], and [`SheetError::Finger`].
    pub fn touched(
        plate: &Plate,
        finger: Option<&Finger>,
        sample_rate_hz: f64,
        grid: SheetGrid,
    ) -> Result<Self, SheetError> {
        let contact = finger.map(|finger| Contact::new(plate, finger)).transpose();
        let contact = contact.map_err(SheetError::Finger)?;
        let Layout { edge, ratio, step_s, wave, mirrored, condition, resonator, .. } =
            Layout::new(plate, sample_rate_hz, &grid)?;
        let curve = CurvedDrive::of(plate, sample_rate_hz)?;
        let damping = damping_per_s(plate, &grid, &wave);
        let scheme = Scheme {
            edge: &edge,
            wave: &wave,
            step_s,
            damping,
            mirrored,
            grid: &grid,
            contact: contact.as_ref(),
        };
        let (plan, term) = scheme.plan(condition);
        let side = edge.rows() as isize - 1;
        Ok(Self {
            fdtd: FdtdGrid::new(plan, grid.threads),
            source: Source::new(ratio, step_s, term, resonator.as_ref(), curve),
            mirrored,
            positions_m: (0..=grid.along).map(|station| station as f64 * edge.dx).collect(),
            widths_m: (-side..=side).map(|row| row as f64 * edge.dz).collect(),
            step_s,
            wave,
            tuning: plate.carries_air().then(|| Box::new(Tuning { plate: plate.clone(), grid, condition })),
            full_scale_m: plate.spec().full_scale_m,
            scope: grid.envelope,
            recorded_since: 0,
            contact,
            edge,
            steps: Vec::with_capacity(STEPS_AT_ONCE),
        })
    }

    /// Drives the plate with codes of -1 to 1 of full scale. Larger codes are clamped; NaN and infinity count as 0.
    pub fn push(&mut self, codes: &[f32]) {
        for part in codes.chunks(self.source.codes_for(STEPS_AT_ONCE)) {
            self.steps.clear();
            self.source.take(part, &mut self.steps);
            self.fdtd.advance(&self.steps);
        }
    }

    /// Makes the wavenumber in air that of the plate at these tones, Hz, as [`SheetGrid::at_tones`] does, and keeps the field:
    /// the next step is the first with it. Without air, or without tones, it changes nothing.
    pub fn retune(&mut self, tones_hz: &[f64]) {
        let Some(Tuning { plate, grid, condition }) = self.tuning.as_deref() else { return };
        let Some(band_hz) = AirWave::band_of(tones_hz) else { return };
        self.wave = AirWave::of(plate, band_hz, self.edge.along());
        let (edge, step_s, mirrored) = (&self.edge, self.step_s, self.mirrored);
        let (damping, contact) = (damping_per_s(plate, grid, &self.wave), self.contact.as_ref());
        let scheme = Scheme { edge, wave: &self.wave, step_s, damping, mirrored, grid, contact };
        let (plan, term) = scheme.plan(*condition);
        self.fdtd.reweigh(plan);
        self.source.set_term(term);
    }

    /// Stations along x, metres: 0 to the plate's length.
    pub fn positions_m(&self) -> &[f64] {
        &self.positions_m
    }

    /// Rows across z, metres: symmetric about 0.
    pub fn widths_m(&self) -> &[f64] {
        &self.widths_m
    }

    /// Writes the displacement in metres, row by row (`widths_m` x `positions_m`); 0 outside the plate. `out` may be
    /// shorter.
    pub fn field_m(&self, out: &mut [f32]) {
        for (line, out) in out.chunks_mut(self.positions_m.len()).take(self.widths_m.len()).enumerate() {
            self.line_m(line, out);
        }
    }

    /// Writes the displacement on the centre line in metres, one number per station; `out` may be shorter.
    pub fn centre_line_m(&self, out: &mut [f32]) {
        self.line_m(self.widths_m.len() / 2, out);
    }

    /// Writes line `line` of the field in metres, zero beyond its last cell.
    fn line_m(&self, line: usize, out: &mut [f32]) {
        let row = self.fdtd.row(self.fdtd_row(line)).enumerate();
        let row = row.map(|(station, value)| self.scale_m(station) as f32 * value);
        for (out, value) in out.iter_mut().zip(row.chain(repeat(0.0))) {
            *out = value;
        }
    }

    /// The displacement at a station over the number on the grid, metres.
    fn scale_m(&self, station: usize) -> f64 {
        self.full_scale_m / self.wave.root_weight(station)
    }

    /// The envelope since the last reset.
    pub fn envelope(&self) -> SheetEnvelope {
        let steps = self.fdtd.steps() - self.recorded_since;
        let stations = self.positions_m.len();
        let middle = self.widths_m.len() / 2;
        let lines = match self.scope {
            EnvelopeScope::CentreLine => middle..middle + 1,
            EnvelopeScope::Everywhere => 0..self.widths_m.len(),
        };
        let count = lines.len() * stations;
        let mut envelope = SheetEnvelope { steps, maximum_m: vec![0.0; count], rms_m: vec![0.0; count] };
        for (place, line) in lines.enumerate() {
            let Some(cells) = self.fdtd.envelope(self.fdtd_row(line)) else { continue };
            let to = place * stations;
            for (station, (maximum, squares)) in cells.take(stations).enumerate() {
                envelope.maximum_m[to + station] = (f64::from(maximum) * self.scale_m(station)) as f32;
                let mean = squares / steps.max(1) as f64;
                envelope.rms_m[to + station] = (mean.sqrt() * self.scale_m(station)) as f32;
            }
        }
        envelope
    }

    /// Restarts the envelope.
    pub fn reset_envelope(&mut self) {
        self.recorded_since = self.fdtd.steps();
        self.fdtd.reset_envelope();
    }

    /// Steps per second of plate time.
    pub fn step_rate_hz(&self) -> f64 {
        1.0 / self.step_s
    }

    /// Number of cells that a step updates.
    pub fn cells(&self) -> usize {
        self.fdtd.plan().reach.iter().map(|reach| reach + 1).sum()
    }

    /// Cell updates per second of plate time. Below about 1e9 per processor core the sheet runs in real time.
    pub fn updates_per_second(&self) -> f64 {
        self.cells() as f64 * self.step_rate_hz()
    }

    /// The grid row that holds line `line` of the field.
    fn fdtd_row(&self, line: usize) -> usize {
        if self.mirrored { line.abs_diff(self.widths_m.len() / 2) } else { line }
    }
}

/// r of the damping term r v_t, 1/s: the loss is that of the plate at one frequency.
fn damping_per_s(plate: &Plate, grid: &SheetGrid, wave: &AirWave) -> f64 {
    let (low, high) = plate.band_hz();
    let loss_at_hz = grid.loss_at_hz.unwrap_or((low * high).sqrt());
    let omega = TAU * loss_at_hz;
    if plate.carries_air() {
        return wave.damping_per_s(plate, loss_at_hz);
    }
    // K^2 (1 + j eta) = (omega^2 + j r omega)/c^2 with r = eta omega.
    plate.stiffness_loss_at(loss_at_hz) * omega
}
