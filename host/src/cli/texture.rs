//! `slipline texture`.

use super::argument::{self, PlateArgument};
use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::schema::with_files;
use super::source::bytes_of;
use super::{output, progress};
use argument::{Beat, Typed};
use clap::Args;
use serde_json::json;
use slipline_model::answer::texture::{self, ProfileReadAnswer, TextureAnswer};
use slipline_model::atomic_file::said;
use slipline_model::field::felt::by_person_words;
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::setup::file;
use slipline_model::texture::{self as textures, Fitted, Made, PROFILE_FILE_BYTES_MAX, ProfileRead, Wish};
use slipline_plate::feeling::Feeling;
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{Measure, show_frequency, show_length, show_place};
use slipline_plate::texture::{
    CHORD_PERIOD, ChordTexture, Figures, Flutter, Palette, TONES_MAX, TextureError,
};
use slipline_plate::{DriveTable, Plate};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// `texture`.
#[derive(Debug, Args)]
pub struct TextureArguments {
    #[command(flatten)]
    plate: PlateArgument,
    #[command(flatten)]
    wanted: WantedArgument,
    /// Largest number of tones, 1 to 16.
    #[arg(long, value_parser = argument::count(1, TONES_MAX), allow_hyphen_values = true, default_value = "16")]
    tones: usize,
    /// Write a setup file that the app opens and `drive --setup` plays.
    #[arg(long, value_name = "SETUP.toml", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
}

/// The wanted texture; one of these.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct WantedArgument {
    /// An even area from the driven end to its felt edge (200mm).
    #[arg(long, value_name = "X", value_parser = argument::place, allow_hyphen_values = true)]
    solid: Option<Typed<f64>>,
    /// The wanted RMS amplitude as breakpoints: lines of place in metres, comma, amplitude.
    #[arg(long, value_name = "FILE.csv")]
    profile: Option<PathBuf>,
    /// The wanted RMS amplitude as the brightness of an image's middle row.
    #[arg(long, value_name = "FILE.png")]
    image: Option<PathBuf>,
    /// The nodes of one tone, with this distance in the middle of its area (12mm).
    #[arg(long, value_name = "LENGTH", value_parser = argument::place, allow_hyphen_values = true)]
    stripes: Option<Typed<f64>>,
    /// Two tones that beat: place and beat frequency (120mm:180Hz).
    #[arg(long, value_name = "X:F", value_parser = argument::beat, allow_hyphen_values = true)]
    beat: Option<Beat>,
}

/// A texture and its name.
struct Named {
    what: String,
    made: Made,
    /// What was read of a profile's table.
    read: Option<ProfileReadAnswer>,
}

pub(super) fn run(arguments: &TextureArguments, as_json: bool) -> Result<(), Failure> {
    let plate = arguments.plate.read()?;
    let out = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let (table, _) = progress::table_for(&plate, SAMPLE_RATE_HZ)?;
    let named = make(&plate, &table, &arguments.wanted, arguments.tones)?;
    let plate = Arc::new(plate);
    let setup = named.made.setup(Arc::clone(&plate));
    let places = TonePlaces::of_setup(&setup, &table);
    if let Some(out) = &out {
        let text = file::write(&setup);
        out.write(|writer| Ok(writer.write_all(text.as_bytes())?))?;
    }
    let answer =
        TextureAnswer { read: named.read.as_ref(), ..TextureAnswer::of(&plate, &named.made, &places) };
    let value = with_files(json!(answer), Destination::names(out.as_ref()));
    output::print(as_json, &value, |writer| {
        output::lines(writer, &lines(&plate, &named, arguments.tones, out.as_ref()))
    })
}

