//! Lines that keep their places when a calibrated plate is used. Only its table shows how far a level moves it, and so how far
//! from its turning point a tone is felt: until then the lines are shown where they were, then the tones follow them.

use slipline_plate::Plate;
use std::sync::Arc;

/// The lines before a calibrated plate was used.
pub(super) struct HeldLines {
    /// The calibrated plate.
    pub(super) plate: Arc<Plate>,
    /// The lines' felt edges, by slot and in metres.
    pub(super) edges_m: Vec<(u8, f64)>,
    /// The peak at level 1 that the plate before states, in metres; `None` where nothing is to be said of another one.
    pub(super) full_peak_m: Option<f64>,
}
