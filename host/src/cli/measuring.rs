//! A measurement with a device: for `measure` and `calibrate`.

use super::argument::{self, Typed};
use super::device::Device;
use super::measured_file::SensorArgument;
use super::{ArmingArgument, Failure, PortArgument, progress};
use clap::Args;
use slipline_link::protocol::event::State;
use slipline_link::{DeviceTable, Request};
use slipline_model::measure::{MeasureError, Measured, Measuring, POINTS, Plan, Sensor, Step, Wanted};
use slipline_model::rig::{PreparedRig, RigOptions};
use slipline_plate::Plate;
use slipline_plate::calibrate::{Measurement, SensorKind};
use slipline_plate::quantity::{Measure, Range, must_be, show_place};
use std::sync::Arc;
use std::time::Duration;

/// Time between two looks at the device.
const GLANCE: Duration = Duration::from_millis(50);

/// Looks until what sounds must have faded.
const FADING: usize = 100;

/// Which frequencies, and how loud.
#[derive(Debug, Args)]
pub(super) struct BandArgument {
    /// The lowest frequency; without it, that of the band that calibrates the plate.
    #[arg(long, value_name = "F", value_parser = argument::frequency, allow_hyphen_values = true)]
    from: Option<Typed<f64>>,
    /// The highest frequency.
    #[arg(long, value_name = "F", value_parser = argument::frequency, allow_hyphen_values = true)]
    to: Option<Typed<f64>>,
    /// How many frequencies, 8 to 1600; without it, as many as calibrate the plate.
    #[arg(long, value_parser = argument::count(POINTS.low as usize, POINTS.high as usize), allow_hyphen_values = true)]
    points: Option<usize>,
}

impl BandArgument {
    fn wanted(&self, plate: &Plate, level: Option<f64>) -> Wanted {
        let of_plate = Wanted::of(plate);
        let hertz = |typed: &Option<Typed<f64>>, or: f64| typed.as_ref().map_or(or, |typed| typed.value);
        Wanted {
            low_hz: hertz(&self.from, of_plate.low_hz),
            high_hz: hertz(&self.to, of_plate.high_hz),
            points: self.points.unwrap_or(of_plate.points),
            level: level.unwrap_or(of_plate.level),
        }
    }
}

/// A place on a plate, metres.
pub(super) fn place_on(plate: &Plate, place: &Typed<f64>) -> Result<f64, Failure> {
    let on_plate = Range::new(0.0, plate.length_m(), "m");
    place.within("--sensor", on_plate, Measure::Length, ", on the plate")
}

/// A device that holds a plate's table, and the combs that measure that plate.
pub(super) struct Bench<'a> {
    device: &'a Device,
    plan: Plan,
    table: Arc<DeviceTable>,
}

impl<'a> Bench<'a> {
    /// Has the device hold the plate's table.
    pub(super) fn new(
        device: &'a Device,
        plate: &Plate,
        band: &BandArgument,
        level: Option<f64>,
    ) -> Result<Self, Failure> {
        let rate_hz = f64::from(device.identity()?.sample_rate_hz);
        let lock_ins = device.snapshot().inputs.map_or(0, |inputs| usize::from(inputs.lock_ins));
        let plan =
            Plan::new(plate, &band.wanted(plate, level), rate_hz, lock_ins).map_err(|error| match error {
                MeasureError::NoInputs => Failure::failed(error),
                error => Failure::usage(error),
            })?;
        let table = device.use_table(plate)?;
        Ok(Self { device, plan, table })
    }

    /// Arms the device, measures, and disarms it.
    pub(super) fn measure(&self, sensor: Sensor) -> Result<Measured, Failure> {
        let inputs = self.device.snapshot().inputs.unwrap_or_default();
        let mut measuring = Measuring::new(self.plan.clone(), self.table.clone(), sensor, &inputs)
            .map_err(Failure::failed)?;
        self.device.arm()?;
        progress::watched("measuring", |progress| {
            let mut ticket = None;
            loop {
                let snapshot = self.device.snapshot();
                measuring.watch(&snapshot);
                // Nobody asks for an end by the progress.
                let _ = progress.at(measuring.progress(snapshot.status.map_or(0, |status| status.now)));
                match measuring.step() {
                    Step::Ask(request) => ticket = Some(self.device.handle().send(request)),
                    Step::Wait => {
                        let outcome = ticket.and_then(|ticket| self.device.wait(ticket, GLANCE));
                        if let Some(outcome) = outcome {
                            measuring.take(&outcome);
                        }
                    }
                    Step::Ended => break,
                }
            }
        });
        self.device.check_attended()?;
        let measured = measuring.finish().map_err(Failure::failed)?;
        self.disarm()?;
        Ok(measured)
    }

    /// Disarms the device, and waits until what sounded has faded: it is armed again in silence only.
    fn disarm(&self) -> Result<(), Failure> {
        self.device.perform(Request::Disarm)?;
        for _ in 0..FADING {
            self.device.perform(Request::Refresh)?;
            if self.device.snapshot().status.is_some_and(|status| status.state != State::Stopping) {
                break;
            }
            self.device.pause(GLANCE);
        }
        Ok(())
    }
}

/// Measures with the same sensor at each of its places, one or two. The sensor of a rig is moved; a person is asked to move that
/// of a device.
pub(super) fn at_places(
    plate: &Plate,
    port: &PortArgument,
    sensor: &SensorArgument,
    band: &BandArgument,
    level: Option<f64>,
    arming: &ArmingArgument,
) -> Result<Vec<Measurement>, Failure> {
    let places: Vec<f64> =
        sensor.places.iter().map(|place| place_on(plate, place)).collect::<Result<_, Failure>>()?;
    let first = places.first().filter(|_| places.len() <= 2);
    let Some(&place_m) = first else {
        let given = format_args!("{} --sensor with --port", places.len());
        return Err(Failure::Usage(must_be(given, "1 or 2: two places of one sensor, or one")));
    };
    let kind = sensor.kind.unwrap_or(SensorKind::Displacement);
    let rig = port.rig_with_sensor(plate, &RigOptions { place_m, sensor: kind, ..RigOptions::default() })?;
    let device = Device::connect(&port.port, rig.as_ref())?;
    device.may_be_armed(arming)?;
    let bench = Bench::new(&device, plate, band, level)?;
    let measure = |&place_m: &f64| {
        put_sensor(&device, rig.as_ref(), place_m)?;
        let measured = bench.measure(Sensor { place_m, kind, input: 0 })?;
        for warning in &measured.warnings {
            eprintln!("slipline: the sensor at {}: {}", show_place(place_m), warning.sentence());
        }
        Ok(measured.measurement)
    };
    places.iter().map(measure).collect()
}

/// Has the sensor stand at a place.
fn put_sensor(device: &Device, rig: Option<&PreparedRig>, place_m: f64) -> Result<(), Failure> {
    if let Some(rig) = rig {
        return rig.hand().put_sensor(place_m).map_err(Failure::usage);
    }
    eprintln!("Put the sensor at {} from the driven end, and press Enter.", show_place(place_m));
    let mut line = String::new();
    match device.during(|| std::io::stdin().read_line(&mut line)) {
        Ok(0) => Err(Failure::Failed(
            "nobody says that the sensor stands: the standard input has ended".to_owned(),
        )),
        Ok(_) => Ok(()),
        Err(error) => Err(Failure::Failed(format!("standard input: {error}"))),
    }
}
