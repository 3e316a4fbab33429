//! Judges a light over the interval of a calibration: green only if it is green at every end.

use super::grading::{Finding, Site};
use super::interval::{End, Interval};
use super::report::{Colour, range};

impl Finding {
    /// Judges the light also over the interval of the calibration: `at` gives its number and colour on a plate.
    /// `words` state how well the quantities behind the light are known.
    pub(super) fn over_interval(
        self,
        site: &Site<'_>,
        words: impl Fn(&Interval) -> String,
        at: impl Fn(&End) -> (f64, Colour),
    ) -> Self {
        self.over_corners(site, words, |end| vec![at(end)])
    }

    /// As [`Finding::over_interval`], with several numbers at each end, for a light that depends on more than
    /// boundary and widths.
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

    /// Judges the light also by its numbers and colours at the ends of an interval: green only if it is green there.
    /// The interval of its number is stated only if there is a number at every end.
    pub(super) fn between(mut self, at_ends: &[(f64, Colour)], words: &str) -> Self {
        let light = &mut self.light;
        if light.colour == Colour::Unchecked || at_ends.is_empty() {
            return self;
        }
        let worst = at_ends.iter().map(|end| end.1).max().unwrap_or(light.colour);
        let mut range_words = String::new();
        let is_stated = at_ends.iter().all(|end| end.0.is_finite());
        if let Some(value) = light.value.filter(|_| is_stated) {
            let low = at_ends.iter().map(|end| end.0).fold(value, f64::min);
            let high = at_ends.iter().map(|end| end.0).fold(value, f64::max);
            (light.low, light.high) = (Some(low), Some(high));
            range_words = range(low, high).map_or(range_words, |range| format!(" ({range} {})", light.unit));
        }
        let range_words = range_words.replace(" )", ")");
        let more = match (light.colour, worst) {
            (Colour::Green, Colour::Green) => {
                format!("It holds over the calibrated interval{range_words}: {words}.")
            }
            (Colour::Green, _) => {
                light.colour = Colour::Amber;
                format!(
                    "It does not hold at an end of the calibrated interval{range_words}: {words}, measure it again with less noise."
                )
            }
            _ => format!("Over the calibrated interval{range_words}: {words}."),
        };
        light.sentence = format!("{} {more}", light.sentence);
        self
    }

    fn beyond_any_plate(mut self) -> Self {
        self.light.colour = Colour::Amber;
        self.light
            .sentence
            .push_str(" At an end of the interval the plate cannot be computed: calibrate it more exactly.");
        self
    }
}
