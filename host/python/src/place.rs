//! The place of a tone: `felt_edge_m`, `turning_point_m` or `frequency_hz`, one of them.

use crate::arguments::in_range;
use crate::error::Failure;
use slipline_model::atomic_file::{read_text, said};
use slipline_model::field::asked_place::{AskedPlace, NoSuchTone, turning_point_on};
use slipline_model::field::simulation::{SAMPLE_RATE_HZ, table_for_watched};
use slipline_model::setup::Setup;
use slipline_model::setup::file::{self, Opened};
use slipline_plate::quantity::{PlaceOrFrequency, Range};
use slipline_plate::{DriveTable, Plate, Progress};
use std::path::Path;
use std::sync::Arc;

/// Level of a tone, over the table's full scale.
pub(crate) const LEVEL: Range = Range::new(0.0, 1.0, "");

/// The place that is asked for; `None` for none. A `TypeError` for more than one.
pub(crate) fn at_most_one(
    felt_edge_m: Option<f64>,
    turning_point_m: Option<f64>,
    frequency_hz: Option<f64>,
) -> Result<Option<AskedPlace>, Failure> {
    let asked = [
        felt_edge_m.map(AskedPlace::FeltEdge),
        turning_point_m.map(|place_m| AskedPlace::TurningPoint(PlaceOrFrequency::Place(place_m))),
        frequency_hz.map(|hz| AskedPlace::TurningPoint(PlaceOrFrequency::Frequency(hz))),
    ];
    let mut asked = asked.into_iter().flatten();
    match (asked.next(), asked.next()) {
        (place, None) => Ok(place),
        (_, Some(_)) => Err(count_of_places("more than one place")),
    }
}

/// The place that is asked for. A `TypeError` for none and for more than one.
pub(crate) fn exactly_one(
    felt_edge_m: Option<f64>,
    turning_point_m: Option<f64>,
    frequency_hz: Option<f64>,
) -> Result<AskedPlace, Failure> {
    at_most_one(felt_edge_m, turning_point_m, frequency_hz)?.ok_or_else(|| count_of_places("no place"))
}

fn count_of_places(given: &str) -> Failure {
    Failure::wrong_arguments(given, "one of felt_edge_m, turning_point_m and frequency_hz")
}

/// The turning point of a tone of this level and of a usual finger, in metres; a felt edge needs the table, which is made.
pub(crate) fn turning_point_m(
    asked: AskedPlace,
    plate: &Arc<Plate>,
    level: f64,
    progress: &mut Progress<'_>,
) -> Result<f64, Failure> {
    in_range("level", level, LEVEL)?;
    if let AskedPlace::TurningPoint(place) = asked {
        return turning_point_on(place, plate).map_err(|refused| Failure::of(&refused));
    }
    let (table, _) =
        table_for_watched(plate, SAMPLE_RATE_HZ, progress).map_err(|error| Failure::of(&error))?;
    turning_point_of(asked, &Setup::new(Arc::clone(plate)), level, &table)
}

/// The turning point of a tone of this level on the plate of a setup, in metres; `table` is that of the plate.
pub(crate) fn turning_point_of(
    asked: AskedPlace,
    setup: &Setup,
    level: f64,
    table: &DriveTable,
) -> Result<f64, Failure> {
    asked.turning_point_m(setup, level, table).map_err(no_such_tone)
}

/// Why no tone is as asked.
pub(crate) fn no_such_tone(error: NoSuchTone) -> Failure {
    match &error {
        NoSuchTone::OutOfRange(refused) => Failure::of(refused),
        &NoSuchTone::NoFeltEdge(place_m, ref refused) => {
            // Of several intervals the nearest.
            let away_m = |&(low_m, high_m): &(f64, f64)| (low_m - place_m).max(place_m - high_m);
            let nearest = refused.reach_m.iter().copied().min_by(|a, b| away_m(a).total_cmp(&away_m(b)));
            match nearest {
                Some(reach_m) => Failure::number(error.to_string(), "felt_edge_m", place_m, reach_m),
                None => Failure::refused(&error),
            }
        }
    }
}

/// The setup of a file.
pub(crate) fn setup_file(path: &str) -> Result<Box<Setup>, Failure> {
    let bad = |why: &dyn std::fmt::Display| Failure::bad_file(path, why);
    let text = read_text(Path::new(path), file::FILE_BYTES_MAX).map_err(|error| bad(&said(&error)))?;
    match file::read(&text).map_err(|error| bad(&error))? {
        Opened::Setup(setup) => Ok(setup),
        Opened::Plate(_) => Err(bad(&"a plate alone, without tones")),
    }
}
