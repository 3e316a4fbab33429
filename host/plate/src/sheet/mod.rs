//! The plate in two dimensions and in time: the scalar wave equation on the tapered plate, driven by DAC codes.
//!
//! ```text
//!  codes -> mean or hold per step -> actuator -> driven column -> lattice (rows x stations) -> field, envelope
//! ```
//!
//! v_tt + r v_t = c^2 (v_xx + v_zz), v = 0 at z = +-W(x), on a uniform grid that the plate's edge cuts. It is the
//! model of a stretched membrane and of the shear-horizontal wave, with all width modes and their coupling; bending
//! is another equation (dispersive, fourth order) and is left to the modal lines.

mod band;
mod block;
mod cost;
mod energy;
mod exchange;
mod intake;
mod kernel;
mod lattice;
mod outline;
mod plan;
mod row;
#[cfg(test)]
mod tests;
mod vector;

pub use cost::Cost;
pub use lattice::Lattice;

use crate::plate::Plate;
use cost::Layout;
use intake::{EndLaw, Feed, Intake};
use kernel::Weights;
use outline::Outline;
use plan::{Column, Plan, plan_of};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::iter::repeat;
use thiserror::Error;

/// Most cells a sheet may have.
pub const CELLS_MAX: usize = 1 << 23;
/// Courant number of the step (1 is the limit of stability).
const COURANT: f64 = 0.99;
/// Steps that are collected before the lattice runs.
const STEPS_AT_ONCE: usize = 4096;

/// How the driven end moves across the width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveShape {
    /// cos(pi z/2W0): the first width mode alone.
    FirstMode,
    /// A raised cosine about `centre` of half-width `reach`, both in half-widths W0 (-0.9 to 0.9; 0.05 to 1): all
    /// width modes, the even ones too when it is off the centre line.
    Patch {
        /// Centre z/W0.
        centre: f64,
        /// Distance z/W0 from the centre to where the patch ends.
        reach: f64,
    },
}

impl DriveShape {
    fn at(self, place: f64) -> f64 {
        match self {
            Self::FirstMode => (FRAC_PI_2 * place).cos(),
            Self::Patch { centre, reach } => {
                let away = (place - centre).abs() / reach;
                if away < 1.0 { 0.5 + 0.5 * (2.0 * FRAC_PI_2 * away).cos() } else { 0.0 }
            }
        }
    }

    fn is_symmetric(self) -> bool {
        match self {
            Self::FirstMode => true,
            Self::Patch { centre, .. } => centre == 0.0,
        }
    }
}

/// Where the envelope is recorded, at every step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EnvelopeScope {
    /// On the centre line only: free.
    CentreLine,
    /// Everywhere: about halves the speed.
    Everywhere,
}

/// The grid of a sheet and how it is run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetGrid {
    /// Cells along the plate's length (16 to 16384).
    pub along: usize,
    /// Cells across the half-width at the driven end (4 to 4096).
    pub across: usize,
    /// How the driven end moves.
    pub drive: DriveShape,
    /// Whether both halves are computed although the drive is symmetric.
    pub whole: bool,
    /// Where the envelope is recorded.
    pub envelope: EnvelopeScope,
    /// The frequency at which the loss is the plate's, Hz; `None`: the middle of the plate's band. The loss is
    /// viscous (r v_t), so the loss factor falls as 1/f about it.
    pub loss_at_hz: Option<f64>,
    /// Threads (1 to 64). The result is the same for every number.
    pub threads: usize,
}

impl SheetGrid {
    /// A grid of `along` x `across` cells for the first width mode, on one thread.
    pub fn new(along: usize, across: usize) -> Self {
        Self {
            along,
            across,
            drive: DriveShape::FirstMode,
            whole: false,
            envelope: EnvelopeScope::CentreLine,
            loss_at_hz: None,
            threads: 1,
        }
    }

    /// The coarsest grid that still shows the whole span: 8 cells on the half-width where the span ends.
    pub fn coarse(plate: &Plate) -> Self {
        let cell = plate.half_width_m(plate.span_m().1) / 8.0;
        let along = (plate.length_m() / cell).ceil().clamp(16.0, 16384.0) as usize;
        let across = (plate.half_width_m(0.0) / cell).ceil().clamp(4.0, 4096.0) as usize;
        Self::new(along, across)
    }

