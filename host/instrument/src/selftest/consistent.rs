//! Whether the parts of a report can be of one test: a report that is judged comes from a file.

use super::limits::step;
use super::report::{SelftestReport, StepResult};
use super::request::Wire;
use super::verdict::Verdict;
use slipline_plate::quantity::must_be;

/// Steps that need a wire.
const WIRED: [(&str, Wire); 5] = [
    (step::DAC_TO_ADC, Wire::DacToSensor),
    (step::DELAY, Wire::DacToSensor),
    (step::NOISE, Wire::DacToSensor),
    (step::TRIGGER, Wire::Trigger),
    (step::STALL, Wire::Trigger),
];
/// Steps that a short test leaves out.
const LONG: [&str; 2] = [step::BOOTLOADER, step::FAULTS];
/// Steps of a test of the amplifier.
const WITH_AMPLIFIER: [&str; 5] = [step::CLOCKS, step::SUPPLY, step::MUTE, step::LINK, step::AMPLIFIER];

impl SelftestReport {
    /// The first part that contradicts another, and what it must be; `None` of a report that one test can give.
    #[must_use]
    pub fn contradiction(&self) -> Option<String> {
        let has_amplifier = self.is_shown(step::AMPLIFIER);
        if self.unit.is_empty() {
            return Some(must_be("unit", "a text that is not empty"));
        }
        if let Some(twice) = self.wires.iter().enumerate().find(|(at, wire)| self.wires[..*at].contains(wire))
        {
            return Some(must_be(format_args!("wires[{}]", twice.0), "another wire than those before it"));
        }
        let is_wired = |wire: Wire| self.wires.iter().any(|name| name == wire.name());
        if let Some((name, wire)) = WIRED.iter().find(|(name, wire)| self.is_shown(name) && !is_wired(*wire))
        {
            let allowed =
                format_args!("a list with {}, by which the step {name} was carried out", wire.name());
            return Some(must_be("wires", allowed));
        }
        let is_left_out = |name: &str| {
            let is_long = self.short && LONG.contains(&name);
            is_long || has_amplifier && !WITH_AMPLIFIER.contains(&name)
        };
        if let Some(at) =
            self.steps.iter().position(|it| it.verdict != Verdict::Skipped && is_left_out(&it.name))
        {
            let which = if has_amplifier { "a test of the amplifier" } else { "a short test" };
            return Some(must_be(format_args!("steps[{at}].verdict"), format_args!("skipped in {which}")));
        }
        let is_hex = |text: &String, digits: usize| {
            text.len() == digits && text.bytes().all(|byte| byte.is_ascii_hexdigit())
        };
        if !self.image_sha256.iter().all(|sum| is_hex(sum, 64)) {
            return Some(must_be("image_sha256", "64 hexadecimal digits or null"));
        }
        let compares = self.step(step::CODES).is_some_and(|it| has(it, "windows"));
        if self.codes_crc.is_some() != compares || !self.codes_crc.iter().all(|crc| is_hex(crc, 8)) {
            let allowed = "eight hexadecimal digits where codes were compared, else null";
            return Some(must_be("codes_crc", allowed));
        }
        self.lacking(has_amplifier)
    }

    /// The first number that this kind of test always has, and that is missing.
    fn lacking(&self, has_amplifier: bool) -> Option<String> {
        let (rate, other) = ("rate error", "rate error in a short time");
        let (rate, other) = if self.short || has_amplifier { (other, rate) } else { (rate, other) };
        // What a firmware that knows the bench reports.
        let knows_bench = has_amplifier || self.is_shown(step::CODES);
        let needed = [
            (step::CLOCKS, rate, true),
            (step::SUPPLY, "brown-out level unset", knows_bench),
            (step::MUTE, "resistor missing", true),
            (step::MUTE, "pin high while muted", knows_bench),
            (step::LINK, "reopenings without answer", !has_amplifier),
        ];
        self.steps.iter().enumerate().find_map(|(at, it)| {
            if it.name == step::CLOCKS && has(it, other) {
                let given = format_args!("steps[{at}].readings has {other:?}");
                return Some(must_be(given, format_args!("{rate:?} in this test")));
            }
            let is_judged = matches!(it.verdict, Verdict::Green | Verdict::Amber);
            let of_step = needed.iter().filter(|(name, ..)| is_judged && *name == it.name);
            let (_, quantity, _) =
                of_step.into_iter().find(|(_, quantity, is_needed)| *is_needed && !has(it, quantity))?;
            Some(format!(
                "steps[{at}].readings has no {quantity:?}, by which the step is {}",
                it.verdict.name()
            ))
        })
    }

    fn step(&self, name: &str) -> Option<&StepResult> {
        self.steps.iter().find(|step| step.name == name)
    }

    /// Whether a step was carried out.
    fn is_shown(&self, name: &str) -> bool {
        self.step(name).is_some_and(|step| step.verdict != Verdict::Skipped)
    }
}

fn has(step: &StepResult, quantity: &str) -> bool {
    step.readings.iter().any(|reading| reading.quantity == quantity)
}
