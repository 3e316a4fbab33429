//! Drives: tones by their places, and textures.

use super::{ANY, Device, Loaded, lock};
use crate::error::Failure;
use crate::options::Options;
use crate::place::{LEVEL, at_most_one};
use crate::result::{Answer, fields};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use slipline_instrument::native::{Client, InterruptibleLink};
use slipline_instrument::requests::ToneRequest;
use slipline_link::Sounding;
use slipline_link::protocol::command::Apply;
use slipline_link::protocol::limits::MAX_TONES;
use slipline_model::answer::ToneAnswer;
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::setup::{GLIDE_RANGE_S, Setup, edit};
use slipline_model::texture::{chord_of, setup_of, sounding};
use slipline_plate::quantity::{Count, Counted, OutOfRange, Range, must_be};
use slipline_plate::texture::TextureTone;
use std::sync::Arc;

/// The fields of a drive, as far as they are known when it begins: those of `slipline drive --json`.
#[derive(Serialize)]
struct DriveAnswer<'a> {
    plate: &'a str,
    /// `None` while it waits for the trigger.
    at_samples: Option<u64>,
    tones: Vec<ToneAnswer>,
    chord_gain_db: Option<f64>,
    table: TableAnswer,
}

#[derive(Serialize)]
struct TableAnswer {
    crc: String,
}

/// The tone of these places, if one of them is given.
pub(super) fn asked_tone(
    felt_edge_m: Option<f64>,
    turning_point_m: Option<f64>,
    frequency_hz: Option<f64>,
    level: f64,
) -> Result<Option<ToneRequest>, Failure> {
    OutOfRange::check("level", level, LEVEL).map_err(|it| Failure::out_of_range(&it))?;
    let asked = at_most_one(felt_edge_m, turning_point_m, frequency_hz)?;
    Ok(asked.map(|asked| ToneRequest { asked, level }))
}

/// A further tone: a dictionary of a place and a level, which is that of the drive by default.
pub(super) fn further_tone(tone: &Bound<'_, PyDict>, level: f64) -> PyResult<ToneRequest> {
    let mut options = Options::new("drive", Some(tone))?;
    let places = ["felt_edge_m", "turning_point_m", "frequency_hz"];
    let [felt_edge_m, turning_point_m, frequency_hz] = places.map(|name| options.number(name, ANY));
    let level = options.number("level", LEVEL)?.unwrap_or(level);
    options.end()?;
    let tone = asked_tone(felt_edge_m?, turning_point_m?, frequency_hz?, level)?;
    let none =
        || Failure::wrong_arguments("a tone of drive()", "a dictionary such as {\"felt_edge_m\": 0.2}");
    Ok(tone.ok_or_else(none)?)
}

/// When a drive begins: a sample index, or a word.
#[derive(Clone, Debug, FromPyObject)]
pub(crate) enum At {
    /// A sample index.
    Index(u64),
    /// `"trigger"`.
    Word(String),
}

impl At {
    pub(super) fn apply(at: Option<Self>) -> Result<Apply, Failure> {
        match at {
            None => Ok(Apply::Next),
            Some(Self::Index(index)) => Ok(Apply::At(index)),
            Some(Self::Word(word)) if word == "trigger" => Ok(Apply::AtTrigger),
            Some(Self::Word(word)) => {
                let given = format_args!("at = {word:?}");
                Err(Failure::wrong_arguments(given, "None, a sample index, or \"trigger\""))
            }
        }
    }
}

impl Device {
    /// Drives these tones.
    pub(super) fn drive_tones(
        &self,
        py: Python<'_>,
        tones: Vec<ToneRequest>,
        glide_s: f64,
        apply: Apply,
    ) -> PyResult<Answer> {
        let (low_s, high_s) = GLIDE_RANGE_S;
        OutOfRange::check("glide_s", glide_s, Range::new(low_s, high_s, "s"))
            .map_err(|it| Failure::out_of_range(&it))?;
        let allowed = Count::new(1, MAX_TONES, Counted::Tones);
        if !allowed.contains(tones.len()) {
            let given = format_args!("{} {}", tones.len(), allowed.of);
            return Err(Failure::refused(must_be(given, allowed)).into());
        }
        let loaded = self.loaded()?;
        self.sound(py, apply, move |_| {
            let like = Setup { glide_s, ..Setup::new(Arc::clone(&loaded.plate)) };
            let setup = ToneRequest::setup(&tones, like, &loaded.table);
            let setup = setup.map_err(|(_, error)| Failure::of(&error))?;
            let sounding = Sounding::Drive(edit::drive(&setup));
            Ok((loaded, setup, sounding))
        })
    }

