//! Errors of a plate, as the panels show them: fields by their captions, numbers in the panels' units and format.
//! The sentences come from the plate library: [`slipline_plate::PlateError::told`].

use crate::caption::{Panel, Unit};
use slipline_plate::Notation;
use slipline_plate::number_format::significant;
use slipline_plate::quantity::Range;

/// Significant digits: as many as the library's ranges have.
const DIGITS: usize = 5;

/// The points of a sampled taper exist only in its file: no panel has a field for them.
fn is_point(field: &str) -> bool {
    field.starts_with("taper.points")
}

fn unit_of(panel: Panel, field: &str) -> Unit {
    let otherwise = if is_point(field) { Unit::Millimetre } else { Unit::Pure };
    panel.caption(field).map_or(otherwise, |caption| caption.unit)
}

impl Notation for Panel {
    fn field(&self, field: &str) -> String {
        match self.caption(field) {
            Some(caption) => caption.name.to_owned(),
            None if is_point(field) => "The file's half-widths".to_owned(),
            None => field.to_owned(),
        }
    }

    fn given(&self, field: &str, value: f64) -> String {
        let name = self.field(field);
        if is_point(field) { name } else { format!("{name} {}", written(value, unit_of(*self, field))) }
    }

    fn range(&self, field: &str, range: Range) -> String {
        let range = range.rounded();
        // Both ends of a range get the same unit.
        let largest = if range.high.is_finite() { range.high } else { range.low };
        let (unit, size) = unit_of(*self, field).shown(largest);
        format!("{} {unit}", range.in_words(|end| significant(end / size, DIGITS))).trim_end().to_owned()
    }

    fn length(&self, metres: f64) -> String {
        written(metres, Unit::Millimetre)
    }

    fn frequency(&self, hertz: f64) -> String {
        written(hertz, Unit::Hertz)
    }
}

/// A value of the library, written with the panel's unit.
fn written(value: f64, unit: Unit) -> String {
    if value.is_finite() { unit.written(value, DIGITS) } else { "no number".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::design::{Request, design};
    use slipline_plate::{Plate, PlateSpec, Taper};

    fn fault(preset: &str, change: impl FnOnce(&mut PlateSpec)) -> String {
        let mut spec = slipline_plate::preset(preset).unwrap().spec().clone();
        change(&mut spec);
        Plate::new(spec).unwrap_err().told(&Panel::Plate)
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
                        let text = error.told(&Panel::Plate);
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
        request.length_m = 0.01;
        let designer = |request: &Request| design(request).unwrap_err().told(&Panel::Designer);
        assert_eq!(
            designer(&request),
            "Length 10 mm: must be longer: the peak of 20 kHz and the tail of 40 kHz alone take 13.1 mm of it; or raise \
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
