//! The end of a plate in bending with both conditions, in place of an end with one.

use crate::definition::drive::DriveEnd;
use crate::definition::impedance::Impedance;
use crate::definition::plate::Plate;
use crate::definition::source::{EndSlope, Source};

/// `plate` with the near field at its driven end, if its drive end leaves that out: a prescribed displacement becomes
/// one with a free slope, a force becomes one on a free end, a resistance a damper on a free end. `None` for a plate
/// whose end is exact, and where the thickness changes, for which there is no law of the near field.
///
/// Its drive may differ from that of `plate` by a factor, see [`drive_rise`].
pub(crate) fn with_whole_end(plate: &Plate) -> Option<Plate> {
    let model = &plate.spec().model;
    model.bending()?;
    if plate.is_graded() {
        return None;
    }
    let drive_end = match plate.spec().drive_end {
        DriveEnd::Displacement => DriveEnd::DisplacementAndSlope { slope: EndSlope::Free },
        DriveEnd::Force { at_frequency_hz } => DriveEnd::Source(Source::soft(model, at_frequency_hz)),
        DriveEnd::Resistance { ratio, at_frequency_hz } => DriveEnd::Source(Source {
            impedance: Impedance::damper(ratio * plate.wave_impedance_n_s_per_m(at_frequency_hz)?),
            ..Source::soft(model, at_frequency_hz)
        }),
        DriveEnd::DisplacementAndSlope { .. } | DriveEnd::Source(_) => return None,
    };
    Some(plate.with_drive_end(drive_end))
}

/// Drive of `plate` over frequency where that of [`with_whole_end`] is constant: proportional to frequency for a
/// resistance, whose damper is moved at its other side, constant otherwise.
pub(crate) fn drive_rise(plate: &Plate, frequency_hz: f64) -> f64 {
    match plate.spec().drive_end {
        DriveEnd::Resistance { at_frequency_hz, .. } => frequency_hz / at_frequency_hz,
        _ => 1.0,
    }
}
