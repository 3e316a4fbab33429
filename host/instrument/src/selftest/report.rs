//! The report of a self-test: steps like lights, each with its numbers, their limits and a sentence.

use super::limits::{self, Limit};
use super::verdict::Verdict;
use slipline_link::capitalized;
use slipline_plate::quantity::number_format::significant;

/// One number of a step.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reading {
    /// The quantity.
    // JSON of selftest, text: What was measured
    pub quantity: String,
    /// The number.
    // JSON of selftest, in `value_unit`: The number
    pub value: f64,
    /// Its unit; empty for a pure number or a count.
    // JSON, text: Unit of `value` and of its limits; empty for a pure number or a count
    pub value_unit: String,
    /// The lowest allowed number; `None` without such a limit.
    // JSON, in `value_unit`: The lowest allowed number; null without such a limit
    pub at_least: Option<f64>,
    /// The highest allowed number; `None` without such a limit.
    // JSON, in `value_unit`: The highest allowed number; null without such a limit
    pub at_most: Option<f64>,
}

impl Reading {
    /// A number with the limits of its step.
    pub(super) fn new(step: &str, quantity: &str, value: f64, unit: &str) -> Self {
        // Of several limits the narrowest is shown.
        let limit = limits::of(step, quantity).last();
        Self {
            quantity: quantity.to_owned(),
            value,
            value_unit: unit.to_owned(),
            at_least: limit.and_then(|limit| limit.at_least),
            at_most: limit.and_then(|limit| limit.at_most),
        }
    }

    /// The number with its unit: `3.27 V`.
    #[must_use]
    pub fn shown(&self) -> String {
        with_unit(self.value, &self.value_unit)
    }

    /// The number with so many digits that it differs from the limit that it exceeds: `3.4004 V`.
    fn shown_beyond(&self, limit: &Limit) -> String {
        let bound = limit.at_most.filter(|most| self.value > *most).or(limit.at_least);
        let unit = &self.value_unit;
        let bound = bound.map(|bound| with_unit(bound, unit));
        let longer = (5..=17)
            .map(|digits| format!("{} {unit}", significant(self.value, digits)).trim_end().to_owned());
        let is_apart = |shown: &String| Some(shown) != bound.as_ref();
        std::iter::once(self.shown()).chain(longer).find(is_apart).unwrap_or_else(|| self.shown())
    }

    /// Its limits in words: `2.9 V to 3.4 V`; `None` of a number that is only reported.
    #[must_use]
    pub fn allowed(&self) -> Option<String> {
        let shown = |value: f64| with_unit(value, &self.value_unit);
        match (self.at_least, self.at_most) {
            (None, None) => None,
            (Some(least), None) => Some(format!("at least {}", shown(least))),
            (None, Some(most)) => Some(format!("at most {}", shown(most))),
            (Some(least), Some(most)) if least == most => Some(shown(least)),
            (Some(least), Some(most)) => Some(format!("{} to {}", shown(least), shown(most))),
        }
    }
}

fn with_unit(value: f64, unit: &str) -> String {
    // A count is shown whole, a small number by three decimals.
    let number = if unit.is_empty() && value.fract() == 0.0 && value.abs() < 1e9 {
        format!("{value:.0}")
    } else if value.abs() < 1.0 {
        significant((1000.0 * value).round() / 1000.0 + 0.0, 3)
    } else {
        significant(value, 4)
    };
    format!("{number} {unit}").trim_end().to_owned()
}

/// One step.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StepResult {
    /// Its name; the same words for every board.
    // JSON, text: Name
    pub name: String,
    /// Its result.
    // JSON, text: green, amber, red, or skipped where the step is not shown
    pub verdict: Verdict,
    /// Its numbers.
    pub readings: Vec<Reading>,
    /// What the result means; of a skipped step, what is missing.
    // JSON of selftest, text: What the result means; of a skipped step, what is missing
    pub sentence: String,
}

impl StepResult {
    /// A step judged by the limits of its numbers. `good` is its sentence where all are kept.
    pub(super) fn judged(name: &str, readings: Vec<Reading>, good: impl Into<String>) -> Self {
        let step = Self { name: name.to_owned(), verdict: Verdict::Green, readings, sentence: good.into() };
        step.judged_again()
    }

    /// A step that could not be carried out: what is missing.
    pub(super) fn skipped(name: &str, missing: impl Into<String>) -> Self {
        Self {
            name: name.to_owned(),
            verdict: Verdict::Skipped,
            readings: Vec::new(),
            sentence: missing.into(),
        }
    }

    /// A step in which the device did not do what it should.
    pub(super) fn failed(name: &str, why: impl Into<String>) -> Self {
        Self { verdict: Verdict::Red, ..Self::skipped(name, why) }
    }

