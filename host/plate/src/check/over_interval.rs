//! Judges a light over what a calibration leaves open: green only if it is green at every end.

use super::grading::{Finding, Site};
use super::interval::{End, Interval};
use super::report::{Colour, range};

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
    /// of its number is stated only where there is a number at every end.
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
