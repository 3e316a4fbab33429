//! The fit of tones to a target.

use super::error::TextureError;
use super::figures::Figures;
use super::nnls::Columns;
use super::palette::Palette;
use super::phases::low_crest_turns;
use super::refinement::{self, Placed};
use super::selection;
use super::target::Target;
use crate::check::sensation::SLIPPERY_FROM_HZ;
use crate::definition::plate::Plate;
use crate::order;
use crate::quantity::OutOfRange;
use crate::table::level::other_plates;

/// Largest number of tones of a texture.
pub const TONES_MAX: usize = 16;
/// Sum of the DAC amplitudes of a texture's tones, over full scale: the rest covers the rounding of levels and
/// positions on the wire.
pub(super) const HEADROOM: f64 = 0.999;
/// Smallest power of a tone over that of the loudest: -60 dB. Quieter tones are left out.
const AUDIBLE: f64 = 1e-6;

/// Least distance of tones that are felt as vibrations, Hz: the sum of closer ones rises and falls so slowly that the
/// area seems to vanish and return. No source: a round value.
pub(crate) const BEAT_OF_VIBRATIONS_HZ: f64 = 5.0;
/// Least distance of ultrasonic tones, Hz: the beat of closer ones is felt as a vibration. No source: a round value.
pub(crate) const BEAT_OF_ULTRASOUND_HZ: f64 = 1000.0;

/// One tone of a texture.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TextureTone {
    /// Turning point, metres.
    pub position_m: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Level, 0 to 1 of the table's full scale.
    pub level: f64,
    /// Phase at its start, turns (0 to 1).
    pub phase_turns: f64,
}

/// Tones whose fields together are close to a target.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Texture {
    /// The tones in the order of their turning points, together as loud as the DAC allows.
    pub tones: Vec<TextureTone>,
    /// Places of the following amplitudes, metres.
    pub places_m: Vec<f64>,
    /// Wanted RMS displacement at each place, metres.
    pub wanted_m: Vec<f64>,
    /// RMS displacement at each place, metres.
    pub rms_m: Vec<f64>,
    /// RMS displacement of the nearest known field with any number of tones at the same loudness, metres.
    pub reach_m: Vec<f64>,
    /// Figures of these tones.
    pub figures: Figures,
    /// Figures of the nearest known field with any number of tones: no larger an error than that of these tones.
    pub reach: Figures,
    /// The target's largest amplitude over the table's peak at full scale.
    scale: f64,
}

impl Texture {
    /// The best texture with at most `most` tones (1 to 16).
    ///
    /// # Errors
    /// [`TextureError::OutOfRange`] for the number of tones, [`TextureError::Silent`] if the plate does not respond.
    pub fn fit(palette: &Palette<'_>, target: &Target, most: usize) -> Result<Self, TextureError> {
        OutOfRange::check_count("tones", most, 1..=TONES_MAX)?;
        let candidates_m = selection::candidates_m(target);
        let candidates = palette.squares(&candidates_m)?;
        let places_m = palette.places_m();
        let (best, few) = selection::best_and_few(&candidates, target, most);
        let best = candidates.times(&best);
        let refined = |places_m| refinement::refine(palette, target, places_m).map(sounding_tones);
        let mut sounding = refined(few.into_iter().map(|candidate| candidates_m[candidate]).collect())?;
        // Each pass of this loop removes at least one tone or ends the loop.
        loop {
            let parted = parted_m(palette, &sounding);
            if parted.len() == sounding.len() {
                break;
            }
            sounding = refined(parted)?;
        }
        let (positions_m, powers): (Vec<f64>, Vec<f64>) = sounding.into_iter().unzip();
        let squares = palette.squares(&positions_m)?.times(&powers);
        let figures = Figures::of(&squares, &places_m, target);
        let reach = Figures::of(&best, &places_m, target);
        // The field that is best in mean squares may have a larger error in RMS amplitude than these tones, which are a number of
        // tones, too.
        let is_nearest = figures.rms_error < reach.rms_error;
        let (best, reach) = if is_nearest { (squares.clone(), figures) } else { (best, reach) };
        let (tones, scale) = loudest_that_fits(palette, &positions_m, &powers);
        let peak_m = palette.table().peak_at_full_scale_m() * scale;
        Ok(Self {
            tones,
            wanted_m: target.wanted.iter().map(|wanted| wanted * peak_m).collect(),
            rms_m: squares.iter().map(|square| square.sqrt() * peak_m).collect(),
            reach_m: best.iter().map(|square| square.max(0.0).sqrt() * peak_m).collect(),
            figures,
            reach,
            places_m,
            scale,
        })
    }

