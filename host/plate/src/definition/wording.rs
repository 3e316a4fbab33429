//! What is wrong with a plate, as a sentence: one wording; the caller chooses how fields and numbers are
//! written.

use super::error::{Consequence, Origin, PlateError};
use super::limits::{
    BAND_RATIO_MAX, BAND_WIDTH_MIN_PERCENT, FILM_PERCENT, FREQUENCY, HALF_WIDTH, TRAVEL_RATIO_MAX,
    WAVELENGTHS_MAX,
};
use crate::quantity::number_format::{at_least, at_most, typed};
use crate::quantity::refusal::wrong_count;
use crate::quantity::{Notation, PlateFile, Range, must_be};
use std::fmt;

impl fmt::Display for PlateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.worded(&PlateFile))
    }
}

impl PlateError {
    /// The error as a sentence without a full stop.
    #[must_use]
    pub fn worded(&self, notation: &dyn Notation) -> String {
        let name = |field: &str| notation.field(field);
        match self {
            Self::OutOfRange { field, value, range, origin } => {
                let allowed = allowed(notation, field, *range, *origin);
                must_be(notation.given(field, *value), allowed)
            }
            Self::Unfit { field, value, consequence } => {
                must_be(notation.given(field, *value), remedy(notation, *consequence))
            }
            Self::Missing { field, needed } => format!("{} is missing: {needed}", name(field)),
            Self::Unexpected { field, reason } => format!("{} does not belong here: {reason}", name(field)),
            Self::UnknownKind { field, value, allowed } => {
                must_be(format_args!("{} = {value}", name(field)), allowed)
            }
            Self::ControlCharacter { field, place, character } => format!(
                "{}: its character {} is U+{:04X}, a control character: write it on one line and without these",
                name(field),
                place + 1,
                u32::from(*character)
            ),
            Self::WrongCount { field, count, allowed } => wrong_count(&name(field), *count, *allowed),
            Self::NotNarrowing { index, position_m, half_width_m } => format!(
                "{} = [{}, {}]: positions must increase and half-widths must decrease from point to point",
                name(&format!("taper.points[{index}]")),
                notation.length(*position_m),
                notation.length(*half_width_m)
            ),
        }
    }
}

/// What a field may be, in words that follow "must be".
fn allowed(notation: &dyn Notation, field: &str, range: Range, origin: Option<Origin>) -> String {
    let within = notation.range(field, range);
    match origin {
        None => within,
        Some(Origin::Entry) => format!("{within} (it must enter the plate)"),
        Some(Origin::Turning) => {
            let Range { low, high, .. } = range.rounded();
            format!(
                "above {} and up to {}: lower cannot enter the plate, higher passes its end",
                notation.frequency(low),
                notation.frequency(high)
            )
        }
        Some(Origin::BandLow(low_hz)) => format!(
            "{within}, at least {BAND_WIDTH_MIN_PERCENT} % above {}",
            notation.given("band low", low_hz)
        ),
        Some(Origin::DrivenEnd) => "0: the points begin at the driven end".to_owned(),
        Some(Origin::Length(length_m)) => {
            format!("{within}: the points must cover the plate ({})", notation.given("length_m", length_m))
        }
        Some(Origin::EndHalfWidth(half_width_m)) => format!(
            "{within}, or the half-width at the end ({}) falls below {}",
            notation.length(at_most(half_width_m, 5)),
            notation.length(HALF_WIDTH.low)
        ),
        Some(Origin::Rising) => format!("{within}: frequencies must rise from point to point"),
        Some(Origin::PeakTravel(peak_m)) => format!(
            "{within}: at most {TRAVEL_RATIO_MAX} times {}",
            notation.given("actuator.peak_travel_m", peak_m)
        ),
    }
}

/// What a field must be for something else to be allowed, in words that follow "must be". The present value is rounded
/// away from what is allowed, so that the two never read the same.
fn remedy(notation: &dyn Notation, consequence: Consequence) -> String {
    let frequency = |hertz: f64| notation.frequency(hertz);
    match consequence {
        Consequence::Frequency(here_hz) => {
            let (limit, here) = if here_hz > FREQUENCY.high {
                (format!("at most {}", frequency(FREQUENCY.high)), at_least(here_hz, 5))
            } else {
                (format!("at least {}", frequency(FREQUENCY.low)), at_most(here_hz, 5))
            };
            format!("a place where the boundary needs {limit} (here {})", frequency(here))
        }
        Consequence::BandRatio(start_hz, end_hz) => format!(
            "a place where the boundary needs at least {}, 1/{BAND_RATIO_MAX} of what it needs at the span's end \
             (here {})",
            frequency(at_least(end_hz / BAND_RATIO_MAX, 5)),
            frequency(at_most(start_hz, 5))
        ),
        Consequence::Wavelengths(count) => {
            format!(
                "within {WAVELENGTHS_MAX} wavelengths of the driven end (here {})",
                typed(at_least(count, 4))
            )
        }
        Consequence::Turning { place_m } => format!(
            "of a law by which the plate narrows faster than the root of its thickness everywhere: at {} it does not",
            notation.length(place_m)
        ),
        Consequence::Film { half_width_m, percent, thickest_m } => format!(
            "at most {} at this wave speed: where the plate is {} wide, at the farthest boundary, a stiffer film bends more than \
             it stretches (the wavenumber is {} % off, at most {} % may be); or raise the tension, or take clamped edges in bending",
            notation.length(at_most(thickest_m, 2)),
            notation.length(at_most(2.0 * half_width_m, 3)),
            typed(at_least(percent, 2)),
            typed(FILM_PERCENT)
        ),
        Consequence::Converging { frequency_hz } => format!(
            "longer: where {} turns, the edges would converge at more than 75 degrees each; or raise the band",
            frequency(frequency_hz)
        ),
        Consequence::Margins { band_hz: (low_hz, high_hz), margins_m } => format!(
            "longer: the peak of {} and the tail of {} alone take {} of it; or raise the band, or set smaller margins",
            frequency(low_hz),
            frequency(high_hz),
            notation.length(at_least(margins_m, 3))
        ),
    }
}

