//! `slipline calibrate`.

use super::argument::{self, PlateArgument};
use super::calibrated::finish;
use super::destination::{Destination, ForceArgument};
use super::device::ArmingArgument;
use super::failure::Failure;
use super::feeling::FeelingArgument;
use super::known_drive::KnownDriveArgument;
use super::measured_file::{SensorArgument, current_of, measurements};
use super::measuring::{BandArgument, ByDevice, at_places, current};
use super::rig::PortArgument;
use super::touch::{TouchArgument, touch};
use super::{progress, sensor_places};
use clap::{ArgGroup, Args, ValueEnum};
use slipline_instrument::calipers::{complete_calipers, with_calipers};
use slipline_instrument::requests::{self, FeltEdgesRequest};
use slipline_model::answer::calibrate::{
    CALIPERS_TOLERANCE, CalibrationReport, FileReadAnswer, TOUCH_TOLERANCE, by_measurements,
};
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_model::setup::file::feeling;
use slipline_plate::calibrate::{
    CalibrateError, Measurement, Placing, Priors, SensorKind, TouchedDrive, Transducer, check_source,
};
use slipline_plate::quantity::must_be;
use slipline_plate::{Plate, limits};
use std::io::Write as _;
use std::path::PathBuf;

/// `calibrate`.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("measured").args(["port", "data", "touches", "plan"]).required(true))]
pub struct CalibrateArguments {
    #[command(flatten)]
    plate: PlateArgument,
    /// Print the proposed places of the sensor and the accuracy of pairs of places, before anything is
    /// measured; with --sensor twice, the accuracy of these places, or why one of them is unsuitable.
    #[arg(long, conflicts_with_all = ["out", "current"])]
    plan: bool,
    /// With --plan: the drive acts beside the centre line, so that it excites the second width mode, too.
    #[arg(long, requires = "plan")]
    off_centre: bool,
    /// Measure now, with this device.
    #[command(flatten)]
    port: Option<PortArgument>,
    #[command(flatten)]
    measured: MeasuredArgument,
    #[command(flatten)]
    sensor: SensorArgument,
    #[command(flatten)]
    band: BandArgument,
    /// Largest sum of all tones in a measurement, over full scale (default 0.5); or the level at which the
    /// touched tones were played (default 0.8).
    #[arg(long, value_parser = argument::level, allow_hyphen_values = true)]
    level: Option<f64>,
    #[command(flatten)]
    known: KnownDriveArgument,
    #[command(flatten)]
    arming: ArmingArgument,
    /// Standard deviation of the stated position of a felt edge, 10um to 50mm.
    #[arg(long, value_name = "LENGTH", value_parser = argument::length(TOUCH_TOLERANCE), allow_hyphen_values = true, default_value = "2mm")]
    touch_tolerance: f64,
    #[command(flatten)]
    feeling: FeelingArgument,
    /// Write the feeling that the touches give, for --feeling.
    #[arg(long, value_name = "FEELING.toml", requires = "touches")]
    feeling_out: Option<PathBuf>,
    #[command(flatten)]
    calipers: CalipersArgument,
    /// Write the plate file with the measured numbers, their intervals and the measured gain.
    #[arg(long, value_name = "FITTED.toml", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
}

/// Earlier measurements.
#[derive(Debug, Args)]
#[command(next_help_heading = "Measurements")]
struct MeasuredArgument {
    /// A measurement of the same sensor at one place. Give two files, of two places; a single one needs a
    /// model of the source and is less accurate. A third file, of a third place, is a check: it widens the
    /// intervals or refuses. A CSV file of PLATES.md is complete by itself. Also read are
    /// REW's text, .frd, any table of frequency and level, universal files (58), and what a phone or an
    /// audio interface recorded of `slipline sweep`, as WAV, FLAC, ALAC (M4A) or AIFF.
    #[arg(long, value_name = "FILE")]
    data: Vec<PathBuf>,
    /// Calibrate by the current of the drive instead of a sensor, with nothing on the plate; the file of
    /// --data, if any, holds this current. The value is the kind of drive.
    #[arg(long, value_enum, value_name = "DRIVE", conflicts_with_all = ["places", "touches"])]
    current: Option<CurrentOf>,
    /// Without a sensor: the felt edge requested by the plate file (or the tone's frequency), and where the finger
    /// felt it (250mm:246mm); give at least two, far apart. This calibrates places, not levels.
    #[arg(long = "touch", value_name = "ASKED:FELT", value_parser = touch, allow_hyphen_values = true)]
    touches: Vec<TouchArgument>,
    /// What is known of the drive whose edges were felt. By default the drive is unknown, unless the plate
    /// file holds values measured by a sensor or the current. An unknown drive needs more touches: six
    /// instead of two.
    #[arg(long, value_enum, value_name = "KNOWN", requires = "touches")]
    touched_drive: Option<DriveKnown>,
}

