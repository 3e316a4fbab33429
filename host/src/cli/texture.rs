//! `slipline texture`.

use super::destination::Destination;
use super::{Failure, ForceArgument, PlateArgument, argument, output, progress};
use argument::{Beat, Typed};
use clap::Args;
use serde_json::{Value, json};
use slipline_model::atomic_file::{read_bytes, read_text, said};
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_model::setup::{Setup, file};
use slipline_model::texture::{self as textures, PROFILE_FILE_BYTES_MAX, setup_of};
use slipline_plate::feeling::Feeling;
use slipline_plate::number_format::with_decimals;
use slipline_plate::quantity::{Measure, show_frequency, show_length, show_place, show_range};
use slipline_plate::texture::{
    CHORD_PERIOD, ChordTexture, Figures, Palette, TONES_MAX, Target, Texture, TextureError,
    least_largest_square_error,
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
    /// Tones at most, 1 to 16.
    #[arg(long, value_parser = argument::count(1, TONES_MAX), allow_hyphen_values = true, default_value = "16")]
    tones: usize,
    /// Write a setup file that the app opens and `drive --setup` plays.
    #[arg(long, value_name = "SETUP.toml")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
}

/// What is wanted; one of these.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct WantedArgument {
    /// An even area from the driven end to where the finger feels it end (200mm).
    #[arg(long, value_name = "X", value_parser = argument::place, allow_hyphen_values = true)]
    solid: Option<Typed<f64>>,
    /// The wanted RMS amplitude as breakpoints: lines of place in metres, comma, amplitude.
    #[arg(long, value_name = "FILE.csv")]
    profile: Option<PathBuf>,
    /// The wanted RMS amplitude as the brightness of an image's middle row.
    #[arg(long, value_name = "FILE.png")]
    image: Option<PathBuf>,
    /// The nodes of one tone, this far apart in the middle of its area (12mm).
    #[arg(long, value_name = "LENGTH", value_parser = argument::place, allow_hyphen_values = true)]
    stripes: Option<Typed<f64>>,
    /// Two tones that beat: where, and how fast (120mm:180Hz).
    #[arg(long, value_name = "X:F", value_parser = argument::beat, allow_hyphen_values = true)]
    beat: Option<Beat>,
}

/// A texture that has been made: its tones, and what is known of it.
struct Made {
    what: String,
    tones: Vec<slipline_plate::texture::TextureTone>,
    fitted: Option<Fitted>,
    /// Where it ends was chosen by its loudness.
    is_solid: bool,
    stripes_m: Option<f64>,
}

impl Made {
    /// How much louder than its tones the setup is as a chord, dB; `None` if it is none.
    fn chord_gain_db(&self) -> Option<f64> {
        let (chord, is_used) = self.fitted.as_ref()?.on_grid.as_ref()?;
        // A solid area louder than it was made would be felt farther.
        is_used.then_some(if self.is_solid { 0.0 } else { chord.gain_db })
    }
}

/// What a fit tells.
struct Fitted {
    /// The same on the multiples of a chord, and whether those are the tones.
    on_grid: Option<(ChordTexture, bool)>,
    is: Figures,
    reach: Figures,
    worst: Figures,
    /// Least largest error of the mean square that any number of tones has.
    largest: f64,
    texture: Texture,
}

pub(super) fn run(arguments: &TextureArguments, as_json: bool) -> Result<(), Failure> {
    let plate = argument::plate(&arguments.plate.plate)?;
    let out = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let (table, _) = progress::table_for(&plate, SAMPLE_RATE_HZ)?;
    let made = make(&plate, &table, &arguments.wanted, arguments.tones)?;
    let plate = Arc::new(plate);
    if let Some(out) = &out {
        let setup =
            Setup { chord_gain_db: made.chord_gain_db(), ..setup_of(Arc::clone(&plate), &made.tones) };
        out.write(|writer| Ok(writer.write_all(file::write(&setup).as_bytes())?))?;
    }
    output::print(as_json, &value(&plate, &made), |writer| {
        output::lines(writer, &lines(&plate, &made, out.as_ref()))
    })
}

