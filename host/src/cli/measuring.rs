//! Measurements with a device, for `measure` and `calibrate`.

use super::argument::{self, Typed};
use super::device::{ArmingArgument, Device, LoadedDevice};
use super::failure::Failure;
use super::known_drive;
use super::measured_file::SensorArgument;
use super::output;
use super::progress;
use super::rig::PortArgument;
use super::source::is_standard_input_taken;
use clap::Args;
use slipline_instrument::measure::{
    Bandwidths, KnownDrive, MeasureError, Measured, POINTS, Sensor, current_sensor,
};
use slipline_instrument::native;
use slipline_instrument::requests::{Frequencies, MeasureRequest};
use slipline_instrument::rig::{PreparedRig, RigOptions};
use slipline_model::atomic_file::said;
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_plate::Plate;
use slipline_plate::calibrate::{DriveCheck, DriveLoad, Measurement, SensorKind, check_places};
use slipline_plate::quantity::{must_be, show_place};

/// The measured frequencies.
#[derive(Debug, Args)]
#[command(next_help_heading = "Frequencies")]
pub(super) struct FrequenciesArgument {
    /// The lowest frequency; by default, that of the band that calibrates the plate.
    #[arg(long, value_name = "F", value_parser = argument::frequency, allow_hyphen_values = true)]
    from: Option<Typed<f64>>,
    /// The highest frequency.
    #[arg(long, value_name = "F", value_parser = argument::frequency, allow_hyphen_values = true)]
    to: Option<Typed<f64>>,
    /// Number of frequencies, 8 to 1600; by default, as many as calibrate the plate.
    #[arg(long, value_parser = argument::count(POINTS.low as usize, POINTS.high as usize), allow_hyphen_values = true)]
    points: Option<usize>,
}

/// The measured frequencies, and the method.
#[derive(Debug, Args)]
#[command(next_help_heading = "Frequencies")]
pub(super) struct BandArgument {
    #[command(flatten)]
    frequencies: FrequenciesArgument,
    /// Use one tone that glides through the band and a capture of the input, instead of combs of tones. It
    /// has less noise, and excludes the distortion of amplifier and sensor.
    #[arg(long)]
    sweep: bool,
}

impl BandArgument {
    /// The measurement of these frequencies at this level, of a drive whose circuit is perhaps known.
    pub(super) fn request(&self, level: Option<f64>, known: Option<KnownDrive>) -> MeasureRequest {
        MeasureRequest { frequencies: self.frequencies.at(level), is_sweep: self.sweep, known }
    }
}

impl FrequenciesArgument {
    /// These frequencies at this level.
    pub(super) fn at(&self, level: Option<f64>) -> Frequencies {
        let hertz = |typed: &Option<Typed<f64>>| typed.as_ref().map(|typed| typed.value);
        Frequencies { low_hz: hertz(&self.from), high_hz: hertz(&self.to), points: self.points, level }
    }
}

/// A device, and its method of measurement.
pub(super) struct Measurer<'a> {
    pub(super) bench: LoadedDevice<'a>,
    measurer: native::Measurer<'a>,
    /// The method's word beside the progress.
    word: &'static str,
}

impl<'a> Measurer<'a> {
    /// Plans the measurement, and uploads the plate's table.
    pub(super) fn new(
        device: &'a Device,
        plate: &'a Plate,
        request: &MeasureRequest,
    ) -> Result<Self, Failure> {
        let table = device.make_table(plate)?;
        // Refused before the table is uploaded.
        let measurer = native::Measurer::new(device, plate, &table, request).map_err(refused)?;
        let bench = LoadedDevice::with(device, plate, table)?;
        Ok(Self { bench, measurer, word: if request.is_sweep { "sweep" } else { "measuring" } })
    }

    /// The same device with one comb only, over the whole band, or with the same sweep: for repeated
    /// measurements.
    pub(super) fn short(&self) -> Self {
        Self { bench: self.bench.clone(), measurer: self.measurer.short(), word: self.word }
    }

    /// Arms the device, measures, and disarms it.
    pub(super) fn measure(&self, sensor: Sensor) -> Result<Measured, Failure> {
        Ok(progress::reported(self.word, |progress| self.measurer.measure(sensor, progress))?)
    }
}

/// A measurement that cannot be planned: what was asked is refused, a device without inputs fails.
pub(super) fn refused(error: MeasureError) -> Failure {
    if error == MeasureError::NoInputs { Failure::failed(error) } else { Failure::refused(error) }
}

/// A device and what it is to measure.
pub(super) struct ByDevice<'a> {
    pub(super) port: &'a PortArgument,
    pub(super) request: MeasureRequest,
    pub(super) arming: &'a ArmingArgument,
}

