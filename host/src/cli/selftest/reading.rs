//! A report read from its file: each field is checked, and an error names it.

use super::super::schema::SCHEMA;
use serde_json::{Map, Value};
use slipline_instrument::selftest::{
    Quantity, Reading, SelftestReport, StepResult, Verdict, Wire, limits_of, quantities_of, quantity,
    required, step,
};
use slipline_plate::quantity::must_be;

/// The largest file that is read.
pub(super) const BYTES_MAX: usize = 1 << 20;
/// Readings of a step, and letters of a text, at most.
const READINGS_MAX: usize = 64;
const LETTERS_MAX: usize = 1000;

/// A report and its date.
///
/// # Errors
/// The field that is missing or is not what it should be, and what is allowed.
pub(super) fn report(text: &str) -> Result<(SelftestReport, String), String> {
    let value: Value = serde_json::from_str(text.trim_start_matches('\u{feff}'))
        .map_err(|error| format!("it is not JSON: {error}"))?;
    let fields = Fields::of(&value, String::new())?;
    let schema = fields.number("schema")?;
    if schema != f64::from(SCHEMA) {
        let allowed = format_args!("{SCHEMA}, that of this version of slipline");
        return Err(must_be(format_args!("schema = {schema}"), allowed));
    }
    let report = SelftestReport {
        board: fields.text("board")?,
        unit: fields.text("unit")?,
        firmware: fields.text("firmware")?,
        build: fields.text("build")?,
        simulated: fields.flag("simulated")?,
        wires: wires(&fields)?,
        short: fields.flag("short")?,
        codes_crc: fields.or_null("codes_crc", Fields::text)?,
        image_sha256: fields.or_null("image_sha256", Fields::text)?,
        steps: steps(&fields)?,
    };
    match report.contradiction() {
        Some(contradiction) => Err(contradiction),
        None => Ok((report, fields.text("date")?)),
    }
}

/// The wires that were fitted.
fn wires(fields: &Fields<'_>) -> Result<Vec<String>, String> {
    let list = fields.list("wires", Wire::ALL.len())?;
    let names = list.iter().enumerate().map(|(at, value)| {
        let wire = value.as_str().and_then(|text| Wire::ALL.into_iter().find(|wire| wire.name() == text));
        let allowed = Wire::ALL.map(Wire::name).join(" or ");
        wire.map(|wire| wire.name().to_owned()).ok_or_else(|| must_be(format_args!("wires[{at}]"), allowed))
    });
    names.collect()
}

/// The steps: all of them, in their order.
fn steps(fields: &Fields<'_>) -> Result<Vec<StepResult>, String> {
    let list = fields.list("steps", step::ALL.len())?;
    let steps = list.iter().enumerate().map(|(at, value)| {
        let fields = Fields::of(value, format!("steps[{at}]."))?;
        let (name, wanted) = (fields.text("name")?, step::ALL.get(at).copied().unwrap_or_default());
        if name != wanted {
            let given = format_args!("{} = {name:?}", fields.place("name"));
            return Err(must_be(given, format_args!("{wanted:?}")));
        }
        read_step(name, &fields)
    });
    let steps: Vec<StepResult> = steps.collect::<Result<_, _>>()?;
    match step::ALL.get(steps.len()) {
        Some(missing) => Err(format!("steps has no step {missing:?}")),
        None => Ok(steps),
    }
}