    /// Plays a texture of the plate in use.
    pub(super) fn play_texture(
        &self,
        py: Python<'_>,
        texture: &Bound<'_, Answer>,
        glide_s: f64,
        apply: Apply,
    ) -> PyResult<Answer> {
        let (low_s, high_s) = GLIDE_RANGE_S;
        OutOfRange::check("glide_s", glide_s, Range::new(low_s, high_s, "s"))
            .map_err(|it| Failure::out_of_range(&it))?;
        let loaded = self.loaded()?;
        let plate: String = texture.getattr("plate")?.extract()?;
        if plate != loaded.plate.name() {
            let own = loaded.plate.name();
            let text =
                format!("the texture is one of the plate {plate:?}, and the device has the table of {own:?}");
            return Err(Failure::refused(text).into());
        }
        let number = |of: &Bound<'_, PyAny>, name: &str| of.getattr(name)?.extract::<f64>();
        let mut tones = Vec::new();
        for tone in texture.getattr("tones")?.try_iter()? {
            let tone = tone?;
            tones.push(TextureTone {
                position_m: number(&tone, "turning_point_m")?,
                frequency_hz: number(&tone, "frequency_hz")?,
                level: number(&tone, "level")?,
                phase_turns: number(&tone, "phase_turns")?,
            });
        }
        let chord = texture.getattr("chord")?;
        let chord_gain_db: Option<f64> =
            if chord.is_none() { None } else { chord.getattr("chord_gain_db")?.extract()? };
        self.sound(py, apply, move |client| {
            let setup = setup_of(Arc::clone(&loaded.plate), &tones);
            let setup = Setup { chord_gain_db, glide_s, ..setup };
            let chord = chord_of(&setup, &loaded.on_device);
            let sounding = sounding(&setup, chord, &loaded.on_device, &client.snapshot());
            let sounding = sounding.map_err(|error| Failure::of(&error))?;
            Ok((loaded, setup, sounding))
        })
    }

    /// Plays what is made, and answers with its beginning and its tones.
    fn sound(
        &self,
        py: Python<'_>,
        apply: Apply,
        make: impl FnOnce(&Client<InterruptibleLink>) -> Result<(Loaded, Setup, Sounding), Failure> + Send,
    ) -> PyResult<Answer> {
        let (at, answer) = self.call(py, move |client| {
            if apply == Apply::AtTrigger && client.snapshot().has_trigger_input() == Some(false) {
                return Err(Failure::refused("the device has no trigger input: leave out at=\"trigger\""));
            }
            let (loaded, setup, sounding) = make(client)?;
            let Loaded { plate, table, on_device } = &loaded;
            if !matches!(sounding, Sounding::Chord(_)) {
                let master = setup.master();
                let sum = setup.tones.iter().map(|tone| (tone.position_m, tone.level * master));
                let checked = on_device.check_sum(&sum.collect::<Vec<_>>());
                checked.map_err(Failure::refused)?;
            }
            let at = client.play(sounding.clone().beginning(apply))?;
            let (places, chord_gain_db) =
                client.during(|| TonePlaces::as_played(setup, Some(&sounding), table))?;
            let tones = TonePlaces::on_device(&places, on_device).map(|(tone, hz)| ToneAnswer::of(tone, hz));
            let answer = DriveAnswer {
                plate: plate.name(),
                at_samples: (apply != Apply::AtTrigger).then_some(at),
                tones: tones.collect(),
                chord_gain_db,
                table: TableAnswer { crc: format!("{:08x}", on_device.crc()) },
            };
            Ok((at, fields(&answer)))
        })?;
        let waits = apply == Apply::AtTrigger;
        {
            let mut state = lock(&self.state);
            (state.began, state.accepted) = ((!waits).then_some(at), waits.then_some(at));
        }
        Answer::of(py, answer)
    }
}
