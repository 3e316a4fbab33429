//! Plates as TOML text, read and written by the tables of [`super::fields`]. `PLATES.md` beside this crate lists every field
//! with its unit and range.

mod numbers;
mod text;
mod writer;

use crate::definition::drive::DriveEnd;
use crate::definition::error::{Origin, PlateError, PlateFileError};
use crate::definition::fields::{DRIVE, HARMONIC_POINTS, PLATE, SECTIONS};
use crate::definition::limits;
use crate::definition::plate::Plate;
use crate::definition::spec::PlateSpec;
use crate::quantity::{Count, Counted, Range, WrongCount};
pub use numbers::PlateFile;
use text::{Given, Text};

/// Largest plate file that is read, bytes.
pub const PLATE_FILE_BYTES_MAX: usize = 1 << 20;

impl Plate {
    /// Reads a plate from TOML text.
    ///
    /// # Errors
    /// [`PlateFileError::TooBig`] above [`PLATE_FILE_BYTES_MAX`]; [`PlateFileError::Syntax`] with the line where the
    /// text is not TOML; [`PlateFileError::Plate`] with the line of a field that is missing, unknown, of the wrong type
    /// or out of range, and what is allowed. No text makes this function panic.
    pub fn from_toml(text: &str) -> Result<Self, PlateFileError> {
        let text = parse(text)?;
        read(&text, &[], None).map_err(|error| in_text(&text, error))
    }
}

fn parse(text: &str) -> Result<Text<'_>, PlateFileError> {
    let allowed = Count::at_most(PLATE_FILE_BYTES_MAX, Counted::Bytes);
    WrongCount::check("the plate file", text.len(), allowed)?;
    Text::parse(text)
}

fn in_text(text: &Text<'_>, error: PlateError) -> PlateFileError {
    PlateFileError::Plate { line: text.line_of(error.field()), error }
}

/// The plate of a text, with `changes` of its numbers. `like` is a plate whose prepared laws are taken where they fit.
fn read(text: &Text<'_>, changes: &[(&str, f64)], like: Option<&Plate>) -> Result<Plate, PlateError> {
    // Unknown fields are reported before missing ones: a mistyped name is both, and "did you mean" helps more.
    let [plate, taper, model, thickness, drive, others @ ..] =
        SECTIONS.map(|schema| text.section(schema, changes));
    let (Some(plate), Some(taper), Some(model), Some(drive)) = (plate?, taper?, model?, drive?) else {
        return Err(first_missing(text));
    };
    if ["name", "length_m", "loss_factor"].iter().any(|name| !plate.has(name)) {
        return Err(first_missing(text));
    }
    let mut spec = PlateSpec::blank();
    for section in [&plate, &taper, &model, &drive] {
        section.read_into(&mut spec)?;
    }
    for section in std::iter::once(thickness).chain(others) {
        let Some(section) = section? else { continue };
        refuse_conflict(&section, &spec)?;
        section.read_into(&mut spec)?;
    }
    let span = (plate.number("span_start_m")?, plate.number("span_end_m")?);
    let band = (plate.number("band_start_hz")?, plate.number("band_end_hz")?);
    match (span, band) {
        ((Some(_), Some(_)), (None, None)) => Plate::like(spec, like),
        ((None, None), (Some(low_hz), Some(high_hz))) => plate_for_band(spec, low_hz, high_hz),
        ((Some(_), None), _) => Err(plate.missing("span_end_m")),
        ((None, Some(_)), _) => Err(plate.missing("span_start_m")),
        ((None, None), (Some(_), None)) => Err(plate.missing("band_end_hz")),
        ((None, None), (None, Some(_))) => Err(plate.missing("band_start_hz")),
        ((None, None), (None, None)) => Err(first_missing(text)),
        ((Some(_), Some(_)), (low, _)) => Err(PlateError::Unexpected {
            field: if low.is_some() { "band_start_hz" } else { "band_end_hz" }.to_owned(),
            reason: "the span is given by span_start_m and span_end_m already".to_owned(),
        }),
    }
}

