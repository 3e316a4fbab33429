//! What a sheet leaves out in a baffle: the pressure at a distance (`frequency/far_air.rs`), which is not local.

use crate::definition::air::Air;
use crate::definition::plate::Plate;
use crate::definition::spec::PlateSpec;
use crate::frequency::{Equation, respond};

/// Points of a field: the place of a peak is right to a hundredth of a millimetre.
const POINTS: usize = 401;
/// Tones of a band at which it is computed; it is largest at its ends.
const TONES: u32 = 5;

/// The error of the wavenumber that would move the peak of a tone as far as that pressure does, relative; 0 where there is none, or
/// no peak.
pub(super) fn error_at(plate: &Plate, frequency_hz: f64) -> f64 {
    match without(plate) {
        Some(near) => error_of(plate, &near, frequency_hz),
        None => 0.0,
    }
}

/// The largest of them from one frequency to another, Hz.
pub(super) fn error_between(plate: &Plate, (low_hz, high_hz): (f64, f64)) -> f64 {
    let Some(near) = without(plate) else { return 0.0 };
    let tone_hz = |i: u32| low_hz * (high_hz / low_hz).powf(f64::from(i) / f64::from(TONES - 1));
    (0..TONES).map(|i| error_of(plate, &near, tone_hz(i))).fold(0.0, f64::max)
}

/// The same plate without that pressure; `None` where there is none.
fn without(plate: &Plate) -> Option<Plate> {
    let air = plate.spec().air?;
    let has_some = air.distant() != 0.0;
    let near = || Plate::new(PlateSpec { air: Some(Air::near_alone(air)), ..plate.spec().clone() });
    has_some.then(near)?.ok()
}

fn error_of(plate: &Plate, near: &Plate, frequency_hz: f64) -> f64 {
    let peak_m = |plate: &Plate| {
        let response = respond(plate, frequency_hz, POINTS, Equation::Corrected).ok()?;
        Some(response.peak?.position_m)
    };
    let apart_m = peak_m(plate).zip(peak_m(near)).map_or(0.0, |(with, without)| (with - without).abs());
    let narrowing = plate.turning_point_m(frequency_hz).map_or(0.0, |x| plate.turning_at(x).1.abs());
    // K s is the same where a wave turns.
    apart_m * narrowing
}