/// Source of a wish: an option and its text, or a file.
enum Source<'a> {
    Option(&'static str, String),
    File(&'a Path, Option<ProfileRead>),
}

/// The wanted texture and its source.
fn wish<'a>(plate: &Plate, wanted: &'a WantedArgument) -> Result<(Wish, Source<'a>), Failure> {
    let typed = |option, text: &str, wish| (wish, Source::Option(option, text.to_owned()));
    Ok(if let Some(place) = &wanted.solid {
        typed("--solid", &place.text, Wish::Solid(place.value))
    } else if let Some(distance) = &wanted.stripes {
        typed("--stripes", &distance.text, Wish::Stripes(distance.value))
    } else if let Some(Beat { place, frequency }) = &wanted.beat {
        let text = format!("{}:{}", place.text, frequency.text);
        typed("--beat", &text, Wish::Beat { place_m: place.value, beat_hz: frequency.value })
    } else {
        let (path, breakpoints, read) = breakpoints(plate, wanted)?;
        (Wish::Profile(breakpoints), Source::File(path, read))
    })
}

fn make(plate: &Plate, table: &DriveTable, wanted: &WantedArgument, most: usize) -> Result<Named, Failure> {
    let (wish, from) = wish(plate, wanted)?;
    let what = match (&wish, &from) {
        (_, Source::File(path, _)) => format!("the profile {}", path.display()),
        (Wish::Solid(place_m), _) => format!("solid to {}", show_place(*place_m)),
        (Wish::Stripes(distance_m), _) => format!("stripes {} apart", show_length(*distance_m)),
        (Wish::Beat { place_m, beat_hz }, _) => {
            format!("a beat of {} at {}", show_frequency(*beat_hz), show_place(*place_m))
        }
        (Wish::Profile(_), Source::Option(..)) => String::new(),
    };
    let palette = Palette::new(plate, table);
    let made = progress::watched("texture", |progress| texture::make(&palette, &wish, most, progress));
    match made {
        Ok(made) => {
            let read = match from {
                Source::File(path, read) => {
                    read.map(|read| ProfileReadAnswer { file: path.display().to_string(), read })
                }
                Source::Option(..) => None,
            };
            Ok(Named { what, made, read })
        }
        Err(error) => Err(match (from, error) {
            (Source::Option(option, text), TextureError::OutOfRange(error)) => {
                let more = format!(" on the plate {:?}", plate.name());
                Failure::outside(option, &text, error.range, Measure::of(error.range.unit), &more)
            }
            (Source::Option(option, text), error) => {
                Failure::because(format!("{option} {text}: {error}"), &error)
            }
            (Source::File(path, _), error) => Failure::in_file(path, error),
        }),
    }
}

/// Places in metres, each with its amplitude.
type Breakpoints = Vec<(f64, f64)>;

/// The file of a profile, the profile, and what was read of a table.
type Profile<'a> = (&'a Path, Breakpoints, Option<ProfileRead>);

/// The profile of a file.
fn breakpoints<'a>(plate: &Plate, wanted: &'a WantedArgument) -> Result<Profile<'a>, Failure> {
    let image = wanted.image.as_deref().unwrap_or(Path::new(""));
    let path = wanted.profile.as_deref().unwrap_or(image);
    let bytes = bytes_of(path, PROFILE_FILE_BYTES_MAX)?;
    let refused = |error| Failure::of_file(path, said(&error));
    if wanted.profile.is_none() {
        return Ok((path, textures::from_png(&bytes, plate.length_m()).map_err(refused)?, None));
    }
    let table = textures::from_csv(&bytes).map_err(refused)?;
    output::note(format_args!("slipline: {}: {}", path.display(), table.read));
    Ok((path, table.breakpoints, Some(table.read)))
}