/// Refuses a section that the drive end hides, and fields that state the same thing twice.
fn refuse_conflict(section: &Given<'_>, spec: &PlateSpec) -> Result<(), PlateError> {
    let given = |names: &[&'static str]| names.iter().copied().find(|name| section.has(name));
    let (field, reason) = match section.name() {
        "drive.lead_in" if !matches!(spec.drive_end, DriveEnd::Source(_)) => {
            let end = DRIVE.kind_of(spec).map_or("", |kind| kind.word);
            let reason = format!("it works only behind a soft drive, a \"source\"; \"{end}\" hides it");
            ("drive.lead_in".to_owned(), reason)
        }
        "air" => {
            let numbers = given(&["density_kg_per_m3", "sound_speed_m_per_s"]);
            let Some(name) = given(&["temperature_c", "height_m"]).filter(|_| numbers.is_some()) else {
                return Ok(());
            };
            let reason = "the air is given by density_kg_per_m3 and sound_speed_m_per_s already";
            (format!("air.{name}"), reason.to_owned())
        }
        "actuator" if section.has("harmonic_level") && given(&HARMONIC_POINTS).is_none() => {
            return Err(section.missing(HARMONIC_POINTS[0]));
        }
        "actuator" => {
            let resonator = given(&["resonance_hz", "quality", "peak_travel_m", "static_travel_m"]);
            let Some(name) = resonator.filter(|_| section.has("points")) else { return Ok(()) };
            let reason = "the response is given by points already; a peak travel needs a resonance";
            (format!("actuator.{name}"), reason.to_owned())
        }
        _ => return Ok(()),
    };
    Err(PlateError::Unexpected { field, reason })
}

/// The error for the first required field or section that is absent; it also lists the other absent ones.
fn first_missing(text: &Text<'_>) -> PlateError {
    const SPAN: &str = "span_start_m";
    let has = |name: &str| {
        let instead = ["span_end_m", "band_start_hz", "band_end_hz"];
        text.has(name) || (name == SPAN && instead.iter().any(|name| text.has(name)))
    };
    let mut absent = ["name", "length_m", "loss_factor", SPAN, "taper", "model", "drive"]
        .into_iter()
        .filter(|name| !has(name));
    let first = absent.next().unwrap_or_default();
    let section = SECTIONS.iter().find(|schema| schema.name == first);
    let told = match (section, PLATE.field(first)) {
        (Some(schema), _) if !first.is_empty() => {
            format!("{}, a section [{first}] with its {}", schema.meaning, schema.kind_field)
        }
        (_, Some(field)) if first == SPAN => {
            format!(
                "{}; a plate has span_start_m and span_end_m, or band_start_hz and band_end_hz",
                field.meaning
            )
        }
        (_, Some(field)) => format!("{}, {}", field.meaning, PLATE.allowed(field)),
        (_, None) => String::new(),
    };
    let others: Vec<String> = absent
        .map(|name| match name {
            "taper" | "model" | "drive" => format!("[{name}]"),
            SPAN => "span_start_m, span_end_m".to_owned(),
            _ => name.to_owned(),
        })
        .collect();
    let others =
        if others.is_empty() { String::new() } else { format!("; missing too: {}", others.join(", ")) };
    PlateError::Missing { field: first.to_owned(), needed: format!("{told}{others}") }
}

/// Makes a plate whose span is given by the frequencies of its two ends.
fn plate_for_band(mut spec: PlateSpec, low_hz: f64, high_hz: f64) -> Result<Plate, PlateError> {
    // A plate with a provisional span gives the turning points of the two frequencies. The band of that span is not the
    // user's: if it were checked, a message would name fields that the file does not have.
    spec.span_start_m = limits::span_start(spec.length_m).low;
    spec.span_end_m = 3.0 * spec.span_start_m;
    let probe = Plate::with_any_band(spec.clone())?;
    let lowest = probe.frequency_for_boundary_hz(spec.span_start_m);
    let highest = probe.frequency_for_boundary_hz(spec.length_m);
    let check = |field: &str, value: f64, low: f64| {
        if value > low && value <= highest {
            return Ok(());
        }
        Err(Range::new(low, highest, "Hz").refuse(field, value, Some(Origin::Turning)))
    };
    check("band_start_hz", low_hz, lowest)?;
    check("band_end_hz", high_hz, low_hz)?;
    limits::FREQUENCY.check("band_start_hz", low_hz)?;
    limits::FREQUENCY.check("band_end_hz", high_hz)?;
    spec.span_start_m = probe.turning_point_m(low_hz).unwrap_or(0.0);
    spec.span_end_m = probe.turning_point_m(high_hz).unwrap_or(0.0).min(spec.length_m);
    Plate::new(spec)
}
