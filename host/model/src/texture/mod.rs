//! Textures of the user: the wish, its files, and the setup that plays it.
//!
//! ```text
//! CSV, PNG --> breakpoints (profile_file) --> Wish --making: slipline_plate::texture--> Made --> Setup --> chord, drive
//! ```

mod chord;
mod draft;
mod drawing;
mod making;
mod profile_file;

pub use chord::{chord_of, sounding};
pub use draft::{BREAKPOINTS_DRAWN_MAX, WishDraft, WishKind};
pub use making::{Fitted, Lack, Made, Rest, Wish, make};
pub use profile_file::{
    PROFILE_FILE_BYTES_MAX, ProfileFileError, ProfileRead, ProfileTable, from_csv, from_png,
};

use crate::setup::{BoundaryMode, MAX_TONES, Setup, ToneSetup};
use slipline_plate::Plate;
use slipline_plate::texture::TextureTone;
use std::sync::Arc;

/// A setup's tones for a texture's: the last one, which forms the edge, becomes the boundary. A setup has 16 at most; the
/// first of a longer list are left out.
fn tones_of(tones: &[TextureTone]) -> Vec<ToneSetup> {
    let tones = tones.iter().rev().take(MAX_TONES).zip(0..).map(|(tone, slot)| ToneSetup {
        slot,
        position_m: tone.position_m,
        level: tone.level,
        phase_turns: tone.phase_turns,
    });
    tones.collect()
}

/// The setup that plays these tones.
#[must_use]
pub fn setup_of(plate: Arc<Plate>, tones: &[TextureTone]) -> Setup {
    Setup { tones: tones_of(tones), boundary: BoundaryMode::TurningPoint, ..Setup::new(plate) }
}