    /// The same target and reach with other tones: `squares` are their mean squares at the places, and `scale` is the
    /// target's largest amplitude over the table's peak at full scale.
    pub(super) fn with_tones(
        &self,
        tones: Vec<TextureTone>,
        figures: Figures,
        squares: &[f64],
        target: &Target,
        scale: f64,
        palette: &Palette<'_>,
    ) -> Self {
        let peak_m = palette.table().peak_at_full_scale_m() * scale;
        let rms_m: Vec<f64> = squares.iter().map(|square| square.sqrt() * peak_m).collect();
        let is_nearest = figures.rms_error < self.reach.rms_error;
        let reach_m = if is_nearest {
            rms_m.clone()
        } else {
            self.reach_m.iter().map(|metres| metres * scale / self.scale).collect()
        };
        Self {
            tones,
            wanted_m: target.wanted.iter().map(|wanted| wanted * peak_m).collect(),
            rms_m,
            reach_m,
            figures,
            reach: if is_nearest { figures } else { self.reach },
            places_m: self.places_m.clone(),
            scale,
        }
    }

    /// The same tones at the loudness of another texture for the same target; unchanged if they cannot be as loud.
    #[must_use]
    pub fn as_loud_as(&self, other: &Self) -> Self {
        self.scaled((other.scale / self.scale).min(1.0))
    }

    /// The same tones with `rms_m` metres at the target's largest amplitude; unchanged if they cannot be as loud.
    #[must_use]
    pub fn at_level(&self, rms_m: f64, palette: &Palette<'_>) -> Self {
        self.scaled((rms_m / (self.scale * palette.table().peak_at_full_scale_m())).min(1.0))
    }

    /// The same tones, `factor` (0 to 1) times as loud.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        scaled.tones.iter_mut().for_each(|tone| tone.level *= factor);
        let fields = scaled.wanted_m.iter_mut().chain(&mut scaled.rms_m).chain(&mut scaled.reach_m);
        fields.for_each(|amplitude| *amplitude *= factor);
        scaled.scale *= factor;
        scaled
    }

    /// The worst figures of these tones on the plates within the plate file's tolerances of wave speed and loss; the
    /// figures on the plate itself if the file states no tolerances.
    ///
    /// # Errors
    /// [`TextureError::Silent`] if one of the plates does not respond.
    pub fn worst(&self, palette: &Palette<'_>, target: &Target) -> Result<Figures, TextureError> {
        let mut worst = self.figures;
        for plate in other_plates(palette.plate()) {
            let figures = self.on(&plate, palette, target)?;
            let larger =
                |one: Option<f64>, other: Option<f64>| one.zip(other).map(|(one, other)| one.max(other));
            let lesser =
                |one: Option<f64>, other: Option<f64>| one.zip(other).map(|(one, other)| one.min(other));
            worst = Figures {
                rms_error: worst.rms_error.max(figures.rms_error),
                ripple_db: larger(worst.ripple_db, figures.ripple_db),
                contrast_db: lesser(worst.contrast_db, figures.contrast_db),
            };
        }
        Ok(worst)
    }

    /// The figures of these tones on another plate, with the same table.
    ///
    /// # Errors
    /// [`TextureError::Silent`] if that plate does not respond.
    pub fn on(&self, plate: &Plate, palette: &Palette<'_>, target: &Target) -> Result<Figures, TextureError> {
        let there = Palette::new(plate, palette.table());
        let positions_m: Vec<f64> = self.tones.iter().map(|tone| tone.position_m).collect();
        let columns: Columns = there.squares(&positions_m)?;
        let powers: Vec<f64> = self.tones.iter().map(|tone| (tone.level / self.scale).powi(2)).collect();
        Ok(Figures::of(&columns.times(&powers), &self.places_m, target))
    }
}

/// Least distance of the next tone below a tone of this frequency, Hz. The friction knows no limit at 20 kHz: a tone right below
/// beats with one above as two above do.
pub(super) fn least_beat_hz(frequency_hz: f64) -> f64 {
    if frequency_hz < SLIPPERY_FROM_HZ { BEAT_OF_VIBRATIONS_HZ } else { BEAT_OF_ULTRASOUND_HZ }
}

