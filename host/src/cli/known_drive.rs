//! What is told of the amplifier and of the drive behind it, and whether that drive is on.

use super::Failure;
use super::argument::within;
use super::bench::{Bench, run};
use clap::{ArgGroup, Args};
use slipline_model::measure::{DriveChecking, KnownDrive};
use slipline_model::rig::PreparedRig;
use slipline_plate::calibrate::{DriveCheck, DriveCircuit, DriveLoad};
use slipline_plate::quantity::{Measure, QuantityError, plain};

/// How far resistance or capacitance may be from a data sheet's.
const TOLERANCE: f64 = 0.25;

/// The circuit from the DAC to the drive, from data sheets: all of it or nothing.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("load").args(["coil", "piezo"]))]
pub(super) struct KnownDriveArgument {
    /// The amplitude of the amplifier's voltage at the DAC's full scale (2V), 1mV to 10kV. With --coil or --piezo, and --shunt:
    /// before anything loud it is checked by quiet tones whether the drive is on.
    #[arg(long, value_name = "VOLT", value_parser = within(volt, Measure::Plain("V"), (1e-3, 1e4)), allow_hyphen_values = true, requires = "load", requires = "shunt")]
    amplifier: Option<f64>,
    /// The amplifier drives a voice coil of this resistance (4ohm), 0.01 to 100000 ohm.
    #[arg(long, value_name = "OHM", value_parser = within(ohm, Measure::Plain("ohm"), (0.01, 1e5)), allow_hyphen_values = true, requires = "amplifier", conflicts_with = "piezo")]
    coil: Option<f64>,
    /// The amplifier drives a piezo of this capacitance (220nF), 0.1 pF to 10 mF.
    #[arg(long, value_name = "FARAD", value_parser = within(farad, Measure::Plain("F"), (1e-13, 1e-2)), allow_hyphen_values = true, requires = "amplifier")]
    piezo: Option<f64>,
    /// The current at the end of the range of the device's second input, behind the shunt (1.65A), 1 nA to 1000 A.
    #[arg(long, value_name = "AMPERE", value_parser = within(ampere, Measure::Plain("A"), (1e-9, 1e3)), allow_hyphen_values = true, requires = "amplifier")]
    shunt: Option<f64>,
}

/// A number with one of these units, or in the last of them.
fn in_units(text: &str, units: &[(&'static str, f64)], unit: &'static str) -> Result<f64, QuantityError> {
    match units.iter().find(|(unit, _)| text.trim_end().ends_with(unit)) {
        Some((unit, scale)) => plain(text, unit).map(|number| number * scale),
        None => plain(text, unit),
    }
}

fn volt(text: &str) -> Result<f64, QuantityError> {
    in_units(text, &[("mV", 1e-3), ("kV", 1e3)], "V")
}

fn ohm(text: &str) -> Result<f64, QuantityError> {
    in_units(text, &[("mohm", 1e-3), ("kohm", 1e3)], "ohm")
}

fn farad(text: &str) -> Result<f64, QuantityError> {
    in_units(text, &[("pF", 1e-12), ("nF", 1e-9), ("uF", 1e-6), ("mF", 1e-3)], "F")
}

fn ampere(text: &str) -> Result<f64, QuantityError> {
    in_units(text, &[("nA", 1e-9), ("uA", 1e-6), ("mA", 1e-3)], "A")
}

impl KnownDriveArgument {
    /// The told drive; that of a rig knows itself.
    pub(super) fn known(&self, rig: Option<&PreparedRig>) -> Option<KnownDrive> {
        let load = match (self.coil, self.piezo) {
            (Some(resistance_ohm), _) => Some(DriveLoad::Coil { resistance_ohm }),
            (None, piezo) => piezo.map(|capacitance_f| DriveLoad::Piezo { capacitance_f }),
        };
        let told = self.amplifier.zip(load).zip(self.shunt);
        let told = told.map(|((full_scale_v, load), full_scale_a)| {
            let circuit = DriveCircuit { full_scale_v, load, tolerance: TOLERANCE };
            KnownDrive { circuit, full_scale_a }
        });
        told.or_else(|| rig.map(PreparedRig::known_drive))
    }
}

/// Makes sure by quiet tones that a drive is on; says what was found. Nothing is played where it is not known.
pub(super) fn check(bench: &Bench<'_>, known: Option<KnownDrive>) -> Result<Option<DriveCheck>, Failure> {
    let Some(known) = known else { return Ok(None) };
    let inputs = bench.inputs();
    let checking = DriveChecking::new(bench.plate, known, bench.table.clone(), bench.rate_hz, &inputs)
        .map_err(Failure::failed)?;
    let found = run(bench.device, "drive", checking)?;
    match found.check {
        check if check.is_on() => Ok(Some(check)),
        check @ DriveCheck::TooQuiet { .. } => Err(Failure::Failed(format!(
            "{check} They are at {} of full scale already: leave out --amplifier to play without this check",
            found.level
        ))),
        check => Err(Failure::Failed(check.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
