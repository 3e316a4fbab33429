//! Computation of the tones for a wanted texture, and their error.
//!
//! ```text
//! Wish --make--> Made: tones, their error, that of any number --finished--> as a chord where that pays
//! ```
//! The first step takes tens of milliseconds, so it follows a pointer; an area by its felt edge and the second step take
//! some tenths of a second.

use super::{setup_of, tones_of};
use crate::setup::Setup;
use crate::setup::edit::Edit;
use slipline_plate::feeling::{EdgesByPerson, Feeling};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{OutOfRange, Range};
use slipline_plate::texture::{
    BEAT_RANGE_HZ, ChordTexture, Figures, Flutter, Palette, Target, Texture, TextureError, TextureTone, beat,
    least_largest_square_error, stripes, stripes_felt_db, stripes_m,
};
use slipline_plate::{Plate, Progress};
use std::sync::Arc;

/// The texture that a user wants to be felt.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Wish {
    /// An even area from the driven end to the place where the finger feels it end, in metres.
    Solid(f64),
    /// The wanted RMS amplitude as breakpoints: places in metres, each with its amplitude in any unit.
    Profile(Vec<(f64, f64)>),
    /// The nodes of one tone, this far apart in the middle of its area, in metres.
    Stripes(f64),
    /// Two tones that beat.
    Beat {
        /// Place of the beat, in metres.
        place_m: f64,
        /// Beat frequency, in Hz.
        beat_hz: f64,
    },
}

/// A texture that has been made.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Made {
    /// Its tones, in order of their turning points.
    pub tones: Vec<TextureTone>,
    /// The quality of the fit; `None` for stripes and beats, which have no target profile.
    pub fitted: Option<Fitted>,
    /// Distance of the nodes of stripes, in metres.
    pub stripes_m: Option<f64>,
    /// How deep the stripes are felt under the finger's contact, in dB.
    pub stripes_felt_db: Option<f64>,
}

/// The result of a fit, and its error.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Fitted {
    target: Target,
    /// The texture whose tones are used.
    pub texture: Texture,
    /// The worst of its figures within the plate's tolerances of speed and loss.
    pub worst: Figures,
    /// Whether the wish states the level: then it is not played louder as a chord.
    has_level: bool,
    /// The results of the slower steps; `None` until [`Made::finished`].
    pub rest: Option<Rest>,
}

/// The results of the slower steps of a fit.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Rest {
    /// The texture with its tones on the multiples of a chord, and whether it is used; `None` where no multiple is in the band.
    pub chord: Option<(ChordTexture, bool)>,
    /// How the area flutters; `None` of a profile.
    pub flutter: Option<Flutter>,
    /// Where persons feel the area end; `None` of a profile.
    pub by_person: Option<EdgesByPerson>,
    /// The smallest possible largest error of the mean square, with any number of tones, relative to the largest wanted mean
    /// square.
    pub largest_square_error: f64,
}

/// The part of a target that cannot be reached, in a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Lack {
    /// No number of tones reaches it.
    Reach(String),
    /// More tones would come nearer.
    Tones(String),
}

impl Lack {
    /// The sentence.
    #[must_use]
    pub fn sentence(&self) -> &str {
        match self {
            Self::Reach(sentence) | Self::Tones(sentence) => sentence,
        }
    }
}

/// Largest error of the RMS amplitude, relative to the largest wanted one, that is not visible in a drawn
/// profile.
const FINE: f64 = 0.05;
/// Ripple of an area that a finger does not notice, dB.
const EVEN_DB: f64 = 3.0;
/// Contrast from which on an edge is clear, dB.
const CLEAR_DB: f64 = 20.0;
/// More tones are proposed if they would reduce the error below this share of it.
const WORTH_IT: f64 = 0.8;

