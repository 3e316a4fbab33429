//! The rig of the simulated device: its plate and a sensor.

use super::argument::{self, Typed};
use super::defaults;
use super::failure::Failure;
use clap::Args;
use slipline_instrument::rig::{Coil, PreparedRig, RigOptions, secret, secret_seed};
use slipline_link::Port;
use slipline_link::simulator::Options;
use slipline_plate::Plate;

/// The port of the device.
#[derive(Debug, Args)]
#[command(next_help_heading = "Device")]
pub struct PortArgument {
    /// sim, a serial port's name, or unix:PATH. Without this option: SLIPLINE_PORT of the environment, else port = "..." of the
    /// settings file, else sim.
    #[arg(long, value_name = "P")]
    port: Option<Port>,
    /// With --port sim: the plate under the simulated device, if it differs from the plate of the command. A
    /// preset's name, a TOML file, or secret:SEED (a plate near it: wave speed within 5 %, 0.5 to 2.5 times the loss).
    #[arg(long, value_name = "TRUTH")]
    actual_plate: Option<String>,
    /// With --port sim: the second and third harmonic of the simulated coil at full scale, such as 1%,0.5%: its force factor and
    /// its suspension change with its displacement. Without this option it is linear.
    #[arg(long, value_name = "SECOND,THIRD", value_parser = two_levels)]
    actual_coil: Option<[f64; 2]>,
    /// With --port sim: the bandwidth of the simulated amplifier, a low-pass of second order, 1kHz to 150kHz (100kHz). Images of the
    /// tones then fold onto the measured current. Without this option it passes every frequency and no image.
    #[arg(long, value_name = "F", value_parser = argument::frequency)]
    actual_amplifier: Option<Typed<f64>>,
    /// With --port sim: the share of full scale within which the output of the simulated device's DAC is linear, 0.1 to 1: louder peaks
    /// are flattened, as on a board (0.88).
    #[arg(long, value_name = "SHARE", value_parser = argument::level)]
    actual_linear_share: Option<f64>,
}

/// Two levels with a comma between them.
fn two_levels(text: &str) -> Result<[f64; 2], String> {
    let (second, third) = text.split_once(',').ok_or("write SECOND,THIRD, such as 1%,0.5%")?;
    let level = |text: &str| argument::level(text).map_err(|error| error.to_string());
    Ok([level(second)?, level(third)?])
}

impl PortArgument {
    /// The port of the option, or else the default one.
    pub(super) fn port(&self) -> Result<Port, Failure> {
        self.port.clone().map_or_else(defaults::port, Ok)
    }

    /// Whether the port is that of the option.
    pub(super) const fn is_given(&self) -> bool {
        self.port.is_some()
    }

    /// The rig of the simulated device with the plate of `--actual-plate`; `None` without this option.
    pub(super) fn rig(&self, nominal: Option<&Plate>) -> Result<Option<PreparedRig>, Failure> {
        let options = self.options(&RigOptions::default())?;
        let truth = self.truth(nominal)?;
        let is_other = options != RigOptions::default();
        match truth.as_ref().or(nominal.filter(|_| is_other)) {
            Some(truth) => prepared(truth, &options).map(Some),
            None if is_other => Err(Failure::usage(
                "--actual-..: the simulated device of this command has no plate, amplifier and coil",
            )),
            None => Ok(None),
        }
    }

    /// These options with the coil, the amplifier and the DAC of the arguments.
    fn options(&self, options: &RigOptions) -> Result<RigOptions, Failure> {
        self.simulates("--actual-coil", self.actual_coil.is_some())?;
        self.simulates("--actual-amplifier", self.actual_amplifier.is_some())?;
        self.simulates("--actual-linear-share", self.actual_linear_share.is_some())?;
        let coil = self.actual_coil.map(|harmonics| Coil::with_harmonics(harmonics, 1.0));
        Ok(RigOptions {
            coil: coil.transpose().map_err(Failure::usage)?,
            amplifier_hz: self.actual_amplifier.as_ref().map(|typed| typed.value),
            linear_share: self.actual_linear_share.unwrap_or(options.linear_share),
            ..options.clone()
        })
    }