fn read_step(name: String, fields: &Fields<'_>) -> Result<StepResult, String> {
    let word = fields.text("verdict")?;
    let verdict = Verdict::ALL.into_iter().find(|verdict| verdict.name() == word);
    let verdict = verdict.ok_or_else(|| {
        let given = format_args!("{} = {word:?}", fields.place("verdict"));
        must_be(given, "skipped, green, amber or red")
    })?;
    let list = fields.list("readings", READINGS_MAX)?;
    let readings = list.iter().enumerate().map(|(at, value)| {
        let fields = Fields::of(value, format!("{}[{at}].", fields.place("readings")))?;
        read_reading(&name, &fields)
    });
    let readings: Vec<Reading> = readings.collect::<Result<_, _>>()?;
    let has_limit = |reading: &Reading| limits_of(&name, &reading.quantity).next().is_some();
    if matches!(verdict, Verdict::Green | Verdict::Amber) && !readings.iter().any(has_limit) {
        return Err(format!("{} has no number by which the step is {word}", fields.place("readings")));
    }
    let has = |quantity: &str| readings.iter().any(|reading| reading.quantity == quantity);
    match (verdict, required(&name).find(|quantity| !has(quantity))) {
        (Verdict::Green | Verdict::Amber, Some(missing)) => {
            return Err(format!(
                "{} has no {missing:?}, by which the step is {word}",
                fields.place("readings")
            ));
        }
        (Verdict::Skipped, _) if !readings.is_empty() => {
            return Err(must_be(fields.place("readings"), "empty in a skipped step"));
        }
        _ => {}
    }
    Ok(StepResult { name, verdict, readings, sentence: fields.text("sentence")? })
}

/// A number of a step that this program knows, in its unit.
fn read_reading(step: &str, fields: &Fields<'_>) -> Result<Reading, String> {
    let (name, value, unit) = (fields.text("quantity")?, fields.number("value")?, fields.text("value_unit")?);
    let known: &Quantity = quantity(step, &name).ok_or_else(|| {
        let names: Vec<&str> = quantities_of(step).map(|quantity| quantity.name).collect();
        let given = format_args!("{} = {name:?}", fields.place("quantity"));
        let allowed =
            if names.is_empty() { "absent: the step has no numbers".to_owned() } else { names.join(", ") };
        must_be(given, allowed)
    })?;
    if unit != known.unit {
        let given = format_args!("{} = {unit:?}", fields.place("value_unit"));
        return Err(must_be(given, format_args!("{:?}", known.unit)));
    }
    if !known.allows(value) {
        return Err(must_be(format_args!("{} = {value}", fields.place("value")), "a whole number from 0"));
    }
    Ok(Reading {
        quantity: name,
        value,
        value_unit: unit,
        at_least: fields.or_null("at_least", Fields::number)?,
        at_most: fields.or_null("at_most", Fields::number)?,
    })
}

/// Whether a letter would steer a terminal: a control character, or one that turns the direction of the text.
fn is_hidden(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The fields of an object, and where it stands.
struct Fields<'a> {
    fields: &'a Map<String, Value>,
    before: String,
}

impl<'a> Fields<'a> {
    fn of(value: &'a Value, before: String) -> Result<Self, String> {
        let what = before.trim_end_matches('.');
        let what = if what.is_empty() { "the report" } else { what };
        let fields = value.as_object().ok_or_else(|| must_be(what, "an object"))?;
        Ok(Self { fields, before })
    }

    fn place(&self, name: &str) -> String {
        format!("{}{name}", self.before)
    }

    fn get(&self, name: &str) -> Result<&'a Value, String> {
        self.fields.get(name).ok_or_else(|| format!("{} is missing", self.place(name)))
    }

    fn text(&self, name: &str) -> Result<String, String> {
        let is_allowed = |text: &&str| text.chars().count() <= LETTERS_MAX && !text.chars().any(is_hidden);
        let text = self.get(name)?.as_str().filter(is_allowed);
        let allowed = format_args!("a text of up to {LETTERS_MAX} letters without control characters");
        text.map(str::to_owned).ok_or_else(|| must_be(self.place(name), allowed))
    }

    fn number(&self, name: &str) -> Result<f64, String> {
        self.get(name)?.as_f64().ok_or_else(|| must_be(self.place(name), "a number"))
    }

    fn flag(&self, name: &str) -> Result<bool, String> {
        self.get(name)?.as_bool().ok_or_else(|| must_be(self.place(name), "true or false"))
    }

    fn list(&self, name: &str, most: usize) -> Result<&'a [Value], String> {
        let list = self.get(name)?.as_array().filter(|list| list.len() <= most);
        list.map(Vec::as_slice)
            .ok_or_else(|| must_be(self.place(name), format_args!("a list of up to {most} entries")))
    }

    fn or_null<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Self, &str) -> Result<T, String>,
    ) -> Result<Option<T>, String> {
        if self.get(name)?.is_null() { Ok(None) } else { read(self, name).map(Some) }
    }
}
