//! A texture as a chord: its tones on multiples of one base frequency, with phases of a small peak.
//!
//! ```text
//! Texture --each to the nearest multiple--> powers fitted anew --> phases (crest) --> as loud as the peak allows
//! ```
//! Tones on a grid repeat exactly, so a device can prove their peak and take them louder than by the sum of their
//! amplitudes. The figures state what the grid costs.

use super::crest::low_peak_turns;
use super::error::TextureError;
use super::figures::Figures;
use super::fit::{HEADROOM, Texture, TextureTone, least_beat_hz};
use super::palette::Palette;
use super::refinement;
use super::target::Target;

/// The longest period of a chord, in samples.
pub const CHORD_PERIOD: u32 = 1 << 14;
/// Halvings of the span between two places.
const HALVINGS: usize = 60;

/// A texture whose tones are multiples of the sample rate over [`CHORD_PERIOD`].
#[derive(Debug, Clone, PartialEq)]
pub struct ChordTexture {
    /// The tones, as loud together as the sum of their amplitudes allows; the phases are those of the chord.
    pub texture: Texture,
    /// Which multiple of the base frequency each tone is; rising.
    pub harmonics: Vec<u32>,
    /// How much louder the chord may be played, since its peak is smaller than the sum: dB, 0 or more.
    pub gain_db: f64,
}

/// What the grid may cost: share of the error, dB of ripple, dB of contrast.
const TOLERATED: (f64, f64, f64) = (0.05, 0.5, 1.0);

impl ChordTexture {
    /// Whether the grid costs next to nothing against the texture with free tones: 5 % of its error, 0.5 dB of ripple and 1 dB of
    /// contrast at most.
    pub fn is_as_good_as(&self, free: &Texture) -> bool {
        let (error, ripple_db, contrast_db) = TOLERATED;
        let (is, was) = (&self.texture.figures, &free.figures);
        let within = |is: Option<f64>, was: Option<f64>, worse_by: f64, sign: f64| {
            is.zip(was).is_none_or(|(is, was)| sign * (is - was) <= worse_by)
        };
        is.rms_error <= (1.0 + error) * was.rms_error
            && within(is.ripple_db, was.ripple_db, ripple_db, 1.0)
            && within(is.contrast_db, was.contrast_db, contrast_db, -1.0)
    }
}

impl Texture {
    /// The same texture on the multiples of `sample rate / CHORD_PERIOD`, with powers fitted anew. `None` if the table's
    /// frequencies hold fewer than one of them for each tone that sounds.
    ///
    /// # Errors
    /// [`TextureError::Silent`] if the plate does not answer.
    pub fn on_grid(
        &self,
        palette: &Palette<'_>,
        target: &Target,
    ) -> Result<Option<ChordTexture>, TextureError> {
        let table = palette.table();
        let base_hz = table.sample_rate_hz / f64::from(CHORD_PERIOD);
        let (start_m, end_m) = target.allowed_m;
        let (lowest, highest) = (
            (table.frequency_hz(start_m) / base_hz).ceil() as u32,
            (table.frequency_hz(end_m) / base_hz).floor() as u32,
        );
        if lowest > highest {
            return Ok(None);
        }
        let nearest: Vec<u32> =
            self.tones.iter().map(|tone| (tone.frequency_hz / base_hz).round() as u32).collect();
        let harmonics = parted(&nearest, lowest.max(1), highest, base_hz);
        let positions_m: Vec<f64> =
            harmonics.iter().map(|&m| place_of(palette, f64::from(m) * base_hz)).collect();
        let powers = refinement::powers_at(palette, target, &positions_m)?;
        let (harmonics, (positions_m, powers)): (Vec<u32>, (Vec<f64>, Vec<f64>)) = harmonics
            .into_iter()
            .zip(positions_m.into_iter().zip(powers))
            .filter(|(_, (_, power))| *power > 0.0)
            .unzip();
        if harmonics.is_empty() {
            return Ok(None);
        }
        let dac: Vec<f64> =
            positions_m.iter().zip(&powers).map(|(&x, power)| power.sqrt() * table.gain(x)).collect();
        let (turns, peak) = low_peak_turns(&harmonics, &dac, CHORD_PERIOD);
        let (sum, loudest) = (dac.iter().sum::<f64>(), powers.iter().copied().fold(0.0, f64::max).sqrt());
        // No tone may be louder than the table allows.
        let scale = |of: f64| (HEADROOM / of).min(loudest.recip());
        let tones = positions_m.iter().zip(&powers).zip(turns).map(|((&position_m, power), phase_turns)| {
            TextureTone {
                position_m,
                frequency_hz: table.frequency_hz(position_m),
                level: power.sqrt() * scale(sum),
                phase_turns,
            }
        });
        let squares = palette.squares(&positions_m)?.times(&powers);
        let figures = Figures::of(&squares, &self.places_m, target);
        let texture = self.with_tones(tones.collect(), figures, &squares, target, scale(sum), palette);
        Ok(Some(ChordTexture { texture, harmonics, gain_db: 20.0 * (scale(peak) / scale(sum)).log10() }))
    }
}

/// These rising harmonics, each within `lowest..=highest` and once, where ultrasonic ones that would beat are moved down, and
/// those for which no room is left are left out. The highest stays: it makes the edge of an area.
fn parted(nearest: &[u32], lowest: u32, highest: u32, base_hz: f64) -> Vec<u32> {
    let mut parted: Vec<u32> = Vec::with_capacity(nearest.len());
    for harmonic in nearest.iter().rev().map(|harmonic| (*harmonic).clamp(lowest, highest)) {
        let Some(&above) = parted.last() else {
            parted.push(harmonic);
            continue;
        };
        let apart = (least_beat_hz(f64::from(harmonic) * base_hz) / base_hz).ceil() as u32;
        let moved = harmonic.min(above.saturating_sub(apart));
        if harmonic != above && moved >= lowest {
            parted.push(moved);
        }
    }
    parted.reverse();
    parted
}

/// The place of the span with this frequency, which must be one of the table's.
fn place_of(palette: &Palette<'_>, frequency_hz: f64) -> f64 {
    let table = palette.table();
    let (mut low_m, mut high_m) = (table.span_start_m, table.span_end_m);
    for _ in 0..HALVINGS {
        let middle_m = 0.5 * (low_m + high_m);
        if table.frequency_hz(middle_m) < frequency_hz { low_m = middle_m } else { high_m = middle_m }
    }
    0.5 * (low_m + high_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ultrasonic_harmonics_that_would_beat_are_moved_down_and_others_stay() {
        // 40 multiples are 976.6 Hz, 41 are 1001; 20 kHz is the multiple 819.2.
        let base_hz = 400e3 / f64::from(CHORD_PERIOD);
        let parted = |nearest: &[u32], lowest| parted(nearest, lowest, 1600, base_hz);
        assert_eq!(parted(&[860, 900, 940, 981], 700), [858, 899, 940, 981]);
        assert_eq!(parted(&[860, 901, 945], 700), [860, 901, 945]);
        // Below 20 kHz 24 Hz are enough, and two on one multiple are one.
        assert_eq!(parted(&[4, 4, 5, 815, 818, 825], 4), [4, 5, 815, 818, 825]);
        // No room for the lowest; the highest is the table's.
        assert_eq!(parted(&[1550, 1590, 1700], 1550), [1559, 1600]);
    }
}
