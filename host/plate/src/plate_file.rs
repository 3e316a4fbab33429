//! Plates as TOML text. `PLATES.md` beside this crate lists every field with its unit and range.

use crate::drive::{Actuator, DriveEnd};
use crate::error::{PlateError, PlateFileError};
use crate::model::{Bending, Model};
use crate::plate::{Plate, PlateSpec};
use crate::taper::Taper;
use serde::{Deserialize, Serialize};

/// Largest plate file that is read, bytes.
pub const PLATE_FILE_BYTES_MAX: usize = 1 << 20;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlateText {
    name: String,
    #[serde(default)]
    description: String,
    length_m: f64,
    loss_factor: f64,
    #[serde(default)]
    wave_speed_tolerance: f64,
    #[serde(default = "default_full_scale")]
    full_scale_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    span_start_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    span_end_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    band_start_hz: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    band_end_hz: Option<f64>,
    taper: TaperText,
    model: ModelText,
    drive: DriveText,
    #[serde(skip_serializing_if = "Option::is_none")]
    actuator: Option<ActuatorText>,
}

fn default_full_scale() -> f64 {
    1e-6
}

#[derive(Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct TaperText {
    kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    half_width_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rate_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    end_half_width_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<[f64; 2]>>,
}

#[derive(Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct ModelText {
    kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    wave_speed_m_per_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shear_modulus_pa: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    youngs_modulus_pa: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    poisson_ratio: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    density_kg_per_m3: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    thickness_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    thick_plate: Option<bool>,
}

#[derive(Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct DriveText {
    end: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    ratio: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    at_frequency_hz: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ActuatorText {
    resonance_hz: f64,
    quality: f64,
}

impl Plate {
    /// Reads a plate from TOML text.
    ///
    /// # Errors
    /// [`PlateFileError`]: too big, not TOML (with the line), or a field that is missing, unknown or out of range
    /// (with the line where it stands). Nothing outside panics this.
    pub fn from_toml(text: &str) -> Result<Self, PlateFileError> {
        if text.len() > PLATE_FILE_BYTES_MAX {
            return Err(PlateFileError::TooBig { bytes: text.len(), limit: PLATE_FILE_BYTES_MAX });
        }
        let parsed: PlateText = toml::from_str(text).map_err(|fault| {
            let line = fault.span().map_or(1, |span| line_at(text, span.start));
            PlateFileError::Syntax { line, message: fault.message().trim().to_owned() }
        })?;
        build(parsed).map_err(|error| {
            let line = field_of(&error).and_then(|field| line_of(text, field));
            PlateFileError::Plate { line, error }
        })
    }

    /// The plate as TOML text that [`Plate::from_toml`] reads back to the same plate.
    pub fn to_toml(&self) -> String {
        let spec = self.spec();
        let text = PlateText {
            name: spec.name.clone(),
            description: spec.description.clone(),
            length_m: spec.length_m,
            loss_factor: spec.loss_factor,
            wave_speed_tolerance: spec.wave_speed_tolerance,
            full_scale_m: spec.full_scale_m,
            span_start_m: Some(spec.span_start_m),
            span_end_m: Some(spec.span_end_m),
            band_start_hz: None,
            band_end_hz: None,
            taper: taper_text(&spec.taper),
            model: model_text(&spec.model),
            drive: drive_text(spec.drive_end),
            actuator: spec.actuator.map(|actuator| ActuatorText {
                resonance_hz: actuator.resonance_hz,
                quality: actuator.quality,
            }),
        };
        // Plain numbers, words and one list of pairs: the writer has nothing to refuse.
        toml::to_string(&text).unwrap_or_default()
    }
}