impl ByDevice<'_> {
    /// Connects to the device, which may be armed; the simulated one is wired to `rig`, if there is one.
    pub(super) fn connect(&self, rig: Option<&PreparedRig>) -> Result<Device, Failure> {
        let device = Device::connect(&self.port.port()?, rig)?;
        device.may_be_armed(self.arming)?;
        Ok(device)
    }

    /// Plans the measurement, uploads the plate's table, and checks that a known drive is on: what was found of it.
    pub(super) fn measurer<'a>(
        &self,
        device: &'a Device,
        plate: &'a Plate,
        rig: Option<&PreparedRig>,
    ) -> Result<(Measurer<'a>, Option<DriveCheck>), Failure> {
        let measurer = Measurer::new(device, plate, &self.request)?;
        let drive = known_drive::check(&measurer.bench, self.request.known_with(rig))?;
        Ok((measurer, drive))
    }
}

/// Measures the current of the drive, of a piezo or of a coil.
pub(super) fn current(plate: &Plate, by: &ByDevice<'_>, is_piezo: bool) -> Result<Measurement, Failure> {
    let rig = by.port.rig_with_sensor(plate, &RigOptions::default())?;
    let device = by.connect(rig.as_ref())?;
    let (measurer, _) = by.measurer(&device, plate, rig.as_ref())?;
    let measured = measurer.measure(current_sensor())?;
    // The simulated amplifier makes images on request alone.
    let is_unstated = is_piezo && rig.is_none() && by.request.known.is_none();
    let warning = is_unstated.then(|| {
        let highest_hz = measured.measurement.points.last().map_or(0.0, |last| last.frequency_hz);
        // The bound is the same for every capacitance.
        let any = DriveLoad::Piezo { capacitance_f: 1e-9 };
        Bandwidths::default().of_drive(plate).warning(&any, highest_hz, f64::from(SAMPLE_RATE_HZ))
    });
    for warning in warning.flatten().iter().chain(&measured.warnings) {
        output::note(format_args!("slipline: the current: {}", warning.sentence()));
    }
    Ok(measured.measurement)
}

/// Measures with the same sensor at each of its places, one or two. The sensor of a rig is moved
/// automatically; for a device the user is asked to move it.
pub(super) fn at_places(
    plate: &Plate,
    by: &ByDevice<'_>,
    sensor: &SensorArgument,
) -> Result<Vec<Measurement>, Failure> {
    let places: Vec<f64> =
        sensor.places.iter().map(|place| place.of_sensor(plate)).collect::<Result<_, Failure>>()?;
    let first = places.first().filter(|_| places.len() <= 2);
    let Some(&place_m) = first else {
        let given = format_args!("{} --sensor with --port", places.len());
        return Err(Failure::Usage(must_be(given, "1 or 2: two places of one sensor, or one")));
    };
    let kind = sensor.kind.unwrap_or(SensorKind::Displacement);
    if let [near_m, far_m] = places[..] {
        let tolerance_m = Measurement::at(near_m, kind, Vec::new()).place_tolerance_m;
        check_places([near_m, far_m], [tolerance_m; 2]).map_err(Failure::failed)?;
    }
    let body = sensor.body.body()?;
    let options = RigOptions { place_m, sensor: kind, body, ..RigOptions::default() };
    let rig = by.port.rig_with_sensor(plate, &options)?;
    if rig.is_none() && is_standard_input_taken() {
        let why = "the sensor's places are confirmed on standard input, which is a file of this command: name a file";
        return Err(Failure::usage(why));
    }
    let device = by.connect(rig.as_ref())?;
    let (measurer, _) = by.measurer(&device, plate, rig.as_ref())?;
    let measure = |&place_m: &f64| {
        put_sensor(&device, rig.as_ref(), place_m)?;
        let measured = measurer.measure(Sensor { place_m, kind, input: 0, body })?;
        for warning in &measured.warnings {
            output::note(format_args!(
                "slipline: the sensor at {}: {}",
                show_place(place_m),
                warning.sentence()
            ));
        }
        Ok(measured.measurement)
    };
    places.iter().map(measure).collect()
}

/// Moves the sensor to a place, or asks the user to.
fn put_sensor(device: &Device, rig: Option<&PreparedRig>, place_m: f64) -> Result<(), Failure> {
    if let Some(rig) = rig {
        return rig.hand().put_sensor(place_m).map_err(Failure::refused);
    }
    output::note(format_args!(
        "Put the sensor at {} from the driven end, and press Enter.",
        show_place(place_m)
    ));
    let mut line = String::new();
    match device.during(|| std::io::stdin().read_line(&mut line))? {
        Ok(0) => Err(Failure::failed("the sensor's place was not confirmed: the standard input has ended")),
        Ok(_) => Ok(()),
        Err(error) => Err(Failure::Failed(format!("standard input: {}", said(&error)))),
    }
}
