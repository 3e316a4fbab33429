//! Textures: tones whose fields together are close to a wanted RMS amplitude over the plate.
//!
//! ```text
//! Target (wanted mean square, weight at each place)
//!    |          Palette: mean square of a tone of level 1, for any turning point of the table
//!    v            v
//! non-negative least squares over candidates -> the fewest tones -> moved off the candidates -> Texture
//!        (nnls)                                   (selection)          (refinement)
//! ```
//! Tones of different frequencies add in power, so the mean square of the sum is linear in the tones' powers, and the
//! best powers are the solution of a convex problem: no number of tones can remove the error that it leaves. This is
//! the mean over all times; the swing of the sum about it is its flutter.

mod crest;
mod error;
mod figures;
mod fit;
mod flutter;
pub mod nnls;
mod on_grid;
mod palette;
mod pattern;
mod phases;
mod reach;
mod refinement;
mod selection;
mod solid;
mod target;

pub use error::TextureError;
pub use figures::Figures;
pub use fit::{TONES_MAX, Texture, TextureTone};
pub use flutter::{FLUTTER_WINDOW_S, Flutter};
pub use on_grid::{CHORD_PERIOD, ChordTexture};
pub use palette::{PLACES, Palette};
pub use pattern::{BEAT_RANGE_HZ, beat, stripes, stripes_felt_db, stripes_m};
pub use reach::{least_largest_error, least_largest_square_error};
pub use target::{Target, Wanted};