    fn validate(&self, sample_rate_hz: f64) -> Result<(), SheetError> {
        let within = |field: &'static str, value: f64, low: f64, high: f64| {
            if value >= low && value <= high {
                return Ok(());
            }
            Err(SheetError::OutOfRange { field, value, low, high })
        };
        within("sample_rate_hz", sample_rate_hz, 1000.0, 1e8)?;
        within("along", self.along as f64, 16.0, 16384.0)?;
        within("across", self.across as f64, 4.0, 4096.0)?;
        within("threads", self.threads as f64, 1.0, 64.0)?;
        if let Some(frequency_hz) = self.loss_at_hz {
            within("loss_at_hz", frequency_hz, 0.1, 1e8)?;
        }
        if let DriveShape::Patch { centre, reach } = self.drive {
            within("drive.centre", centre, -0.9, 0.9)?;
            within("drive.reach", reach, 0.05, 1.0)?;
        }
        Ok(())
    }
}

/// Why a sheet was refused.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SheetError {
    /// The plate bends: the scalar wave equation is not its equation.
    #[error(
        "{plate} is a plate in bending: a sheet carries membranes and shear waves, use a time line for it"
    )]
    Bends {
        /// Name of the plate.
        plate: String,
    },
    /// A number is outside its range (or not a number).
    #[error("{field} = {value}: must be {low} to {high}")]
    OutOfRange {
        /// The field of [`SheetGrid`], or `sample_rate_hz`.
        field: &'static str,
        /// The value that was given.
        value: f64,
        /// Lowest allowed.
        low: f64,
        /// Highest allowed.
        high: f64,
    },
    /// The grid is too big to be held.
    #[error("the grid would have {cells} cells: at most {limit}")]
    TooBig {
        /// Cells it would have.
        cells: usize,
        /// Most cells.
        limit: usize,
    },
}

/// The largest and the root-mean-square displacement since the last reset.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetEnvelope {
    /// Steps that were recorded.
    pub steps: u64,
    /// Largest |v| in metres: one number per station for the centre line, else row by row as [`Sheet::field_m`].
    pub maximum_m: Vec<f32>,
    /// Root mean square of v in metres, laid out as `maximum_m`.
    pub rms_m: Vec<f32>,
}

/// A tapered plate in two dimensions, at one moment.
#[derive(Debug)]
pub struct Sheet {
    lattice: Lattice,
    outline: Outline,
    intake: Intake,
    mirrored: bool,
    positions_m: Vec<f64>,
    widths_m: Vec<f64>,
    step_s: f64,
    speed_m_per_s: f64,
    full_scale_m: f64,
    scope: EnvelopeScope,
    recorded_since: u64,
    steps: Vec<f32>,
}

impl Sheet {
    /// A sheet at rest, driven by codes of `sample_rate_hz` (1000 to 1e8).
    ///
    /// # Errors
    /// [`SheetError`] when the plate bends, or the grid or the rate is out of range.
    pub fn new(plate: &Plate, sample_rate_hz: f64, grid: SheetGrid) -> Result<Self, SheetError> {
        let Layout { outline, pace, step_s, speed_m_per_s: speed, mirrored } =
            Layout::new(plate, sample_rate_hz, &grid)?;
        let (low, high) = plate.band_hz();
        let loss_at_hz = grid.loss_at_hz.unwrap_or((low * high).sqrt());
        // K^2 (1 + j eta) = (omega^2 + j r omega)/c^2 with r = eta omega.
        let damping = plate.wave_loss() * TAU * loss_at_hz;
        let scheme = Scheme { outline: &outline, speed, step_s, damping, mirrored, grid: &grid };
        let (plan, feed) = scheme.plan(EndLaw::of(plate));
        let side = outline.rows() as isize - 1;
        Ok(Self {
            lattice: Lattice::new(plan, grid.threads),
            intake: Intake::new(pace, step_s, feed, plate.spec().actuator.as_ref()),
            mirrored,
            positions_m: (0..=grid.along).map(|station| station as f64 * outline.dx).collect(),
            widths_m: (-side..=side).map(|row| row as f64 * outline.dz).collect(),
            step_s,
            speed_m_per_s: speed,
            full_scale_m: plate.spec().full_scale_m,
            scope: grid.envelope,
            recorded_since: 0,
            outline,
            steps: Vec::with_capacity(STEPS_AT_ONCE),
        })
    }

