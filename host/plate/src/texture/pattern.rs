//! Textures by the nodes of one tone, and by the beat of two tones.

use super::error::TextureError;
use super::fit::{HEADROOM, TextureTone};
use super::palette::Palette;
use crate::definition::plate::Plate;
use crate::quantity::{OutOfRange, Range};
use crate::special::sinc::sinc;
use std::f64::consts::PI;

/// Allowed beat frequencies, Hz: a finger feels them as a vibration.
pub const BEAT_RANGE_HZ: (f64, f64) = (1.0, 1000.0);
const HALVINGS: usize = 60;

/// Distance of the nodes of a tone halfway between the driven end and its turning point, metres: half a wavelength
/// there. Beyond that place they are farther apart. `None` if the wave cannot enter.
pub fn stripes_m(plate: &Plate, frequency_hz: f64) -> Option<f64> {
    let middle_m = 0.5 * plate.turning_point_m(frequency_hz)?;
    let squared = plate.width_mode(1).wavenumber_squared(middle_m, frequency_hz);
    (squared > 0.0).then(|| PI / squared.sqrt())
}

/// Depth of stripes `stripes_m` metres apart as felt with a contact of `contact_m` metres, dB: the ratio of the largest
/// to the smallest mean square under the contact, (1 + |S|)/(1 - |S|) with S = sin(pi c/d)/(pi c/d), for a wave whose
/// amplitude is zero at its nodes. Infinite for a contact of zero length; 0 for a contact of a whole number of stripes.
pub fn stripes_felt_db(stripes_m: f64, contact_m: f64) -> f64 {
    let left = sinc(contact_m / stripes_m).abs();
    10.0 * ((1.0 + left) / (1.0 - left)).log10()
}

/// The tone whose nodes are `distance_m` metres apart in the middle of its area, as loud as possible.
///
/// # Errors
/// [`TextureError::OutOfRange`] with the distances that the table's tones can have, [`TextureError::Silent`] if the
/// tones at the ends of the span do not enter the plate.
pub fn stripes(palette: &Palette<'_>, distance_m: f64) -> Result<TextureTone, TextureError> {
    let table = palette.table();
    let at = |x: f64| stripes_m(palette.plate(), table.frequency_hz(x)).ok_or(TextureError::Silent);
    let (mut wide_m, mut narrow_m) = table.span_m();
    OutOfRange::check("stripes", distance_m, Range::new(at(narrow_m)?, at(wide_m)?, "m"))?;
    for _ in 0..HALVINGS {
        let middle_m = 0.5 * (wide_m + narrow_m);
        if at(middle_m)? > distance_m { wide_m = middle_m } else { narrow_m = middle_m }
    }
    Ok(tone(palette, wide_m, 1.0))
}

/// Two equally loud tones, `beat_hz` apart, with their peaks around `place_m` metres: where both have amplitude, their
/// sum rises and falls `beat_hz` times a second.
///
/// # Errors
/// [`TextureError::OutOfRange`] if `beat_hz` is not 1 to 1000 Hz, or with the places that the table's tones can have.
pub fn beat(palette: &Palette<'_>, place_m: f64, beat_hz: f64) -> Result<[TextureTone; 2], TextureError> {
    OutOfRange::check("beat frequency", beat_hz, Range::new(BEAT_RANGE_HZ.0, BEAT_RANGE_HZ.1, "Hz"))?;
    let table = palette.table();
    let peak_m = |frequency_hz: f64| palette.plate().airy_peak_m(frequency_hz).unwrap_or(0.0);
    let (low_hz, high_hz) = (table.frequency_hz(table.span_m().0), table.frequency_hz(table.span_m().1));
    let (lowest_hz, highest_hz) = (low_hz + 0.5 * beat_hz, high_hz - 0.5 * beat_hz);
    // For a band narrower than the beat this range is empty, and every place is outside it.
    OutOfRange::check("beat", place_m, Range::new(peak_m(lowest_hz), peak_m(highest_hz), "m"))?;
    let middle_hz = zero_of(lowest_hz, highest_hz, |hz| peak_m(hz) - place_m);
    let at = |hz: f64| zero_of(table.span_m().0, table.span_m().1, |x| table.frequency_hz(x) - hz);
    let positions_m = [middle_hz - 0.5 * beat_hz, middle_hz + 0.5 * beat_hz].map(at);
    let level = HEADROOM / positions_m.iter().map(|&x| table.gain(x)).sum::<f64>();
    Ok(positions_m.map(|x| tone(palette, x, level.min(1.0))))
}

fn tone(palette: &Palette<'_>, position_m: f64, level: f64) -> TextureTone {
    let frequency_hz = palette.table().frequency_hz(position_m);
    TextureTone { position_m, frequency_hz, level, phase_turns: 0.0 }
}

/// The zero of a rising function between `low` and `high`.
fn zero_of(mut low: f64, mut high: f64, above: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if above(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
