//! The damper that absorbs the returning wave: at the driven end, or behind a lead-in.
//!
//! Membranes and shear waves have one condition at their end, so a mechanical resistance of the wave impedance Z
//! ([`Plate::wave_impedance_n_s_per_m`]) absorbs the returning wave completely. Z changes with the frequency and a real
//! damper does not, so the match is made where the two ends of the band are wrong by the same factor.
//!
//! A plate in bending has two conditions and a near field: R = Z at its free end sends more than half of the amplitude
//! back, the best R a third. What matches a whole band is a lead-in: the plate goes on behind the drive, with a layer that
//! dissipates and a damper at its far end. The designer takes the shortest whose reflection stays below the target over
//! the band, with as much loss as possible: close to the cut-off much loss makes the lead-in unlike the plate, and its own
//! beginning reflects.

use crate::frequency::driven_end::source_reflection;
use crate::spec::drive::DriveEnd;
use crate::spec::limits;
use crate::spec::plate::Plate;
use crate::spec::source::{LeadIn, Source};
use serde::Serialize;
use std::f64::consts::TAU;

/// What absorbs the returning wave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Damper {
    /// Mechanical resistance R, N s/m: at the driven end, or at the far end of the lead-in.
    pub resistance_n_s_per_m: f64,
    /// Frequency for which it is chosen, Hz: without a lead-in it matches there (R = Z).
    pub match_frequency_hz: f64,
    /// Smallest and largest R/Z over the band.
    pub ratio_range: (f64, f64),
    /// Largest share of the returning wave's amplitude that the driven end sends back, over the band.
    pub largest_reflection: f64,
    /// The strip behind the drive of a plate in bending; `None` where a damper at the driven end matches.
    pub lead_in: Option<LeadIn>,
}

/// Number of frequencies in the band at which r is evaluated.
const BAND_PLACES: usize = 201;
/// Frequencies in the band at which a lead-in is judged.
const LEAD_IN_PLACES: usize = 31;
/// Loss factors of a strip of metal with a constrained damping layer, in the order in which they are tried.
const LEAD_IN_LOSSES: [f64; 3] = [0.2, 0.14, 0.1];
/// Largest reflection of a lead-in. With 0.11 (60 mm on the preset `al-bending`) a wave speed that is 1 % off costs 1.01 dB,
/// with 0.09 (70 mm) 0.89 dB.
const REFLECTION: f64 = 0.09;
/// Lengths of a lead-in that are tried, in wavelengths of the band's middle.
const LEAD_IN_WAVELENGTHS: (f64, f64, f64) = (0.5, 0.05, 4.0);
/// Resistances behind a lead-in that are tried, over Z in the band's middle.
const LEAD_IN_RATIOS: [f64; 5] = [0.25, 0.31, 0.37, 0.44, 0.52];

/// The end that matches `plate` over `band_hz`, and what it is made of.
pub(super) fn matched(plate: &Plate, band_hz: (f64, f64)) -> (DriveEnd, Damper) {
    let (at_frequency_hz, ratio_range) = best_match(plate, band_hz);
    let impedance = plate.wave_impedance_n_s_per_m(at_frequency_hz).unwrap_or(f64::NAN);
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

/// The shortest lead-in that stays below [`REFLECTION`] over the band, or the best one if none does; and its largest
/// reflection.
fn shortest_lead_in(
    plate: &Plate,
    band_hz: (f64, f64),
    at_frequency_hz: f64,
    impedance: f64,
) -> (Source, f64) {
    let k0 = plate.width_mode(1).wavenumber_squared(0.0, at_frequency_hz).max(1e-300).sqrt();
    let (first, step, last) = LEAD_IN_WAVELENGTHS;
    let soft = Source::soft(&plate.spec().model, at_frequency_hz);
    let mut best = (soft, f64::INFINITY);
    let count = ((last - first) / step) as usize;
    for loss_factor in LEAD_IN_LOSSES {
        for number in 0..=count {
            // Whole millimetres are cut more easily; a tenth of the step is enough on a small plate.
            let length_m = rounded_up((first + step * number as f64) * TAU / k0);
            for ratio in LEAD_IN_RATIOS {
                let end_resistance_n_s_per_m = ratio * impedance;
                let lead_in = LeadIn { length_m, loss_factor, end_resistance_n_s_per_m };
                let source = Source { lead_in: Some(lead_in), ..soft };
                let largest = largest_reflection(plate, &source, band_hz, best.1);
                if largest < best.1 {
                    best = (source, largest);
                }
            }
            if best.1 <= REFLECTION {
                return best;
            }
        }
    }
    best
}

/// The largest reflection of `source` over the band; the search ends early where it exceeds `enough`.
fn largest_reflection(plate: &Plate, source: &Source, band_hz: (f64, f64), enough: f64) -> f64 {
    let mut largest: f64 = 0.0;
    for frequency_hz in band_places(band_hz, LEAD_IN_PLACES) {
        largest = largest.max(source_reflection(plate, source, frequency_hz).map_or(1.0, |r| r.norm()));
        if largest >= enough {
            break;
        }
    }
    largest
}

/// The next whole millimetre, or the next tenth below 10 mm; at least a lead-in's shortest length.
fn rounded_up(length_m: f64) -> f64 {
    let per_metre = if length_m < 0.01 { 1e4 } else { 1e3 };
    ((length_m * per_metre).ceil() / per_metre).clamp(limits::LEAD_IN_LENGTH.low, limits::LEAD_IN_LENGTH.high)
}

/// `count` frequencies of the band in equal ratios, both ends included, Hz.
fn band_places(band_hz: (f64, f64), count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| band_hz.0 * (band_hz.1 / band_hz.0).powf(i as f64 / (count - 1) as f64))
}

/// The frequency of the band, Hz, where Z is closest to the geometric mean of its extremes; and the smallest and
/// the largest r over the band for a damper that matches there.
fn best_match(plate: &Plate, band_hz: (f64, f64)) -> (f64, (f64, f64)) {
    // 1/Z.
    let slowness = |frequency_hz: f64| {
        1.0 / plate.wave_impedance_n_s_per_m(frequency_hz).unwrap_or(f64::NAN).max(1e-300)
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
