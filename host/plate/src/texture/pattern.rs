//! Textures by the nodes of one tone, and by the beat of two tones.

use super::error::TextureError;
use super::fit::{HEADROOM, TextureTone};
use super::palette::Palette;
use crate::definition::plate::Plate;
use crate::feeling::Feeling;
use crate::frequency::{Equation, respond};
use crate::quantity::{OutOfRange, Range, decibels};
use std::f64::consts::PI;

/// Allowed beat frequencies, Hz: a finger feels them as a vibration.
pub const BEAT_RANGE_HZ: (f64, f64) = (1.0, 1000.0);
const HALVINGS: usize = 60;
/// Places of the field whose stripes are felt: a contact of 10 mm on a plate of 1 m covers twenty.
const FELT_PLACES: usize = 2001;

/// Distance of the nodes of a tone halfway between the driven end and its turning point, metres: half a wavelength
/// there. Beyond that place they are farther apart. `None` if the wave cannot enter.
pub fn stripes_m(plate: &Plate, frequency_hz: f64) -> Option<f64> {
    let middle_m = 0.5 * plate.turning_point_m(frequency_hz)?;
    let squared = plate.width_mode(1).wavenumber_squared(middle_m, frequency_hz);
    (squared > 0.0).then(|| PI / squared.sqrt())
}

/// Depth of the stripes of a tone as felt in the middle of its area, dB: the mean square under the contact at the lower of two
/// neighbouring stripes over that between them. 0 where nothing is felt between two stripes: the contact covers both, or the
/// tone has a single one.
///
/// Equal stripes with nodes of zero amplitude between them would have (1 + |S|)/(1 - |S|) with S = sin(pi c/d)/(pi c/d), c the
/// contact and d their distance. On a plate the stripes are unequal, and loss and the part of the wave that travels leave
/// amplitude at the nodes.
///
/// # Errors
/// [`TextureError::Silent`] if the plate does not respond.
pub fn stripes_felt_db(plate: &Plate, tone: &TextureTone, feeling: &Feeling) -> Result<f64, TextureError> {
    let field = respond(plate, tone.frequency_hz, FELT_PLACES, Equation::Corrected);
    let field = field.map_err(|_| TextureError::Silent)?;
    let felt = feeling.contact_amplitude(plate, &field.amplitude);
    if !felt.iter().all(|it| it.is_finite()) {
        return Err(TextureError::Silent);
    }
    let middle = 0.5 * field.turning_point_m / plate.length_m() * (FELT_PLACES - 1) as f64;
    let is_node = |&i: &usize| felt[i] < felt[i - 1] && felt[i] <= felt[i + 1];
    let nodes: Vec<usize> = (1..FELT_PLACES - 1).filter(is_node).collect();
    let off = |node: usize| (node as f64 - middle).abs();
    let nearest = (0..nodes.len()).min_by(|&a, &b| off(nodes[a]).total_cmp(&off(nodes[b])));
    let Some(nearest) = nearest else { return Ok(0.0) };
    let from = nearest.checked_sub(1).map_or(0, |before| nodes[before]);
    let to = nodes.get(nearest + 1).copied().unwrap_or(FELT_PLACES - 1);
    let highest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
    let node = nodes[nearest];
    let lower = highest(&felt[from..node]).min(highest(&felt[node..=to]));
    Ok(decibels(lower / felt[node]))
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
