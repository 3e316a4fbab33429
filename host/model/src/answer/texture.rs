//! Textures.

use super::ToneAnswer;
use super::tone::edges_m;
use crate::field::simulation::SAMPLE_RATE_HZ;
use crate::field::tone_places::TonePlaces;
use crate::texture::{self, Fitted, Made, ProfileRead, Rest, Wish};
use serde::Serialize;
use slipline_plate::feeling::Feeling;
use slipline_plate::texture::{CHORD_PERIOD, ChordTexture, Figures, Palette, TextureError};
use slipline_plate::{Plate, Progress};

/// Makes a texture of at most `most` tones (1 to 16), the slower steps included, for a usual finger.
///
/// # Errors
/// [`TextureError`]: the unsuitable value and its range, or that the caller has cancelled it.
pub fn make(
    palette: &Palette<'_>,
    wish: &Wish,
    most: usize,
    progress: &mut Progress<'_>,
) -> Result<Made, TextureError> {
    let feeling = Feeling::default();
    let made = texture::make(palette, wish, most, &feeling, &mut progress.part(0.0, 0.6))?;
    made.finished(palette, &feeling, &mut progress.part(0.6, 1.0))
}

/// The fields of `slipline texture --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TextureAnswer<'a> {
    /// JSON, text: Name of the plate
    pub plate: &'a str,
    /// The tones.
    pub tones: Vec<TextureToneAnswer>,
    /// JSON, 1: Error of the RMS amplitude, over its largest value
    pub rms_error: Option<f64>,
    /// JSON: Ripple of the area; null where there is none
    pub ripple_db: Option<f64>,
    /// JSON: Level before the edge over the level behind it
    pub contrast_db: Option<f64>,
    /// Felt edge of a dull and of a keen finger; `None` where none is felt.
    pub felt_edge_by_person_m: Option<[Option<f64>; 2]>,
    /// JSON: Swing of the RMS over 30 ms within a second, at the median place
    pub flutter_db: Option<f64>,
    /// JSON: Frequency of this swing
    pub flutter_hz: Option<f64>,
    /// JSON: Largest swing of the RMS over 30 ms in the area
    pub flutter_largest_db: Option<f64>,
    /// JSON: Place of that swing
    pub flutter_largest_m: Option<f64>,
    /// JSON, 1: As `rms_error`, the worst within the tolerances
    pub worst_rms_error: Option<f64>,
    /// JSON: As `ripple_db`, the worst within the tolerances
    pub worst_ripple_db: Option<f64>,
    /// What any number of tones would reach.
    pub reach: Option<ReachAnswer>,
    /// JSON: Places along the plate, or the turning point of a knot
    pub position_m: Option<&'a [f64]>,
    /// JSON: The wanted RMS amplitude at each place
    pub wanted_rms_m: Option<&'a [f64]>,
    /// JSON: RMS amplitude at each place
    pub rms_m: Option<&'a [f64]>,
    /// JSON: Distance of the stripes in the middle; null for others
    pub stripes_m: Option<f64>,
    /// JSON: Depth of the stripes under a contact, in the middle; null for others
    pub stripes_felt_db: Option<f64>,
    /// The texture as a chord.
    pub chord: Option<ChordAnswer<'a>>,
    /// `None` where the profile is none of a table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read: Option<&'a ProfileReadAnswer>,
}

/// The fields of a profile's table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ProfileReadAnswer {
    /// JSON, text: The file that was read
    pub file: String,
    /// How the file was read.
    #[serde(flatten)]
    pub read: ProfileRead,
}

/// The fields of a tone of a texture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TextureToneAnswer {
    /// The tone.
    #[serde(flatten)]
    pub tone: ToneAnswer,
    /// JSON, turns: Phase of the tone
    pub phase_turns: f64,
}

/// The fields of what any number of tones would reach.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReachAnswer {
    /// The figures of merit.
    #[serde(flatten)]
    pub figures: Figures,
    /// JSON, 1: Largest error of the square of the amplitude with any number of tones
    pub largest_square_error: Option<f64>,
}

/// The fields of a texture as a chord.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChordAnswer<'a> {
    /// JSON, true or false: Whether the chord is used
    pub is_used: bool,
    /// JSON: The tones of a chord are multiples of this frequency
    pub base_frequency_hz: f64,
    /// JSON, count: Multiples of the base frequency, one for each tone
    pub harmonics: &'a [u32],
    /// JSON: How much louder the chord is than the sum of its tones allows; null where it is none
    pub chord_gain_db: Option<f64>,
    /// Level of the input below the end of its range; of a chord, above the sum of its tones.
    pub headroom_db: f64,
    /// The figures of merit.
    #[serde(flatten)]
    pub figures: Figures,
}

impl<'a> TextureAnswer<'a> {
    /// The fields of a texture; `places` are those of its setup, whose tones stand the other way round.
    #[must_use]
    pub fn of(plate: &'a Plate, made: &'a Made, places: &[TonePlaces]) -> Self {
        let Made { tones, fitted, stripes_m, stripes_felt_db } = made;
        let fitted = fitted.as_ref();
        let rest = fitted.and_then(|it| it.rest.as_ref());
        let flutter = rest.and_then(|rest| rest.flutter);
        let tones = tones.iter().zip(places.iter().rev()).map(|(tone, places)| TextureToneAnswer {
            tone: ToneAnswer { level: tone.level, ..ToneAnswer::of(places, tone.frequency_hz) },
            phase_turns: tone.phase_turns,
        });
        let chord = rest.and_then(|rest| rest.chord.as_ref());
        Self {
            plate: plate.name(),
            tones: tones.collect(),
            rms_error: fitted.map(|it| it.texture.figures.rms_error),
            ripple_db: fitted.and_then(|it| it.texture.figures.ripple_db),
            contrast_db: fitted.and_then(|it| it.texture.figures.contrast_db),
            felt_edge_by_person_m: rest.and_then(|rest| rest.by_person).map(edges_m),
            flutter_db: flutter.map(|flutter| flutter.swing_db),
            flutter_hz: flutter.map(|flutter| flutter.frequency_hz),
            flutter_largest_db: flutter.map(|flutter| flutter.largest_db),
            flutter_largest_m: flutter.map(|flutter| flutter.largest_at_m),
            worst_rms_error: fitted.map(|it| it.worst.rms_error),
            worst_ripple_db: fitted.and_then(|it| it.worst.ripple_db),
            reach: fitted.map(|it| ReachAnswer::of(it, rest)),
            position_m: fitted.map(|it| &it.texture.places_m[..]),
            wanted_rms_m: fitted.map(|it| &it.texture.wanted_m[..]),
            rms_m: fitted.map(|it| &it.texture.rms_m[..]),
            stripes_m: *stripes_m,
            stripes_felt_db: *stripes_felt_db,
            chord: chord.map(|(chord, is_used)| ChordAnswer::of(chord, *is_used, made)),
            read: None,
        }
    }
}

impl ReachAnswer {
    fn of(Fitted { texture, .. }: &Fitted, rest: Option<&Rest>) -> Self {
        Self { figures: texture.reach, largest_square_error: rest.map(|rest| rest.largest_square_error) }
    }
}

impl<'a> ChordAnswer<'a> {
    fn of(chord: &'a ChordTexture, is_used: bool, made: &Made) -> Self {
        Self {
            is_used,
            base_frequency_hz: f64::from(SAMPLE_RATE_HZ) / f64::from(CHORD_PERIOD),
            harmonics: &chord.harmonics,
            chord_gain_db: made.chord_gain_db(),
            headroom_db: chord.gain_db,
            figures: chord.texture.figures,
        }
    }
}