/// What is known of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DriveKnown {
    /// As the plate file states it, except for its gain.
    AsTold,
    /// Resistance, mass, spring and resonance may have any usual values.
    Unknown,
}

/// The kind of drive whose current is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CurrentOf {
    /// A voice coil.
    Coil,
    /// A piezo.
    Piezo,
}

impl CurrentOf {
    const fn transducer(self) -> Transducer {
        match self {
            Self::Coil => Transducer::Coil,
            Self::Piezo => Transducer::Piezo,
        }
    }
}

/// The plate's widths and length by calipers and a rule: all three or none.
#[derive(Debug, Args)]
#[command(next_help_heading = "Calipers")]
struct CalipersArgument {
    /// Half of the width at the driven end, by calipers.
    #[arg(long, value_name = "W0", value_parser = argument::length(limits::HALF_WIDTH), allow_hyphen_values = true, requires = "end_half_width", requires = "length")]
    half_width: Option<f64>,
    /// Half of the width at the narrow end, by calipers.
    #[arg(long, value_name = "WL", value_parser = argument::length(limits::HALF_WIDTH), allow_hyphen_values = true, requires = "half_width", requires = "length")]
    end_half_width: Option<f64>,
    /// Distance from the driven to the narrow end, by a rule.
    #[arg(long, value_name = "L", value_parser = argument::length(limits::LENGTH), allow_hyphen_values = true, requires = "half_width", requires = "end_half_width")]
    length: Option<f64>,
    /// Standard deviation of both half-widths measured with the calipers, 100nm to 10mm.
    #[arg(long, value_name = "LENGTH", value_parser = argument::length(CALIPERS_TOLERANCE), allow_hyphen_values = true, default_value = "50um")]
    calipers_tolerance: f64,
}

impl CalipersArgument {
    /// The plate with its measured dimensions, and their uncertainties. The parser refuses incomplete ones itself.
    fn applied_to(&self, plate: &Plate) -> Result<(Plate, Priors), Failure> {
        let Self { half_width, end_half_width, length, calipers_tolerance } = *self;
        let calipers = complete_calipers(half_width, end_half_width, length, Some(calipers_tolerance));
        with_calipers(plate, calipers.map_err(Failure::usage)?)
            .map_err(|error| Failure::because(format!("by calipers: {error}"), &error))
    }
}

