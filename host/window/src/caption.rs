//! The captions and units of a plate's fields in the panels, for the fields and for messages about them.
//! [`slipline_plate::quantity`] writes, reads and checks their numbers.

use slipline_plate::quantity::{Caption, Form, Unit};

/// Length of the plate.
pub const LENGTH: Caption = Caption::new("Length", Unit::Millimetre, &["length_m"]);
/// Half-width at the driven end.
pub const HALF_WIDTH: Caption = Caption::new("Half-width", Unit::Millimetre, &["taper.half_width_m"]);
/// Rate of an exponential taper.
pub const TAPER_RATE: Caption = Caption::new("Taper rate", Unit::Times("1/m", 1.0), &["taper.rate_per_m"]);
/// Half-width at the end of a linear taper.
pub const END_HALF_WIDTH: Caption =
    Caption::new("End half-width", Unit::Millimetre, &["taper.end_half_width_m"]);
/// Nearest boundary.
pub const SPAN_START: Caption = Caption::new("Span from", Unit::Millimetre, &["span_start_m"]);
/// Farthest boundary.
pub const SPAN_END: Caption = Caption::new("Span to", Unit::Millimetre, &["span_end_m"]);
/// Wave speed of a membrane.
pub const WAVE_SPEED: Caption =
    Caption::new("Wave speed", Unit::Times("m/s", 1.0), &["model.wave_speed_m_per_s"]);
/// Tension of a membrane, per metre of width.
pub const TENSION: Caption = Caption::new("Tension", Unit::Times("N/m", 1.0), &["model.tension_n_per_m"]);
/// Shear modulus.
pub const SHEAR_MODULUS: Caption =
    Caption::new("Shear modulus", Unit::Times("MPa", 1e6), &["model.shear_modulus_pa"]);
/// Young's modulus.
pub const YOUNGS_MODULUS: Caption = Caption::new(
    "Young's modulus",
    Unit::Times("GPa", 1e9),
    &["model.youngs_modulus_pa", "material.youngs_modulus_pa"],
);
/// Poisson's ratio.
pub const POISSON_RATIO: Caption =
    Caption::new("Poisson's ratio", Unit::Pure, &["model.poisson_ratio", "material.poisson_ratio"]);
/// Density.
pub const DENSITY: Caption = Caption::new(
    "Density",
    Unit::Times("kg/m³", 1.0),
    &["model.density_kg_per_m3", "material.density_kg_per_m3"],
);
/// Thickness of the sheet.
pub const THICKNESS: Caption =
    Caption::new("Thickness", Unit::Millimetre, &["thickness_m", "model.thickness_m"]);
/// Loss factor.
pub const LOSS_FACTOR: Caption =
    Caption::new("Loss factor", Unit::Pure, &["loss_factor", "material.loss_factor"]);
/// r of a damped source.
pub const DRIVE_RATIO: Caption = Caption::new("Resistance ratio", Unit::Pure, &["drive.ratio"]);
/// The frequency at which r holds; no panel has a field for it.
pub const DRIVE_FREQUENCY: Caption =
    Caption::new("Frequency of the resistance", Unit::Hertz, &["drive.at_frequency_hz"]);
/// Resistance of a driven end.
pub const END_RESISTANCE: Caption =
    Caption::new("End resistance", Unit::Times("N s/m", 1.0), &["drive.resistance_n_s_per_m"]);
/// Mass that moves with a driven end.
pub const MOVING_MASS: Caption = Caption::new("Moving mass", Unit::Times("g", 1e-3), &["drive.mass_kg"]);
/// Stiffness of a driven end against the frame.
pub const END_STIFFNESS: Caption =
    Caption::new("End stiffness", Unit::Times("N/m", 1.0), &["drive.stiffness_n_per_m"]);
/// Length of the lead-in.
pub const LEAD_IN_LENGTH: Caption =
    Caption::new("Lead-in length", Unit::Millimetre, &["drive.lead_in.length_m"]);
/// Loss factor of the lead-in.
pub const LEAD_IN_LOSS: Caption =
    Caption::new("Lead-in loss factor", Unit::Pure, &["drive.lead_in.loss_factor"]);
/// Damper at the far end of the lead-in.
pub const LEAD_IN_DAMPER: Caption =
    Caption::new("Lead-in damper", Unit::Times("N s/m", 1.0), &["drive.lead_in.end_resistance_n_s_per_m"]);
/// Displacement of the drive at DAC full scale, of the plate on the screen.
pub const AT_FULL_SCALE: Caption = Caption::new("At full scale", Unit::Millimetre, &["full_scale_m"]);
/// Resonance of the actuator.
pub const RESONANCE: Caption = Caption::new("Resonance", Unit::Hertz, &["actuator.resonance_hz"]);
/// Quality factor of the actuator's resonance.
pub const QUALITY: Caption = Caption::new("Quality", Unit::Pure, &["actuator.quality"]);
/// How far the actuator may move.
pub const PEAK_TRAVEL: Caption = Caption::new("Peak travel", Unit::Millimetre, &["actuator.peak_travel_m"]);
/// How far a steady signal at full scale would move it.
pub const STATIC_TRAVEL: Caption =
    Caption::new("Travel at full scale", Unit::Millimetre, &["actuator.static_travel_m"]);
