//! What a calibration leaves open of a plate, and what that does to a light.
//!
//! The intervals of wave speed, widths and loss go together: each alone moves the boundary much farther than all of them may.
//! So the ends of the interval are the plates with the widths at both ends of theirs and the wave speed that puts the boundary
//! at an end of its own. A light that depends on nothing else is monotone in each of these over so short a way, so what holds
//! at these corners holds between them.

use super::grading::{Finding, Site};
use super::report::{Colour, range};
use crate::quantity::number_format::with_decimals;
use crate::quantity::show_length;
use crate::spec::limits;
use crate::spec::plate::Plate;
use std::f64::consts::TAU;

/// The interval of a calibrated plate at one boundary.
#[derive(Debug)]
pub(super) struct Interval {
    /// How well the boundary is known: half of the interval, metres.
    pub(super) boundary_m: f64,
    /// Factor of the loss to either end of its interval.
    pub(super) loss: f64,
    /// The plates at its corners.
    pub(super) ends: Vec<End>,
    /// Whether all corners are plates that can be computed.
    is_whole: bool,
}

/// A plate at an end of the interval.
#[derive(Debug)]
pub(super) struct End {
    pub(super) plate: Plate,
    /// Where the wave turns that turns at the boundary of the plate itself, metres.
    pub(super) boundary_m: f64,
}

impl Interval {
    /// That of `plate` at the boundary `boundary_m`, metres, where the wave of `frequency_hz` turns; `None` for a plate that
    /// nobody has measured.
    pub(super) fn new(plate: &Plate, boundary_m: f64, frequency_hz: f64) -> Option<Self> {
        let calibration = plate.spec().calibration.as_ref()?;
        let half_m = plate.boundary_tolerance_m(boundary_m)?;
        let nearest_m = limits::span_start(plate.length_m()).low;
        let mut ends = Vec::new();
        let mut is_whole = true;
        for [side, width, taper] in corners() {
            let scale = (width * calibration.half_width_tolerance).exp();
            let power = 1.0 + taper * calibration.taper_tolerance;
            let place_m = (boundary_m + side * half_m).max(nearest_m);
            match turning_at(plate, (scale, power), place_m, frequency_hz) {
                Some(plate) => ends.push(End { plate, boundary_m: place_m }),
                None => is_whole = false,
            }
        }
        let loss = 1.0 + plate.spec().loss_tolerance.unwrap_or(super::thresholds::LOSS_TOLERANCE);
        Some(Self { boundary_m: half_m, loss, ends, is_whole })
    }

    /// How well the boundary is known, in words.
    pub(super) fn boundary(&self) -> String {
        boundary_words(self.boundary_m)
    }

    /// The same, and how well the loss is known.
    pub(super) fn boundary_and_loss(&self) -> String {
        format!("{}, the loss to a factor of {}", self.boundary(), with_decimals(self.loss, 2))
    }
}

/// How well a boundary is known, in words.
pub(super) fn boundary_words(half_m: f64) -> String {
    format!("the boundary is known to ±{}", show_length(half_m))
}

/// The signs of boundary, width and taper at the corners.
fn corners() -> impl Iterator<Item = [f64; 3]> {
    (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| if bit == 0 { -1.0 } else { 1.0 }))
}

/// The plate with its taper stretched and with the wave speed at which a wave of `frequency_hz` turns at `place_m`.
fn turning_at(plate: &Plate, (scale, power): (f64, f64), place_m: f64, frequency_hz: f64) -> Option<Plate> {
    let plate = plate.with_taper(plate.spec().taper.stretched(scale, power)).ok()?;
    let wavenumber = plate.spec().model.wavenumber_squared(TAU * frequency_hz).sqrt();
    let turning = plate.width_mode(1).number / plate.turning_half_width_m(place_m);
    plate.with_wave_speed(wavenumber / turning).ok()
}

impl Finding {
    /// Judges the light over the interval of the calibration, too: `at` is its number and colour on a plate. `words` say how well
    /// that is known which the light depends on.
    pub(super) fn over_interval(
        self,
        site: &Site<'_>,
        words: impl Fn(&Interval) -> String,
        at: impl Fn(&End) -> (f64, Colour),
    ) -> Self {
        self.over_corners(site, words, |end| vec![at(end)])
    }

    /// As [`Finding::over_interval`], where the light has several numbers at each end: it depends on more than boundary and widths.
    pub(super) fn over_corners(
        self,
        site: &Site<'_>,
        words: impl Fn(&Interval) -> String,
        at: impl Fn(&End) -> Vec<(f64, Colour)>,
    ) -> Self {
        let Some(interval) = &site.interval else { return self };
        let all: Vec<(f64, Colour)> = interval.ends.iter().flat_map(at).collect();
        let found = self.between(&all, &words(interval));
        if interval.is_whole || found.light.colour != Colour::Green {
            found
        } else {
            found.beyond_any_plate()
        }
    }

    /// Judges the light by its numbers and colours at the ends of an interval, too: green only if it is green there. The interval
    /// of its number is told only where there is a number at every end.
    pub(super) fn between(mut self, at_ends: &[(f64, Colour)], words: &str) -> Self {
        let light = &mut self.light;
        if light.colour == Colour::Unchecked || at_ends.is_empty() {
            return self;
        }
        let worst = at_ends.iter().map(|end| end.1).max().unwrap_or(light.colour);
        let mut told = String::new();
        let is_told = at_ends.iter().all(|end| end.0.is_finite());
        if let Some(value) = light.value.filter(|_| is_told) {
            let low = at_ends.iter().map(|end| end.0).fold(value, f64::min);
            let high = at_ends.iter().map(|end| end.0).fold(value, f64::max);
            (light.low, light.high) = (Some(low), Some(high));
            told = range(low, high).map_or(told, |range| format!(" ({range} {})", light.unit));
        }
        let told = told.replace(" )", ")");
        let more = match (light.colour, worst) {
            (Colour::Green, Colour::Green) => {
                format!("It holds over the calibrated interval{told}: {words}.")
            }
            (Colour::Green, _) => {
                light.colour = Colour::Amber;
                format!(
                    "It does not hold at an end of the calibrated interval{told}: {words}, measure it again with less noise."
                )
            }
            _ => format!("Over the calibrated interval{told}: {words}."),
        };
        light.sentence = format!("{} {more}", light.sentence);
        self
    }

    fn beyond_any_plate(mut self) -> Self {
        self.light.colour = Colour::Amber;
        self.light
            .sentence
            .push_str(" An end of the interval is no plate that can be computed: calibrate it more exactly.");
        self
    }
}
