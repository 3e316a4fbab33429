//! The limits of a plate's fields, used both to check a field and to describe its range.

use crate::quantity::{Count, Counted, Range};

/// Length of a plate or of a design.
pub const LENGTH: Range = Range::new(0.005, 10.0, "m");
/// Loss factor of a material or a tension.
pub const LOSS_FACTOR: Range = Range::new(0.0, 0.5, "");
/// Relative uncertainty of the wave speed.
pub(crate) const WAVE_SPEED_TOLERANCE: Range = Range::new(0.0, 0.05, "");
/// Relative uncertainty of the loss factor, which may be wrong by a factor of 1 to 5.
pub(crate) const LOSS_TOLERANCE: Range = Range::new(0.0, 4.0, "");
/// Exponent of the loss factor over the frequency, and half of its interval.
pub(crate) const LOSS_EXPONENT: Range = Range::new(-2.0, 2.0, "");
pub(crate) const LOSS_EXPONENT_TOLERANCE: Range = Range::new(0.0, 2.0, "");
/// How far the wavenumber of a film may be off before the farthest boundary, %.
pub const FILM_PERCENT: f64 = 2.0;
/// Displacement of the drive at DAC full scale.
pub const FULL_SCALE: Range = Range::new(1e-9, 0.1, "m");
/// Half-width anywhere on a plate.
pub const HALF_WIDTH: Range = Range::new(1e-5, 10.0, "m");
/// How far the edges give: a kerf or a frame that turns inward makes it negative.
pub const EDGE_GIVE: Range = Range::new(-0.002, 0.005, "m");
/// How well that is known.
pub(crate) const EDGE_GIVE_TOLERANCE: Range = Range::new(0.0, 0.005, "m");
/// Tension across over tension along a membrane, and half of its interval.
pub(crate) const TENSION_RATIO: Range = Range::new(0.5, 2.0, "");
pub(crate) const TENSION_RATIO_TOLERANCE: Range = Range::new(0.0, 0.5, "");
/// Rate of an exponential taper.
pub(crate) const TAPER_RATE: Range = Range::new(0.01, 1000.0, "1/m");
/// Position of a point of a sampled taper.
pub(crate) const TAPER_PLACE: Range = Range::new(0.0, 100.0, "m");
/// Wave speed of a membrane.
pub const WAVE_SPEED: Range = Range::new(0.1, 2e4, "m/s");
/// Shear modulus.
pub(crate) const SHEAR_MODULUS: Range = Range::new(100.0, 1e12, "Pa");
/// Young's modulus.
pub(crate) const YOUNGS_MODULUS: Range = Range::new(1e3, 1e13, "Pa");
/// Poisson's ratio.
pub(crate) const POISSON_RATIO: Range = Range::new(0.0, 0.499, "");
/// Density.
pub(crate) const DENSITY: Range = Range::new(1.0, 3e4, "kg/m^3");
/// Thickness of the sheet.
pub const THICKNESS: Range = Range::new(1e-6, 0.1, "m");
/// Rate at which the thickness falls.
pub(crate) const THICKNESS_RATE: Range = Range::new(-1e3, 1e3, "1/m");
/// Ratio r of a resistance drive end to the wave impedance.
pub(crate) const DRIVE_RATIO: Range = Range::new(0.01, 100.0, "");
/// Frequency of a boundary.
pub const FREQUENCY: Range = Range::new(0.5, 1e7, "Hz");
/// An actuator's resonance.
pub const RESONANCE: Range = Range::new(0.1, 1e7, "Hz");
/// An actuator's quality factor.
pub const QUALITY: Range = Range::new(0.1, 1000.0, "");
/// How far an actuator may move, or would move at DAC full scale.
pub const TRAVEL: Range = Range::new(1e-9, 0.1, "m");
/// Frequency of a point of an actuator's measured response.
pub(crate) const CURVE_FREQUENCY: Range = Range::new(0.1, 1e7, "Hz");
/// Gain of such a point.
pub(crate) const GAIN: Range = Range::new(-200.0, 200.0, "dB");
/// Level of a drive's harmonic over its fundamental.
pub(crate) const HARMONIC: Range = Range::new(-200.0, 0.0, "dB");
/// Bandwidth of an amplifier, or of a filter beside it.
pub const BANDWIDTH: Range = Range::new(10.0, 1e8, "Hz");
/// Level of the tone at which harmonics were measured.
pub const HARMONIC_LEVEL: Range = Range::new(1e-3, 1.0, "");
/// Phase of such a point.
pub(crate) const PHASE: Range = Range::new(-36e3, 36e3, "degrees");
/// Tension of a membrane, per metre of width.
pub(crate) const TENSION: Range = Range::new(1e-9, 1e13, "N/m");
/// chi^2 of a calibration over the number of its residuals.
pub(crate) const CHI2_PER_N: Range = Range::new(0.0, 1e6, "");
/// How well a calibration knows a width, as a fraction.
pub const CALIBRATED: Range = Range::new(0.0, 1.0, "");
/// How well a calibration knows the level of the peak.
pub(crate) const LEVEL_TOLERANCE_DB: Range = Range::new(0.0, 40.0, "dB");
/// Mechanical resistance of a driven end or of the damper behind a lead-in.
pub(crate) const MECHANICAL_RESISTANCE: Range = Range::new(0.0, 1e9, "N s/m");
/// Mass that moves with a driven end.
pub(crate) const MOVING_MASS: Range = Range::new(0.0, 1e3, "kg");
/// Stiffness of a driven end against the frame.
pub(crate) const END_STIFFNESS: Range = Range::new(0.0, 1e12, "N/m");
/// Length of a lead-in.
pub(crate) const LEAD_IN_LENGTH: Range = Range::new(1e-3, 10.0, "m");
/// Loss factor of a lead-in with its layer.
pub(crate) const LEAD_IN_LOSS: Range = Range::new(0.0, 2.0, "");
/// Side of the contact of a finger.
pub(crate) const CONTACT: Range = Range::new(5e-4, 0.1, "m");
/// Density of the air around a plate.
pub(crate) const AIR_DENSITY: Range = Range::new(0.05, 20.0, "kg/m^3");
/// Speed of sound in it.
pub(crate) const SOUND_SPEED: Range = Range::new(100.0, 2000.0, "m/s");
/// Its temperature, degrees Celsius.
pub(crate) const AIR_TEMPERATURE: Range = Range::new(-60.0, 100.0, "°C");
/// Its height above the sea.
pub(crate) const AIR_HEIGHT: Range = Range::new(-500.0, 9000.0, "m");
/// Coefficient alpha of the air's mass on each face.
pub(crate) const AIR_COEFFICIENT: Range = Range::new(0.0, 10.0, "");
/// Distance of a table from the lower face: nearer, the air in the gap sticks to both walls (its layer is 0.2 mm thick at 100 Hz).
pub(crate) const AIR_GAP: Range = Range::new(0.003, 1.0, "m");
/// Share of the air's pressure at a distance.
pub(crate) const DISTANT_AIR: Range = Range::new(-1.0, 2.0, "");
/// Thickness of both sheets of a frame together.
pub(crate) const FRAME_THICKNESS: Range = Range::new(0.001, 0.2, "m");
/// Width of the rim of a design's frame.
pub const RIM: Range = Range::new(0.01, 0.5, "m");

