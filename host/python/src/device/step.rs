//! A step of a drive: its tones and their glide, made for the plate in use, and its answer.

use super::Loaded;
use super::wait::sample_index;
use crate::arguments::{in_range, items};
use crate::error::Failure;
use crate::options::Options;
use crate::place::{LEVEL, at_most_one, no_such_tone};
use crate::result::fields;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde_json::{Map, Value};
use slipline_instrument::native::{Client, InterruptibleLink};
use slipline_instrument::requests::ToneRequest;
use slipline_link::protocol::limits::MAX_TONES;
use slipline_link::{Snapshot, Sounding};
use slipline_model::answer::ToneAnswer;
use slipline_model::companions::with_companions;
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::setup::{GLIDE_RANGE_S, Setup, edit};
use slipline_plate::quantity::{Count, Counted, Range, must_be};
use std::sync::Arc;

/// The level of a tone that has none of its own.
const USUAL_LEVEL: f64 = 0.8;
/// The duration of a change that has none of its own.
const USUAL_GLIDE_S: f64 = 0.02;

/// The tone of these places, if one of them is given.
pub(super) fn asked_tone(
    felt_edge_m: Option<f64>,
    turning_point_m: Option<f64>,
    frequency_hz: Option<f64>,
    level: f64,
) -> Result<Option<ToneRequest>, Failure> {
    in_range("level", level, LEVEL)?;
    let asked = at_most_one(felt_edge_m, turning_point_m, frequency_hz)?;
    Ok(asked.map(|asked| ToneRequest { asked, level }))
}

/// A further tone: a dictionary of a place and a level, which is that of the drive by default.
pub(super) fn further_tone(tone: &Bound<'_, PyDict>, level: f64) -> PyResult<ToneRequest> {
    let mut options = Options::new("drive", tone)?;
    let places = ["felt_edge_m", "turning_point_m", "frequency_hz"];
    let [felt_edge_m, turning_point_m, frequency_hz] = places.map(|name| options.number(name));
    let level = options.number_in("level", LEVEL)?.unwrap_or(level);
    options.end()?;
    let tone = asked_tone(felt_edge_m?, turning_point_m?, frequency_hz?, level)?;
    let none =
        || Failure::wrong_arguments("a tone of drive()", "a dictionary such as {\"felt_edge_m\": 0.2}");
    Ok(tone.ok_or_else(none)?)
}

/// Refuses a duration of a change.
pub(super) fn check_glide(glide_s: f64) -> Result<(), Failure> {
    let (low_s, high_s) = GLIDE_RANGE_S;
    in_range("glide_s", glide_s, Range::new(low_s, high_s, "s"))
}

/// Tones, none for silence, and how long the change to them takes.
pub(super) struct Step {
    tones: Vec<ToneRequest>,
    glide_s: f64,
}

impl Step {
    /// Most steps of a sequence.
    pub(super) const MOST: usize = 10_000;

    /// The tones of a drive.
    pub(super) fn of(tones: Vec<ToneRequest>, glide_s: f64) -> Result<Self, Failure> {
        check_glide(glide_s)?;
        let allowed = Count::new(1, MAX_TONES, Counted::Tones);
        if !allowed.contains(tones.len()) {
            let given = format_args!("{} {}", tones.len(), allowed.of);
            return Err(Failure::refused(must_be(given, allowed)));
        }
        Ok(Self { tones, glide_s })
    }

