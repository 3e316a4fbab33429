//! `calibrate --touch`: a felt edge.

use super::argument::{self, PlaceArgument, Typed};
use super::failure::Failure;
use slipline_instrument::requests::{FeltEdgeError, FeltEdgeRequest};
use slipline_model::field::asked_place::{AskedPlace, NoSuchTone};
use slipline_plate::Plate;
use slipline_plate::quantity::{Measure, PlaceOrFrequency};

/// A felt edge on the command line: the requested one, or the tone's frequency, and where the finger felt it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TouchArgument {
    asked: PlaceArgument,
    felt: Typed<f64>,
}

/// Parses `250mm:246mm`, the requested felt edge and the place where it was felt.
pub(super) fn touch(text: &str) -> Result<TouchArgument, String> {
    let (asked, felt) = text.rsplit_once(':').ok_or("write ASKED:FELT, such as 250mm:246mm")?;
    let asked =
        argument::place_or_frequency(asked).map_err(|error| format!("the felt edge asked for: {error}"))?;
    let felt = argument::place(felt).map_err(|error| format!("where it was felt: {error}"))?;
    Ok(TouchArgument { asked, felt })
}

impl TouchArgument {
    /// The requested place; a frequency is that of the tone.
    pub(super) fn request(&self) -> FeltEdgeRequest {
        let asked = match self.asked.value {
            PlaceOrFrequency::Place(place_m) => AskedPlace::FeltEdge(place_m),
            frequency @ PlaceOrFrequency::Frequency(_) => AskedPlace::TurningPoint(frequency),
        };
        FeltEdgeRequest { asked, felt_m: self.felt.value }
    }

    /// The refusal of this touch on a plate.
    pub(super) fn refused(&self, plate: &Plate, error: &FeltEdgeError) -> Failure {
        if let Err(failure) = self.asked.with_unit(plate, "--touch") {
            return failure;
        }
        match error {
            FeltEdgeError::Felt(refused) => {
                Failure::outside("--touch", &self.felt.text, refused.range, Measure::Length, ", on the plate")
            }
            FeltEdgeError::Asked(NoSuchTone::OutOfRange(refused)) => {
                self.asked.outside(plate, "--touch", refused)
            }
            FeltEdgeError::Asked(NoSuchTone::NoFeltEdge(_, refusal)) => {
                let given = format_args!("invalid value '{}' for '--touch'", self.asked.text);
                let refused = refusal.sentence(given);
                Failure::Usage(format!("{refused}; or name the tone by its frequency (126Hz:246mm)"))
            }
        }
    }
}