#[cfg(test)]
mod tests {
    use crate::Progress;
    use crate::design::{Edge, Material, Request, Wave, design};
    use crate::{DriveEnd, Plate, PlateSpec, Taper, TurningWidth, preset};

    fn refusal(preset_name: &str, change: impl FnOnce(&mut PlateSpec)) -> String {
        let mut spec = preset(preset_name).expect("a preset").spec().clone();
        spec.turning_width = TurningWidth::Plain;
        change(&mut spec);
        Plate::new(spec).expect_err("refused").to_string()
    }

    #[test]
    fn a_range_that_other_fields_move_is_printed_with_its_cause() {
        let sampled = |points: &[[f64; 2]]| {
            let taper = Taper::Sampled { points: points.to_vec() };
            refusal("membrane", |spec| spec.taper = taper)
        };
        assert_eq!(
            sampled(&[[0.0, 0.05], [0.2, 0.01]]),
            "taper.points[1][0] = 0.2: must be at least 0.32 m: the points must cover the plate (length_m = 0.32)"
        );
        assert_eq!(
            sampled(&[[0.1, 0.05], [0.4, 0.01]]),
            "taper.points[0][0] = 0.1: must be 0: the points begin at the driven end"
        );
        assert_eq!(
            sampled(&[[0.0, 0.05], [0.4, 0.06]]),
            "taper.points[1] = [0.4 m, 0.06 m]: positions must increase and half-widths must decrease from point to \
             point"
        );
        let steep = |spec: &mut PlateSpec| {
            spec.taper = Taper::Exponential { half_width_m: 0.05, rate_per_m: 100.0 };
        };
        assert_eq!(
            refusal("membrane", steep),
            "taper.rate_per_m = 100: must be at most 26.616 1/m, or the half-width at the end (6.332e-16 m) falls \
             below 1e-5 m"
        );
        let slow = |spec: &mut PlateSpec| spec.drive_end = DriveEnd::Force { at_frequency_hz: 2.0 };
        assert_eq!(
            refusal("membrane", slow),
            "drive.at_frequency_hz = 2: must be 60.006 to 1e7 Hz (it must enter the plate)"
        );
        assert_eq!(
            refusal("membrane", |spec| spec.name = "a\nb".to_owned()),
            "name: its character 2 is U+000A, a control character: write it on one line and without these"
        );
    }

    #[test]
    fn a_derived_limit_is_printed_with_its_value_here() {
        let exponential = |half_width_m, rate_per_m, span: (f64, f64)| {
            move |spec: &mut PlateSpec| {
                spec.taper = Taper::Exponential { half_width_m, rate_per_m };
                (spec.span_start_m, spec.span_end_m) = span;
                spec.drive_end = DriveEnd::Displacement;
            }
        };
        assert_eq!(
            refusal("membrane", exponential(10.0, 0.5, (0.01, 0.3))),
            "span_start_m = 0.01: must be a place where the boundary needs at least 0.5 Hz (here 0.3015 Hz)"
        );
        assert_eq!(
            refusal("membrane", exponential(0.5, 30.0, (0.01, 0.2))),
            "span_start_m = 0.01: must be a place where the boundary needs at least 37.822 Hz, 1/64 of what it needs \
             at the span's end (here 8.0991 Hz)"
        );
        assert_eq!(
            refusal("al-bending", exponential(1e-4, 1.0, (0.01, 0.3))),
            "span_end_m = 0.3: must be a place where the boundary needs at most 1e7 Hz (here 2.2284e8 Hz)"
        );
        assert_eq!(
            refusal("membrane", exponential(4e-4, 0.5, (0.01, 0.3))),
            "span_end_m = 0.3: must be within 60 wavelengths of the driven end (here 76.13)"
        );
        let wave = Wave::Bending { edge: Edge::Supported, thick_plate: true };
        let material = Material::named("aluminium").expect("known");
        let request = Request::new("short", material, 2e-3, wave, (20e3, 40e3), 0.01);
        // The air of the room does next to nothing to such a plate.
        for request in [Request { air: None, ..request.clone() }, request.clone()] {
            assert_eq!(
                design(&request, &mut Progress::unwatched()).expect_err("too short").to_string(),
                "length_m = 0.01: must be longer: the peak of 20000 Hz and the tail of 40000 Hz alone take 0.0254 m of it; \
                 or raise the band, or set smaller margins"
            );
        }
        let request = Request { length_m: 0.3, band_hz: (20e3, 20.5e3), ..request };
        assert_eq!(
            design(&request, &mut Progress::unwatched()).expect_err("too narrow").to_string(),
            "band high = 20500: must be 21000 to 1e7 Hz, at least 5 % above band low = 20000"
        );
    }
}