    /// A step of a sequence, with its sample index.
    pub(super) fn read(given: &Bound<'_, PyDict>) -> PyResult<(u64, Self)> {
        let mut options = Options::new("sequence", given)?;
        let Some(at) = options.take("at")? else {
            return Err(Failure::wrong_arguments(
                "a drive of sequence() without at",
                "one with a sample index",
            )
            .into());
        };
        let at = sample_index("at", &at, "a sample index")?;
        let level = options.number_in("level", LEVEL)?.unwrap_or(USUAL_LEVEL);
        let glide_s = options.number("glide_s")?.unwrap_or(USUAL_GLIDE_S);
        let [felt_edge_m, turning_point_m, frequency_hz] =
            ["felt_edge_m", "turning_point_m", "frequency_hz"].map(|name| options.number(name));
        let first = asked_tone(felt_edge_m?, turning_point_m?, frequency_hz?, level)?;
        let further: Vec<Bound<'_, PyDict>> = match options.take("tones")? {
            Some(tones) => items("tones", &tones, MAX_TONES)?,
            None => Vec::new(),
        };
        options.end()?;
        let further = further.iter().map(|tone| further_tone(tone, level));
        let tones = first.map(Ok).into_iter().chain(further).collect::<PyResult<Vec<_>>>()?;
        if tones.is_empty() {
            check_glide(glide_s)?;
            return Ok((at, Self { tones, glide_s }));
        }
        Ok((at, Self::of(tones, glide_s)?))
    }

    /// Makes it for the plate in use.
    pub(super) fn prepare(self, loaded: &Loaded) -> Result<Prepared, Failure> {
        let Self { tones, glide_s } = self;
        let like = Setup { glide_s, ..Setup::new(Arc::clone(&loaded.plate)) };
        let setup = ToneRequest::setup(&tones, like, &loaded.table);
        let setup = setup.map_err(|(_, error)| no_such_tone(error))?;
        let sounding = Sounding::Drive(edit::drive(&setup));
        Prepared::new(loaded.clone(), setup, sounding)
    }
}

/// What sounds on the plate in use.
pub(super) struct Prepared {
    loaded: Loaded,
    setup: Setup,
    pub(super) sounding: Sounding,
}

/// The fields of a drive, as far as they are known when it begins: those of `slipline drive --json`.
#[derive(Serialize)]
struct DriveAnswer<'a> {
    plate: &'a str,
    /// `None` while it waits for the trigger, and for one that never begins.
    at_samples: Option<u64>,
    tones: Vec<ToneAnswer>,
    chord_gain_db: Option<f64>,
    table: TableAnswer,
}

#[derive(Serialize)]
struct TableAnswer {
    crc: String,
}

impl Prepared {
    /// What sounds; refused if the sum of its tones is too large for the plate's table.
    pub(super) fn new(loaded: Loaded, setup: Setup, sounding: Sounding) -> Result<Self, Failure> {
        if !matches!(sounding, Sounding::Chord(_)) {
            let master = setup.master();
            let sum = setup.tones.iter().map(|tone| (tone.position_m, tone.level * master));
            loaded.on_device.check_sum(&sum.collect::<Vec<_>>()).map_err(Failure::refused)?;
        }
        Ok(Self { loaded, setup, sounding })
    }

    /// The same with companions that cancel the drive's harmonics.
    pub(super) fn with_companions(self) -> Result<Self, Failure> {
        let comb = with_companions(&self.setup, &self.loaded.on_device).map_err(Failure::refused)?;
        Ok(Self { setup: self.setup.without_harmonics(), sounding: Sounding::Comb(comb), ..self })
    }

    /// Refuses to play it where the device holds another table by now.
    pub(super) fn check_table(&self, snapshot: &Snapshot) -> Result<(), Failure> {
        let active = snapshot.table.report.active.as_ref();
        if snapshot.is_connected() && active != Some(&self.loaded.on_device.header()) {
            let name = self.loaded.plate.name();
            let text = format!(
                "the device no longer has the table of {name:?}: another thread called use(), or the device was restarted; \
                 call use(plate)"
            );
            return Err(Failure::refused(text));
        }
        Ok(())
    }

    /// Its fields; `at` is the index at which it begins, if known.
    pub(super) fn answer(
        &self,
        client: &Client<InterruptibleLink>,
        at: Option<u64>,
    ) -> Result<Map<String, Value>, Failure> {
        let Loaded { plate, table, on_device } = &self.loaded;
        let setup = self.setup.clone();
        let (places, chord_gain_db) =
            client.during(|| TonePlaces::as_played(setup, Some(&self.sounding), table))?;
        let tones = TonePlaces::on_device(&places, on_device).map(|(tone, hz)| ToneAnswer::of(tone, hz));
        Ok(fields(&DriveAnswer {
            plate: plate.name(),
            at_samples: at,
            tones: tones.collect(),
            chord_gain_db,
            table: TableAnswer { crc: format!("{:08x}", on_device.crc()) },
        }))
    }
}