fn lines(
    plate: &Plate,
    named: &Named,
    most: usize,
    out: Option<&Destination>,
) -> Vec<(&'static str, String)> {
    let Named { what, made, .. } = named;
    let mut lines = vec![("Plate", plate.name().to_owned()), ("Texture", what.clone())];
    for tone in &made.tones {
        let (place, frequency) = (show_place(tone.position_m), show_frequency(tone.frequency_hz));
        lines.push((
            "Tone",
            format!("turning point at {place}, {frequency}, level {}", with_decimals(tone.level, 3)),
        ));
    }
    if let Some(fitted) = &made.fitted {
        let Fitted { worst, texture, rest, .. } = fitted;
        let (is, reach) = (&texture.figures, &texture.reach);
        let percent = |share: f64| format!("{} %", with_decimals(100.0 * share, 1));
        let decibel = |value: f64| format!("{} dB", with_decimals(value, 1));
        let error = |figures: &Figures| percent(figures.rms_error);
        let three = |what: fn(&Figures) -> Option<f64>| {
            let (is, reach, worst) = (what(is)?, what(reach)?, what(worst)?);
            let [is, reach, worst] = [is, reach, worst].map(decibel);
            Some(format!("{is} (any number of tones {reach}, worst within the tolerances {worst})"))
        };
        let (is, reach, worst) = (error(is), error(reach), error(worst));
        lines.push((
            "Error",
            format!("{is} (any number of tones {reach}, worst within the tolerances {worst})"),
        ));
        lines.extend(three(|figures| figures.ripple_db).map(|text| ("Ripple", text)));
        let by_person = rest.as_ref().and_then(|rest| by_person_words(rest.by_person?));
        lines.extend(by_person.map(|words| ("Felt to", words)));
        let flutter = rest.as_ref().and_then(|rest| rest.flutter);
        lines.extend(flutter.map(|Flutter { swing_db, largest_db, largest_at_m, frequency_hz }| {
            let (swing, beat) = (decibel(swing_db), show_frequency(frequency_hz));
            let (largest, place) = (decibel(largest_db), show_place(largest_at_m));
            let what = format!("{swing} at about {beat}, up to {largest} at {place}");
            ("Flutter", format!("{what}: its RMS over 30 ms, within a second"))
        }));
        lines.extend(three(|figures| figures.contrast_db).map(|text| ("Contrast", text)));
        let largest_m = texture.rms_m.iter().copied().fold(0.0, f64::max);
        lines.push(("RMS at most", show_length(largest_m)));
        let chord = rest.as_ref().and_then(|rest| rest.chord.as_ref());
        let words = |(chord, is_used): &(ChordTexture, bool)| chord_words(chord, *is_used, fitted.is_solid());
        lines.extend(chord.map(|chord| ("Chord", words(chord))));
        lines.extend(made.lack(most).map(|lack| ("Reach", lack.sentence().to_owned())));
    }
    if let Some(distance_m) = made.stripes_m {
        let felt = made.stripes_felt_db.map_or(String::new(), |felt_db| {
            let contact = show_length(Feeling::default().contact_m);
            format!(", felt {} dB deep under a contact of {contact}", with_decimals(felt_db, 1))
        });
        lines.push(("Stripes", format!("{} apart in the middle{felt}", show_length(distance_m))));
    }
    lines.extend(out.map(|out| ("Written to", out.path().display().to_string())));
    lines
}

/// The tones as a chord, in words.
fn chord_words(chord: &ChordTexture, is_used: bool, is_solid: bool) -> String {
    let base = show_frequency(f64::from(SAMPLE_RATE_HZ) / f64::from(CHORD_PERIOD));
    let decibel = |value: f64| format!("{} dB", with_decimals(value, 1));
    match (is_used, chord.texture.figures.ripple_db) {
        (true, _) if is_solid => {
            let headroom = decibel(chord.gain_db);
            format!("multiples of {base}; its peak leaves {headroom} above the sum of its tones")
        }
        (true, _) => {
            format!(
                "multiples of {base}, played {} louder than the sum of its tones allows",
                decibel(chord.gain_db)
            )
        }
        (false, Some(ripple_db)) => {
            format!("none: on multiples of {base} the ripple would be {}", decibel(ripple_db))
        }
        (false, None) => {
            let error = with_decimals(100.0 * chord.texture.figures.rms_error, 1);
            format!("none: on multiples of {base} the error would be {error} %")
        }
    }
}
