//! Makes a light, with colour and sentence, of a number at a boundary.

use super::interval::Interval;
use super::levels::SiteLevels;
use super::prepared::Prepared;
use super::report::{Colour, Light, Limit};
use super::stretch::Stretch;
use super::thresholds::Limits;
use crate::definition::plate::Plate;
use crate::frequency::Response;

/// A light and its severity within its colour; over a span the light with the highest severity is kept.
pub(super) struct Finding {
    pub(super) light: Light,
    pub(super) severity: f64,
}

/// One boundary on a prepared plate and the quantities computed there: the input of every light.
pub(super) struct Site<'a> {
    pub(super) prepared: &'a Prepared,
    pub(super) plate: &'a Plate,
    pub(super) boundary_m: f64,
    pub(super) frequency_hz: f64,
    /// The amplitude over the plate at that frequency.
    pub(super) response: Response,
    pub(super) levels: SiteLevels,
    /// The interval that a calibration states here; `None` for an uncalibrated plate.
    pub(super) interval: Option<Interval>,
}

impl Finding {
    /// States the limits of the light's number.
    pub(super) fn limited(mut self, limit: Limit) -> Self {
        self.light.limit = Some(limit);
        self
    }

    /// States where on the plate the light fails; nothing if it is green or unchecked.
    pub(super) fn over(mut self, stretches: impl FnOnce() -> Vec<Stretch>) -> Self {
        if self.light.colour > Colour::Green {
            self.light.stretches = stretches();
        }
        self
    }

    /// States the one place where it fails; nothing if it is green or unchecked.
    pub(super) fn at(self, place_m: f64) -> Self {
        self.over(|| vec![Stretch::at(place_m)])
    }
}

impl Site<'_> {
    /// Place of the peak, metres; the boundary if there is none.
    pub(super) fn peak_m(&self) -> f64 {
        self.response.peak.map_or(self.boundary_m, |peak| peak.position_m)
    }

    /// A light with its colour by `value` and `limit`, with a sentence per colour.
    pub(super) fn graded(
        &self,
        name: &'static str,
        value: f64,
        unit: &'static str,
        limit: Limit,
        sentences: [String; 3],
    ) -> Finding {
        let (colour, severity) = match limit {
            Limit::AtMost(limits) => (colour(value, limits), value),
            Limit::AtLeast(limits) => (colour_at_least(value, limits), -value),
        };
        self.judged(name, Some(value), unit, colour, severity, pick(colour, sentences)).limited(limit)
    }

    /// A light of a given colour.
    pub(super) fn judged(
        &self,
        name: &'static str,
        value: Option<f64>,
        unit: &'static str,
        colour: Colour,
        severity: f64,
        sentence: String,
    ) -> Finding {
        // An infinite number has no JSON; the sentence says it in words.
        let value = value.filter(|value| value.is_finite());
        Finding {
            light: Light {
                name,
                value,
                low: None,
                high: None,
                unit,
                limit: None,
                colour,
                sentence,
                boundary_m: self.boundary_m,
                stretches: Vec::new(),
            },
            severity,
        }
    }
}

/// The sentence for the colour.
pub(super) fn pick(colour: Colour, [green, amber, red]: [String; 3]) -> String {
    match colour {
        // An unchecked light has no value to grade and is not passed here.
        Colour::Green | Colour::Unchecked => green,
        Colour::Amber => amber,
        Colour::Red => red,
    }
}

/// Green from the first limit on, amber from the second on; NaN is red.
pub(super) fn colour_at_least(measure: f64, Limits { green, amber }: Limits) -> Colour {
    colour(-measure, Limits { green: -green, amber: -amber })
}

/// Green up to the first limit, amber up to the second; NaN is red.
pub(super) fn colour(measure: f64, limits: Limits) -> Colour {
    if measure <= limits.green {
        Colour::Green
    } else if measure <= limits.amber {
        Colour::Amber
    } else {
        Colour::Red
    }
}