fn make(plate: &Plate, table: &DriveTable, wanted: &WantedArgument, most: usize) -> Result<Made, Failure> {
    let palette = Palette::new(plate, table);
    let on_plate = format!(" on the plate {:?}", plate.name());
    let refused = |option: &str, text: &str, error: TextureError| match error {
        TextureError::OutOfRange(error) => {
            let range = show_range(error.range.low, error.range.high, Measure::of(error.range.unit));
            Failure::value(option, text, format!("{range}{on_plate}"))
        }
        error => Failure::Usage(format!("{option} {text}: {error}")),
    };
    if let Some(place) = &wanted.solid {
        let (texture, target) = Texture::solid_to(&palette, place.value, most, &Feeling::default())
            .map_err(|error| refused("--solid", &place.text, error))?;
        return fitted(&palette, &target, texture, format!("solid to {}", show_place(place.value)));
    }
    if let Some(distance) = &wanted.stripes {
        let tone = slipline_plate::texture::stripes(&palette, distance.value)
            .map_err(|error| refused("--stripes", &distance.text, error))?;
        let stripes_m = slipline_plate::texture::stripes_m(plate, tone.frequency_hz);
        let what = format!("stripes {} apart", show_length(distance.value));
        return Ok(Made { what, tones: vec![tone], fitted: None, is_solid: false, stripes_m });
    }
    if let Some(Beat { place, frequency }) = &wanted.beat {
        let text = format!("{}:{}", place.text, frequency.text);
        let tones = slipline_plate::texture::beat(&palette, place.value, frequency.value)
            .map_err(|error| refused("--beat", &text, error))?;
        let what = format!("a beat of {} at {}", show_frequency(frequency.value), show_place(place.value));
        return Ok(Made { what, tones: tones.to_vec(), fitted: None, is_solid: false, stripes_m: None });
    }
    let (path, breakpoints) = breakpoints(plate, wanted)?;
    let in_file = |error: TextureError| Failure::Usage(format!("{}: {error}", path.display()));
    let target = Target::profile(&palette, &breakpoints).map_err(in_file)?;
    let texture = Texture::fit(&palette, &target, most).map_err(in_file)?;
    fitted(&palette, &target, texture, format!("the profile {}", path.display()))
}

fn fitted(palette: &Palette<'_>, target: &Target, texture: Texture, what: String) -> Result<Made, Failure> {
    let is_solid = texture.figures.ripple_db.is_some();
    let chord = texture.on_grid(palette, target).map_err(Failure::usage)?;
    let on_grid = chord.map(|chord| {
        let is_used = chord.is_as_good_as(&texture);
        (chord, is_used)
    });
    let texture = match &on_grid {
        // As loud as the free tones, which may have been made quieter than the DAC allows.
        Some((chord, true)) => chord.texture.as_loud_as(&texture),
        _ => texture,
    };
    let worst = texture.worst(palette, target).map_err(Failure::usage)?;
    let largest = least_largest_square_error(palette, target).map_err(Failure::usage)?;
    let (is, reach) = (texture.figures, texture.reach);
    let tones = texture.tones.clone();
    Ok(Made {
        what,
        tones,
        fitted: Some(Fitted { on_grid, is, reach, worst, largest, texture }),
        is_solid,
        stripes_m: None,
    })
}

/// Places in metres, each with its amplitude.
type Breakpoints = Vec<(f64, f64)>;

/// The profile of a file, and the file's name.
fn breakpoints<'a>(plate: &Plate, wanted: &'a WantedArgument) -> Result<(&'a Path, Breakpoints), Failure> {
    let failed = |path: &Path, error: &dyn std::fmt::Display| {
        Failure::Usage(format!("{}: {}", path.display(), said(&error)))
    };
    if let Some(path) = &wanted.profile {
        let text = read_text(path, PROFILE_FILE_BYTES_MAX).map_err(|error| failed(path, &error))?;
        let breakpoints = textures::from_csv(&text).map_err(|error| failed(path, &error))?;
        return Ok((path, breakpoints));
    }
    let path = wanted.image.as_deref().unwrap_or(Path::new(""));
    let bytes = read_bytes(path, PROFILE_FILE_BYTES_MAX).map_err(|error| failed(path, &error))?;
    let breakpoints = textures::from_png(&bytes, plate.length_m()).map_err(|error| failed(path, &error))?;
    Ok((path, breakpoints))
}

