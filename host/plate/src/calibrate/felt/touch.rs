//! A felt edge at a mark, and the prior knowledge of the drive of its tone.

use crate::calibrate::error::CalibrateError;
use crate::definition::{Plate, limits};
use crate::quantity::{OutOfRange, Range};

/// Least distance of the nearest from the farthest mark, in standard deviations of a mark.
const MARKS_APART: f64 = 10.0;

/// A felt edge at a mark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Place of the mark, metres from the driven end.
    pub mark_m: f64,
    /// Standard deviation of the felt edge from the mark, metres (1e-5 to 0.05); 0.002 for a fingertip.
    pub tolerance_m: f64,
    /// The tone's frequency, Hz.
    pub frequency_hz: f64,
    /// Peak amplitude of the tone as the plate file predicts it, metres (1e-12 to 0.1): that of the table, times the
    /// level.
    pub peak_m: f64,
}

/// Knowledge of the drive whose tones are touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TouchedDrive {
    /// The drive is as the plate file states it up to one factor, because its current or its levels were measured.
    AsStated,
    /// The drive has 0.4 to 2.5 times the matched resistance, some mass and stiffness, and a resonance near the band.
    Unknown,
}

impl TouchedDrive {
    /// The drive of a plate: unknown, unless a calibration has measured the levels.
    #[must_use]
    pub fn of(plate: &Plate) -> Self {
        let measured = plate.spec().calibration.as_ref().and_then(|it| it.correction.as_ref());
        if measured.is_some() { Self::AsStated } else { Self::Unknown }
    }
}

/// Refuses numbers out of their ranges, a single mark, and marks that are too close.
pub(crate) fn check(plate: &Plate, touches: &[Touch]) -> Result<(), CalibrateError> {
    for touch in touches {
        OutOfRange::check("mark_m", touch.mark_m, Range::new(0.0, plate.length_m(), "m"))?;
        OutOfRange::check("tolerance_m", touch.tolerance_m, Range::new(1e-5, 0.05, "m"))?;
        OutOfRange::check("frequency_hz", touch.frequency_hz, limits::FREQUENCY)?;
        OutOfRange::check("peak_m", touch.peak_m, Range::new(1e-12, 0.1, "m"))?;
    }
    check_marks(touches)
}

fn check_marks(touches: &[Touch]) -> Result<(), CalibrateError> {
    let (mut near, mut far, mut tolerance_m) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for touch in touches {
        (near, far) = (near.min(touch.mark_m), far.max(touch.mark_m));
        tolerance_m = tolerance_m.max(touch.tolerance_m);
    }
    let apart_m = (far - near).max(0.0);
    let least_m = MARKS_APART * tolerance_m;
    if touches.len() < 2 || apart_m < least_m {
        return Err(CalibrateError::CloseMarks { count: touches.len(), apart_m, least_m });
    }
    Ok(())
}