/// The tones above [`AUDIBLE`] as (place, power), in the order of their places.
fn sounding_tones(placed: Placed) -> Vec<(f64, f64)> {
    let loudest = placed.powers.iter().copied().fold(0.0, f64::max);
    let mut sounding: Vec<(f64, f64)> = placed.positions_m.into_iter().zip(placed.powers).collect();
    sounding.retain(|&(_, power)| power > AUDIBLE * loudest);
    order::sort_by(&mut sounding, |(one, _), (other, _)| one.total_cmp(other));
    sounding
}

/// The places of these tones; tones whose beat would be too slow are merged to one place between them.
fn parted_m(palette: &Palette<'_>, sounding: &[(f64, f64)]) -> Vec<f64> {
    let table = palette.table();
    let mut parted: Vec<(f64, f64)> = Vec::with_capacity(sounding.len());
    for &(place_m, power) in sounding {
        if let Some((last_m, last_power)) = parted.last_mut() {
            let (low_hz, high_hz) = (table.frequency_hz(*last_m), table.frequency_hz(place_m));
            if high_hz - low_hz < least_beat_hz(high_hz) {
                let sum = *last_power + power;
                *last_m = (*last_m * *last_power + place_m * power) / sum;
                *last_power = sum;
                continue;
            }
        }
        parted.push((place_m, power));
    }
    parted.into_iter().map(|(place_m, _)| place_m).collect()
}

/// The tones at the highest common scale that the DAC's range and the range of each level allow, and that scale.
fn loudest_that_fits(palette: &Palette<'_>, positions_m: &[f64], powers: &[f64]) -> (Vec<TextureTone>, f64) {
    let table = palette.table();
    let dac: Vec<f64> =
        positions_m.iter().zip(powers).map(|(&x, power)| power.sqrt() * table.gain(x)).collect();
    let sum: f64 = dac.iter().sum();
    let loudest = powers.iter().copied().fold(0.0, f64::max).sqrt();
    let scale = if sum > 0.0 { (HEADROOM / sum).min(loudest.recip()) } else { 0.0 };
    let tone = |((&position_m, power), phase_turns): ((&f64, &f64), f64)| TextureTone {
        position_m,
        frequency_hz: table.frequency_hz(position_m),
        level: power.sqrt() * scale,
        phase_turns,
    };
    (positions_m.iter().zip(powers).zip(low_crest_turns(&dac)).map(tone).collect(), scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frequency::numerov::work;
    use crate::{DriveTable, presets};

    /// A profile that is drawn is fitted within 20 ms while the pointer moves (`cargo bench -p slipline-plate` prints the
    /// time): a sweep of eight frequencies takes about 0.2 ms on `al-bending`. These profiles take up to 49.
    #[test]
    fn a_drawn_profile_of_eight_tones_takes_a_bounded_number_of_sweeps() {
        for preset in presets() {
            let plate = preset.plate().expect("a preset");
            let table = DriveTable::build(&plate, 400e3, 65).expect("has a table");
            let length_m = plate.length_m();
            // One that falls, one that rises, a bump, and a scribble.
            let scribble = (0..30).map(|i| (0.03 * f64::from(i), 1.0 + (1.7 * f64::from(i)).sin())).collect();
            for shares in [
                vec![(0.05, 1.0), (0.9, 0.0)],
                vec![(0.05, 0.1), (0.9, 1.0)],
                vec![(0.4, 0.1), (0.5, 1.0), (0.6, 0.1)],
                scribble,
            ] {
                let profile: Vec<(f64, f64)> = shares
                    .into_iter()
                    .map(|(share, amplitude): (f64, f64)| (share * length_m, amplitude))
                    .collect();
                let before = work::done();
                let palette = Palette::new(&plate, &table);
                let target = Target::profile(&palette, &profile).expect("a profile");
                Texture::fit(&palette, &target, 8).and_then(|it| it.worst(&palette, &target)).expect("fits");
                let after = work::done();
                let (grids, sweeps) = (after.grids - before.grids, after.sweeps - before.sweeps);
                assert!(grids <= 9 && sweeps <= 60, "{}: {grids} grids, {sweeps} sweeps", preset.name);
            }
        }
    }
}
