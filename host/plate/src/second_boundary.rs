//! The boundaries that a drive's harmonics make beyond that of the tone itself.
//!
//! A harmonic of the order n is a wave of n times the frequency. It turns where the plate is n times narrower, on an exponential
//! membrane ln(n)/d beyond the tone's own turning point and in bending half as far, so it vibrates where the tone leaves the plate
//! still. The threshold of vibration falls by 12 dB an octave up to 250 Hz: a harmonic 40 dB below the tone is felt there.
//!
//! ```text
//! tone: frequency, level, drive --[Harmonics]--> drive at n f --respond at n f--> HarmonicWave --Feeling--> SecondBoundary
//! ```

use crate::definition::{Harmonics, Plate};
use crate::feeling::{Feeling, FeltEdge, FeltTone};
use crate::frequency::{Equation, RespondError, respond};
use crate::quantity::decibels;
use crate::quantity::number_format::{significant, with_decimals};
use num_complex::Complex64;

/// A tone by its drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrivenTone {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Level, 0 to 1 of the table's full scale.
    pub level: f64,
    /// Complex displacement of the driven end, metres, as of [`crate::DriveTable::driven_end_m`] times the level.
    pub drive_m: Complex64,
}

/// The steady wave of a harmonic.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicWave {
    /// Its frequency over that of the tone: 2 or 3.
    pub order: u8,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Its drive over that of the tone.
    pub ratio: f64,
    /// Where it turns, metres; beyond the plate's end if it reaches that.
    pub turning_point_m: f64,
    /// Complex displacement at places uniform from 0 to the plate's end, metres.
    pub wave: Vec<Complex64>,
}

impl HarmonicWave {
    /// The waves of all harmonics that the plate file states, at `points` (8 to 200 001) places; none where it states none.
    ///
    /// # Errors
    /// As [`respond`], for a multiple of the tone's frequency.
    pub fn of_tone(plate: &Plate, tone: &DrivenTone, points: usize) -> Result<Vec<Self>, RespondError> {
        let Some(harmonics) = &plate.spec().harmonics else { return Ok(Vec::new()) };
        let DrivenTone { frequency_hz, level, drive_m } = *tone;
        let stated = Harmonics::ORDERS.into_iter().filter_map(|order| {
            let drive_of_it_m = harmonics.drive(order, frequency_hz, level, drive_m)?;
            Some((order, harmonics.ratio(order, frequency_hz, level)?.norm(), drive_of_it_m))
        });
        let solve = |(order, ratio, drive_m): (u8, f64, Complex64)| {
            let frequency_hz = f64::from(order) * frequency_hz;
            let response = respond(plate, frequency_hz, points, Equation::Corrected)?;
            let wave = response.amplitude.iter().map(|f| f * drive_m).collect();
            Ok(Self { order, frequency_hz, ratio, turning_point_m: response.turning_point_m, wave })
        };
        stated.map(solve).collect()
    }

    /// The same wave where tone and harmonic are this factor as high.
    pub(crate) fn times(&self, factor: f64) -> Self {
        Self { wave: self.wave.iter().map(|f| f * factor).collect(), ..self.clone() }
    }

    /// Mean square displacement at each place, metres squared.
    #[must_use]
    pub fn squares(&self) -> Vec<f64> {
        self.wave.iter().map(|f| 0.5 * f.norm_sqr()).collect()
    }
}

/// What a finger feels of one harmonic alone beyond the felt edge of its tone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondBoundary {
    /// Frequency of the harmonic over that of the tone: 2 or 3.
    pub order: u8,
    /// Frequency of the harmonic, Hz.
    pub frequency_hz: f64,
    /// Where the harmonic turns, metres; beyond the plate's end if it reaches that.
    pub turning_point_m: f64,
    /// Largest strength beyond the felt edge of the tone over the threshold, dB; minus infinity for a harmonic without amplitude.
    pub over_threshold_db: f64,
    /// Where the sensation of the harmonic alone ends.
    pub felt_to: FeltEdge,
    /// Drive of the harmonic over that of the tone, at the tone's level.
    pub ratio: f64,
}

impl SecondBoundary {
    /// The second boundary of each wave beyond `edge`, the felt edge of the tone; none where the tone is felt up to the plate's
    /// end, because there no side is still. Where the tone itself is not felt, the whole plate should be still.
    #[must_use]
    pub fn each(plate: &Plate, feeling: &Feeling, edge: FeltEdge, waves: &[HarmonicWave]) -> Vec<Self> {
        let still_from_m = match edge {
            FeltEdge::At(edge_m) => edge_m,
            FeltEdge::Nowhere => 0.0,
            FeltEdge::PlateEnd => return Vec::new(),
        };
        let of_wave = |wave: &HarmonicWave| {
            let squares = wave.squares();
            let felt = FeltTone { frequency_hz: wave.frequency_hz, squares: &squares };
            let strength = feeling.strength(plate, &[felt]);
            let first = still_from_m / plate.length_m() * strength.len().saturating_sub(1) as f64;
            let beyond = strength.iter().skip(first.ceil() as usize);
            Self {
                order: wave.order,
                frequency_hz: wave.frequency_hz,
                turning_point_m: wave.turning_point_m,
                over_threshold_db: decibels(beyond.copied().fold(0.0, f64::max)),
                felt_to: Feeling::edge(plate, &strength),
                ratio: wave.ratio,
            }
        };
        waves.iter().map(of_wave).collect()
    }

    /// The one of them that is farthest over the threshold.
    #[must_use]
    pub fn loudest(boundaries: &[Self]) -> Option<Self> {
        boundaries.iter().copied().max_by(|a, b| a.over_threshold_db.total_cmp(&b.over_threshold_db))
    }

    /// Whether a finger feels the harmonic beyond the felt edge of the tone.
    #[must_use]
    pub fn is_felt(&self) -> bool {
        self.over_threshold_db > 0.0
    }

    /// The largest ratio of the drive at this level that a finger does not feel beyond the felt edge; `None` for a harmonic without
    /// amplitude.
    #[must_use]
    pub fn silent_below(&self) -> Option<f64> {
        let ratio = self.ratio * 10_f64.powf(-0.05 * self.over_threshold_db);
        ratio.is_finite().then_some(ratio)
    }

    /// `second boundary at 231 mm, +12 dB over the threshold`; of a harmonic that passes the plate's end, `the third harmonic reaches
    /// the plate's end, +10 dB over the threshold`. `length_m` is the plate's.
    #[must_use]
    pub fn words(&self, length_m: f64) -> String {
        let over = format!("{:+.0} dB over the threshold", self.over_threshold_db);
        if self.turning_point_m <= length_m {
            format!("second boundary at {} mm, {over}", with_decimals(1e3 * self.turning_point_m, 0))
        } else {
            format!("the {} harmonic reaches the plate's end, {over}", self.ordinal())
        }
    }

    /// `silent below 0.18 %`; empty for a harmonic without amplitude.
    #[must_use]
    pub fn silent_words(&self) -> String {
        let percent = self.silent_below().map(|ratio| significant(100.0 * ratio, 2));
        percent.map_or_else(String::new, |percent| format!("silent below {percent} %"))
    }

    /// `second` or `third`.
    #[must_use]
    pub const fn ordinal(&self) -> &'static str {
        if self.order == 2 { "second" } else { "third" }
    }
}
