//! The request for a sheet: resolution, drive, recording and loss, with their ranges.

use super::air_wave::{AirWave, Stations, WAVENUMBER_ERROR_MAX};
use super::distant_air;
use crate::definition::plate::Plate;
use crate::definition::sample_rate::{SAMPLE_RATE_MAX_HZ, SampleRateError};
use crate::frequency::RespondError;
use crate::quantity::{OutOfRange, Range, WrongCount};
use crate::time::DriveCurveError;
use std::f64::consts::FRAC_PI_2;
use thiserror::Error;

/// Most cells of a sheet, 2 `along` x `across`: both halves over the plate's length.
pub(crate) const CELLS_MAX: usize = 1 << 23;

/// How the driven end moves across the width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveShape {
    /// cos(pi z/(2 W0)): excites the first width mode only.
    FirstMode,
    /// A raised cosine about `centre`, which ends at the distance `reach`. It excites all odd width modes and, off the
    /// centre line, the even ones, too.
    Patch {
        /// Centre z/W0 (-0.9 to 0.9).
        centre: f64,
        /// Distance z/W0 from the centre to the end of the patch (0.05 to 1).
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

/// Where the envelope is recorded; it is recorded at every step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EnvelopeScope {
    /// On the centre line only, at almost no cost.
    CentreLine,
    /// Everywhere, which about halves the speed.
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
    /// Whether to compute both halves even if the drive is symmetric.
    pub whole: bool,
    /// Where the envelope is recorded.
    pub envelope: EnvelopeScope,
    /// The frequency at which the loss factor is the plate's, Hz (0.1 to 1e8); `None` for the geometric mean of the
    /// plate's band. The loss of a sheet is viscous (r v_t), so its loss factor is proportional to 1/f.
    pub loss_at_hz: Option<f64>,
    /// The lowest and the highest tone at which the wavenumber of a plate in air is the plate's, Hz (0.1 to 1e8); two equal ones
    /// for one tone, which is exact. Between two the largest error is about the least that one equation has; beside them it rises
    /// with the distance. `None`: the plate's band. Without air it has no effect.
    pub air_at_hz: Option<(f64, f64)>,
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
            air_at_hz: None,
            threads: 1,
        }
    }

    /// The same grid with the wavenumber in air for these tones, Hz: exact at one tone, with its group speed; among more the
    /// largest error is about least. Without air, or without tones, it is the same grid.
    ///
    /// # Errors
    /// [`SheetError::Air`] if a tone's wavenumber would be off by more than a hundredth.
    pub fn at_tones(self, plate: &Plate, tones_hz: &[f64]) -> Result<Self, SheetError> {
        let carries = plate.carries_air() && plate.spec().model.wave_speed_m_per_s().is_some();
        let Some(band_hz) = AirWave::band_of(tones_hz).filter(|_| carries) else { return Ok(self) };
        let along = self.along.max(1);
        let stations = Stations { step_m: plate.length_m() / along as f64, count: along + 1 };
        let wave = AirWave::of(plate, band_hz, stations);
        let error_at = |&tone_hz: &f64| wave.error_at(plate, tone_hz) + distant_air::error_at(plate, tone_hz);
        let error = tones_hz.iter().map(error_at).fold(0.0, f64::max);
        if error > WAVENUMBER_ERROR_MAX {
            return Err(SheetError::Air { plate: plate.name().to_owned(), error });
        }
        Ok(Self { air_at_hz: Some(band_hz), ..self })
    }

    /// A coarse grid that resolves the whole span: 8 cells on the half-width at the span's end, within the limits of
    /// `along` and `across`. For a very narrow plate it may exceed what a sheet accepts.
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
        if let Some((low_hz, high_hz)) = self.air_at_hz {
            within("air_at_hz.0", low_hz, 0.1, 1e8)?;
            within("air_at_hz.1", high_hz, low_hz, 1e8)?;
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
#[non_exhaustive]
pub enum SheetError {
    /// The plate is in bending, which the scalar wave equation does not describe.
    #[error(
        "{plate} is a plate in bending: a sheet carries membranes and shear waves, use a time line for it"
    )]
    Bends {
        /// Name of the plate.
        plate: String,
    },
    /// A membrane with the stiffness of its film, which the scalar wave equation does not describe.
    #[error("{plate} has the stiffness of its film: a sheet carries ideal membranes, use a time line for it")]
    Film {
        /// Name of the plate.
        plate: String,
    },
    /// Air swings with the plate, and so much of it that the one equation of a sheet does not follow its mass over the tones.
    #[error(
        "{plate} carries air: the wavenumber of a sheet would be wrong by {:.1} %, and at most {:.0} % is allowed: use a time line, or fewer tones",
        100.0 * error, 100.0 * WAVENUMBER_ERROR_MAX
    )]
    Air {
        /// Name of the plate.
        plate: String,
        /// The largest relative error of the wavenumber.
        error: f64,
    },
    /// The driven end is one that the sheet does not carry.
    #[error(
        "{plate} is driven by a source with a mass and a spring: a sheet carries \"displacement\", \"force\" and \"resistance\""
    )]
    DriveEnd {
        /// Name of the plate.
        plate: String,
    },
    /// The sample rate does not carry the band of a plate whose drive is a measured curve.
    #[error(transparent)]
    SampleRate(#[from] SampleRateError),
    /// No filter has the measured curve of the plate's drive: its actuator's or its calibration's.
    #[error(transparent)]
    Drive(#[from] DriveCurveError),
    /// A finger that the plate cannot have.
    #[error(transparent)]
    Finger(RespondError),
    /// A field of [`SheetGrid`] or `sample_rate_hz` is out of range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// The grid has too many cells.
    #[error(transparent)]
    TooBig(#[from] WrongCount),
}