    /// Plays codes (-1 to 1 of full scale; anything else is clamped, what is no number counts as 0).
    pub fn push(&mut self, codes: &[f32]) {
        for part in codes.chunks(STEPS_AT_ONCE) {
            self.steps.clear();
            self.intake.take(part, &mut self.steps);
            self.lattice.advance(&self.steps);
        }
    }

    /// Stations along x, metres: 0 to the plate's length.
    pub fn positions_m(&self) -> &[f64] {
        &self.positions_m
    }

    /// Rows across z, metres: symmetric about 0.
    pub fn widths_m(&self) -> &[f64] {
        &self.widths_m
    }

    /// Writes the displacement in metres, row by row (`widths_m` x `positions_m`); 0 outside the plate.
    ///
    /// What does not fit into `out` is left away.
    pub fn field_m(&self, out: &mut [f32]) {
        for (line, out) in out.chunks_mut(self.positions_m.len()).take(self.widths_m.len()).enumerate() {
            self.line_m(line, out);
        }
    }

    /// Writes the displacement on the centre line in metres, one number per station.
    pub fn centre_line_m(&self, out: &mut [f32]) {
        self.line_m(self.widths_m.len() / 2, out);
    }

    /// Writes line `line` of the field in metres, zero beyond its last cell.
    fn line_m(&self, line: usize, out: &mut [f32]) {
        let scale = self.full_scale_m as f32;
        let row = self.lattice.row(self.lattice_row(line));
        for (out, value) in out.iter_mut().zip(row.map(|value| scale * value).chain(repeat(0.0))) {
            *out = value;
        }
    }

    /// The envelope since the last reset.
    pub fn envelope(&self) -> SheetEnvelope {
        let steps = self.lattice.steps() - self.recorded_since;
        let stations = self.positions_m.len();
        let middle = self.widths_m.len() / 2;
        let lines = match self.scope {
            EnvelopeScope::CentreLine => middle..middle + 1,
            EnvelopeScope::Everywhere => 0..self.widths_m.len(),
        };
        let count = lines.len() * stations;
        let mut envelope = SheetEnvelope { steps, maximum_m: vec![0.0; count], rms_m: vec![0.0; count] };
        for (place, line) in lines.enumerate() {
            let Some((maximum, squares)) = self.lattice.envelope(self.lattice_row(line)) else { continue };
            let to = place * stations;
            for (station, (maximum, squares)) in
                maximum.numbers().zip(squares.numbers()).take(stations).enumerate()
            {
                envelope.maximum_m[to + station] = (f64::from(maximum) * self.full_scale_m) as f32;
                let mean = squares / steps.max(1) as f64;
                envelope.rms_m[to + station] = (mean.sqrt() * self.full_scale_m) as f32;
            }
        }
        envelope
    }

    /// Begins the envelope anew.
    pub fn reset_envelope(&mut self) {
        self.recorded_since = self.lattice.steps();
        self.lattice.reset_envelope();
    }

    /// Energy per surface density, J/(kg/m^2): 1/2 integral of v_t^2 + c^2 |grad v|^2 over the plate.
    ///
    /// Steps conserve it to rounding when there is no loss and the driven end is held or free.
    pub fn energy_j_per_kg_m2(&self) -> f64 {
        let unit =
            energy::energy(&self.lattice, &self.outline, self.mirrored, self.step_s, self.speed_m_per_s);
        unit * self.full_scale_m.powi(2)
    }

    /// Steps per second of plate time.
    pub fn step_rate_hz(&self) -> f64 {
        1.0 / self.step_s
    }

    /// Cells that a step updates.
    pub fn cells(&self) -> usize {
        self.lattice.plan().reach.iter().map(|reach| reach + 1).sum()
    }

