//! Sensation of a finger on a simulated plate.

use super::{Simulated, ToneResult};
use crate::field::felt::Felt;
use slipline_plate::feeling::Feeling;
use slipline_plate::{Complex64, Plate};

impl ToneResult {
    fn measured_tone(&self) -> Option<(f64, &[Complex64])> {
        (!self.is_blurred).then_some((self.frequency_hz, &self.field_m[..]))
    }

    /// The sensation of this tone alone, from its measured field; `None` if the window does not resolve it
    /// from another tone. `plate` is the one on which the waves ran.
    #[must_use]
    pub fn felt(&self, plate: &Plate, feeling: &Feeling) -> Option<Felt> {
        self.measured_tone().map(|tone| Felt::of_tones(plate, feeling, &[tone]))
    }
}

impl Simulated {
    /// The sensation of all tones together, from their measured fields; `None` if the window does not resolve
    /// two of them. `plate` is the one on which the waves ran.
    #[must_use]
    pub fn felt(&self, plate: &Plate, feeling: &Feeling) -> Option<Felt> {
        let tones: Option<Vec<(f64, &[Complex64])>> =
            self.tones.iter().map(ToneResult::measured_tone).collect();
        tones.map(|tones| Felt::of_tones(plate, feeling, &tones))
    }
}