fn value(plate: &Plate, made: &Made) -> Value {
    let Made { tones, fitted, stripes_m, .. } = made;
    let reach = |Fitted { reach, largest, .. }: &Fitted| {
        json!({
            "rms_error": reach.rms_error,
            "ripple_db": reach.ripple_db,
            "contrast_db": reach.contrast_db,
            "largest_square_error": largest,
        })
    };
    json!({
        "plate": plate.name(),
        "tones": tones.iter().map(|tone| json!({
            "position_m": tone.position_m,
            "frequency_hz": tone.frequency_hz,
            "level": tone.level,
            "phase_turns": tone.phase_turns,
        })).collect::<Vec<_>>(),
        "rms_error": fitted.as_ref().map(|it| it.is.rms_error),
        "ripple_db": fitted.as_ref().and_then(|it| it.is.ripple_db),
        "contrast_db": fitted.as_ref().and_then(|it| it.is.contrast_db),
        "worst_rms_error": fitted.as_ref().map(|it| it.worst.rms_error),
        "worst_ripple_db": fitted.as_ref().and_then(|it| it.worst.ripple_db),
        "reach": fitted.as_ref().map(reach),
        "position_m": fitted.as_ref().map(|it| &it.texture.places_m),
        "wanted_rms_m": fitted.as_ref().map(|it| &it.texture.wanted_m),
        "rms_m": fitted.as_ref().map(|it| &it.texture.rms_m),
        "stripes_m": stripes_m,
        "chord": fitted.as_ref().and_then(|it| it.on_grid.as_ref()).map(|(chord, is_used)| json!({
            "is_used": is_used,
            "base_frequency_hz": f64::from(SAMPLE_RATE_HZ) / f64::from(CHORD_PERIOD),
            "harmonics": chord.harmonics,
            "gain_db": made.chord_gain_db(),
            "headroom_db": chord.gain_db,
            "rms_error": chord.texture.figures.rms_error,
            "ripple_db": chord.texture.figures.ripple_db,
            "contrast_db": chord.texture.figures.contrast_db,
        })),
    })
}

fn lines(plate: &Plate, made: &Made, out: Option<&Destination>) -> Vec<(&'static str, String)> {
    let mut lines = vec![("Plate", plate.name().to_owned()), ("Texture", made.what.clone())];
    for tone in &made.tones {
        let (place, frequency) = (show_place(tone.position_m), show_frequency(tone.frequency_hz));
        lines.push(("Tone", format!("{place}, {frequency}, level {}", with_decimals(tone.level, 3))));
    }
    if let Some(Fitted { on_grid, is, reach, worst, texture, .. }) = &made.fitted {
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
        lines.extend(three(|figures| figures.contrast_db).map(|text| ("Contrast", text)));
        let largest_m = texture.rms_m.iter().copied().fold(0.0, f64::max);
        lines.push(("RMS at most", show_length(largest_m)));
        lines.extend(on_grid.as_ref().map(|(chord, is_used)| ("Chord", chord_words(chord, *is_used, made))));
    }
    if let Some(distance_m) = made.stripes_m {
        lines.push(("Stripes", format!("{} apart in the middle", show_length(distance_m))));
    }
    lines.extend(out.map(|out| ("Written to", out.path().display().to_string())));
    lines
}

/// What the tones are as a chord.
fn chord_words(chord: &ChordTexture, is_used: bool, made: &Made) -> String {
    let base = show_frequency(f64::from(SAMPLE_RATE_HZ) / f64::from(CHORD_PERIOD));
    let decibel = |value: f64| format!("{} dB", with_decimals(value, 1));
    match (is_used, chord.texture.figures.ripple_db) {
        (true, _) if made.is_solid => {
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
