//! Captions and units of a plate's fields in the panels, used for the fields and for messages about them.

use slipline_model::numbers::quantity::{self, QuantityError};
use slipline_plate::number_format::significant;

/// Significant digits of a number in a field: more than anyone measures, but few enough to hide rounding from a
/// change of units.
pub const FIELD_DIGITS: usize = 7;

/// One field of a panel.
#[derive(Debug)]
pub struct Caption {
    /// Its caption.
    pub name: &'static str,
    /// The plate library's names of this field.
    pub keys: &'static [&'static str],
    /// The unit of its number.
    pub unit: Unit,
}

/// The unit of a panel's field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unit {
    /// Millimetres.
    Millimetre,
    /// Hertz, or kilohertz from 1 kHz on.
    Hertz,
    /// A unit of this name that is so many times the library's unit.
    Times(&'static str, f64),
    /// None.
    Pure,
}

impl Unit {
    /// The unit's name for a number of this size, and its size in the library's unit.
    #[must_use]
    pub fn shown(self, value: f64) -> (&'static str, f64) {
        match self {
            Self::Millimetre => ("mm", 1e-3),
            Self::Hertz if value.abs() >= 1e3 => ("kHz", 1e3),
            Self::Hertz => ("Hz", 1.0),
            Self::Times(name, size) => (name, size),
            Self::Pure => ("", 1.0),
        }
    }

    /// A number in the library's unit as text for the field, with this many significant digits.
    #[must_use]
    pub fn written(self, value: f64, digits: usize) -> String {
        let (name, size) = self.shown(value);
        format!("{} {name}", significant(value / size, digits)).trim_end().to_owned()
    }

    /// Parses a number that was typed into the field; the result is in the library's unit.
    ///
    /// # Errors
    /// [`QuantityError`] for a text that is not a number, or has a unit that does not fit.
    pub fn read(self, text: &str) -> Result<f64, QuantityError> {
        match self {
            Self::Millimetre => quantity::length_m(text),
            Self::Hertz => quantity::frequency_hz(text),
            Self::Times(name, size) => quantity::plain(text, name).map(|number| number * size),
            Self::Pure => quantity::plain(text, ""),
        }
    }
}

