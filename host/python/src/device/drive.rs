//! Drives: tones by their places, and textures.

use super::step::{Prepared, Step, check_glide};
use super::wait::{Limits, sample_index};
use super::{Device, lock};
use crate::error::Failure;
use crate::result::Answer;
use crate::result::kind::Drive;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::PyString;
use pyo3::{Borrowed, type_hint_identifier, type_hint_union};
use serde_json::{Map, Value};
use slipline_instrument::native::{Client, ClientError, InterruptibleLink, TimedDrive};
use slipline_instrument::requests::ToneRequest;
use slipline_link::Sounding;
use slipline_link::protocol::command::Apply;
use slipline_model::setup::Setup;
use slipline_model::texture::{chord_of, setup_of, sounding};
use slipline_plate::texture::TextureTone;
use std::sync::Arc;

/// When a drive begins: a sample index, or with the trigger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum At {
    /// A sample index.
    Index(u64),
    /// The rise of the trigger input.
    Trigger,
}

/// What is allowed for it.
const BEGINNINGS: &str = "None, a sample index, or \"trigger\"";

impl<'a, 'py> FromPyObject<'a, 'py> for At {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = type_hint_union!(
        <u64 as FromPyObject<'a, 'py>>::INPUT_TYPE,
        type_hint_identifier!("builtins", "str")
    );

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match given.cast::<PyString>() {
            Ok(word) if word.to_str()? == "trigger" => Ok(Self::Trigger),
            Ok(word) => {
                let given = format_args!("at = {:?}", word.to_str()?);
                Err(Failure::wrong_arguments(given, BEGINNINGS).into())
            }
            Err(_) => sample_index("at", &given, BEGINNINGS).map(Self::Index),
        }
    }
}

impl At {
    /// When the device begins.
    pub(super) const fn begin(at: Option<Self>) -> Apply {
        match at {
            None => Apply::Next,
            Some(Self::Index(index)) => Apply::At(index),
            Some(Self::Trigger) => Apply::AtTrigger,
        }
    }
}

/// What becomes of a drive when it is sent.
enum Sent {
    /// It begins at this index, or waits for the trigger since then.
    Accepted(u64),
    /// A newer drive or a stop of another thread took its place.
    Superseded,
}

impl Device {
    /// Drives these tones.
    pub(super) fn drive_tones(
        &self,
        py: Python<'_>,
        tones: Vec<ToneRequest>,
        glide_s: f64,
        apply: Apply,
        cancels: bool,
    ) -> PyResult<Answer<Drive>> {
        let step = Step::of(tones, glide_s)?;
        let loaded = self.loaded()?;
        self.sound(py, apply, move |_| {
            let prepared = step.prepare(&loaded)?;
            if cancels { prepared.with_companions() } else { Ok(prepared) }
        })
    }

    /// Plays a texture of the plate in use.
    pub(super) fn play_texture(
        &self,
        py: Python<'_>,
        texture: &Bound<'_, PyAny>,
        glide_s: f64,
        apply: Apply,
    ) -> PyResult<Answer<Drive>> {
        check_glide(glide_s)?;
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
            Prepared::new(loaded, setup, sounding)
        })
    }

    /// Plays what is made, and answers with its beginning and its tones.
    fn sound(
        &self,
        py: Python<'_>,
        apply: Apply,
        make: impl FnOnce(&Client<InterruptibleLink>) -> Result<Prepared, Failure> + Send,
    ) -> PyResult<Answer<Drive>> {
        let waits = apply == Apply::AtTrigger;
        let (sent, answer) = self.call(py, move |client| {
            if waits && client.snapshot().has_trigger_input() == Some(false) {
                return Err(Failure::refused("the device has no trigger input: leave out at=\"trigger\""));
            }
            let prepared = make(client)?;
            prepared.check_table(&client.snapshot())?;
            let sent = send(client, prepared.sounding.clone(), apply)?;
            let at = if let Sent::Accepted(at) = sent { Some(at).filter(|_| !waits) } else { None };
            Ok((sent, prepared.answer(client, at)?))
        })?;
        if let Sent::Accepted(at) = sent {
            let mut state = lock(&self.state);
            (state.began, state.accepted) = ((!waits).then_some(at), waits.then_some(at));
        }
        result_of(py, answer, matches!(sent, Sent::Superseded))
    }

    /// Plays each of these steps from its index on.
    pub(super) fn play_steps(
        &self,
        py: Python<'_>,
        steps: Vec<(u64, Step)>,
        limits: Limits,
    ) -> PyResult<Vec<Answer<Drive>>> {
        let loaded = self.loaded()?;
        let (began, answers) = self.call(py, move |client| {
            let mut wait = limits.begin(client);
            let made = client.during(|| {
                let steps = steps.into_iter();
                steps.map(|(at, step)| Ok((at, step.prepare(&loaded)?))).collect::<Result<Vec<_>, Failure>>()
            })??;
            if let Some((_, prepared)) = made.first() {
                prepared.check_table(&client.snapshot())?;
            }
            let drives =
                made.iter().map(|(at, prepared)| TimedDrive { at: *at, sounding: prepared.sounding.clone() });
            let began = client.play_each(drives.collect(), || wait.goes_on())?;
            wait.check()?;
            let answers = made.iter().zip(&began).map(|((_, prepared), &at)| prepared.answer(client, at));
            let answers = answers.collect::<Result<Vec<_>, Failure>>()?;
            Ok((began, answers))
        })?;
        if let Some(at) = began.iter().copied().flatten().last() {
            let mut state = lock(&self.state);
            (state.began, state.accepted) = (Some(at), None);
        }
        let results = answers.into_iter().zip(began);
        results.map(|(answer, at)| result_of(py, answer, at.is_none())).collect()
    }

    /// Ends what sounds at this sample index; returns the index at which it begins to fade.
    pub(super) fn stop_at(&self, py: Python<'_>, at: u64, glide_s: f64) -> PyResult<u64> {
        check_glide(glide_s)?;
        let limits = Limits::new(None, None)?;
        self.call(py, move |client| {
            let mut wait = limits.begin(client);
            match client.stop_at(at, glide_s, || wait.goes_on())? {
                Some(at) => Ok(at),
                // Another thread has stopped it, or drives.
                None => Ok(client.refresh()?),
            }
        })
    }
}

/// Sends what sounds; an index that is far ahead, or behind another change, is waited for.
fn send(client: &Client<InterruptibleLink>, sounding: Sounding, apply: Apply) -> Result<Sent, ClientError> {
    let stops = client.stops();
    let sent = match apply {
        Apply::At(at) => client.play_at(TimedDrive { at, sounding }, || client.stops() == stops),
        Apply::Next | Apply::AtTrigger => client.play(sounding.beginning(apply)).map(Some),
    };
    match sent {
        Ok(Some(at)) => Ok(Sent::Accepted(at)),
        Ok(None) | Err(ClientError::Superseded) => Ok(Sent::Superseded),
        Err(error) => Err(error),
    }
}

fn result_of(py: Python<'_>, answer: Map<String, Value>, is_superseded: bool) -> PyResult<Answer<Drive>> {
    Answer::of(py, answer)?.with(py, "superseded", is_superseded)
}
