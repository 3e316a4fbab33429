//! `Plate.texture`.

use crate::arguments::{ArrayLike, SERIES_MAX, count_in};
use crate::error::Failure;
use crate::result::kind::Texture;
use crate::result::{Answer, fields};
use crate::waiting::compute;
use pyo3::prelude::*;
use slipline_model::answer::texture::{TextureAnswer, make};
use slipline_model::atomic_file::{read_bytes, said};
use slipline_model::field::simulation::{SAMPLE_RATE_HZ, table_for_watched};
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::texture::{PROFILE_FILE_BYTES_MAX, Wish, from_png};
use slipline_plate::Plate;
use slipline_plate::quantity::{OutOfRange, Range};
use slipline_plate::texture::{Palette, TONES_MAX, TextureError};
use std::path::PathBuf;
use std::sync::Arc;

/// The wanted texture; one of these.
pub(crate) struct Wanted {
    pub(crate) solid_m: Option<f64>,
    pub(crate) profile: Option<(Vec<f64>, Vec<f64>)>,
    pub(crate) image: Option<PathBuf>,
    pub(crate) stripes_m: Option<f64>,
    pub(crate) beat: Option<(f64, f64)>,
}

impl Wanted {
    /// The wish and the argument that names its number.
    fn wish(self, plate: &Plate) -> Result<(Wish, &'static str), Failure> {
        let Self { solid_m, profile, image, stripes_m, beat } = self;
        let mut wishes = Vec::new();
        wishes.extend(solid_m.map(|place_m| (Wish::Solid(place_m), "solid_m")));
        wishes.extend(stripes_m.map(|distance_m| (Wish::Stripes(distance_m), "stripes_m")));
        wishes.extend(beat.map(|(place_m, beat_hz)| (Wish::Beat { place_m, beat_hz }, "beat")));
        if let Some((places_m, amplitudes)) = profile {
            if places_m.len() != amplitudes.len() {
                let given =
                    format_args!("profile of {} places and {} amplitudes", places_m.len(), amplitudes.len());
                return Err(Failure::wrong_arguments(given, "two series of the same length"));
            }
            wishes.push((Wish::Profile(places_m.into_iter().zip(amplitudes).collect()), "profile"));
        }
        if let Some(path) = image {
            let bad = |why: String| Failure::bad_file(path.display(), why);
            let bytes = read_bytes(&path, PROFILE_FILE_BYTES_MAX).map_err(|error| bad(said(&error)))?;
            let breakpoints = from_png(&bytes, plate.length_m()).map_err(|error| bad(said(&error)))?;
            wishes.push((Wish::Profile(breakpoints), "image"));
        }
        match (wishes.pop(), wishes.is_empty()) {
            (Some(wish), true) => Ok(wish),
            (wish, _) => {
                let given = if wish.is_some() { "more than one texture" } else { "no texture" };
                Err(Failure::wrong_arguments(given, "one of solid_m, profile, image, stripes_m and beat"))
            }
        }
    }
}

/// The two series of a profile: a tuple, a list, the rows of an array.
pub(crate) fn profile(given: &Bound<'_, PyAny>) -> PyResult<(Vec<f64>, Vec<f64>)> {
    let wrong = || Failure::wrong_arguments("profile", "two series: places in metres, and amplitudes");
    let mut rows = given.try_iter().map_err(|_| wrong())?;
    let mut next = |name| -> PyResult<Vec<f64>> {
        let row = rows.next().ok_or_else(wrong)??;
        row.extract::<ArrayLike<'_>>()?.series(name, SERIES_MAX)
    };
    let profile = (next("the places of profile")?, next("the amplitudes of profile")?);
    if rows.next().is_some() { Err(wrong().into()) } else { Ok(profile) }
}

/// Makes the texture of at most `most` tones.
pub(crate) fn run(
    py: Python<'_>,
    plate: &Arc<Plate>,
    wanted: Wanted,
    most: i64,
) -> PyResult<Answer<Texture>> {
    let most = count_in("tones", most, Range::new(1.0, TONES_MAX as f64, ""))?;
    let plate = Arc::clone(plate);
    let found = compute(py, move |progress| {
        let (wish, argument) = wanted.wish(&plate)?;
        let (table, _) = table_for_watched(&plate, SAMPLE_RATE_HZ, &mut progress.part(0.0, 0.2))
            .map_err(|it| Failure::of(&it))?;
        let palette = Palette::new(&plate, &table);
        let made = make(&palette, &wish, most, &mut progress.part(0.2, 1.0)).map_err(|error| {
            let TextureError::OutOfRange(refused) = error else { return Failure::of(&error) };
            Failure::of(&OutOfRange { field: argument, ..refused })
        })?;
        let places = TonePlaces::of_setup(&made.setup(Arc::clone(&plate)), &table);
        Ok(fields(&TextureAnswer::of(&plate, &made, &places)))
    })?;
    Answer::of(py, found)
}
