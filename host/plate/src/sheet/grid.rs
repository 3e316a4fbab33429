//! The grid of a sheet as it is asked for: how fine, how driven, what is recorded, and what is refused.

use crate::quantity::{OutOfRange, Range};
use crate::spec::plate::Plate;
use crate::spec::sample_rate::SAMPLE_RATE_MAX_HZ;
use std::f64::consts::FRAC_PI_2;
use thiserror::Error;

/// Most cells that a sheet of the plate's length may have, both halves together.
pub const CELLS_MAX: usize = 1 << 23;

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
    pub(super) fn at(self, place: f64) -> f64 {
        match self {
            Self::FirstMode => (FRAC_PI_2 * place).cos(),
            Self::Patch { centre, reach } => {
                let away = (place - centre).abs() / reach;
                if away < 1.0 { 0.5 + 0.5 * (2.0 * FRAC_PI_2 * away).cos() } else { 0.0 }
            }
        }
    }

    pub(super) fn is_symmetric(self) -> bool {
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

    pub(super) fn validate(&self, sample_rate_hz: f64) -> Result<(), SheetError> {
        let within = |field: &'static str, value: f64, low: f64, high: f64| {
            OutOfRange::check(field, value, Range::new(low, high, ""))
        };
        within("sample_rate_hz", sample_rate_hz, 1000.0, SAMPLE_RATE_MAX_HZ)?;
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
    /// A field of [`SheetGrid`], or `sample_rate_hz`, is out of range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// The grid is too big to be held.
    #[error("the grid would have {cells} cells: at most {limit}")]
    TooBig {
        /// Cells it would have.
        cells: usize,
        /// Most cells.
        limit: usize,
    },
}
