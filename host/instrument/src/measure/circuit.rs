//! The circuit from the DAC to the drive, by its data sheets: parsing of its values, and their allowed
//! ranges.

use slipline_plate::quantity::{QuantityError, Range, plain};

/// Accepted deviation of a resistance or a capacitance from its data sheet, relative.
pub const TOLERANCE: f64 = 0.25;
/// Allowed amplitudes of the amplifier's voltage at the DAC's full scale.
pub const AMPLIFIER: Range = Range::new(1e-3, 1e4, "V");
/// Allowed resistances of a voice coil.
pub const COIL: Range = Range::new(0.01, 1e5, "ohm");
/// Allowed capacitances of a piezo.
pub const PIEZO: Range = Range::new(1e-13, 1e-2, "F");
/// Allowed currents at the end of the range of the shunt's input.
pub const SHUNT: Range = Range::new(1e-9, 1e3, "A");

/// Parses a number with one of these units; a number alone is in the last unit.
fn in_units(text: &str, units: &[(&'static str, f64)], unit: &'static str) -> Result<f64, QuantityError> {
    match units.iter().find(|(unit, _)| text.trim_end().ends_with(unit)) {
        Some((unit, scale)) => plain(text, unit).map(|number| number * scale),
        None => plain(text, unit),
    }
}

/// Parses a voltage (`2 V`, `250mV`), in volts.
///
/// # Errors
/// [`QuantityError`]: no number, or another unit.
pub fn volt(text: &str) -> Result<f64, QuantityError> {
    in_units(text, &[("mV", 1e-3), ("kV", 1e3)], "V")
}

/// Parses a resistance (`4ohm`, `1.2 kohm`), in ohms.
///
/// # Errors
/// [`QuantityError`]: no number, or another unit.
pub fn ohm(text: &str) -> Result<f64, QuantityError> {
    in_units(text, &[("mohm", 1e-3), ("kohm", 1e3)], "ohm")
}

/// Parses a capacitance (`220 nF`), in farads.
///
/// # Errors
/// [`QuantityError`]: no number, or another unit.
pub fn farad(text: &str) -> Result<f64, QuantityError> {
    in_units(text, &[("pF", 1e-12), ("nF", 1e-9), ("uF", 1e-6), ("µF", 1e-6), ("mF", 1e-3)], "F")
}

/// Parses a current (`1.65 A`, `500mA`), in amperes.
///
/// # Errors
/// [`QuantityError`]: no number, or another unit.
pub fn ampere(text: &str) -> Result<f64, QuantityError> {
    in_units(text, &[("nA", 1e-9), ("uA", 1e-6), ("µA", 1e-6), ("mA", 1e-3), ("kA", 1e3)], "A")
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::quantity::show_si;

    #[test]
    fn quantities_of_a_circuit_are_read_with_their_prefixes() {
        let close = |found: Result<f64, QuantityError>, wanted: f64| {
            let found = found.unwrap();
            assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
        };
        close(volt("2 V"), 2.0);
        close(volt("250mV"), 0.25);
        close(ohm("4ohm"), 4.0);
        close(ohm("1.2kohm"), 1200.0);
        close(farad("220nF"), 220e-9);
        close(farad("3e-6"), 3e-6);
        close(ampere("500mA"), 0.5);
        assert!(farad("220nH").is_err() && volt("two").is_err());
    }

    #[test]
    fn what_is_shown_of_a_circuit_can_be_typed() {
        type Read = fn(&str) -> Result<f64, QuantityError>;
        let quantities: [(Read, Range); 4] =
            [(volt, AMPLIFIER), (ohm, COIL), (farad, PIEZO), (ampere, SHUNT)];
        for (read, Range { low, high, unit }) in quantities {
            for value in [low, (low * high).sqrt(), 0.1 * high, high] {
                let shown = show_si(value, unit);
                let back = read(&shown).unwrap_or_else(|error| panic!("{shown}: {error}"));
                assert!((back / value - 1.0).abs() < 1e-3, "{shown} is read as {back}");
            }
        }
    }
}
