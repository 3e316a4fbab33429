//! `Plate.simulate`.

use crate::actual::{self, PlateArgument};
use crate::arguments::{ArrayLike, OneOrMore, in_range};
use crate::error::Failure;
use crate::feeling;
use crate::place::{LEVEL, exactly_one, no_such_tone, setup_file};
use crate::result::kind::Simulation;
use crate::result::{Answer, fields};
use crate::waiting::compute;
use pyo3::prelude::*;
use serde_json::{Map, Value};
use slipline_instrument::requests::{NamedFeeling, SimulateRequest, ToneRequest};
use slipline_link::DeviceTable;
use slipline_link::protocol::limits::MAX_TONES;
use slipline_link::simulator::loopback::Loopback;
use slipline_model::field::asked_place::AskedPlace;
use slipline_model::field::simulation::{
    MAX_SECONDS, SAMPLE_RATE_HZ, SimulationError, Solver, table_for_watched,
};
use slipline_model::setup::Setup;
use slipline_model::texture::{chord_of, sounding};
use slipline_plate::quantity::{PlaceOrFrequency, Range};
use slipline_plate::{DriveTable, Finger, Plate, Progress};
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::available_parallelism;

/// The level of a tone that has none of its own.
const USUAL_LEVEL: f64 = 0.8;
/// Most threads of a sheet.
const THREADS_MAX: usize = 64;

/// What sounds: tones, each by its place and level, or a setup of a file.
enum Sounds {
    Tones(Vec<ToneRequest>),
    Setup(Box<Setup>),
}

/// A drive to simulate.
struct Drive {
    request: SimulateRequest,
    sounds: Sounds,
    feeling: NamedFeeling,
}

/// The options of a simulation.
pub(crate) struct Options<'py> {
    pub(crate) actual_plate: Option<PlateArgument<'py>>,
    pub(crate) duration_s: Option<f64>,
    pub(crate) no_table: bool,
    pub(crate) sheet: bool,
    pub(crate) finger: Option<Finger>,
    pub(crate) feeling: Option<PathBuf>,
    pub(crate) setup: Option<PathBuf>,
}

