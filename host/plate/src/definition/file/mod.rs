//! Plates as TOML text. `PLATES.md` beside this crate lists every field with its unit and range.

mod fields;
mod numbers;
mod text;
mod writer;

use crate::definition::actuator::{Actuator, Resonator};
use crate::definition::air::{Air, AirMounting, Faces, Gas};
use crate::definition::calibration::{Calibration, SOURCE_TOLERANCE};
use crate::definition::drive::DriveEnd;
use crate::definition::error::{Origin, PlateError, PlateFileError};
use crate::definition::film::Film;
use crate::definition::impedance::Impedance;
use crate::definition::limits;
use crate::definition::model::{Bending, Model};
use crate::definition::plate::{Plate, PlateSpec};
use crate::definition::response_curve::ResponseCurve;
use crate::definition::source::{EndSlope, LeadIn, Source};
use crate::definition::taper::Taper;
use crate::definition::thickness::Thickness;
use crate::definition::travel::Travel;
use crate::definition::turning_width::TurningWidth;
use crate::quantity::number_format::typed;
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
    let given = text.section(&fields::PLATE, changes)?;
    let [_, others @ ..] = fields::SECTIONS;
    let [taper, model, thickness, drive, lead_in, air, actuator, calibration] =
        others.map(|schema| text.section(schema, changes));
    let (Some(plate), Some(taper), Some(model), Some(drive)) = (given, taper?, model?, drive?) else {
        return Err(first_missing(text));
    };
    if ["name", "length_m", "loss_factor"].iter().any(|name| !plate.has(name)) {
        return Err(first_missing(text));
    }
    let model = model_of(&model)?;
    let lead_in = lead_in?.as_ref().map(lead_in_of).transpose()?;
    let mut spec = PlateSpec {
        name: plate.text("name")?.unwrap_or_default(),
        description: plate.text("description")?.unwrap_or_default(),
        taper: taper_of(&taper)?,
        turning_width: turning_width_of(&plate)?,
        length_m: plate.required("length_m")?,
        drive_end: drive_of(&drive, &model, lead_in)?,
        model,
        thickness: thickness?.as_ref().map(thickness_of).transpose()?,
        loss_factor: plate.required("loss_factor")?,
        wave_speed_tolerance: plate.number("wave_speed_tolerance")?.unwrap_or(0.0),
        loss_tolerance: plate.number("loss_tolerance")?,
        air: air?.as_ref().map(air_of).transpose()?,
        actuator: actuator?.as_ref().map(actuator_of).transpose()?,
        full_scale_m: plate.number("full_scale_m")?.unwrap_or(1e-6),
        span_start_m: 0.0,
        span_end_m: 0.0,
        calibration: calibration?.as_ref().map(calibration_of).transpose()?,
    };
    let span = (plate.number("span_start_m")?, plate.number("span_end_m")?);
    let band = (plate.number("band_start_hz")?, plate.number("band_end_hz")?);
    match (span, band) {
        ((Some(start_m), Some(end_m)), (None, None)) => {
            spec.span_start_m = start_m;
            spec.span_end_m = end_m;
            Plate::like(spec, like)
        }
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
    let section = fields::SECTIONS.iter().find(|schema| schema.name == first);
    let told = match (section, fields::PLATE.field(first)) {
        (Some(schema), _) if !first.is_empty() => {
            format!("{}, a section [{first}] with its {}", schema.meaning, schema.kind_field)
        }
        (_, Some(field)) if first == SPAN => {
            format!(
                "{}; a plate has span_start_m and span_end_m, or band_start_hz and band_end_hz",
                field.meaning
            )
        }
        (_, Some(field)) => format!("{}, {}", field.meaning, fields::PLATE.allowed(field)),
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

fn turning_width_of(plate: &Given<'_>) -> Result<TurningWidth, PlateError> {
    let word = plate.word("turning_width")?;
    let chosen = TurningWidth::ALL.into_iter().find(|width| word == Some(width.word()));
    Ok(chosen.unwrap_or_default())
}

fn taper_of(given: &Given<'_>) -> Result<Taper, PlateError> {
    Ok(match given.kind {
        "exponential" => Taper::Exponential {
            half_width_m: given.required("half_width_m")?,
            rate_per_m: given.required("rate_per_m")?,
        },
        "linear" => Taper::Linear {
            half_width_m: given.required("half_width_m")?,
            end_half_width_m: given.required("end_half_width_m")?,
        },
        _ => Taper::Sampled { points: given.points("points")? },
    })
}

fn thickness_of(given: &Given<'_>) -> Result<Thickness, PlateError> {
    Ok(match given.kind {
        "exponential" => Thickness::Exponential { rate_per_m: given.required("rate_per_m")? },
        "linear" => Thickness::Linear { end_thickness_m: given.required("end_thickness_m")? },
        _ => Thickness::Sampled { points: given.points("points")? },
    })
}

fn model_of(given: &Given<'_>) -> Result<Model, PlateError> {
    let bending = || {
        Ok(Bending {
            youngs_modulus_pa: given.required("youngs_modulus_pa")?,
            poisson_ratio: given.required("poisson_ratio")?,
            density_kg_per_m3: given.required("density_kg_per_m3")?,
            thickness_m: given.required("thickness_m")?,
            thick_plate: given.flag("thick_plate")?,
        })
    };
    Ok(match given.kind {
        "membrane" => Model::Membrane {
            wave_speed_m_per_s: given.required("wave_speed_m_per_s")?,
            tension_n_per_m: given.number("tension_n_per_m")?,
            film: film_of(given)?,
        },
        "shear-horizontal" => Model::ShearHorizontal {
            shear_modulus_pa: given.required("shear_modulus_pa")?,
            density_kg_per_m3: given.required("density_kg_per_m3")?,
            thickness_m: given.number("thickness_m")?,
        },
        "bending-supported" => Model::BendingSupported(bending()?),
        _ => Model::BendingClamped(bending()?),
    })
}

/// Three fields that belong together: `None` without any of them. Where one is given, the message names those that are missing.
fn together(given: &Given<'_>, [a, b, c]: [&'static str; 3]) -> Result<Option<[f64; 3]>, PlateError> {
    if ![a, b, c].iter().any(|field| given.has(field)) {
        return Ok(None);
    }
    Ok(Some([given.required(a)?, given.required(b)?, given.required(c)?]))
}

fn film_of(given: &Given<'_>) -> Result<Option<Film>, PlateError> {
    let fields = together(given, ["youngs_modulus_pa", "poisson_ratio", "thickness_m"])?;
    Ok(fields.map(|[youngs_modulus_pa, poisson_ratio, thickness_m]| Film {
        youngs_modulus_pa,
        poisson_ratio,
        thickness_m,
    }))
}

fn drive_of(given: &Given<'_>, model: &Model, lead_in: Option<LeadIn>) -> Result<DriveEnd, PlateError> {
    if lead_in.is_some() && given.kind != "source" {
        return Err(PlateError::Unexpected {
            field: "drive.lead_in".to_owned(),
            reason: format!(
                "it acts behind a force that leaves the end soft, a \"source\"; \"{}\" hides it",
                given.kind
            ),
        });
    }
    let slope = given.word("slope")?.map(|word| if word == "held" { EndSlope::Held } else { EndSlope::Free });
    Ok(match given.kind {
        "displacement" => {
            slope.map_or(DriveEnd::Displacement, |slope| DriveEnd::DisplacementAndSlope { slope })
        }
        "force" => DriveEnd::Force { at_frequency_hz: given.required("at_frequency_hz")? },
        "source" => DriveEnd::Source(Source {
            impedance: Impedance {
                resistance_n_s_per_m: given.number("resistance_n_s_per_m")?.unwrap_or(0.0),
                mass_kg: given.number("mass_kg")?.unwrap_or(0.0),
                stiffness_n_per_m: given.number("stiffness_n_per_m")?.unwrap_or(0.0),
            },
            at_frequency_hz: given.required("at_frequency_hz")?,
            slope: slope.or(model.bending().map(|_| EndSlope::Free)),
            lead_in,
        }),
        _ => DriveEnd::Resistance {
            ratio: given.required("ratio")?,
            at_frequency_hz: given.required("at_frequency_hz")?,
        },
    })
}

fn lead_in_of(given: &Given<'_>) -> Result<LeadIn, PlateError> {
    Ok(LeadIn {
        length_m: given.required("length_m")?,
        loss_factor: given.required("loss_factor")?,
        end_resistance_n_s_per_m: given.number("end_resistance_n_s_per_m")?.unwrap_or(0.0),
    })
}

fn air_of(given: &Given<'_>) -> Result<Air, PlateError> {
    let mounting = match given.kind {
        "baffle" => AirMounting::Baffle { faces: faces_of(given)? },
        "bare-frame" => AirMounting::BareFrame,
        "unknown" => AirMounting::Unknown,
        "coefficient" => {
            AirMounting::Coefficient { alpha: given.required("coefficient")?, faces: faces_of(given)? }
        }
        "calibrated" => AirMounting::Calibrated {
            alpha: given.required("coefficient")?,
            faces: faces_of(given)?,
            distant: given.required("distant_share")?,
        },
        _ => return Ok(Air::Vacuum),
    };
    let numbers = ["density_kg_per_m3", "sound_speed_m_per_s"].iter().any(|name| given.has(name));
    if let Some(name) = ["temperature_c", "height_m"].into_iter().find(|name| numbers && given.has(name)) {
        return Err(PlateError::Unexpected {
            field: format!("air.{name}"),
            reason: "the air is given by density_kg_per_m3 and sound_speed_m_per_s already".to_owned(),
        });
    }
    let gas = if numbers {
        Gas::Given {
            density_kg_per_m3: given.required("density_kg_per_m3")?,
            sound_speed_m_per_s: given.required("sound_speed_m_per_s")?,
        }
    } else {
        Gas::Atmosphere {
            temperature_c: given.number("temperature_c")?.unwrap_or(20.0),
            height_m: given.number("height_m")?.unwrap_or(0.0),
        }
    };
    Ok(Air::Around { gas, mounting })
}

fn faces_of(given: &Given<'_>) -> Result<Faces, PlateError> {
    match given.number("faces")? {
        None => Ok(Faces::default()),
        Some(1.0) => Ok(Faces::One),
        Some(2.0) => Ok(Faces::Two),
        Some(count) => Err(PlateError::UnknownKind {
            field: "air.faces".to_owned(),
            value: typed(count),
            allowed: "1 or 2".to_owned(),
        }),
    }
}

fn actuator_of(given: &Given<'_>) -> Result<Actuator, PlateError> {
    const RESONATOR: [&str; 4] = ["resonance_hz", "quality", "peak_travel_m", "static_travel_m"];
    if given.has("points") {
        if let Some(name) = RESONATOR.into_iter().find(|name| given.has(name)) {
            return Err(PlateError::Unexpected {
                field: format!("actuator.{name}"),
                reason: "the response is given by points already; a peak travel needs a resonance".to_owned(),
            });
        }
        return Ok(Actuator::Measured(ResponseCurve { points: given.points("points")? }));
    }
    let has_travel = given.has("peak_travel_m") || given.has("static_travel_m");
    Ok(Actuator::Resonator(Resonator {
        resonance_hz: given.required("resonance_hz")?,
        quality: given.required("quality")?,
        travel: has_travel.then(|| travel_of(given)).transpose()?,
    }))
}

fn calibration_of(given: &Given<'_>) -> Result<Calibration, PlateError> {
    let correction = given.has("points").then(|| given.points("points")).transpose()?;
    Ok(Calibration {
        chi2_per_n: given.required("chi2_per_n")?,
        half_width_tolerance: given.required("half_width_tolerance")?,
        taper_tolerance: given.required("taper_tolerance")?,
        level_tolerance_db: given.number("level_tolerance_db")?,
        source_tolerance: source_tolerance_of(given)?,
        correction: correction.map(|points| ResponseCurve { points }),
    })
}

fn source_tolerance_of(given: &Given<'_>) -> Result<Option<Impedance>, PlateError> {
    let fields = together(given, SOURCE_TOLERANCE)?;
    Ok(fields.map(|[resistance_n_s_per_m, mass_kg, stiffness_n_per_m]| Impedance {
        resistance_n_s_per_m,
        mass_kg,
        stiffness_n_per_m,
    }))
}

/// Half a limit is none: where one of two fields is given, the message names the other.
fn travel_of(given: &Given<'_>) -> Result<Travel, PlateError> {
    Ok(Travel { peak_m: given.required("peak_travel_m")?, static_m: given.required("static_travel_m")? })
}