fn build(text: PlateText) -> Result<Plate, PlateError> {
    let taper = taper(text.taper)?;
    let model = model(text.model)?;
    let drive_end = drive(&text.drive)?;
    let mut spec = PlateSpec {
        name: text.name,
        description: text.description,
        taper,
        length_m: text.length_m,
        model,
        loss_factor: text.loss_factor,
        wave_speed_tolerance: text.wave_speed_tolerance,
        drive_end,
        actuator: text
            .actuator
            .map(|given| Actuator { resonance_hz: given.resonance_hz, quality: given.quality }),
        full_scale_m: text.full_scale_m,
        span_start_m: 0.0,
        span_end_m: 0.0,
    };
    match (text.span_start_m, text.span_end_m, text.band_start_hz, text.band_end_hz) {
        (Some(start), Some(end), None, None) => {
            spec.span_start_m = start;
            spec.span_end_m = end;
            Plate::new(spec)
        }
        (None, None, Some(low), Some(high)) => plate_for_band(spec, low, high),
        (Some(_), None, ..) => Err(missing("span_end_m", "span_start_m needs it; up to length_m")),
        (None, Some(_), ..) => Err(missing("span_start_m", "span_end_m needs it; above 0")),
        (None, None, Some(_), None) => Err(missing("band_end_hz", "band_start_hz needs it")),
        (None, None, None, Some(_)) => Err(missing("band_start_hz", "band_end_hz needs it")),
        (None, None, None, None) => Err(missing(
            "span_start_m",
            "a plate has span_start_m and span_end_m, or band_start_hz and band_end_hz",
        )),
        (Some(_), Some(_), ..) => Err(PlateError::Unexpected {
            field: if text.band_start_hz.is_some() { "band_start_hz" } else { "band_end_hz" }.to_owned(),
            reason: "the span is given by span_start_m and span_end_m already".to_owned(),
        }),
    }
}

/// A plate whose span is given by the frequencies of its ends.
fn plate_for_band(mut spec: PlateSpec, low_hz: f64, high_hz: f64) -> Result<Plate, PlateError> {
    // A plate with its widest span answers where the two frequencies turn.
    spec.span_start_m = 1e-3 * spec.length_m;
    spec.span_end_m = 3e-3 * spec.length_m;
    let probe = Plate::new(spec.clone())?;
    let lowest = probe.frequency_for_boundary_hz(spec.span_start_m);
    let highest = probe.frequency_for_boundary_hz(spec.length_m);
    let check = |field: &str, value: f64, low: f64| {
        if value > low && value <= highest {
            return Ok(());
        }
        Err(PlateError::OutOfRange {
            field: field.to_owned(),
            value,
            allowed: format!(
                "{low:.4} to {highest:.4} Hz: lower cannot enter the plate, higher passes its end"
            ),
        })
    };
    check("band_start_hz", low_hz, lowest)?;
    check("band_end_hz", high_hz, low_hz)?;
    spec.span_start_m = probe.turning_point_m(low_hz).unwrap_or(0.0);
    spec.span_end_m = probe.turning_point_m(high_hz).unwrap_or(0.0).min(spec.length_m);
    Plate::new(spec)
}

fn missing(field: &str, needed: &str) -> PlateError {
    PlateError::Missing { field: field.to_owned(), needed: needed.to_owned() }
}

/// Takes the fields a kind needs and refuses the ones it does not have.
struct Fields<'a> {
    table: &'a str,
    kind: &'a str,
}

impl Fields<'_> {
    fn need<T>(&self, name: &str, value: Option<T>) -> Result<T, PlateError> {
        value
            .ok_or_else(|| missing(&format!("{}.{name}", self.table), &format!("\"{}\" needs it", self.kind)))
    }

    fn refuse(&self, strangers: &[(&str, bool)]) -> Result<(), PlateError> {
        match strangers.iter().find(|(_, given)| *given) {
            None => Ok(()),
            Some((name, _)) => Err(PlateError::Unexpected {
                field: format!("{}.{name}", self.table),
                reason: format!("\"{}\" has no such field", self.kind),
            }),
        }
    }
}

