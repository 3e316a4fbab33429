//! The damper that absorbs the returning wave: at the driven end, or behind a lead-in.
//!
//! The amplitude equation of membranes and shear waves has one condition at the driven end. So a mechanical resistance
//! equal to the wave impedance Z ([`Plate::wave_impedance_n_s_per_m`]; for a film slightly less) absorbs the returning
//! wave completely. Z depends on the frequency, the resistance of a real damper does not. So the damper matches where Z
//! is the geometric mean of its extremes over the band, and is off by the same factor at both.
//!
//! A plate in bending has two conditions and a near field: R = Z at its free end reflects more than half of the
//! amplitude, the best R a third. A lead-in matches over a whole band: the plate continues behind the drive, with a
//! layer that dissipates and a damper at its far end. The designer takes the shortest lead-in whose reflection stays
//! below the target over the band, with the largest possible loss: close to the cut-off a large loss makes the lead-in
//! unlike the plate, and the start of the lead-in reflects. The reflection from the far end also adds to the wave that
//! the drive launches; the longer the lead-in, the more this sum depends on the wave speed. So the level is judged,
//! too, over the tolerance of the wave speed.

use crate::definition::drive::DriveEnd;
use crate::definition::limits;
use crate::definition::plate::Plate;
use crate::definition::source::{LeadIn, Source};
use crate::frequency::driven_end::{Scattering, SourceEnd};
use serde::Serialize;
use std::f64::consts::TAU;

/// The part that absorbs the returning wave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, serde::Deserialize)]
pub struct Damper {
    /// Mechanical resistance R, N s/m: at the driven end, or at the far end of the lead-in.
    // JSON: Resistance of the damper
    pub resistance_n_s_per_m: f64,
    /// Frequency for which R is chosen, Hz; without a lead-in the damper matches there (R = Z).
    // JSON: Frequency at which the damper matches
    pub match_frequency_hz: f64,
    /// Smallest and largest R/Z over the band.
    // JSON, 1: Smallest and largest R/Z over the band
    pub ratio_range: (f64, f64),
    /// Largest reflection of the returning wave at the driven end over the band, as a ratio of amplitudes.
    // JSON, 1: Largest share of the returning wave that the end reflects
    pub largest_reflection: f64,
    /// The strip behind the drive of a plate in bending; `None` where a damper at the driven end matches.
    pub lead_in: Option<LeadIn>,
}

/// Number of frequencies in the band at which R/Z is evaluated.
const BAND_PLACES: usize = 201;
/// Number of frequencies in the band at which a lead-in is judged.
const LEAD_IN_PLACES: usize = 31;
/// Loss factors of a metal strip with a constrained damping layer, in the order of the search.
const LEAD_IN_LOSSES: [f64; 3] = [0.2, 0.14, 0.1];
/// Largest reflection of a lead-in. With 0.11 (60 mm on the preset `al-bending`) an error of 1 % in the wave speed
/// costs 1.01 dB, with 0.09 (70 mm) 0.89 dB.
const REFLECTION: f64 = 0.09;
/// Largest unevenness of the level over the tolerance of the wave speed, dB. It is slightly below the 1 dB that designs
/// guarantee, because the band contains more frequencies than those judged.
const LEVEL_DB: f64 = 0.97;
/// 20 lg e.
const DB_PER_NEPER: f64 = 8.685_889_638_065_037;
/// Lengths of a lead-in that are tried: first, step and last, in wavelengths of the middle of the band.
const LEAD_IN_WAVELENGTHS: (f64, f64, f64) = (0.5, 0.05, 4.0);
/// Resistances behind a lead-in that are tried, over Z in the middle of the band.
const LEAD_IN_RATIOS: [f64; 5] = [0.25, 0.31, 0.37, 0.44, 0.52];

/// The driven end that matches `plate` over `band_hz`, and its damper.
pub(super) fn matched(plate: &Plate, band_hz: (f64, f64)) -> (DriveEnd, Damper) {
    let (at_frequency_hz, ratio_range) = best_match(plate, band_hz);
    let impedance = plate.matching_resistance_n_s_per_m(at_frequency_hz).unwrap_or(f64::NAN);
    if plate.spec().model.bending().is_some() {
        let (source, largest_reflection) = shortest_lead_in(plate, band_hz, at_frequency_hz, impedance);
        let resistance_n_s_per_m = source.lead_in.map_or(0.0, |lead_in| lead_in.end_resistance_n_s_per_m);
        let ratio = resistance_n_s_per_m / impedance;
        let damper = Damper {
            resistance_n_s_per_m,
            match_frequency_hz: at_frequency_hz,
            ratio_range: (ratio * ratio_range.0, ratio * ratio_range.1),
            largest_reflection,
            lead_in: source.lead_in,
        };
        return (DriveEnd::Source(source), damper);
    }
    let reflected = |ratio: f64| ((1.0 - ratio) / (1.0 + ratio)).abs();
    let damper = Damper {
        resistance_n_s_per_m: impedance,
        match_frequency_hz: at_frequency_hz,
        ratio_range,
        largest_reflection: reflected(ratio_range.0).max(reflected(ratio_range.1)),
        lead_in: None,
    };
    (DriveEnd::Resistance { ratio: 1.0, at_frequency_hz }, damper)
}