    /// Cell updates that one second of plate time takes: below some 1e9 per core a sheet runs live.
    pub fn updates_per_second(&self) -> f64 {
        self.cells() as f64 * self.step_rate_hz()
    }

    /// The lattice row that holds line `line` of the field.
    fn lattice_row(&self, line: usize) -> usize {
        if self.mirrored { line.abs_diff(self.widths_m.len() / 2) } else { line }
    }
}

/// What the weights of the update follow from.
struct Scheme<'a> {
    outline: &'a Outline,
    speed: f64,
    step_s: f64,
    /// r of r v_t, 1/s.
    damping: f64,
    mirrored: bool,
    grid: &'a SheetGrid,
}

impl Scheme<'_> {
    /// (v+ - 2 v + v-)/dt^2 + r (v+ - v-)/2dt = c^2 (second differences), solved for v+.
    fn plan(&self, law: EndLaw) -> (Plan, Feed) {
        let outline = self.outline;
        let along = (self.speed * self.step_s / outline.dx).powi(2);
        let across = (self.speed * self.step_s / outline.dz).powi(2);
        let loss = 0.5 * self.damping * self.step_s;
        let divisor = 1.0 + loss;
        let weights = Weights {
            own: ((2.0 - 2.0 * along - 2.0 * across) / divisor) as f32,
            past: ((1.0 - loss) / divisor) as f32,
            along: (along / divisor) as f32,
            across: (across / divisor) as f32,
        };
        let side = outline.rows() - 1;
        let rows: Vec<usize> = if self.mirrored {
            (0..=side).collect()
        } else {
            (0..2 * side + 1).map(|row| row.abs_diff(side)).collect()
        };
        // Links of a point to its two neighbours in z; the centre line has two outward ones.
        let across_links = |station: usize, row: usize| {
            let outward = outline.across_link(station, row);
            if row == 0 { 2.0 * outward } else { 1.0 + outward }
        };
        let own = |station: usize, row: usize| {
            let held = along * (1.0 + outline.along_link(station, row)) + across * across_links(station, row);
            ((2.0 - held) / divisor) as f32
        };
        let own_by_row: Vec<Vec<f32>> = rows
            .iter()
            .map(|&row| (1..=outline.reach[row]).map(|station| own(station, row)).collect())
            .collect();

        // The driven column is half a cell wide: v_tt = c^2 (2/dx ((v1 - v0)/dx - v_x(0)) + v_zz).
        let (resisted, feed) = match law {
            EndLaw::Held => (0.0, Feed::Value),
            EndLaw::Pushed { slope_per_m } => {
                (0.0, Feed::Scaled(2.0 * along * outline.dx * slope_per_m / divisor))
            }
            EndLaw::Resisted { rho_s_per_m } => {
                let b = along * outline.dx * rho_s_per_m / self.step_s;
                (b, Feed::Change(2.0 * b / (divisor + b)))
            }
        };
        let moves = if law == EndLaw::Held { 0.0 } else { 1.0 / (divisor + resisted) };
        let column_own = |row: usize| {
            let links = 2.0 * along * outline.along_link(0, row) + across * across_links(0, row);
            (moves * (2.0 - links)) as f32
        };
        let column = Column {
            own: rows.iter().map(|&row| column_own(row)).collect(),
            past: (moves * (1.0 - loss - resisted)) as f32,
            inward: (moves * 2.0 * along) as f32,
            across: (moves * across) as f32,
            profile: (0..rows.len())
                .map(|row| {
                    let from_centre = if self.mirrored { row as f64 } else { row as f64 - side as f64 };
                    self.grid.drive.at(from_centre / self.grid.across as f64) as f32
                })
                .collect(),
        };
        let recorded = match self.grid.envelope {
            EnvelopeScope::Everywhere => 0..rows.len(),
            EnvelopeScope::CentreLine if self.mirrored => 0..1,
            EnvelopeScope::CentreLine => side..side + 1,
        };
        let reach: Vec<usize> = rows.iter().map(|&row| outline.reach[row]).collect();
        let plain: Vec<usize> = rows.iter().map(|&row| outline.plain(row)).collect();
        (plan_of(&reach, &plain, &own_by_row, self.mirrored, weights, Some(column), recorded), feed)
    }
}