fn taper(text: TaperText) -> Result<Taper, PlateError> {
    let fields = Fields { table: "taper", kind: &text.kind };
    let (rate, end, points) =
        (text.rate_per_m.is_some(), text.end_half_width_m.is_some(), text.points.is_some());
    match text.kind.as_str() {
        "exponential" => {
            fields.refuse(&[("end_half_width_m", end), ("points", points)])?;
            Ok(Taper::Exponential {
                half_width_m: fields.need("half_width_m", text.half_width_m)?,
                rate_per_m: fields.need("rate_per_m", text.rate_per_m)?,
            })
        }
        "linear" => {
            fields.refuse(&[("rate_per_m", rate), ("points", points)])?;
            Ok(Taper::Linear {
                half_width_m: fields.need("half_width_m", text.half_width_m)?,
                end_half_width_m: fields.need("end_half_width_m", text.end_half_width_m)?,
            })
        }
        "sampled" => {
            let width = text.half_width_m.is_some();
            fields.refuse(&[("half_width_m", width), ("rate_per_m", rate), ("end_half_width_m", end)])?;
            Ok(Taper::Sampled { points: fields.need("points", text.points)? })
        }
        _ => Err(unknown("taper.kind", &text.kind, "\"exponential\", \"linear\", \"sampled\"")),
    }
}

fn taper_text(taper: &Taper) -> TaperText {
    match taper {
        Taper::Exponential { half_width_m, rate_per_m } => TaperText {
            kind: "exponential".to_owned(),
            half_width_m: Some(*half_width_m),
            rate_per_m: Some(*rate_per_m),
            ..TaperText::default()
        },
        Taper::Linear { half_width_m, end_half_width_m } => TaperText {
            kind: "linear".to_owned(),
            half_width_m: Some(*half_width_m),
            end_half_width_m: Some(*end_half_width_m),
            ..TaperText::default()
        },
        Taper::Sampled { points } => {
            TaperText { kind: "sampled".to_owned(), points: Some(points.clone()), ..TaperText::default() }
        }
    }
}

fn model(text: ModelText) -> Result<Model, PlateError> {
    let fields = Fields { table: "model", kind: &text.kind };
    let speed = ("wave_speed_m_per_s", text.wave_speed_m_per_s.is_some());
    let shear = ("shear_modulus_pa", text.shear_modulus_pa.is_some());
    let density = ("density_kg_per_m3", text.density_kg_per_m3.is_some());
    let bending_only = [
        ("youngs_modulus_pa", text.youngs_modulus_pa.is_some()),
        ("poisson_ratio", text.poisson_ratio.is_some()),
        ("thickness_m", text.thickness_m.is_some()),
        ("thick_plate", text.thick_plate.is_some()),
    ];
    match text.kind.as_str() {
        "membrane" => {
            fields.refuse(&bending_only)?;
            fields.refuse(&[shear, density])?;
            Ok(Model::Membrane {
                wave_speed_m_per_s: fields.need("wave_speed_m_per_s", text.wave_speed_m_per_s)?,
            })
        }
        "shear-horizontal" => {
            fields.refuse(&bending_only)?;
            fields.refuse(&[speed])?;
            Ok(Model::ShearHorizontal {
                shear_modulus_pa: fields.need("shear_modulus_pa", text.shear_modulus_pa)?,
                density_kg_per_m3: fields.need("density_kg_per_m3", text.density_kg_per_m3)?,
            })
        }
        "bending-supported" | "bending-clamped" => {
            fields.refuse(&[speed, shear])?;
            let bending = Bending {
                youngs_modulus_pa: fields.need("youngs_modulus_pa", text.youngs_modulus_pa)?,
                poisson_ratio: fields.need("poisson_ratio", text.poisson_ratio)?,
                density_kg_per_m3: fields.need("density_kg_per_m3", text.density_kg_per_m3)?,
                thickness_m: fields.need("thickness_m", text.thickness_m)?,
                thick_plate: text.thick_plate.unwrap_or(false),
            };
            Ok(if text.kind == "bending-supported" {
                Model::BendingSupported(bending)
            } else {
                Model::BendingClamped(bending)
            })
        }
        _ => Err(unknown(
            "model.kind",
            &text.kind,
            "\"membrane\", \"shear-horizontal\", \"bending-supported\", \"bending-clamped\"",
        )),
    }
}