    /// The step judged by the limits of this program, whatever limits stand beside its numbers. A step that was skipped or failed
    /// without a number stays so.
    pub(super) fn judged_again(mut self) -> Self {
        // The widest limit of each number that it exceeds.
        let broken: Vec<(&Reading, &Limit)> = self
            .readings
            .iter()
            .filter_map(|reading| {
                let mut limits = limits::of(&self.name, &reading.quantity);
                Some((reading, limits.find(|limit| !limit.allows(reading.value))?))
            })
            .collect();
        let Some(worst) = broken.iter().map(|(_, limit)| limit.beyond).max() else { return self };
        let sentences: Vec<String> = broken
            .iter()
            .map(|(reading, limit)| {
                let of_limit =
                    Reading { at_least: limit.at_least, at_most: limit.at_most, ..(*reading).clone() };
                let allowed = of_limit.allowed().unwrap_or_default();
                let quantity = capitalized(&reading.quantity);
                format!("{quantity} is {}, allowed: {allowed}. {}", reading.shown_beyond(limit), limit.remedy)
            })
            .collect();
        let sentence = sentences.join(" ");
        if worst > self.verdict {
            (self.verdict, self.sentence) = (worst, sentence);
        }
        self
    }
}

/// The report of a self-test.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SelftestReport {
    /// The board's name.
    pub board: String,
    /// Number of this device.
    // JSON of selftest, text: Number of this device
    pub unit: String,
    /// The firmware's version.
    pub firmware: String,
    /// The firmware's build.
    pub build: String,
    /// Whether the device is simulated.
    pub simulated: bool,
    /// The wires that were fitted, by their names.
    // JSON of selftest, text: The wires that were fitted, as --wire takes them
    pub wires: Vec<String>,
    /// Whether it was a short test.
    // JSON of selftest, true or false: Whether it was a short test
    pub short: bool,
    /// CRC-32 over the digests of the compared windows of codes, in hexadecimal; `None` where none were compared.
    // JSON, text: CRC-32 over the digests of the compared codes, eight hexadecimal digits; null where none were compared
    pub codes_crc: Option<String>,
    /// SHA-256 of the image of this build, in hexadecimal; `None` where the program does not hold it.
    // JSON, text: SHA-256 of the image of this build, 64 hexadecimal digits; null where the program does not hold it
    pub image_sha256: Option<String>,
    /// The steps, always in the same order.
    pub steps: Vec<StepResult>,
}

impl SelftestReport {
    /// The worst verdict; skipped steps do not count, unless all are.
    #[must_use]
    pub fn worst(&self) -> Verdict {
        self.steps.iter().map(|step| step.verdict).max().unwrap_or(Verdict::Skipped)
    }

    /// The names of the steps with this verdict.
    pub fn named(&self, verdict: Verdict) -> impl Iterator<Item = &str> {
        self.steps.iter().filter(move |step| step.verdict == verdict).map(|step| step.name.as_str())
    }

    /// Whether no step is red and at least one was carried out.
    #[must_use]
    pub fn passed(&self) -> bool {
        matches!(self.worst(), Verdict::Green | Verdict::Amber)
    }

    /// The line by which a report is found in a log: `SELFTEST PASS unit=.. build=.. sha=..`, then the names of the steps that are
    /// not green.
    #[must_use]
    pub fn line(&self) -> String {
        let result = if self.passed() { "PASS" } else { "FAIL" };
        let word = |text: &str| text.split_whitespace().collect::<Vec<_>>().join("_");
        let sha = self.image_sha256.as_deref().unwrap_or("none");
        let mut line =
            format!("SELFTEST {result} unit={} build={} sha={sha}", word(&self.unit), word(&self.build));
        for verdict in [Verdict::Red, Verdict::Amber, Verdict::Skipped] {
            let names: Vec<String> = self.named(verdict).map(word).collect();
            if !names.is_empty() {
                line.push_str(&format!(" {}={}", verdict.name(), names.join(",")));
            }
        }
        line
    }

    /// The same numbers judged by the limits of this program.
    #[must_use]
    pub fn judged_again(mut self) -> Self {
        self.steps = self.steps.into_iter().map(StepResult::judged_again).collect();
        self
    }
}

#[cfg(test)]
mod tests {
    use super::super::limits::step;
    use super::*;

    #[test]
    fn a_number_beyond_its_limit_is_never_shown_as_the_limit() {
        for (name, quantity, value, unit, wanted) in [
            (step::SUPPLY, "VREF+", 3.400_003_4, "V", "VREF+ is 3.400003 V, allowed: 2.9 V to 3.4 V."),
            (
                step::NOISE,
                "SINAD at 1 kHz",
                59.999_99,
                "dB",
                "SINAD at 1 kHz is 59.99999 dB, allowed: at least 60 dB.",
            ),
            (
                step::CLOCKS,
                "rate error",
                -300.0001,
                "ppm",
                "Rate error is -300.0001 ppm, allowed: -300 ppm to 300 ppm.",
            ),
            (step::SUPPLY, "VREF+", 2.7, "V", "VREF+ is 2.7 V, allowed"),
        ] {
            let judged = StepResult::judged(name, vec![Reading::new(name, quantity, value, unit)], "Good.");
            assert!(judged.sentence.starts_with(wanted), "{}", judged.sentence);
        }
    }
}
