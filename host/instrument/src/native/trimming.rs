//! The course of a trim: the wave speed of a calibrated plate, measured once and then again and again.

use serde::Serialize;
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_plate::calibrate::{CalibrateError, Measurement, SpeedTrim, Trimmed, departure};
use slipline_plate::quantity::Range;
use slipline_plate::{Plate, TableError};
use std::time::Instant;

/// Durations of a trim, seconds.
pub const TRIM_S: Range = Range::new(0.0, 86_400.0, "s");

/// What has been measured so far.
#[derive(Debug)]
pub struct Trimming {
    trim: SpeedTrim,
    begun: Instant,
    later: Vec<(f64, Trimmed)>,
}

impl Trimming {
    /// Begins with the first measurement of a plate.
    ///
    /// # Errors
    /// Those of [`SpeedTrim::new`].
    pub fn begin(plate: &Plate, first: &Measurement) -> Result<Self, CalibrateError> {
        Ok(Self { trim: SpeedTrim::new(plate, first)?, begun: Instant::now(), later: Vec::new() })
    }

    /// Whether a trim of this duration, seconds since its first measurement, is not over yet; one without a duration is.
    #[must_use]
    pub fn goes_on(&self, duration_s: Option<f64>) -> bool {
        duration_s.is_some_and(|duration_s| self.begun.elapsed().as_secs_f64() < duration_s)
    }

    /// Takes a later measurement by the same sensor; returns the seconds since the first one, and what the speed is now.
    ///
    /// # Errors
    /// Those of [`SpeedTrim::later`].
    pub fn add(&mut self, later: &Measurement) -> Result<(f64, &Trimmed), CalibrateError> {
        let now = self.trim.later(later)?;
        let after_s = self.begun.elapsed().as_secs_f64();
        self.later.push((after_s, now));
        Ok((after_s, self.last()))
    }

    /// The latest speed.
    #[must_use]
    pub fn last(&self) -> &Trimmed {
        self.later.last().map_or(self.trim.begin(), |(_, now)| now)
    }

    /// What no measurement shows, see [`SpeedTrim::caution`].
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        self.trim.caution()
    }

    /// The fields of `slipline trim --json` for a sensor at `place_m`; `ended_by` says what has ended the trim.
    ///
    /// # Errors
    /// The table of the plate, see [`departure`].
    pub fn answer<'a>(
        &self,
        plate: &'a Plate,
        place_m: f64,
        ended_by: &'a str,
    ) -> Result<TrimAnswer<'a>, TableError> {
        let moved = departure(plate, &self.last().plate, f64::from(SAMPLE_RATE_HZ))?;
        Ok(TrimAnswer {
            plate: plate.name(),
            place_m,
            begin: TrimmedAnswer::of(self.trim.begin()),
            later: self
                .later
                .iter()
                .map(|(after_s, now)| LaterAnswer { after_s: *after_s, now: TrimmedAnswer::of(now) })
                .collect(),
            turning_point_error_m: moved.boundary_m,
            ended_by,
            caution: self.caution(),
        })
    }
}

/// The fields of `slipline trim --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrimAnswer<'a> {
    /// Name of the plate.
    pub plate: &'a str,
    /// Place of the sensor.
    pub place_m: f64,
    /// The wave speed at the beginning.
    pub begin: TrimmedAnswer,
    /// Those that were found later.
    pub later: Vec<LaterAnswer>,
    /// Largest error of turning points by the file before.
    pub turning_point_error_m: f64,
    /// time, stop or input (of --stdin), or the signal that ended it.
    pub ended_by: &'a str,
    /// A caution that no measurement reveals and the user must check.
    pub caution: Option<String>,
}

/// The fields of one measured speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrimmedAnswer {
    /// JSON, 1: Wave speed over that of the file
    pub wave_speed_share: f64,
    /// JSON of trim, 1: Lower end of the 95 % interval of the wave speed
    pub low: f64,
    /// JSON of trim, 1: Upper end of the 95 % interval of the wave speed
    pub high: f64,
    /// Square of the deviation per answer, in units of its noise.
    pub chi2_per_n: f64,
}

/// The fields of each later speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LaterAnswer {
    /// JSON: Time since the first measurement
    pub after_s: f64,
    /// The wave speed at that time.
    #[serde(flatten)]
    pub now: TrimmedAnswer,
}

impl TrimmedAnswer {
    fn of(trimmed: &Trimmed) -> Self {
        let Trimmed { share, low, high, chi2_per_n, .. } = *trimmed;
        Self { wave_speed_share: share, low, high, chi2_per_n }
    }
}