/// The shortest lead-in whose [`Unevenness`] is within the limits over the band, or the best one if there is none; and
/// its largest reflection.
fn shortest_lead_in(
    plate: &Plate,
    band_hz: (f64, f64),
    at_frequency_hz: f64,
    impedance: f64,
) -> (Source, f64) {
    let k0 = plate.width_mode(1).wavenumber_squared(0.0, at_frequency_hz).max(1e-300).sqrt();
    let (first, step, last) = LEAD_IN_WAVELENGTHS;
    let soft = Source::soft(&plate.spec().model, at_frequency_hz);
    let tolerance = plate.spec().wave_speed_tolerance;
    let others = [1.0 - tolerance, 1.0 + tolerance].map(|speed| plate.with_wave_speed(speed).ok());
    let places: Vec<[Option<SourceEnd<'_>>; 3]> = band_places(band_hz, LEAD_IN_PLACES)
        .map(|hz| {
            let end = |plate| SourceEnd::new(plate, hz, &LEAD_IN_LOSSES);
            [end(plate), others[0].as_ref().and_then(end), others[1].as_ref().and_then(end)]
        })
        .collect();
    // If no lead-in can be judged: the longest, with the largest loss.
    let longest = LeadIn {
        length_m: rounded_up(last * TAU / k0),
        loss_factor: LEAD_IN_LOSSES[0],
        end_resistance_n_s_per_m: LEAD_IN_RATIOS[2] * impedance,
    };
    let mut best = (Source { lead_in: Some(longest), ..soft }, Unevenness::MOST);
    let count = ((last - first) / step) as usize;
    for loss_factor in LEAD_IN_LOSSES {
        for number in 0..=count {
            // Whole millimetres are easier to cut; below 10 mm tenths of a millimetre are used.
            let length_m = rounded_up((first + step * number as f64) * TAU / k0);
            for ratio in LEAD_IN_RATIOS {
                let end_resistance_n_s_per_m = ratio * impedance;
                let lead_in = LeadIn { length_m, loss_factor, end_resistance_n_s_per_m };
                let source = Source { lead_in: Some(lead_in), ..soft };
                let found = Unevenness::over(&places, &source, best.1.merit());
                if found.merit() < best.1.merit() {
                    best = (source, found);
                }
            }
            if best.1.merit() <= 1.0 {
                return (best.0, best.1.reflected);
            }
        }
    }
    (best.0, best.1.reflected)
}

/// The deviations from an even level that a lead-in causes.
#[derive(Debug, Clone, Copy)]
struct Unevenness {
    /// Largest |r| over the band.
    reflected: f64,
    /// Largest error of the level over the band, at any wave speed within the plate's tolerance, dB: the ripple,
    /// 20 lg(1 + |r|), and half of the change of the launched wave over the tolerance, because the table takes the
    /// middle.
    level_db: f64,
}

impl Unevenness {
    const MOST: Self = Self { reflected: 1.0, level_db: f64::INFINITY };

    /// Largest ratio of a deviation to its limit: at most 1 within the limits.
    fn merit(&self) -> f64 {
        (self.reflected / REFLECTION).max(self.level_db / LEVEL_DB)
    }

    /// The unevenness of `source` at the `places` of the band, each at the nominal wave speed and at two others. The
    /// evaluation ends early where the merit reaches `enough`.
    fn over(places: &[[Option<SourceEnd<'_>>; 3]], source: &Source, enough: f64) -> Self {
        let mut found = Self { reflected: 0.0, level_db: 0.0 };
        for [nominal, others @ ..] in places {
            let Some(nominal) = nominal else { return Self::MOST };
            let Scattering { reflected, launched_ln } = nominal.scattering(source);
            found.reflected = found.reflected.max(reflected);
            if found.merit() < enough {
                let others = others.iter().flatten().map(|end| end.scattering(source).launched_ln);
                let (low, high) =
                    others.fold((launched_ln, launched_ln), |(low, high), ln| (low.min(ln), high.max(ln)));
                found.level_db = found.level_db.max(DB_PER_NEPER * (reflected.ln_1p() + 0.5 * (high - low)));
            }
            if found.merit() >= enough {
                break;
            }
        }
        found
    }
}

/// Rounded up to whole millimetres, below 10 mm to tenths; clamped to the allowed lengths of a lead-in.
fn rounded_up(length_m: f64) -> f64 {
    let per_metre = if length_m < 0.01 { 1e4 } else { 1e3 };
    ((length_m * per_metre).ceil() / per_metre).clamp(limits::LEAD_IN_LENGTH.low, limits::LEAD_IN_LENGTH.high)
}

/// `count` frequencies of the band in geometric progression, both ends included, Hz.
fn band_places(band_hz: (f64, f64), count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| band_hz.0 * (band_hz.1 / band_hz.0).powf(i as f64 / (count - 1) as f64))
}

/// The frequency of the band, Hz, where Z is closest to the geometric mean of its extremes; and the smallest and the
/// largest R/Z over the band for a damper that matches there.
fn best_match(plate: &Plate, band_hz: (f64, f64)) -> (f64, (f64, f64)) {
    // 1/Z.
    let slowness = |frequency_hz: f64| {
        1.0 / plate.matching_resistance_n_s_per_m(frequency_hz).unwrap_or(f64::NAN).max(1e-300)
    };
    let places: Vec<(f64, f64)> = band_places(band_hz, BAND_PLACES).map(|hz| (hz, slowness(hz))).collect();
    let (low, high) = places
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), place| (low.min(place.1), high.max(place.1)));
    let middle = (low * high).sqrt();
    let nearest =
        |a: &&(f64, f64), b: &&(f64, f64)| (a.1 / middle).ln().abs().total_cmp(&(b.1 / middle).ln().abs());
    let at = places.iter().min_by(nearest).map_or(band_hz.0, |place| place.0);
    let matched = slowness(at);
    (at, (low / matched, high / matched))
}