fn model_text(model: &Model) -> ModelText {
    let bending_text = |kind: &str, bending: &Bending| ModelText {
        kind: kind.to_owned(),
        youngs_modulus_pa: Some(bending.youngs_modulus_pa),
        poisson_ratio: Some(bending.poisson_ratio),
        density_kg_per_m3: Some(bending.density_kg_per_m3),
        thickness_m: Some(bending.thickness_m),
        thick_plate: Some(bending.thick_plate),
        ..ModelText::default()
    };
    match model {
        Model::Membrane { wave_speed_m_per_s } => ModelText {
            kind: "membrane".to_owned(),
            wave_speed_m_per_s: Some(*wave_speed_m_per_s),
            ..ModelText::default()
        },
        Model::ShearHorizontal { shear_modulus_pa, density_kg_per_m3 } => ModelText {
            kind: "shear-horizontal".to_owned(),
            shear_modulus_pa: Some(*shear_modulus_pa),
            density_kg_per_m3: Some(*density_kg_per_m3),
            ..ModelText::default()
        },
        Model::BendingSupported(bending) => bending_text("bending-supported", bending),
        Model::BendingClamped(bending) => bending_text("bending-clamped", bending),
    }
}

fn drive(text: &DriveText) -> Result<DriveEnd, PlateError> {
    let fields = Fields { table: "drive", kind: &text.end };
    let (ratio, at) = (("ratio", text.ratio.is_some()), ("at_frequency_hz", text.at_frequency_hz.is_some()));
    match text.end.as_str() {
        "displacement" => {
            fields.refuse(&[ratio, at])?;
            Ok(DriveEnd::Displacement)
        }
        "force" => {
            fields.refuse(&[ratio])?;
            Ok(DriveEnd::Force { at_frequency_hz: fields.need("at_frequency_hz", text.at_frequency_hz)? })
        }
        "resistance" => Ok(DriveEnd::Resistance {
            ratio: fields.need("ratio", text.ratio)?,
            at_frequency_hz: fields.need("at_frequency_hz", text.at_frequency_hz)?,
        }),
        _ => Err(unknown("drive.end", &text.end, "\"displacement\", \"force\", \"resistance\"")),
    }
}

fn drive_text(end: DriveEnd) -> DriveText {
    match end {
        DriveEnd::Displacement => DriveText { end: "displacement".to_owned(), ..DriveText::default() },
        DriveEnd::Force { at_frequency_hz } => {
            DriveText { end: "force".to_owned(), ratio: None, at_frequency_hz: Some(at_frequency_hz) }
        }
        DriveEnd::Resistance { ratio, at_frequency_hz } => DriveText {
            end: "resistance".to_owned(),
            ratio: Some(ratio),
            at_frequency_hz: Some(at_frequency_hz),
        },
    }
}

fn unknown(field: &str, value: &str, allowed: &str) -> PlateError {
    // A hostile file may hold a very long word: the message quotes its beginning.
    let value: String = value.chars().take(40).collect();
    PlateError::UnknownKind { field: field.to_owned(), value, allowed: allowed.to_owned() }
}

fn field_of(error: &PlateError) -> Option<&str> {
    match error {
        PlateError::OutOfRange { field, .. }
        | PlateError::Missing { field, .. }
        | PlateError::Unexpected { field, .. }
        | PlateError::UnknownKind { field, .. }
        | PlateError::TooLong { field, .. } => Some(field),
        PlateError::NotNarrowing { .. } => Some("taper.points"),
    }
}

/// Line of byte `offset`, from 1.
fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

/// Line of the key (or, if the key is not there, of its table's header), from 1.
fn line_of(text: &str, field: &str) -> Option<usize> {
    let field = field.split('[').next().unwrap_or(field);
    let (wanted_table, wanted_key) = field.split_once('.').unwrap_or(("", field));
    let mut table = String::new();
    let mut header = None;
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.split(']').next()) {
            table = name.trim().to_owned();
            if table == wanted_table {
                header = Some(number + 1);
            }
        } else if let Some((key, _)) = line.split_once('=') {
            let key = key.trim();
            if (table == wanted_table && key == wanted_key) || (table.is_empty() && key == field) {
                return Some(number + 1);
            }
        }
    }
    header
}
