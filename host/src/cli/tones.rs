//! The tones of a command, each by its felt edge, its turning point or its frequency.
//!
//! ```text
//! --felt-edge, --turning-point --> AskedTones, checked against the plate's span
//!                                      --table, feeling--> ToneSetups, or the reachable felt edges
//! ```

use super::argument::{self, PlaceArgument, level};
use super::failure::Failure;
use super::feeling::FeelingArgument;
use clap::Args;
use slipline_instrument::requests::{NamedFeeling, ToneRequest};
use slipline_link::protocol::limits::MAX_TONES;
use slipline_model::field::asked_place::{AskedPlace, NoSuchTone};
use slipline_model::field::tone_places::TonePlaces;
pub(super) use slipline_model::setup::BoundaryMode as PlaceKind;
use slipline_model::setup::{Setup, ToneSetup};
use slipline_plate::quantity::{
    Count, Counted, Measure, PlaceOrFrequency, must_be, show_frequency, show_place, show_range,
};
use slipline_plate::{DriveTable, Plate};
use std::sync::Arc;

/// The prefix of an option; the words of lines have no dashes.
const OPTION: &str = "--";

/// The tones.
#[derive(Debug, Args)]
#[command(next_help_heading = "Tones")]
pub(super) struct TonesArgument {
    /// A tone by its felt edge, the place where a finger feels it end (250mm), or by its frequency (126Hz); with a level
    /// of its own after a colon (250mm:0.5). Repeated for more tones, up to 16.
    #[arg(long = "felt-edge", value_name = "X[:LEVEL]", value_parser = tone, allow_hyphen_values = true, conflicts_with = "turning_points")]
    felt_edges: Vec<ToneArgument>,
    /// A tone by its turning point, the place where its wave turns (120mm), or by its frequency (126Hz); with a level of
    /// its own after a colon (120mm:0.5). Repeated for more tones, up to 16.
    #[arg(long = "turning-point", value_name = "X[:LEVEL]", value_parser = tone, allow_hyphen_values = true)]
    turning_points: Vec<ToneArgument>,
    /// The level of each tone that has none of its own, 0 to 1 of the table's full scale.
    #[arg(long, value_parser = level, allow_hyphen_values = true, default_value = "0.8")]
    level: f64,
    #[command(flatten)]
    feeling: FeelingArgument,
    #[command(flatten)]
    gone: GoneArgument,
}

/// A tone on the command line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ToneArgument {
    at: PlaceArgument,
    level: Option<f64>,
    /// As it was typed.
    text: String,
}

/// Parses `120mm` or `120mm:0.5`, a place or a frequency, and a level.
pub(super) fn tone(text: &str) -> Result<ToneArgument, String> {
    let (at, level) = match text.rsplit_once(':') {
        Some((at, loudness)) => (at, Some(level(loudness).map_err(|error| format!("its level: {error}"))?)),
        None => (text, None),
    };
    let at = argument::place_or_frequency(at).map_err(|error| error.to_string())?;
    Ok(ToneArgument { at, level, text: text.trim().to_owned() })
}

/// Options whose word had two meanings; refused with the words in their place.
#[derive(Debug, Args)]
pub(super) struct GoneArgument {
    #[arg(long, hide = true, value_name = "X", allow_hyphen_values = true)]
    boundary: Option<String>,
    #[arg(long, hide = true, value_name = "X:LEVEL", allow_hyphen_values = true)]
    tone: Vec<String>,
}

impl GoneArgument {
    /// Refuses them; `felt_edge` says where a felt edge is taken.
    pub(super) fn refuse(&self, felt_edge: &str) -> Result<(), Failure> {
        let gone = self.boundary.iter().map(|text| ("--boundary", text));
        let mut gone = gone.chain(self.tone.iter().map(|text| ("--tone", text)));
        let Some((option, text)) = gone.next() else { return Ok(()) };
        Err(Failure::Usage(format!(
            "{option} is no option any more: write --turning-point {text} for what it did, the place where the wave \
             turns; the place where a finger feels a tone end is {felt_edge}"
        )))
    }
}

/// What is asked for by the place that defines a tone; an error names `option`. A frequency is the tone of this frequency,
/// whatever its places are.
fn asked(kind: PlaceKind, at: &PlaceArgument, plate: &Plate, option: &str) -> Result<AskedPlace, Failure> {
    at.with_unit(plate, option)?;
    Ok(match (kind, at.value) {
        (PlaceKind::FeltEdge, PlaceOrFrequency::Place(place_m)) => AskedPlace::FeltEdge(place_m),
        (PlaceKind::FeltEdge, PlaceOrFrequency::Frequency(_)) | (PlaceKind::TurningPoint, _) => {
            AskedPlace::TurningPoint(PlaceOrFrequency::Place(at.turning_point_on(plate, option)?))
        }
    })
}

/// What is asked of one tone.
#[derive(Clone, Debug)]
struct AskedTone {
    request: ToneRequest,
    /// As it was typed.
    text: String,
}

/// The tones of a command, which fit the plate's span as far as that is known without a table.
#[derive(Clone)]
pub(super) struct AskedTones {
    tones: Vec<AskedTone>,
    pub(super) feeling: NamedFeeling,
}

