//! Solid areas with a given felt edge.

use super::error::TextureError;
use super::fit::Texture;
use super::palette::Palette;
use super::target::Target;
use crate::feeling::{EdgesByPerson, Feeling, FeltEdge, FeltTone};
use crate::progress::Progress;
use crate::quantity::{OutOfRange, Range};

/// Tolerated distance from the wanted felt edge, metres.
const CLOSE_M: f64 = 1e-5;
/// Largest number of bisection steps.
const TRIES: usize = 24;

impl Texture {
    /// The felt edge of these tones.
    ///
    /// # Errors
    /// [`TextureError::Silent`] if the plate does not respond.
    pub fn felt_edge(&self, palette: &Palette<'_>, feeling: &Feeling) -> Result<FeltEdge, TextureError> {
        Ok(Feeling::edge(palette.plate(), &self.strength(palette, feeling)?))
    }

    /// The felt edges of these tones for persons with a high and with a low threshold.
    ///
    /// # Errors
    /// [`TextureError::Silent`] if the plate does not respond.
    pub fn edges_by_person(
        &self,
        palette: &Palette<'_>,
        feeling: &Feeling,
    ) -> Result<EdgesByPerson, TextureError> {
        Ok(Feeling::edges_by_person(palette.plate(), &self.strength(palette, feeling)?))
    }

    /// Strength of the sensation at each of the palette's places, see [`Feeling::strength`].
    fn strength(&self, palette: &Palette<'_>, feeling: &Feeling) -> Result<Vec<f64>, TextureError> {
        let positions_m: Vec<f64> = self.tones.iter().map(|tone| tone.position_m).collect();
        let columns = palette.squares(&positions_m)?;
        let peak_m = palette.table().peak_at_full_scale_m();
        let fields: Vec<Vec<f64>> = columns
            .iter()
            .zip(&self.tones)
            .map(|(column, tone)| {
                column.iter().map(|square| square * (tone.level * peak_m).powi(2)).collect()
            })
            .collect();
        let felt: Vec<FeltTone<'_>> = fields
            .iter()
            .zip(&self.tones)
            .map(|(squares, tone)| FeltTone { frequency_hz: tone.frequency_hz, squares })
            .collect();
        Ok(feeling.strength(palette.plate(), &felt))
    }

    /// A solid area of at most `most` tones (1 to 16) that is felt up to `felt_edge_m`, and its target, which holds the
    /// turning point. Progress is reported, and the caller can stop it.
    ///
    /// # Errors
    /// As [`Texture::fit`]; [`TextureError::OutOfRange`] with the range of the felt edges of the span's turning points
    /// if `felt_edge_m` is outside it; [`TextureError::NotFelt`] if nothing is felt, or the whole plate;
    /// [`TextureError::Stopped`].
    pub fn solid_to(
        palette: &Palette<'_>,
        felt_edge_m: f64,
        most: usize,
        feeling: &Feeling,
        progress: &mut Progress<'_>,
    ) -> Result<(Self, Target), TextureError> {
        let mut tried = 0;
        let mut at = |turning_point_m: f64| -> Result<(Self, Target, FeltEdge), TextureError> {
            progress.at(f64::from(tried) / (TRIES + 2) as f64)?;
            tried += 1;
            let target = Target::solid(palette, turning_point_m)?;
            let texture = Self::fit(palette, &target, most)?;
            let edge = texture.felt_edge(palette, feeling)?;
            Ok((texture, target, edge))
        };
        let (mut low_m, mut high_m) = (shortest_m(palette), palette.table().span_m().1);
        let (first, last) = (at(low_m)?, at(high_m)?);
        let whole = Range::new(0.0, palette.plate().length_m(), "m");
        // If nothing is felt, the edge counts as one at the driven end.
        let place_m = |edge: FeltEdge| match edge {
            FeltEdge::At(place_m) => place_m,
            FeltEdge::Nowhere => whole.low,
            FeltEdge::PlateEnd => whole.high,
        };
        let (nearest_m, farthest_m) = (place_m(first.2), place_m(last.2));
        if nearest_m >= whole.high || farthest_m <= whole.low {
            return Err(TextureError::NotFelt { edge: first.2 });
        }
        OutOfRange::check("felt edge", felt_edge_m, Range::new(nearest_m, farthest_m, "m"))?;
        if felt_edge_m - nearest_m < CLOSE_M {
            return Ok((first.0, first.1));
        }
        // The nearest area found so far whose edge is at the wanted place or beyond it.
        let mut far = last;
        for _ in 0..TRIES {
            if place_m(far.2) - felt_edge_m < CLOSE_M {
                break;
            }
            let middle_m = 0.5 * (low_m + high_m);
            let found = at(middle_m)?;
            if place_m(found.2) < felt_edge_m {
                low_m = middle_m;
            } else {
                high_m = middle_m;
                far = found;
            }
        }
        // Where another set of tones becomes the best, the felt edge jumps; a lower level then moves the edge back.
        let (mut low, mut high) = (0.0, 1.0);
        while place_m(far.2) - felt_edge_m >= CLOSE_M && high - low > 1e-6 {
            let middle = 0.5 * (low + high);
            let quieter = far.0.scaled(middle);
            let edge = quieter.felt_edge(palette, feeling)?;
            if place_m(edge) < felt_edge_m {
                low = middle;
            } else {
                high = middle;
                if place_m(edge) - felt_edge_m < CLOSE_M {
                    far = (quieter, far.1, edge);
                }
            }
        }
        Ok((far.0, far.1))
    }
}

/// The nearest turning point of the span with an even area of at least two places, metres.
fn shortest_m(palette: &Palette<'_>) -> f64 {
    let table = palette.table();
    let (mut short_m, mut long_m) = table.span_m();
    if Target::solid(palette, short_m).is_ok() {
        return short_m;
    }
    for _ in 0..TRIES {
        let middle_m = 0.5 * (short_m + long_m);
        if Target::solid(palette, middle_m).is_ok() { long_m = middle_m } else { short_m = middle_m }
    }
    long_m
}