pub(super) fn run(arguments: &CalibrateArguments, as_json: bool) -> Result<(), Failure> {
    let MeasuredArgument { data, touches, .. } = &arguments.measured;
    if arguments.port.is_some() && (arguments.plan || !data.is_empty() || !touches.is_empty()) {
        // The parser refuses --port itself beside these.
        let why = "--actual-plate selects the plate of the simulated device: it requires --port sim";
        return Err(Failure::usage(why));
    }
    let file = arguments.plate.read()?;
    let out = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let feeling_out = Destination::perhaps(arguments.feeling_out.as_deref(), arguments.force)?;
    if out.as_ref().zip(feeling_out.as_ref()).is_some_and(|(plate, feeling)| plate.is(feeling)) {
        return Err(Failure::usage("--out and --feeling-out name the same file"));
    }
    let (nominal, priors) = arguments.calipers.applied_to(&file)?;
    if arguments.plan {
        let placing = Placing {
            sensor: arguments.sensor.kind.unwrap_or(SensorKind::Displacement),
            points: arguments.band.request(None, None).frequencies.on(&nominal).points,
            off_centre: arguments.off_centre,
            priors,
        };
        let asked = asked_places(&nominal, &arguments.sensor)?;
        return sensor_places::print(&nominal, &placing, asked, as_json);
    }
    let mut understood = Vec::new();
    let found = match &arguments.measured.touches[..] {
        [] => {
            let measured;
            (measured, understood) = read_or_measured(&nominal, arguments)?;
            let current = arguments.measured.current.map(CurrentOf::transducer);
            let measured = requests::measured(&measured, current)
                .ok_or_else(|| Failure::usage("--data names no file"))?;
            by_measurements(&nominal, measured, &priors)
        }
        touches => touched(&nominal, touches, arguments, &priors)?,
    };
    if let (Some(out), Some(felt)) = (&feeling_out, found.as_ref().ok().and_then(|it| it.feeling)) {
        let text = feeling::write(&felt);
        out.write(|writer| Ok(writer.write_all(text.as_bytes())?))?;
    }
    finish(&file, found, &understood, out.as_ref(), feeling_out.as_ref(), as_json)
}

/// The two sensor places given with --plan.
fn asked_places(nominal: &Plate, sensor: &SensorArgument) -> Result<Option<[f64; 2]>, Failure> {
    match &sensor.places[..] {
        [] => Ok(None),
        [near, far] => Ok(Some([near.of_sensor(nominal)?, far.of_sensor(nominal)?])),
        places => {
            let given = format_args!("{} --sensor with --plan", places.len());
            Err(Failure::Usage(must_be(given, "none or 2: both places of the sensor")))
        }
    }
}

/// The measurements of the same sensor, at one place or at two: by a device or from files, with what was read of these.
fn read_or_measured(
    nominal: &Plate,
    arguments: &CalibrateArguments,
) -> Result<(Vec<Measurement>, Vec<FileReadAnswer>), Failure> {
    let data = &arguments.measured.data;
    let Some(port) = &arguments.port else {
        if arguments.measured.current.is_some() {
            return match &data[..] {
                [file] => current_of(nominal, file, &arguments.sensor).map(|(it, read)| (vec![it], read)),
                more => {
                    let given = format_args!("{} files of --data with --current", more.len());
                    Err(Failure::Usage(must_be(given, "1: the current, with nothing on the plate")))
                }
            };
        }
        if data.len() > 3 {
            let given = format_args!("{} files of --data", data.len());
            return Err(Failure::Usage(must_be(given, "1 to 3, of the same sensor at as many places")));
        }
        return measurements(nominal, data, &arguments.sensor);
    };
    if arguments.measured.current.is_some() || arguments.sensor.places.len() == 1 {
        check_source(nominal).map_err(Failure::failed)?;
    }
    let request = arguments.band.request(arguments.level, arguments.known.stated()?);
    let by = ByDevice { port, request, arming: &arguments.arming };
    let measured = match arguments.measured.current {
        Some(of) => vec![current(nominal, &by, of == CurrentOf::Piezo)?],
        None => at_places(nominal, &by, &arguments.sensor)?,
    };
    Ok((measured, Vec::new()))
}

/// The calibration by felt edges.
fn touched(
    nominal: &Plate,
    touches: &[TouchArgument],
    arguments: &CalibrateArguments,
    priors: &Priors,
) -> Result<Result<CalibrationReport, CalibrateError>, Failure> {
    let request = FeltEdgesRequest {
        edges: touches.iter().map(TouchArgument::request).collect(),
        level: arguments.level,
        tolerance_m: Some(arguments.touch_tolerance),
        drive: arguments.measured.touched_drive.map(|known| match known {
            DriveKnown::AsTold => TouchedDrive::AsStated,
            DriveKnown::Unknown => TouchedDrive::Unknown,
        }),
        feeling: arguments.feeling.read()?.feeling,
    };
    let (table, _) = progress::table_for(nominal, SAMPLE_RATE_HZ)?;
    request.calibrate(nominal, priors, &table).map_err(|(number, error)| match touches.get(number) {
        Some(touch) => touch.refused(nominal, &error),
        None => Failure::refused(error),
    })
}