/// Allowed start of the span of a plate of this length, metres from the driven end.
pub fn span_start(length_m: f64) -> Range {
    Range::new(1e-3 * length_m, 0.999 * length_m, "m")
}

/// Name of a plate.
pub const NAME: Count = Count::new(1, 80, Counted::Characters);
/// Description of a plate, on one line.
pub(crate) const DESCRIPTION: Count = Count::new(0, 400, Counted::Characters);
/// Points of an actuator's measured response.
pub(crate) const CURVE_POINTS: Count = Count::new(2, 10_000, Counted::Points);
/// Points of a sampled taper.
pub(crate) const TAPER_POINTS: Count = Count::new(2, 10_000, Counted::Points);

/// Most wavelengths between the driven end and the boundary; this bounds the work of every computation.
pub const WAVELENGTHS_MAX: f64 = 60.0;
/// Largest ratio of the band's end to its start (six octaves); the time-domain filters grow with it.
pub const BAND_RATIO_MAX: f64 = 64.0;
/// Largest ratio of an actuator's travel at DAC full scale to its peak travel.
pub const TRAVEL_RATIO_MAX: f64 = 1000.0;
/// Least distance of a design's highest frequency above its lowest, percent of the lowest.
pub const BAND_WIDTH_MIN_PERCENT: f64 = 5.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::number_format::{at_least, at_most};

    #[test]
    fn the_ends_of_a_range_are_written_as_they_would_be_typed_and_are_allowed() {
        assert_eq!(LENGTH.to_string(), "0.005 to 10 m");
        assert_eq!(HALF_WIDTH.to_string(), "1e-5 to 10 m");
        assert_eq!(SHEAR_MODULUS.to_string(), "100 to 1e12 Pa");
        assert_eq!(LOSS_FACTOR.to_string(), "0 to 0.5");
        for (low, high, wanted) in [
            (60.005_999_999_999_986, 1_052.621_421, "60.006 to 1052.6"),
            (59.999_999_999_999_986, 0.299_699_999_999_999_97, "60 to 0.29969"),
            (0.08 + 1e-3 * 0.3, 0.3, "0.0803 to 0.3"),
            (-2.000_001, -1e-9 / 3.0, "-2 to -3.3334e-10"),
        ] {
            let range = Range::new(low, high, "");
            assert_eq!(range.to_string(), wanted);
            assert!(at_least(low, 5) >= low && at_most(high, 5) <= high, "{wanted}");
        }
        assert_eq!(Range::at_most(28.312_34, "1/m").to_string(), "at most 28.312 1/m");
        assert_eq!(Range::at_least(0.3, "m").to_string(), "at least 0.3 m");
    }
}