/// Makes a texture of at most `most` tones (1 to 16); `feeling` determines where an area ends.
///
/// # Errors
/// [`TextureError`]: the unsuitable value and its range, or that the caller has cancelled it.
pub fn make(
    palette: &Palette<'_>,
    wish: &Wish,
    most: usize,
    feeling: &Feeling,
    progress: &mut Progress<'_>,
) -> Result<Made, TextureError> {
    let plain = |tones| Made { tones, fitted: None, stripes_m: None, stripes_felt_db: None };
    match *wish {
        Wish::Solid(felt_edge_m) => {
            let (texture, target) = Texture::solid_to(palette, felt_edge_m, most, feeling, progress)?;
            fitted(palette, target, texture)
        }
        Wish::Profile(ref breakpoints) => {
            let target = Target::profile(palette, breakpoints)?;
            let texture = Texture::fit(palette, &target, most)?;
            fitted(palette, target, texture)
        }
        Wish::Stripes(distance_m) => {
            let tone = stripes(palette, distance_m)?;
            let stripes_m = stripes_m(palette.plate(), tone.frequency_hz);
            let stripes_felt_db = Some(stripes_felt_db(palette.plate(), &tone, feeling)?);
            Ok(Made { stripes_m, stripes_felt_db, ..plain(vec![tone]) })
        }
        Wish::Beat { place_m, beat_hz } => {
            let table = palette.table();
            let band_hz = table.frequency_hz(table.span_m().1) - table.frequency_hz(table.span_m().0);
            // Such a beat would leave no place.
            if beat_hz > band_hz {
                let range = Range::new(BEAT_RANGE_HZ.0, BEAT_RANGE_HZ.1.min(band_hz), "Hz");
                OutOfRange::check("beat frequency", beat_hz, range)?;
            }
            Ok(plain(beat(palette, place_m, beat_hz)?.to_vec()))
        }
    }
}

fn fitted(palette: &Palette<'_>, target: Target, texture: Texture) -> Result<Made, TextureError> {
    let worst = texture.worst(palette, &target)?;
    let tones = texture.tones.clone();
    let fitted = Some(Fitted { target, texture, worst, has_level: false, rest: None });
    Ok(Made { tones, fitted, stripes_m: None, stripes_felt_db: None })
}

impl Fitted {
    /// Weight of the error at each place; 0 where the target is free.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        self.target.weight()
    }

    /// Whether it is an area, whose end is chosen by its loudness.
    #[must_use]
    pub fn is_solid(&self) -> bool {
        self.texture.figures.ripple_db.is_some()
    }
}

impl Made {
    /// The same texture with `rms_m` metres at its largest wanted amplitude, or as loud as its tones can be; unchanged
    /// where nothing was fitted.
    #[must_use]
    pub fn at_level(mut self, rms_m: f64, palette: &Palette<'_>) -> Self {
        if let Some(fitted) = &mut self.fitted {
            fitted.texture = fitted.texture.at_level(rms_m, palette);
            fitted.has_level = true;
            self.tones = fitted.texture.tones.clone();
        }
        self
    }

    /// The texture after the slower steps: its tones on the multiples of a chord, where the fit is nearly as good, and the
    /// error that any number of tones would leave.
    ///
    /// # Errors
    /// [`TextureError::Silent`] if the plate does not respond, [`TextureError::Stopped`].
    pub fn finished(
        self,
        palette: &Palette<'_>,
        feeling: &Feeling,
        progress: &mut Progress<'_>,
    ) -> Result<Self, TextureError> {
        let Some(Fitted { target, texture, has_level, .. }) = self.fitted else { return Ok(self) };
        progress.at(0.0)?;
        let chord = texture.on_grid(palette, &target)?.map(|chord| {
            let is_used = chord.is_as_good_as(&texture);
            (chord, is_used)
        });
        progress.at(0.4)?;
        let largest_square_error = least_largest_square_error(palette, &target)?;
        let texture = match &chord {
            // As loud as the free tones, which may have been lowered below the DAC's limit.
            Some((chord, true)) => chord.texture.as_loud_as(&texture),
            _ => texture,
        };
        let flutter = texture.flutter(palette, &target)?;
        let by_person = flutter.map(|_| texture.edges_by_person(palette, feeling)).transpose()?;
        let made = fitted(palette, target, texture)?;
        let rest = Some(Rest { chord, flutter, by_person, largest_square_error });
        Ok(Self { fitted: made.fitted.map(|fitted| Fitted { rest, has_level, ..fitted }), ..made })
    }

    /// Gain of the chord over separate tones, in dB; `None` if the texture is no chord.
    #[must_use]
    pub fn chord_gain_db(&self) -> Option<f64> {
        let fitted = self.fitted.as_ref()?;
        let (chord, is_used) = fitted.rest.as_ref()?.chord.as_ref()?;
        // A louder solid area would be felt beyond its wanted end.
        let keeps_level = fitted.is_solid() || fitted.has_level;
        is_used.then_some(if keeps_level { 0.0 } else { chord.gain_db })
    }

    /// The change of a setup that plays it.
    #[must_use]
    pub fn edit(&self) -> Edit {
        Edit::Texture { tones: tones_of(&self.tones), chord_gain_db: self.chord_gain_db() }
    }

    /// The setup that plays it on its plate.
    #[must_use]
    pub fn setup(&self, plate: Arc<Plate>) -> Setup {
        Setup { chord_gain_db: self.chord_gain_db(), ..setup_of(plate, &self.tones) }
    }