/// Simulates tones by their felt edges, turning points or frequencies, one of the three.
pub(crate) fn run(
    py: Python<'_>,
    plate: &Arc<Plate>,
    places: [Option<ArrayLike<'_>>; 3],
    level: Option<ArrayLike<'_>>,
    options: Options<'_>,
) -> PyResult<Answer<Simulation>> {
    let Options { actual_plate, duration_s: seconds, no_table, sheet: is_sheet, finger, feeling, setup } =
        options;
    let has_gains = !no_table;
    seconds.map_or(Ok(()), |it| in_range("duration_s", it, Range::new(0.01, MAX_SECONDS, "s")))?;
    let feeling = feeling::read(feeling.as_deref())?;
    let threads = available_parallelism().map_or(1, |count| count.get().min(THREADS_MAX));
    let solver = if is_sheet { Solver::Sheet { threads } } else { Solver::Line };
    let (plate, sounds, feeling) = match setup {
        None => (Arc::clone(plate), Sounds::Tones(tones(places, level)?), feeling),
        Some(path) if places.iter().all(Option::is_none) && level.is_none() => {
            let path = path.to_string_lossy();
            let setup = setup_file(&path)?;
            let feeling = NamedFeeling::of_setup(&setup, path.into_owned());
            (Arc::clone(&setup.plate), Sounds::Setup(setup), feeling)
        }
        Some(_) => {
            let given = "a setup beside a place or a level";
            return Err(Failure::wrong_arguments(given, "alone: the file has its tones").into());
        }
    };
    let has_felt_edge = matches!(&sounds, Sounds::Tones(tones)
        if tones.iter().any(|tone| matches!(tone.asked, AskedPlace::FeltEdge(_))));
    if !has_gains && (has_felt_edge || matches!(sounds, Sounds::Setup(_))) {
        let given = "no_table beside felt_edge_m or a setup";
        return Err(Failure::wrong_arguments(given, "False: the table's gains set them").into());
    }
    let actual = actual_plate.map(|given| actual::plate(&given, Some(&plate))).transpose()?;
    let request = SimulateRequest { plate, actual, has_gains, seconds, solver, finger };
    let drive = Drive { request, sounds, feeling };
    let found = compute(py, move |progress| drive.simulate(progress))?;
    Answer::of(py, found)
}

/// The tones of the arguments.
fn tones(places: [Option<ArrayLike<'_>>; 3], level: Option<ArrayLike<'_>>) -> PyResult<Vec<ToneRequest>> {
    let [felt_edges_m, turning_points_m, frequencies_hz] = places;
    let numbers = |given: Option<ArrayLike<'_>>, name: &str| -> PyResult<Option<Vec<f64>>> {
        let numbers = given.map(|given| given.one_or_more(name, MAX_TONES)).transpose()?;
        Ok(numbers.map(OneOrMore::numbers))
    };
    let felt_edges_m = numbers(felt_edges_m, "felt_edge_m")?;
    let turning_points_m = numbers(turning_points_m, "turning_point_m")?;
    let frequencies_hz = numbers(frequencies_hz, "frequency_hz")?;
    let first = |given: &Option<Vec<f64>>| given.as_ref().map(|_| 0.0);
    // Counts the arguments; an empty series is one, too.
    exactly_one(first(&felt_edges_m), first(&turning_points_m), first(&frequencies_hz))?;
    let felt_edges = felt_edges_m.into_iter().flatten().map(AskedPlace::FeltEdge);
    let turning_points = turning_points_m.into_iter().flatten().map(PlaceOrFrequency::Place);
    let frequencies = frequencies_hz.into_iter().flatten().map(PlaceOrFrequency::Frequency);
    let asked: Vec<AskedPlace> =
        felt_edges.chain(turning_points.chain(frequencies).map(AskedPlace::TurningPoint)).collect();
    let level = level.map(|given| given.one_or_more("level", MAX_TONES)).transpose()?;
    let levels = level.unwrap_or(OneOrMore::One(USUAL_LEVEL)).numbers();
    let levels = match levels[..] {
        [level] => vec![level; asked.len()],
        _ => levels,
    };
    if levels.len() != asked.len() {
        let given = format_args!("{} levels of {} tones", levels.len(), asked.len());
        return Err(Failure::wrong_arguments(given, "one for all tones, or one for each").into());
    }
    for &level in &levels {
        in_range("level", level, LEVEL)?;
    }
    Ok(asked.into_iter().zip(levels).map(|(asked, level)| ToneRequest { asked, level }).collect())
}

impl Drive {
    fn simulate(&self, progress: &mut Progress<'_>) -> Result<Map<String, Value>, Failure> {
        let failed = |error: SimulationError| Failure::of(&error);
        let mut part = progress.part(0.0, 0.1);
        let (table, device_table) =
            table_for_watched(&self.request.plate, SAMPLE_RATE_HZ, &mut part).map_err(failed)?;
        let setup = self.setup(&table)?;
        let sounding = match self.sounds {
            Sounds::Tones(_) => None,
            Sounds::Setup(_) => Some(played(&setup, &device_table)?),
        };
        let planned = self.request.plan(setup, sounding, &table).map_err(|error| Failure::of(&error))?;
        let result = planned.run(&mut progress.part(0.1, 1.0)).map_err(failed)?;
        Ok(fields(&planned.drive(&self.feeling, &result).answer()))
    }

    /// The setup that sounds.
    fn setup(&self, table: &DriveTable) -> Result<Setup, Failure> {
        let tones = match &self.sounds {
            Sounds::Setup(setup) => return Ok((**setup).clone()),
            Sounds::Tones(tones) => tones,
        };
        let (plate, feeling) = (Arc::clone(&self.request.plate), self.feeling.feeling);
        let setup = ToneRequest::setup(tones, Setup { feeling, ..Setup::new(plate) }, table);
        setup.map_err(|(_, error)| no_such_tone(error))
    }
}

/// What plays the setup of a file: its chord if it has one that the device can play, otherwise its tones.
fn played(setup: &Setup, table: &DeviceTable) -> Result<slipline_link::Sounding, Failure> {
    let chain = Loopback::connect(SAMPLE_RATE_HZ).map_err(|error| Failure::of(&error))?;
    sounding(setup, chord_of(setup, table), table, chain.view()).map_err(|error| Failure::of(&error))
}
