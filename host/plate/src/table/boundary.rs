//! Turning point and peak of tones on a plate, whichever plate's table they are from.

use super::level::DriveToPeak;
use crate::definition::plate::Plate;
use crate::frequency::error::RespondError;
use crate::frequency::respond::check_frequency;
use crate::progress::Progress;
use thiserror::Error;

/// The boundary of a tone on a plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Boundary {
    /// Turning point, metres; beyond the plate's end if the wave reaches it.
    pub turning_point_m: f64,
    /// Peak displacement at a DAC amplitude of full scale, metres. Where the plate has no turning-point peak, the amplitude
    /// at the turning point over 0.6628.
    pub peak_m: f64,
}

/// Why a tone has no boundary on a plate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum NoBoundary {
    /// The wave cannot enter the plate.
    #[error("the wave does not enter the plate")]
    CannotEnter,
    /// The frequency is above [`crate::respond_range`].
    #[error("the wave turns far beyond the plate's end")]
    TooHigh,
    /// The amplitude is zero or not finite.
    #[error("the amplitude is zero or not finite")]
    Silent,
}

/// The boundary of each tone on `plate`, driven by a DAC of `sample_rate_hz`. All tones are solved together, on one grid.
///
/// ```
/// use slipline_plate::{boundaries, preset};
///
/// let plate = preset("membrane").unwrap();
/// let frequency_hz = plate.frequency_for_boundary_hz(0.16);
/// let boundary = boundaries(&plate, &[frequency_hz, 1.0], 400e3);
/// assert!((boundary[0].unwrap().turning_point_m - 0.16).abs() < 1e-9);
/// assert!(boundary[1].is_err(), "1 Hz cannot enter");
/// ```
#[must_use]
pub fn boundaries(
    plate: &Plate,
    frequencies_hz: &[f64],
    sample_rate_hz: f64,
) -> Vec<Result<Boundary, NoBoundary>> {
    let turning: Vec<Result<f64, NoBoundary>> = frequencies_hz
        .iter()
        .map(|&frequency_hz| {
            check_frequency(plate, frequency_hz).map_err(|error| match error {
                RespondError::CannotEnter { .. } => NoBoundary::CannotEnter,
                _ => NoBoundary::TooHigh,
            })?;
            plate.turning_point_m(frequency_hz).ok_or(NoBoundary::CannotEnter)
        })
        .collect();
    let solved: Vec<f64> =
        turning.iter().zip(frequencies_hz).filter(|(at, _)| at.is_ok()).map(|(_, hz)| *hz).collect();
    let drive_to_peak = DriveToPeak::unchecked(plate, sample_rate_hz);
    let levels = drive_to_peak.each_level(&solved, &mut Progress::unwatched());
    let mut levels = levels.unwrap_or_default().into_iter();
    turning
        .into_iter()
        .map(|at| {
            let turning_point_m = at?;
            let level = levels.next().and_then(Result::ok).ok_or(NoBoundary::Silent)?;
            Ok(Boundary { turning_point_m, peak_m: level.amplitude * plate.spec().full_scale_m })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frequency::numerov::work;
    use crate::{Equation, PlateSpec, preset, presets, respond};

    fn span_frequencies(plate: &Plate, count: u32) -> Vec<f64> {
        let (start_m, end_m) = plate.span_m();
        let place = |i: u32| start_m + (end_m - start_m) * f64::from(i) / f64::from(count - 1);
        (0..count).map(|i| plate.frequency_for_boundary_hz(place(i))).collect()
    }

    #[test]
    fn boundaries_match_the_fine_solution() {
        for preset in presets() {
            let plate = preset.plate().expect("a preset");
            let frequencies_hz = span_frequencies(&plate, 11);
            for (frequency_hz, found) in frequencies_hz.iter().zip(boundaries(&plate, &frequencies_hz, 400e3))
            {
                let found = found.expect("on the span");
                let fine = respond(&plate, *frequency_hz, 2001, Equation::Corrected).expect("enters");
                assert_eq!(found.turning_point_m, fine.turning_point_m);
                let Some(peak) = fine.peak else { continue };
                let droop = crate::special::sinc::sinc(frequency_hz / 400e3);
                let peak_m = peak.amplitude
                    * droop
                    * plate.drive_response(*frequency_hz).norm()
                    * plate.spec().full_scale_m;
                let off_db = 20.0 * (found.peak_m / peak_m).log10();
                assert!(off_db.abs() < 1e-3, "{} at {frequency_hz}: {off_db} dB", preset.name);
            }
        }
    }

    #[test]
    fn eight_tones_take_one_grid_and_one_sweep() {
        let plate = preset("al-bending").expect("a preset");
        let before = work::done();
        let found = boundaries(&plate, &span_frequencies(&plate, 8), 400e3);
        let after = work::done();
        assert!(found.iter().all(Result::is_ok));
        let work = (after.grids - before.grids, after.sweeps - before.sweeps, after.single - before.single);
        assert_eq!(work, (1, 1, 0));
    }

    #[test]
    fn a_tone_without_a_boundary_says_why_and_leaves_the_others_alone() {
        let plate = preset("membrane").expect("a preset");
        let in_span = plate.frequency_for_boundary_hz(0.16);
        let highest_hz = crate::respond_range(&plate).high;
        let wanted = boundaries(&plate, &[in_span], 400e3)[0];
        for (hz, why) in [
            (0.9 * plate.cut_off_hz(), NoBoundary::CannotEnter),
            (1.01 * highest_hz, NoBoundary::TooHigh),
            (f64::NAN, NoBoundary::TooHigh),
        ] {
            assert_eq!(boundaries(&plate, &[hz, in_span, hz], 400e3), [Err(why), wanted, Err(why)]);
        }
        // A tone that is too weak for a number.
        let lossy = Plate::new(PlateSpec { loss_factor: 0.5, ..plate.spec().clone() }).expect("valid");
        assert!(boundaries(&lossy, &[in_span], 400e3)[0].is_ok());
    }
}