    /// Which part of the target cannot be reached; `None` if all can. `most` is the number of tones that were allowed.
    #[must_use]
    pub fn lack(&self, most: usize) -> Option<Lack> {
        let Fitted { texture, .. } = self.fitted.as_ref()?;
        let (is, reach) = (texture.figures, texture.reach);
        let percent = |share: f64| format!("{} %", with_decimals(100.0 * share, 1));
        let decibel = |value: f64| format!("{} dB", with_decimals(value, 1));
        if let (Some(ripple_db), Some(contrast_db)) = (reach.ripple_db, reach.contrast_db) {
            if ripple_db > EVEN_DB || contrast_db < CLEAR_DB {
                let (ripple, contrast) = (decibel(ripple_db), decibel(contrast_db));
                return Some(Lack::Reach(format!(
                    "This plate has no more even area, whatever the number of tones: with any number the ripple is \
                     {ripple} and the contrast {contrast}."
                )));
            }
        } else if reach.rms_error > FINE {
            let error = percent(reach.rms_error);
            return Some(Lack::Reach(format!(
                "The target cannot be reached exactly: any number of tones leaves an error of {error}. Every tone vibrates \
                 everywhere before its turning point, so the amplitude can fall along the plate but hardly rise."
            )));
        }
        let is_short = self.tones.len() >= most && is.rms_error > FINE;
        (is_short && reach.rms_error < WORTH_IT * is.rms_error).then(|| {
            let (is, reach) = (percent(is.rms_error), percent(reach.rms_error));
            let leave = if most == 1 { "tone leaves" } else { "tones leave" };
            Lack::Tones(format!("{most} {leave} an error of {is}; any number would leave {reach}."))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::DriveTable;

    fn membrane() -> (Plate, DriveTable) {
        let plate = slipline_plate::preset("membrane").unwrap();
        let table = DriveTable::build(&plate, 400e3, 129).unwrap();
        (plate, table)
    }

    fn made(wish: &Wish, most: usize) -> Made {
        let (plate, table) = membrane();
        let (palette, feeling) = (Palette::new(&plate, &table), Feeling::default());
        make(&palette, wish, most, &feeling, &mut Progress::unwatched()).unwrap()
    }

    #[test]
    fn only_what_is_out_of_reach_is_reported() {
        let falls = Wish::Profile(vec![(0.01, 1.0), (0.28, 0.1)]);
        assert_eq!(made(&falls, 16).lack(16), None);
        let rises = made(&Wish::Profile(vec![(0.01, 0.1), (0.25, 1.0)]), 16);
        let Some(Lack::Reach(sentence)) = rises.lack(16) else { panic!("it is within reach") };
        assert!(
            sentence.starts_with("The target cannot be reached exactly: any number of tones leaves"),
            "{sentence}"
        );
        let Some(Lack::Tones(few)) = made(&falls, 1).lack(1) else { panic!("one is enough") };
        assert!(few.starts_with("1 tone leaves an error of"), "{few}");
        assert_eq!(made(&Wish::Solid(0.28), 16).lack(16), None);
        assert_eq!(made(&Wish::Stripes(0.05), 16).lack(16), None);
    }

    #[test]
    fn a_finished_area_states_its_flutter_and_where_persons_feel_it_end() {
        let (plate, table) = membrane();
        let (palette, feeling) = (Palette::new(&plate, &table), Feeling::default());
        let rest = |wish| {
            let made = made(&wish, 8);
            let made = made.finished(&palette, &feeling, &mut Progress::unwatched()).unwrap();
            made.fitted.and_then(|fitted| fitted.rest).unwrap()
        };
        let area = rest(Wish::Solid(0.25));
        assert!(area.flutter.is_some_and(|flutter| flutter.swing_db > 3.0), "{:?}", area.flutter);
        let by_person = area.by_person.unwrap();
        let (near_m, far_m) = (by_person.near.place_m().unwrap(), by_person.far.place_m().unwrap());
        assert!(near_m < 0.25 && 0.25 < far_m && far_m - near_m < 0.02, "{by_person:?}");
        let profile = rest(Wish::Profile(vec![(0.01, 1.0), (0.28, 0.1)]));
        assert_eq!((profile.flutter, profile.by_person), (None, None));
    }

    #[test]
    fn an_area_that_is_no_longer_wanted_is_cancelled() {
        let (plate, table) = membrane();
        let palette = Palette::new(&plate, &table);
        let mut reports = 0;
        let mut go_on = |_| {
            reports += 1;
            reports < 4
        };
        let given_up =
            make(&palette, &Wish::Solid(0.25), 16, &Feeling::default(), &mut Progress::new(&mut go_on));
        assert!(matches!(given_up, Err(TextureError::Stopped(_))), "it was made");
        assert_eq!(reports, 4);
    }
}