    /// Refuses an option of the simulated device with another port.
    fn simulates(&self, option: &str, is_given: bool) -> Result<(), Failure> {
        let port = self.port()?;
        if is_given && port != Port::Simulated {
            return Err(Failure::Usage(format!(
                "{option} is of the simulated device: it requires --port sim, not {port}"
            )));
        }
        Ok(())
    }

    /// The rig of the simulated device with a sensor: on the plate of the command or that of
    /// `--actual-plate`. `None` for another port.
    pub(super) fn rig_with_sensor(
        &self,
        nominal: &Plate,
        options: &RigOptions,
    ) -> Result<Option<PreparedRig>, Failure> {
        let (truth, options) = (self.truth(Some(nominal))?, self.options(options)?);
        if self.port()? != Port::Simulated {
            return Ok(None);
        }
        prepared(truth.as_ref().unwrap_or(nominal), &options).map(Some)
    }

    /// The plate of `--actual-plate`.
    fn truth(&self, nominal: Option<&Plate>) -> Result<Option<Plate>, Failure> {
        let Some(text) = &self.actual_plate else { return Ok(None) };
        self.simulates("--actual-plate", true)?;
        actual_plate(text, nominal).map(Some)
    }
}

/// The plate of `--actual-plate`: a file, a preset, or one near the plate of the command.
pub(super) fn actual_plate(text: &str, nominal: Option<&Plate>) -> Result<Plate, Failure> {
    let Some(seed) = secret_seed(text) else { return argument::plate(text) };
    let allowed = "secret:SEED with a whole number from 0 to 18446744073709551615";
    let seed = seed.map_err(|_| Failure::value("--actual-plate", text, allowed))?;
    let nominal = nominal.ok_or_else(|| {
        Failure::Usage(format!(
            "--actual-plate {text} is drawn near the plate of the command, and this command has none"
        ))
    })?;
    secret(nominal, seed).map_err(|error| Failure::because(format!("--actual-plate {text}: {error}"), &error))
}

/// A rig on this plate, for the simulated device.
pub(super) fn prepared(truth: &Plate, options: &RigOptions) -> Result<PreparedRig, Failure> {
    let rate_hz = f64::from(Options::default().sample_rate_hz);
    PreparedRig::new(truth, options, rate_hz).map_err(Failure::refused)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(port: &str, actual: Option<&str>) -> PortArgument {
        PortArgument {
            port: Some(port.parse().unwrap()),
            actual_plate: actual.map(str::to_owned),
            actual_coil: None,
            actual_amplifier: None,
            actual_linear_share: None,
        }
    }

    #[test]
    fn a_rig_stands_on_the_plate_that_was_named_or_on_one_near_it() {
        let nominal = slipline_plate::preset("membrane").unwrap();
        let truth =
            |actual: &str| port("sim", Some(actual)).rig(Some(&nominal)).unwrap().unwrap().truth().clone();
        assert!(port("sim", None).rig(Some(&nominal)).unwrap().is_none());
        assert_eq!(truth("membrane-heavy").name(), "membrane-heavy");
        assert_eq!(truth("secret"), truth("secret:1"));
        assert_ne!(truth("secret:2"), truth("secret:1"));
        assert_eq!(truth("secret:2"), secret(&nominal, 2).unwrap());
    }

    #[test]
    fn a_plate_for_another_port_a_bad_seed_and_a_secret_near_nothing_are_bad_usage() {
        let nominal = slipline_plate::preset("membrane").unwrap();
        let refused = |argument: PortArgument, nominal: Option<&Plate>| match argument.rig(nominal) {
            Err(failure) if failure.exit_code() == 2 => failure.to_string(),
            other => panic!("{other:?}"),
        };
        let message = refused(port("/dev/ttyACM0", Some("membrane")), Some(&nominal));
        assert!(message.contains("--port sim, not /dev/ttyACM0"), "{message}");
        let message = refused(port("sim", Some("secret:-1")), Some(&nominal));
        assert!(message.contains("'secret:-1' for '--actual-plate'"), "{message}");
        assert!(refused(port("sim", Some("secret")), None).contains("has none"));
        assert!(refused(port("sim", Some("secrets")), Some(&nominal)).contains("secrets"));
    }
}
