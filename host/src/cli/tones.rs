//! The tones of a command, each by its felt edge, its turning point or its frequency.
//!
//! ```text
//! --felt-edge, --turning-point --> AskedTones, checked against the plate's span
//!                                      --table, feeling--> ToneSetups, or the felt edges that can be had
//! ```

use super::Failure;
use super::argument::{self, PlaceArgument, level};
use super::feeling::{FeelingArgument, NamedFeeling};
use clap::Args;
use serde_json::{Value, json};
use slipline_link::protocol::limits::MAX_TONES;
use slipline_model::field::edge_reach::{NoFeltEdge, turning_point_of};
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::setup::{Setup, ToneSetup};
use slipline_plate::feeling::FeltEdge;
use slipline_plate::quantity::{
    Count, Counted, Measure, PlaceOrFrequency, must_be, show_frequency, show_place, show_range,
};
use slipline_plate::{DriveTable, Plate};
use std::sync::Arc;

/// The tones.
#[derive(Debug, Args)]
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
fn tone(text: &str) -> Result<ToneArgument, String> {
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

/// What is asked of one tone.
#[derive(Clone, Debug)]
struct AskedTone {
    at: AskedPlace,
    level: f64,
    text: String,
}

/// The place that defines a tone, in metres.
#[derive(Clone, Copy, Debug)]
enum AskedPlace {
    TurningPoint(f64),
    FeltEdge(f64),
}

/// The tones of a command, which fit the plate's span as far as that is known without a table.
pub(super) struct AskedTones {
    tones: Vec<AskedTone>,
    pub(super) feeling: NamedFeeling,
}

impl TonesArgument {
    /// The tones on a plate.
    pub(super) fn on(&self, plate: &Plate) -> Result<AskedTones, Failure> {
        self.gone.refuse("--felt-edge X")?;
        let feeling = self.feeling.read()?;
        let felt_edges = self.felt_edges.iter().map(|tone| self.felt_edge(plate, tone));
        let turning_points = self.turning_points.iter().map(|tone| {
            let place_m = tone.at.turning_point_on(plate, "--turning-point")?;
            Ok(self.asked(tone, AskedPlace::TurningPoint(place_m)))
        });
        let tones = felt_edges.chain(turning_points).collect::<Result<Vec<_>, Failure>>()?;
        match tones.len() {
            0 => Err(Failure::Usage("name a --felt-edge or a --turning-point".to_owned())),
            count if count > MAX_TONES => {
                let allowed = Count::new(1, MAX_TONES, Counted::Tones);
                Err(Failure::Usage(must_be(format_args!("{count} {}", allowed.of), allowed)))
            }
            _ => Ok(AskedTones { tones, feeling }),
        }
    }

    fn asked(&self, tone: &ToneArgument, at: AskedPlace) -> AskedTone {
        AskedTone { at, level: tone.level.unwrap_or(self.level), text: tone.text.clone() }
    }

    fn felt_edge(&self, plate: &Plate, tone: &ToneArgument) -> Result<AskedTone, Failure> {
        let at = match tone.at.value {
            PlaceOrFrequency::Place(place_m) => AskedPlace::FeltEdge(place_m),
            // A frequency is the tone of this frequency, whatever its places are.
            PlaceOrFrequency::Frequency(_) => {
                AskedPlace::TurningPoint(tone.at.turning_point_on(plate, "--felt-edge")?)
            }
        };
        Ok(self.asked(tone, at))
    }
}

impl AskedTones {
    /// Whether a felt edge is asked for.
    pub(super) fn has_felt_edge(&self) -> bool {
        self.tones.iter().any(|tone| matches!(tone.at, AskedPlace::FeltEdge(_)))
    }

    /// The setup of these tones; `table` is that of the plate. An error names the felt edges that can be had.
    pub(super) fn setup(&self, plate: &Arc<Plate>, table: &DriveTable) -> Result<Setup, Failure> {
        let feeling = self.feeling.feeling;
        let mut setup = Setup { feeling, tones: Vec::new(), ..Setup::new(Arc::clone(plate)) };
        for (slot, tone) in (0..).zip(&self.tones) {
            let position_m = match tone.at {
                AskedPlace::TurningPoint(place_m) => place_m,
                AskedPlace::FeltEdge(place_m) => turning_point_of(&setup, tone.level, table, place_m)
                    .map_err(|refusal| refused(&tone.text, place_m, plate, &refusal))?,
            };
            setup.tones.push(ToneSetup { slot, position_m, level: tone.level, phase_turns: 0.0 });
        }
        Ok(setup)
    }
}

/// The refusal of a felt edge that no tone has, with the turning point that plays the frequency of this place.
fn refused(text: &str, place_m: f64, plate: &Plate, refusal: &NoFeltEdge) -> Failure {
    let (start_m, end_m) = plate.span_m();
    let turns = if (start_m..=end_m).contains(&place_m) {
        let frequency = show_frequency(plate.frequency_for_boundary_hz(place_m));
        format!("--turning-point {text} plays {frequency}, whose wave turns there")
    } else {
        format!("--turning-point takes {}", show_range(start_m, end_m, Measure::Length))
    };
    let refused = refusal.sentence(format_args!("invalid value '{text}' for '--felt-edge'"));
    Failure::Usage(format!("{refused}; {turns}"))
}

/// The tones of a setup as (turning point in metres, level).
pub(super) fn turning_points(setup: &Setup) -> Vec<(f64, f64)> {
    setup.tones.iter().map(|tone| (tone.position_m, tone.level)).collect()
}

/// Both places of a tone, its frequency and its level, as JSON. `frequency_hz` is what the device plays.
pub(super) fn value(places: &TonePlaces, frequency_hz: f64) -> Value {
    let by_person = [places.by_person.near, places.by_person.far].map(FeltEdge::place_m);
    json!({
        "turning_point_m": places.turning_point_m,
        "felt_edge_m": places.felt_edge.place_m(),
        "felt_edge_by_person_m": by_person,
        "felt": places.felt_words(),
        "frequency_hz": frequency_hz,
        "level": places.level,
    })
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
