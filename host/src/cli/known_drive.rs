//! The drive circuit given by the arguments, and the check that this drive is on.

use super::argument::within;
use super::device::LoadedDevice;
use super::failure::Failure;
use super::progress;
use clap::{ArgGroup, Args};
use slipline_instrument::measure::circuit::{AMPLIFIER, COIL, PIEZO, SHUNT, ampere, farad, ohm, volt};
use slipline_instrument::measure::{BANDWIDTH, Bandwidths, KnownDrive};
use slipline_instrument::native::ClientError;
use slipline_instrument::requests::circuit_of;
use slipline_plate::calibrate::DriveCheck;
use slipline_plate::quantity::number_format::significant;
use slipline_plate::quantity::{self, Measure, NotAllowed, QuantityError, Range, TypedRange};

/// The circuit from the DAC to the drive, from data sheets: all values or none.
#[derive(Debug, Args)]
#[command(next_help_heading = "Drive circuit")]
#[command(group = ArgGroup::new("load").args(["coil", "piezo"]))]
pub(super) struct KnownDriveArgument {
    /// The amplitude of the amplifier's voltage at the DAC's full scale (2V), 1mV to 10kV. With --coil or --piezo, and --shunt,
    /// quiet tones check that the drive is on before anything loud is played.
    #[arg(long, value_name = "VOLT", value_parser = of_circuit(volt, AMPLIFIER), allow_hyphen_values = true, requires = "load", requires = "shunt")]
    amplifier: Option<f64>,
    /// The amplifier drives a voice coil of this resistance (4ohm), 0.01 to 100000 ohm.
    #[arg(long, value_name = "OHM", value_parser = of_circuit(ohm, COIL), allow_hyphen_values = true, requires = "amplifier", conflicts_with = "piezo")]
    coil: Option<f64>,
    /// The amplifier drives a piezo of this capacitance (220nF), 0.1 pF to 10 mF.
    #[arg(long, value_name = "FARAD", value_parser = of_circuit(farad, PIEZO), allow_hyphen_values = true, requires = "amplifier")]
    piezo: Option<f64>,
    /// The current at the end of the range of the device's second input, behind the shunt (1.65A), 1 nA to 1000 A.
    #[arg(long, value_name = "AMPERE", value_parser = of_circuit(ampere, SHUNT), allow_hyphen_values = true, requires = "amplifier")]
    shunt: Option<f64>,
    /// The bandwidth of the amplifier (120kHz), a low-pass of second order, 10Hz to 100MHz. It bounds the images of the tones above half
    /// of the sample rate that fold onto a measured current. Without it the plate file's counts.
    #[arg(long, value_name = "F", value_parser = of_circuit(quantity::frequency_hz, BANDWIDTH), allow_hyphen_values = true, requires = "amplifier")]
    amplifier_bandwidth: Option<f64>,
    /// The bandwidth of a filter of second order before the amplifier or before the input of the current, 10Hz to 100MHz.
    #[arg(long, value_name = "F", value_parser = of_circuit(quantity::frequency_hz, BANDWIDTH), allow_hyphen_values = true, requires = "amplifier")]
    filter_bandwidth: Option<f64>,
}

/// A parser of a quantity of the circuit.
fn of_circuit(
    parse: fn(&str) -> Result<f64, QuantityError>,
    range: Range,
) -> impl Fn(&str) -> Result<f64, NotAllowed<TypedRange>> + Clone + Send + Sync + 'static {
    within(parse, Measure::Plain(range.unit), (range.low, range.high))
}

impl KnownDriveArgument {
    /// The drive circuit of the arguments. The parser refuses an incomplete one itself.
    pub(super) fn stated(&self) -> Result<Option<KnownDrive>, Failure> {
        let bandwidths =
            Bandwidths { amplifier_hz: self.amplifier_bandwidth, filter_hz: self.filter_bandwidth };
        circuit_of(self.amplifier, self.coil, self.piezo, self.shunt, bandwidths).map_err(Failure::usage)
    }
}

/// Checks with quiet tones that a known drive is on. For an unknown one it plays nothing and returns `None`.
pub(super) fn check(
    bench: &LoadedDevice<'_>,
    known: Option<KnownDrive>,
) -> Result<Option<DriveCheck>, Failure> {
    let Some(known) = known else { return Ok(None) };
    let found = progress::reported("drive", |progress| {
        bench.device.check_drive(bench.plate, &bench.table, known, progress)
    });
    match found {
        Ok(found) => Ok(Some(found.check)),
        Err(ClientError::NotOn(found)) if matches!(found.check, DriveCheck::TooQuiet { .. }) => {
            Err(Failure::Failed(format!(
                "{} They are at {} of full scale already: leave out --amplifier to play without this check",
                found.check,
                significant(found.level, 3)
            )))
        }
        Err(error) => Err(error.into()),
    }
}