const fn caption(name: &'static str, unit: Unit, keys: &'static [&'static str]) -> Caption {
    Caption { name, keys, unit }
}

/// Length of the plate.
pub const LENGTH: Caption = caption("Length", Unit::Millimetre, &["length_m"]);
/// Half-width at the driven end.
pub const HALF_WIDTH: Caption = caption("Half-width", Unit::Millimetre, &["taper.half_width_m"]);
/// Rate of an exponential taper.
pub const TAPER_RATE: Caption = caption("Taper rate", Unit::Times("1/m", 1.0), &["taper.rate_per_m"]);
/// Half-width at the end of a linear taper.
pub const END_HALF_WIDTH: Caption = caption("End half-width", Unit::Millimetre, &["taper.end_half_width_m"]);
/// Nearest boundary.
pub const SPAN_START: Caption = caption("Span from", Unit::Millimetre, &["span_start_m"]);
/// Farthest boundary.
pub const SPAN_END: Caption = caption("Span to", Unit::Millimetre, &["span_end_m"]);
/// Wave speed of a membrane.
pub const WAVE_SPEED: Caption = caption("Wave speed", Unit::Times("m/s", 1.0), &["model.wave_speed_m_per_s"]);
/// Shear modulus.
pub const SHEAR_MODULUS: Caption =
    caption("Shear modulus", Unit::Times("MPa", 1e6), &["model.shear_modulus_pa"]);
/// Young's modulus.
pub const YOUNGS_MODULUS: Caption = caption(
    "Young's modulus",
    Unit::Times("GPa", 1e9),
    &["model.youngs_modulus_pa", "material.youngs_modulus_pa"],
);
/// Poisson's ratio.
pub const POISSON_RATIO: Caption =
    caption("Poisson's ratio", Unit::Pure, &["model.poisson_ratio", "material.poisson_ratio"]);
/// Density.
pub const DENSITY: Caption =
    caption("Density", Unit::Times("kg/m³", 1.0), &["model.density_kg_per_m3", "material.density_kg_per_m3"]);
/// Thickness of the sheet.
pub const THICKNESS: Caption = caption("Thickness", Unit::Millimetre, &["thickness_m", "model.thickness_m"]);
/// Loss factor.
pub const LOSS_FACTOR: Caption = caption("Loss factor", Unit::Pure, &["loss_factor", "material.loss_factor"]);
/// r of a damped source.
pub const DRIVE_RATIO: Caption = caption("Resistance ratio", Unit::Pure, &["drive.ratio"]);
/// The frequency at which r holds; no panel has a field for it.
pub const DRIVE_FREQUENCY: Caption =
    caption("Frequency of the resistance", Unit::Hertz, &["drive.at_frequency_hz"]);
/// Displacement of the drive at DAC full scale, of the plate on the screen.
pub const AT_FULL_SCALE: Caption = caption("At full scale", Unit::Millimetre, &["full_scale_m"]);
/// The same, of a design.
pub const FULL_SCALE: Caption = caption("Full scale", Unit::Millimetre, &["full_scale_m"]);
/// Lowest frequency of a design.
pub const BAND_LOW: Caption = caption("Band from", Unit::Hertz, &["band low"]);
/// Highest frequency of a design.
pub const BAND_HIGH: Caption = caption("Band to", Unit::Hertz, &["band high"]);
/// From the driven end to a design's nearest boundary.
pub const START_MARGIN: Caption =
    caption("Start margin", Unit::Millimetre, &["start_margin_m", "span_start_m"]);
/// From a design's farthest boundary to the narrow end.
pub const END_MARGIN: Caption = caption("End margin", Unit::Millimetre, &["end_margin_m", "span_end_m"]);
/// Width of the frame's rim.
pub const RIM: Caption = caption("Rim", Unit::Millimetre, &["rim_m"]);
/// Name of a design.
pub const NAME: Caption = caption("Name", Unit::Pure, &["name"]);

/// The panel whose captions are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// The numbers of the plate on the screen.
    Plate,
    /// The designer.
    Designer,
}

const PLATE: [&Caption; 16] = [
    &LENGTH,
    &HALF_WIDTH,
    &TAPER_RATE,
    &END_HALF_WIDTH,
    &SPAN_START,
    &SPAN_END,
    &WAVE_SPEED,
    &SHEAR_MODULUS,
    &YOUNGS_MODULUS,
    &POISSON_RATIO,
    &DENSITY,
    &THICKNESS,
    &LOSS_FACTOR,
    &DRIVE_RATIO,
    &DRIVE_FREQUENCY,
    &AT_FULL_SCALE,
];

const DESIGNER: [&Caption; 7] = [&FULL_SCALE, &BAND_LOW, &BAND_HIGH, &START_MARGIN, &END_MARGIN, &RIM, &NAME];

impl Panel {
    /// The caption of one of the library's fields. A field that the designer does not have gets the caption of the
    /// plate panel, which shows the chosen value.
    #[must_use]
    pub fn caption(self, key: &str) -> Option<&'static Caption> {
        let own = if self == Self::Designer { &DESIGNER[..] } else { &[] };
        own.iter().chain(&PLATE).find(|caption| caption.keys.contains(&key)).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_any_size_reads_back_from_its_field() {
        for (caption, value, text) in [
            (&AT_FULL_SCALE, 1e-9, "0.000001 mm"),
            (&LENGTH, 0.34, "340 mm"),
            (&TAPER_RATE, 4.62, "4.62 1/m"),
            (&YOUNGS_MODULUS, 70e9, "70 GPa"),
            (&BAND_LOW, 28_500.0, "28.5 kHz"),
            (&LOSS_FACTOR, 0.0, "0"),
        ] {
            assert_eq!(caption.unit.written(value, FIELD_DIGITS), text, "{}", caption.name);
            let read = caption.unit.read(text).unwrap();
            assert!((read - value).abs() <= 1e-12 * value, "{}: {read}", caption.name);
        }
    }
}