/// Coefficient of the air's mass on each face.
pub const AIR_COEFFICIENT: Caption = Caption::new("Air coefficient", Unit::Pure, &["air.coefficient"]);
/// Share of the air's pressure at a distance.
pub const DISTANT_SHARE: Caption = Caption::new("Distant share", Unit::Pure, &["air.distant_share"]);
/// Density of the air.
pub const AIR_DENSITY: Caption =
    Caption::new("Air density", Unit::Times("kg/m³", 1.0), &["air.density_kg_per_m3"]);
/// Speed of sound.
pub const SOUND_SPEED: Caption =
    Caption::new("Speed of sound", Unit::Times("m/s", 1.0), &["air.sound_speed_m_per_s"]);
/// Temperature of the air.
pub const AIR_TEMPERATURE: Caption =
    Caption::new("Temperature", Unit::Times("°C", 1.0), &["air.temperature_c"]);
/// Height above the sea.
pub const AIR_HEIGHT: Caption = Caption::new("Height above sea", Unit::Times("m", 1.0), &["air.height_m"]);
/// Displacement of the drive at DAC full scale, of a design.
pub const FULL_SCALE: Caption = Caption::new("Full scale", Unit::Millimetre, &["full_scale_m"]);
/// Lowest frequency of a design.
pub const BAND_LOW: Caption = Caption::new("Band from", Unit::Hertz, &["band low"]);
/// Highest frequency of a design.
pub const BAND_HIGH: Caption = Caption::new("Band to", Unit::Hertz, &["band high"]);
/// From the driven end to a design's nearest boundary.
pub const START_MARGIN: Caption =
    Caption::new("Start margin", Unit::Millimetre, &["start_margin_m", "span_start_m"]);
/// From a design's farthest boundary to the narrow end.
pub const END_MARGIN: Caption = Caption::new("End margin", Unit::Millimetre, &["end_margin_m", "span_end_m"]);
/// Width of the frame's rim.
pub const RIM: Caption = Caption::new("Rim", Unit::Millimetre, &["rim_m"]);
/// Name of a design.
pub const NAME: Caption = Caption::new("Name", Unit::Pure, &["name"]);

/// The points of a sampled taper. They exist only in its file: no panel has a field for them.
const TAPER_POINTS: Caption = Caption::new("The file's half-widths", Unit::Millimetre, &["taper.points"]);

/// The panel whose captions are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// The numbers of the plate on the screen.
    Plate,
    /// The designer.
    Designer,
}

const PLATE: [&Caption; 34] = [
    &LENGTH,
    &HALF_WIDTH,
    &TAPER_RATE,
    &END_HALF_WIDTH,
    &SPAN_START,
    &SPAN_END,
    &WAVE_SPEED,
    &TENSION,
    &SHEAR_MODULUS,
    &YOUNGS_MODULUS,
    &POISSON_RATIO,
    &DENSITY,
    &THICKNESS,
    &LOSS_FACTOR,
    &DRIVE_RATIO,
    &DRIVE_FREQUENCY,
    &END_RESISTANCE,
    &MOVING_MASS,
    &END_STIFFNESS,
    &LEAD_IN_LENGTH,
    &LEAD_IN_LOSS,
    &LEAD_IN_DAMPER,
    &AT_FULL_SCALE,
    &RESONANCE,
    &QUALITY,
    &PEAK_TRAVEL,
    &STATIC_TRAVEL,
    &AIR_COEFFICIENT,
    &DISTANT_SHARE,
    &AIR_DENSITY,
    &SOUND_SPEED,
    &AIR_TEMPERATURE,
    &AIR_HEIGHT,
    &TAPER_POINTS,
];

const DESIGNER: [&Caption; 7] = [&FULL_SCALE, &BAND_LOW, &BAND_HIGH, &START_MARGIN, &END_MARGIN, &RIM, &NAME];