impl TonesArgument {
    /// The tones on a plate.
    pub(super) fn on(&self, plate: &Plate) -> Result<AskedTones, Failure> {
        self.gone.refuse("--felt-edge X")?;
        let feeling = self.feeling.read()?;
        let tone_of = |kind: PlaceKind, tone: &ToneArgument| {
            let asked = asked(kind, &tone.at, plate, &format!("{OPTION}{}", kind.word()))?;
            let request = ToneRequest { asked, level: tone.level.unwrap_or(self.level) };
            Ok(AskedTone { request, text: tone.text.clone() })
        };
        let felt_edges = self.felt_edges.iter().map(|tone| tone_of(PlaceKind::FeltEdge, tone));
        let turning_points = self.turning_points.iter().map(|tone| tone_of(PlaceKind::TurningPoint, tone));
        let tones = felt_edges.chain(turning_points).collect::<Result<Vec<_>, Failure>>()?;
        match tones.len() {
            0 => Err(Failure::usage("name a --felt-edge or a --turning-point")),
            count if count > MAX_TONES => {
                let allowed = Count::new(1, MAX_TONES, Counted::Tones);
                Err(Failure::Usage(must_be(format_args!("{count} {}", allowed.of), allowed)))
            }
            _ => Ok(AskedTones { tones, feeling }),
        }
    }
}

impl AskedTones {
    /// Whether a felt edge is asked for.
    pub(super) fn has_felt_edge(&self) -> bool {
        self.tones.iter().any(|tone| matches!(tone.request.asked, AskedPlace::FeltEdge(_)))
    }

    /// The tones of a setup, by their turning points.
    pub(super) fn of_setup(setup: &Setup, feeling: NamedFeeling) -> Self {
        let asked = |tone: &ToneSetup| {
            let asked = AskedPlace::TurningPoint(PlaceOrFrequency::Place(tone.position_m));
            AskedTone { request: ToneRequest { asked, level: tone.level }, text: String::new() }
        };
        Self { tones: setup.tones.iter().map(asked).collect(), feeling }
    }

    /// These tones with other places, in their order; those after the last place stay.
    pub(super) fn moved(
        mut self,
        plate: &Plate,
        kind: PlaceKind,
        places: &[ToneArgument],
    ) -> Result<Self, Failure> {
        self.allow(places.len(), "places")?;
        for (tone, place) in self.tones.iter_mut().zip(places) {
            tone.request.asked = asked(kind, &place.at, plate, kind.word())?;
            tone.request.level = place.level.unwrap_or(tone.request.level);
            tone.text.clone_from(&place.text);
        }
        Ok(self)
    }

    /// These tones with other levels, in their order; those after the last level stay. A tone requested by its
    /// felt edge keeps it.
    pub(super) fn at_levels(mut self, levels: &[f64]) -> Result<Self, Failure> {
        self.allow(levels.len(), "levels")?;
        self.tones.iter_mut().zip(levels).for_each(|(tone, level)| tone.request.level = *level);
        Ok(self)
    }

    fn allow(&self, count: usize, what: &str) -> Result<(), Failure> {
        match self.tones.len() {
            most if (1..=most).contains(&count) => Ok(()),
            most => Err(Failure::Usage(must_be(
                format_args!("{count} {what}"),
                format_args!("1 to {most}: of the tones, in their order"),
            ))),
        }
    }

    /// The setup of these tones; `table` is that of the plate. An error names the reachable felt edges.
    pub(super) fn setup(&self, plate: &Arc<Plate>, table: &DriveTable) -> Result<Setup, Failure> {
        let like = Setup { feeling: self.feeling.feeling, ..Setup::new(Arc::clone(plate)) };
        let requests: Vec<_> = self.tones.iter().map(|tone| tone.request).collect();
        ToneRequest::setup(&requests, like, table).map_err(|(number, error)| match self.tones.get(number) {
            Some(tone) => tone.refused(plate, error, OPTION),
            None => Failure::refused(error),
        })
    }

    /// A setup of these tones in the slots of `before`, with its master level and glide.
    pub(super) fn after(&self, before: &Setup, table: &DriveTable) -> Result<Setup, Failure> {
        let mut setup = before.without_chord();
        for (tone, asked) in setup.tones.iter_mut().zip(&self.tones) {
            let ToneRequest { asked: place, level } = asked.request;
            let position_m = place.turning_point_m(before, level, table);
            tone.position_m = position_m.map_err(|error| asked.refused(&before.plate, error, ""))?;
            tone.level = level;
        }
        Ok(setup)
    }
}

impl AskedTone {
    /// The refusal of this tone, whose options begin with `dashes`: of a felt edge that no tone has, with the turning point
    /// that plays the frequency of this place.
    fn refused(&self, plate: &Plate, error: NoSuchTone, dashes: &str) -> Failure {
        let (place_m, refusal) = match error {
            NoSuchTone::NoFeltEdge(place_m, refusal) => (place_m, refusal),
            NoSuchTone::OutOfRange(refusal) => return Failure::refused(refusal),
        };
        let text = &self.text;
        let (start_m, end_m) = plate.span_m();
        let turns = if (start_m..=end_m).contains(&place_m) {
            let frequency = show_frequency(plate.frequency_for_boundary_hz(place_m));
            format!("{dashes}turning-point {text} plays {frequency}, whose wave turns there")
        } else {
            format!("{dashes}turning-point takes {}", show_range(start_m, end_m, Measure::Length))
        };
        let refused = refusal.sentence(format_args!("invalid value '{text}' for '{dashes}felt-edge'"));
        Failure::Usage(format!("{refused}; {turns}"))
    }
}

/// Both places of a tone, its frequency and its level, as a sentence.
pub(super) fn words(places: &TonePlaces, frequency_hz: f64) -> String {
    format!(
        "Tone {}: {}; turning point at {}; {}, level {:.3}.",
        u16::from(places.slot) + 1,
        places.felt_words(),
        show_place(places.turning_point_m),
        show_frequency(frequency_hz),
        places.level
    )
}
