//! Writes a plate as TOML text.

use crate::definition::actuator::Actuator;
use crate::definition::air::{Air, AirMounting, Faces, Gas};
use crate::definition::calibration::Calibration;
use crate::definition::drive::DriveEnd;
use crate::definition::model::{Bending, Model};
use crate::definition::plate::Plate;
use crate::definition::source::{EndSlope, Source};
use crate::definition::taper::Taper;
use crate::definition::thickness::Thickness;
use serde::Serialize;

#[derive(Serialize)]
struct PlateText {
    name: String,
    description: String,
    length_m: f64,
    loss_factor: f64,
    wave_speed_tolerance: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    loss_tolerance: Option<f64>,
    turning_width: &'static str,
    full_scale_m: f64,
    span_start_m: f64,
    span_end_m: f64,
    taper: TaperText,
    model: ModelText,
    #[serde(skip_serializing_if = "Option::is_none")]
    thickness: Option<ThicknessText>,
    drive: DriveText,
    #[serde(skip_serializing_if = "Option::is_none")]
    air: Option<AirText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    actuator: Option<ActuatorText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    calibration: Option<CalibrationText>,
}

#[derive(Serialize, Default)]
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

#[derive(Serialize, Default)]
struct ModelText {
    kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    wave_speed_m_per_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tension_n_per_m: Option<f64>,
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

#[derive(Serialize, Default)]
struct ThicknessText {
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    rate_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    end_thickness_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<[f64; 2]>>,
}

#[derive(Serialize, Default)]
struct DriveText {
    end: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    ratio: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    at_frequency_hz: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    resistance_n_s_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mass_kg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stiffness_n_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    slope: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lead_in: Option<LeadInText>,
}

#[derive(Serialize)]
struct LeadInText {
    length_m: f64,
    loss_factor: f64,
    end_resistance_n_s_per_m: f64,
}

#[derive(Serialize, Default)]
struct AirText {
    mounting: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    coefficient: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    distant_share: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    faces: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    density_kg_per_m3: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sound_speed_m_per_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    temperature_c: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    height_m: Option<f64>,
}

#[derive(Serialize, Default)]
struct ActuatorText {
    #[serde(skip_serializing_if = "Option::is_none")]
    resonance_hz: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    quality: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    peak_travel_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    static_travel_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<[f64; 3]>>,
}

#[derive(Serialize)]
struct CalibrationText {
    chi2_per_n: f64,
    half_width_tolerance: f64,
    taper_tolerance: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    level_tolerance_db: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    resistance_tolerance_n_s_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mass_tolerance_kg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stiffness_tolerance_n_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<[f64; 3]>>,
}

impl Plate {
    /// The plate as TOML text that [`Plate::from_toml`] reads back to the same plate.
    pub fn to_toml(&self) -> String {
        let spec = self.spec();
        let text = PlateText {
            name: spec.name.clone(),
            description: spec.description.clone(),
            length_m: spec.length_m,
            loss_factor: spec.loss_factor,
            wave_speed_tolerance: spec.wave_speed_tolerance,
            loss_tolerance: spec.loss_tolerance,
            turning_width: spec.turning_width.word(),
            full_scale_m: spec.full_scale_m,
            span_start_m: spec.span_start_m,
            span_end_m: spec.span_end_m,
            taper: taper_text(&spec.taper),
            model: model_text(&spec.model),
            thickness: spec.thickness.as_ref().map(thickness_text),
            drive: drive_text(spec.drive_end),
            air: spec.air.map(air_text),
            actuator: spec.actuator.as_ref().map(actuator_text),
            calibration: spec.calibration.as_ref().map(calibration_text),
        };
        // `PlateText` holds only strings, numbers and lists of numbers, which TOML can always represent.
        toml::to_string(&text).unwrap_or_default()
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

fn thickness_text(thickness: &Thickness) -> ThicknessText {
    match thickness {
        Thickness::Exponential { rate_per_m } => {
            ThicknessText { kind: "exponential", rate_per_m: Some(*rate_per_m), ..ThicknessText::default() }
        }
        Thickness::Linear { end_thickness_m } => ThicknessText {
            kind: "linear",
            end_thickness_m: Some(*end_thickness_m),
            ..ThicknessText::default()
        },
        Thickness::Sampled { points } => {
            ThicknessText { kind: "sampled", points: Some(points.clone()), ..ThicknessText::default() }
        }
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
        Model::Membrane { wave_speed_m_per_s, tension_n_per_m, film } => ModelText {
            kind: "membrane".to_owned(),
            wave_speed_m_per_s: Some(*wave_speed_m_per_s),
            tension_n_per_m: *tension_n_per_m,
            youngs_modulus_pa: film.map(|film| film.youngs_modulus_pa),
            poisson_ratio: film.map(|film| film.poisson_ratio),
            thickness_m: film.map(|film| film.thickness_m),
            ..ModelText::default()
        },
        Model::ShearHorizontal { shear_modulus_pa, density_kg_per_m3, thickness_m } => ModelText {
            kind: "shear-horizontal".to_owned(),
            shear_modulus_pa: Some(*shear_modulus_pa),
            density_kg_per_m3: Some(*density_kg_per_m3),
            thickness_m: *thickness_m,
            ..ModelText::default()
        },
        Model::BendingSupported(bending) => bending_text("bending-supported", bending),
        Model::BendingClamped(bending) => bending_text("bending-clamped", bending),
    }
}

fn drive_text(end: DriveEnd) -> DriveText {
    let named = |end: &str| DriveText { end: end.to_owned(), ..DriveText::default() };
    let word = |slope: EndSlope| match slope {
        EndSlope::Free => "free",
        EndSlope::Held => "held",
    };
    match end {
        DriveEnd::Displacement => named("displacement"),
        DriveEnd::DisplacementAndSlope { slope } => {
            DriveText { slope: Some(word(slope)), ..named("displacement") }
        }
        DriveEnd::Force { at_frequency_hz } => {
            DriveText { at_frequency_hz: Some(at_frequency_hz), ..named("force") }
        }
        DriveEnd::Resistance { ratio, at_frequency_hz } => {
            DriveText { ratio: Some(ratio), at_frequency_hz: Some(at_frequency_hz), ..named("resistance") }
        }
        DriveEnd::Source(source) => source_text(source, source.slope.map(word), named("source")),
    }
}

fn source_text(source: Source, slope: Option<&'static str>, text: DriveText) -> DriveText {
    DriveText {
        at_frequency_hz: Some(source.at_frequency_hz),
        resistance_n_s_per_m: Some(source.impedance.resistance_n_s_per_m),
        mass_kg: Some(source.impedance.mass_kg),
        stiffness_n_per_m: Some(source.impedance.stiffness_n_per_m),
        slope,
        lead_in: source.lead_in.map(|lead_in| LeadInText {
            length_m: lead_in.length_m,
            loss_factor: lead_in.loss_factor,
            end_resistance_n_s_per_m: lead_in.end_resistance_n_s_per_m,
        }),
        ..text
    }
}

fn air_text(air: Air) -> AirText {
    let Air::Around { gas, mounting } = air else {
        return AirText { mounting: "vacuum", ..AirText::default() };
    };
    let number = |faces: Faces| {
        Some(match faces {
            Faces::One => 1,
            Faces::Two => 2,
        })
    };
    let (mounting, coefficient, faces) = match mounting {
        AirMounting::Baffle { faces } => ("baffle", None, number(faces)),
        AirMounting::BareFrame => ("bare-frame", None, None),
        AirMounting::Unknown => ("unknown", None, None),
        AirMounting::Coefficient { alpha, faces } => ("coefficient", Some(alpha), number(faces)),
        AirMounting::Calibrated { alpha, faces, .. } => ("calibrated", Some(alpha), number(faces)),
    };
    let distant_share = match air {
        Air::Around { mounting: AirMounting::Calibrated { distant, .. }, .. } => Some(distant),
        Air::Around { .. } | Air::Vacuum => None,
    };
    let text = AirText { mounting, coefficient, distant_share, faces, ..AirText::default() };
    match gas {
        Gas::Given { density_kg_per_m3, sound_speed_m_per_s } => AirText {
            density_kg_per_m3: Some(density_kg_per_m3),
            sound_speed_m_per_s: Some(sound_speed_m_per_s),
            ..text
        },
        Gas::Atmosphere { temperature_c, height_m } => {
            AirText { temperature_c: Some(temperature_c), height_m: Some(height_m), ..text }
        }
    }
}

fn calibration_text(calibration: &Calibration) -> CalibrationText {
    let source = calibration.source_tolerance.as_ref();
    CalibrationText {
        chi2_per_n: calibration.chi2_per_n,
        half_width_tolerance: calibration.half_width_tolerance,
        taper_tolerance: calibration.taper_tolerance,
        level_tolerance_db: calibration.level_tolerance_db,
        resistance_tolerance_n_s_per_m: source.map(|half| half.resistance_n_s_per_m),
        mass_tolerance_kg: source.map(|half| half.mass_kg),
        stiffness_tolerance_n_per_m: source.map(|half| half.stiffness_n_per_m),
        points: calibration.correction.as_ref().map(|curve| curve.points.clone()),
    }
}

fn actuator_text(actuator: &Actuator) -> ActuatorText {
    match actuator {
        Actuator::Resonator(resonator) => ActuatorText {
            resonance_hz: Some(resonator.resonance_hz),
            quality: Some(resonator.quality),
            peak_travel_m: resonator.travel.map(|travel| travel.peak_m),
            static_travel_m: resonator.travel.map(|travel| travel.static_m),
            points: None,
        },
        Actuator::Measured(curve) => {
            ActuatorText { points: Some(curve.points.clone()), ..ActuatorText::default() }
        }
    }
}