impl Form for Panel {
    /// A field that the designer does not have gets the caption of the plate panel, which shows the chosen value.
    fn caption(&self, field: &str) -> Option<&Caption> {
        let own = if *self == Self::Designer { &DESIGNER[..] } else { &[] };
        own.iter().chain(&PLATE).find(|caption| caption.is_of(field)).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::Notation as _;
    use slipline_plate::design::{Request, design};
    use slipline_plate::{Plate, PlateSpec, Taper};

    fn fault(preset: &str, change: impl FnOnce(&mut PlateSpec)) -> String {
        let mut spec = slipline_plate::preset(preset).unwrap().spec().clone();
        change(&mut spec);
        Plate::new(spec).unwrap_err().worded(&Panel::Plate)
    }

    #[test]
    fn a_fault_names_the_label_and_the_panels_units() {
        let half_width = |value| {
            move |spec: &mut PlateSpec| {
                if let Taper::Exponential { half_width_m, .. } = &mut spec.taper {
                    *half_width_m = value;
                }
            }
        };
        assert_eq!(fault("membrane", |spec| spec.length_m = 11.0), "Length 11000 mm: must be 5 to 10000 mm");
        assert_eq!(fault("membrane", |spec| spec.loss_factor = 0.7), "Loss factor 0.7: must be 0 to 0.5");
        assert!(fault("membrane", half_width(9e9)).starts_with("Half-width 9.000e12 mm: must be "));
        assert!(
            fault("membrane", |spec| spec.span_end_m = 1.0)
                .starts_with("Span to 1000 mm: must be 80.32 to 320 mm")
        );
        let modulus = fault("al-bending", |spec| {
            if let slipline_plate::Model::BendingSupported(bending) = &mut spec.model {
                bending.youngs_modulus_pa = 2e13;
            }
        });
        assert_eq!(modulus, "Young's modulus 20000 GPa: must be 0.000001 to 10000 GPa");
    }

    #[test]
    fn no_fault_of_a_plate_shows_a_name_of_the_file_or_a_bare_metre() {
        for preset in slipline_plate::presets() {
            for factor in [1e-9, 1e-3, 0.1, 3.0, 1e4, 1e300, f64::NAN] {
                let changes: [fn(&mut PlateSpec, f64); 6] = [
                    |spec, f| spec.length_m *= f,
                    |spec, f| spec.full_scale_m *= f,
                    |spec, f| spec.span_start_m *= f,
                    |spec, f| spec.span_end_m *= f,
                    |spec, f| {
                        if let Taper::Exponential { rate_per_m, .. } = &mut spec.taper {
                            *rate_per_m *= f;
                        }
                    },
                    |spec, f| {
                        if let Taper::Exponential { half_width_m, .. } = &mut spec.taper {
                            *half_width_m *= f;
                        }
                    },
                ];
                for change in changes {
                    let mut spec = slipline_plate::preset(preset.name).unwrap().spec().clone();
                    change(&mut spec, factor);
                    if let Err(error) = Plate::new(spec) {
                        let text = error.worded(&Panel::Plate);
                        assert!(
                            !text.contains('_') && !text.contains(" m ") && !text.ends_with(" m"),
                            "{text}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn every_sentence_has_its_numbers_in_the_panels_units() {
        let narrow = |spec: &mut PlateSpec| {
            spec.taper = Taper::Exponential { half_width_m: 0.05, rate_per_m: 100.0 };
        };
        assert_eq!(
            fault("membrane", narrow),
            "Taper rate 100 1/m: must be at most 26.616 1/m, or the half-width at the end (6.332e-13 mm) falls below \
             0.01 mm"
        );
        let short = Taper::Sampled { points: vec![[0.0, 0.05], [0.2, 0.01]] };
        assert_eq!(
            fault("membrane", |spec| spec.taper = short),
            "The file's half-widths: must be at least 320 mm: the points must cover the plate (Length 320 mm)"
        );
        let slow = |spec: &mut PlateSpec| {
            spec.taper = Taper::Exponential { half_width_m: 1e-4, rate_per_m: 1.0 };
        };
        assert_eq!(
            fault("al-bending", slow),
            "Span to 278 mm: must be where the boundary needs at most 10000 kHz (here 213250 kHz)"
        );
        let mut request = slipline_model::jobs::design::Draft::default().request().unwrap();
        (request.length_m, request.air) = (0.01, None);
        let designer = |request: &Request| design(request).unwrap_err().worded(&Panel::Designer);
        assert_eq!(
            designer(&request),
            "Length 10 mm: must be longer: the peak of 20 kHz and the tail of 40 kHz alone take 25.4 mm of it; or raise \
             the band, or set smaller margins"
        );
        (request.length_m, request.band_hz) = (0.3, (400.0, 400.0));
        assert_eq!(
            designer(&request),
            "Band to 400 Hz: must be 0.42 to 10000 kHz, at least 5 % above Band from 400 Hz"
        );
    }

    #[test]
    fn a_panel_names_a_field_by_its_own_caption() {
        for (field, plate, designer) in [
            ("full_scale_m", "At full scale", "Full scale"),
            ("span_end_m", "Span to", "End margin"),
            ("model.thickness_m", "Thickness", "Thickness"),
            ("taper.points[3][1]", "The file's half-widths", "The file's half-widths"),
        ] {
            assert_eq!([Panel::Plate, Panel::Designer].map(|panel| panel.field(field)), [plate, designer]);
        }
    }
}
