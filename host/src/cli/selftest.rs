//! `slipline selftest`: a board's test of itself, its report, and the judgement of a report.

mod reading;
mod utc;

use super::destination::{Destination, ForceArgument};
use super::device::{ArmingArgument, Device};
use super::failure::Failure;
use super::rig::PortArgument;
use super::schema::finished;
use super::source::text_of;
use super::{images, output, progress};
use clap::Args;
use serde_json::{Value, json};
use slipline_instrument::selftest::{SelftestReport, SelftestRequest, StepResult, Verdict, Wire};
use slipline_link::Port;
use slipline_link::simulator::{Options, Wires};
use std::io::{self, IsTerminal as _, Write};
use std::path::PathBuf;
use std::time::SystemTime;

/// `selftest`.
#[derive(Debug, Args)]
pub struct SelftestArguments {
    #[command(flatten)]
    port: PortArgument,
    /// A wire between two pins of the board: dac=sensor or trigger=trigger-in. May be given twice. Steps without their wire are
    /// skipped.
    #[arg(long, value_name = "PIN=PIN", help_heading = "Board")]
    wire: Vec<Wire>,
    /// The amplifier is unplugged: steps may take the mute pin high, to time its fall, and to make the board fail on purpose.
    #[arg(long, help_heading = "Board")]
    amplifier_unplugged: bool,
    /// Test the amplifier, connected and switched on, once all else has passed without it: tones at -40 dB, which an input must receive
    /// while the device drives, and not while it is muted.
    #[arg(long, help_heading = "Board", conflicts_with_all = ["wire", "amplifier_unplugged", "ask"])]
    amplifier: bool,
    #[command(flatten)]
    arming: ArmingArgument,
    /// Test in three seconds: fewer codes, and the clocks over that time alone.
    #[arg(long, help_heading = "Board")]
    short: bool,
    /// Ask a person to press the board's buttons, which is done by itself where a board is tested from a terminal.
    #[arg(long, help_heading = "Board")]
    ask: bool,
    /// Write the report to this file, as --json prints it.
    #[arg(long, value_name = "REPORT.json", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
    /// Judge this report by the limits of this program; no device is tested.
    #[arg(long, value_name = "REPORT.json", conflicts_with_all = ["port", "actual_plate", "actual_amplifier", "actual_coil", "actual_linear_share", "despite_brown_out_level", "despite_no_profile", "wire", "amplifier_unplugged", "amplifier", "short", "ask", "out", "force"])]
    judge: Option<PathBuf>,
}

pub(super) fn run(arguments: &SelftestArguments, as_json: bool) -> Result<(), Failure> {
    let answer = match &arguments.judge {
        Some(path) => {
            let read = reading::report(&text_of(path, reading::BYTES_MAX)?);
            let (report, date) = read.map_err(|broken| Failure::of_file(path, broken))?;
            Answer { report: report.judged_again(), date, port: None, files: Vec::new() }
        }
        None => test(arguments)?,
    };
    output::print(as_json, &answer.json(), |out| page(out, &answer.report))?;
    match answer.report.named(Verdict::Red).count() {
        0 if answer.report.passed() => Ok(()),
        0 => Err(Failure::Failed("no step of the self-test was carried out".to_owned())),
        1 => Err(Failure::Red(format!("1 of {} steps is red", answer.report.steps.len()))),
        red => Err(Failure::Red(format!("{red} of {} steps are red", answer.report.steps.len()))),
    }
}

/// A report, and where it is from.
struct Answer {
    report: SelftestReport,
    date: String,
    port: Option<Port>,
    files: Vec<String>,
}

impl Answer {
    fn json(&self) -> Value {
        let mut value = json!(self.report);
        // JSON `date`, text: When the test ended, in UTC
        value["date"] = json!(self.date);
        value["files"] = json!(self.files);
        // JSON `passed`, true or false: Whether no step is red
        value["passed"] = json!(self.report.passed());
        value["port"] = json!(self.port.as_ref().map(ToString::to_string));
        value
    }
}

/// Tests the board and writes the report.
fn test(arguments: &SelftestArguments) -> Result<Answer, Failure> {
    let out = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let port = arguments.port.port()?;
    if arguments.port.rig(None)?.is_some() {
        return Err(Failure::usage("--actual-plate: a self-test has no plate"));
    }
    let wires = |wire| arguments.wire.contains(&wire);
    let options = Options {
        wires: Wires {
            dac_to_sensor: wires(Wire::DacToSensor),
            trigger: wires(Wire::Trigger),
            amplifier_to_sensor: arguments.amplifier,
        },
        ..Options::default()
    };
    let request = SelftestRequest {
        is_amplifier_unplugged: arguments.amplifier_unplugged,
        is_amplifier_on: arguments.amplifier,
        // Nobody presses the button of the simulated device.
        asks: arguments.ask || port != Port::Simulated && io::stderr().is_terminal(),
        is_short: arguments.short,
        seed: seed(),
        ..SelftestRequest::default()
    };
    let device = Device::observe_simulating(&port, options)?;
    device.identity()?;
    if arguments.amplifier {
        device.may_be_armed(&arguments.arming)?;
    }
    let mut asked = None;
    let mut report = progress::reported("self-test", |progress| {
        device.selftest(request.with_wires(&arguments.wire), |share, prompt| {
            if let Some(prompt) = prompt.filter(|prompt| asked != Some(*prompt)) {
                output::note(prompt.sentence());
            }
            asked = prompt;
            progress(share);
        })
    })?;
    report.image_sha256 =
        if report.simulated { None } else { images::sha256_of(&report.board, &report.build) };
    let files = Destination::names(&out);
    let answer = Answer { report, date: utc::text(SystemTime::now()), port: Some(port), files };
    if let Some(out) = &out {
        out.write_measured(&format!("{}\n", finished(&answer.json())))?;
    }
    Ok(answer)
}

/// Another seed in each test: the drives differ.
fn seed() -> u64 {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(1, |time| time.as_nanos() as u64)
}

/// The page of text.
fn page(out: &mut dyn Write, report: &SelftestReport) -> io::Result<()> {
    writeln!(
        out,
        "Board {}, unit {}, firmware {} ({})",
        report.board, report.unit, report.firmware, report.build
    )?;
    let width = report.steps.iter().map(|step| step.name.len()).max().unwrap_or_default();
    for StepResult { name, verdict, readings, sentence } in
        report.steps.iter().filter(|step| step.verdict != Verdict::Skipped)
    {
        writeln!(out, "{:<7}  {name:<width$}  {sentence}", verdict.name())?;
        for reading in readings {
            let allowed =
                reading.allowed().map_or(String::new(), |allowed| format!("  (allowed: {allowed})"));
            writeln!(out, "{:<7}  {:<width$}  {}: {}{allowed}", "", "", reading.quantity, reading.shown())?;
        }
    }
    if report.named(Verdict::Skipped).next().is_some() {
        writeln!(out, "Not shown:")?;
    }
    for step in report.steps.iter().filter(|step| step.verdict == Verdict::Skipped) {
        writeln!(out, "{:<7}  {:<width$}  {}", step.verdict.name(), step.name, step.sentence)?;
    }
    writeln!(out, "{}", report.line())
}
