//! Lights for sound: the sound level of one tone and the beat of two.

use crate::check::grading::{Finding, Site, colour};
use crate::check::report::{Colour, Limit};
use crate::check::stretch::Stretch;
use crate::check::thresholds::{
    AUDIBLE_DB_A, BEAT_HZ, LISTENER_M, Limits, NEAR_ULTRASOUND_DB, NEAR_ULTRASOUND_END_HZ, ULTRASONIC_HZ,
    ULTRASOUND_DB,
};
use crate::quantity::{decibels, number_format::with_decimals};
use std::f64::consts::{PI, SQRT_2, TAU};

/// Density of air at 20 degrees C, kg/m^3.
const AIR_DENSITY: f64 = 1.204;
/// Speed of sound in air at 20 degrees C, m/s.
const AIR_SPEED: f64 = 343.2;
/// Reference sound pressure, Pa.
const REFERENCE_PA: f64 = 20e-6;

/// Sound pressure level of a plane wave, dB SPL (re 20 uPa): an infinite surface that moves in phase with the given
/// displacement amplitude a in metres radiates an RMS pressure of rho c omega a/sqrt 2. This is an upper bound for a
/// plate. Minus infinity for an amplitude of 0.
pub(crate) fn plane_wave_level_db(frequency_hz: f64, displacement_m: f64) -> f64 {
    level_db(AIR_DENSITY * AIR_SPEED * TAU * frequency_hz * displacement_m)
}

/// A-weighting of IEC 61672-1 at a frequency in Hz, dB; 0 at 1 kHz.
pub(crate) fn a_weighting_db(frequency_hz: f64) -> f64 {
    let square = frequency_hz * frequency_hz;
    let pole = |f: f64| square + f * f;
    let response = 12_194.217_f64.powi(2) * square * square
        / (pole(20.598_997) * (pole(107.652_65) * pole(737.862_23)).sqrt() * pole(12_194.217));
    decibels(response) + 2.0
}

/// Sound pressure level of a sine with the given pressure amplitude, dB SPL.
fn level_db(pressure_amplitude_pa: f64) -> f64 {
    decibels(pressure_amplitude_pa / SQRT_2 / REFERENCE_PA)
}

/// Upper bound of the level at [`LISTENER_M`], dB SPL: the Rayleigh integral with all parts of the plate in phase,
/// p = rho omega^2 (volume displacement)/(2 pi distance), or the plane wave of the largest amplitude if that is less.
fn bound_db(site: &Site<'_>) -> f64 {
    let response = &site.response;
    let scale_m = site.prepared.peak_m() / response.height();
    let step_m = site.plate.length_m() / (response.position_m.len() - 1) as f64;
    // The first width mode is a half sine, with a mean over the width of 2/pi of the centre line. Between clamped edges
    // the mean is lower (0.52), so this stays an upper bound.
    let swept_m3: f64 = response
        .position_m
        .iter()
        .zip(&response.amplitude)
        .map(|(&x, amplitude)| amplitude.norm() * scale_m * 2.0 * site.plate.half_width_m(x) * (2.0 / PI))
        .sum::<f64>()
        * step_m;
    let omega = TAU * site.frequency_hz;
    let rayleigh = level_db(AIR_DENSITY * omega * omega * swept_m3 / (TAU * LISTENER_M));
    let largest = response.amplitude.iter().map(|amplitude| amplitude.norm()).fold(0.0, f64::max) * scale_m;
    rayleigh.min(plane_wave_level_db(site.frequency_hz, largest))
}

pub(in crate::check) fn level_light(site: &Site<'_>) -> Finding {
    let bound = bound_db(site);
    let (value, unit, limits) = if site.frequency_hz < ULTRASONIC_HZ {
        (bound + a_weighting_db(site.frequency_hz), "dB(A)", AUDIBLE_DB_A)
    } else if site.frequency_hz < NEAR_ULTRASOUND_END_HZ {
        (bound, "dB", NEAR_ULTRASOUND_DB)
    } else {
        (bound, "dB", ULTRASOUND_DB)
    };
    // At level 0 the sound level is minus infinity; it is stated as 0 dB.
    let value = value.max(0.0);
    let open_db = site.levels.open_db(site.plate);
    let at_ends = open_db.map_or(Vec::new(), |open_db| {
        [value - open_db, value + open_db].map(|level| (level.max(0.0), colour(level, limits))).to_vec()
    });
    let known = open_db.map_or(String::new(), level_words);
    site.graded(
        "sound level",
        value,
        unit,
        Limit::AtMost(limits),
        [
            format!("At most {value:.0} {unit} of sound at half a metre."),
            format!(
                "Up to {value:.0} {unit} of sound at half a metre: keep sessions short or lower the level."
            ),
            format!(
                "Up to {value:.0} {unit} of sound at half a metre: lower the level or enclose the plate."
            ),
        ],
    )
    .between(&at_ends, &known)
}

/// The accuracy of the peak level, in words.
pub(in crate::check) fn level_words(open_db: f64) -> String {
    format!("the level of the peak is known to ±{} dB", with_decimals(open_db, 2))
}

pub(in crate::check) fn beat_light(site: &Site<'_>) -> Finding {
    let others = &site.prepared.conditions.other_boundaries_m;
    let tones: Vec<(f64, f64)> = others
        .iter()
        .map(|&x| (site.plate.frequency_for_boundary_hz(x), x))
        .chain([(site.frequency_hz, site.boundary_m)])
        .filter(|&(frequency_hz, _)| frequency_hz >= ULTRASONIC_HZ)
        .collect();
    // Smallest difference of two frequencies, Hz, and the distance from the drive that both tones reach.
    let (mut nearest, mut reach_m) = (f64::INFINITY, 0.0);
    for (i, first) in tones.iter().enumerate() {
        for second in &tones[i + 1..] {
            // Tones of equal frequency do not beat.
            let difference = (first.0 - second.0).abs();
            if difference > 1e-6 && difference < nearest {
                (nearest, reach_m) = (difference, first.1.min(second.1));
            }
        }
    }
    let (colour, sentence) = if nearest < BEAT_HZ {
        let sentence = format!(
            "Two ultrasonic tones are {nearest:.0} Hz apart and beat at a rate skin feels: move them apart, or use it on purpose."
        );
        (Colour::Amber, sentence)
    } else if nearest.is_infinite() {
        (Colour::Green, "No two ultrasonic tones sound together: nothing beats.".to_owned())
    } else {
        let sentence =
            format!("The ultrasonic tones are {nearest:.0} Hz apart: their beat is too fast to feel.");
        (Colour::Green, sentence)
    };
    site.judged("beat", Some(nearest), "Hz", colour, -nearest, sentence)
        .limited(Limit::AtLeast(Limits { green: BEAT_HZ, amber: 0.0 }))
        .over(|| vec![Stretch { from_m: 0.0, to_m: reach_m }])
}
