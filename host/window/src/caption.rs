//! The captions of the panels, for their fields and for messages about them: those of a plate's fields
//! ([`slipline_plate::fields`]), and those that the designer has beside them. [`slipline_plate::quantity`] writes, reads and
//! checks their numbers.

use slipline_plate::fields;
use slipline_plate::quantity::{Caption, Form, Unit};

/// The panel whose captions are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// The numbers of the plate on the screen.
    Plate,
    /// The designer.
    Designer,
}

/// The designer's own captions, each with the library's names of its field.
const DESIGNER: [(&str, Unit, &[&str]); 7] = [
    ("Full scale", Unit::Millimetre, &["full_scale_m"]),
    ("Band from", Unit::Hertz, &["band low"]),
    ("Band to", Unit::Hertz, &["band high"]),
    ("Start margin", Unit::Millimetre, &["start_margin_m", "span_start_m"]),
    ("End margin", Unit::Millimetre, &["end_margin_m", "span_end_m"]),
    ("Rim", Unit::Millimetre, &["rim_m"]),
    ("Name", Unit::Pure, &["name"]),
];

/// The fields of a design that become a field of its plate.
const OF_THE_PLATE: [(&str, &str); 5] = [
    ("thickness_m", "model.thickness_m"),
    ("material.youngs_modulus_pa", "model.youngs_modulus_pa"),
    ("material.poisson_ratio", "model.poisson_ratio"),
    ("material.density_kg_per_m3", "model.density_kg_per_m3"),
    ("material.loss_factor", "loss_factor"),
];

impl Form for Panel {
    /// A field that the designer does not have gets the caption of the plate panel, which shows the chosen value.
    fn caption(&self, field: &str) -> Option<Caption> {
        let own = DESIGNER.iter().find(|(.., keys)| *self == Self::Designer && keys.contains(&field));
        if let Some(&(name, unit, _)) = own {
            return Some(Caption { name, unit });
        }
        let known = OF_THE_PLATE.iter().find(|(design, _)| *design == field);
        fields::field(known.map_or(field, |(_, plate)| plate))?.caption
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::Progress;
    use slipline_plate::design::{DesignError, Request, design};
    use slipline_plate::quantity::Notation as _;
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
            "Span to 278 mm: must be a place where the boundary needs at most 10000 kHz (here 213250 kHz)"
        );
        let mut request = slipline_model::jobs::design::Draft::default().request().unwrap();
        (request.length_m, request.air) = (0.01, None);
        let designer = |request: &Request| match design(request, &mut Progress::unwatched()) {
            Err(DesignError::Plate(error)) => error.worded(&Panel::Designer),
            designed => panic!("{designed:?}"),
        };
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
