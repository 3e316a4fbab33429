//! Requested tones, each by one of its places or its frequency.

use slipline_model::field::asked_place::{AskedPlace, NoSuchTone};
use slipline_model::setup::{Setup, ToneSetup};
use slipline_plate::DriveTable;

/// A tone that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneRequest {
    /// The place that defines it.
    pub asked: AskedPlace,
    /// Its level, 0 to 1.
    pub level: f64,
}

impl ToneRequest {
    /// The setup of these tones alone, in the slots from 0, with the plate, the feeling and the glide of `like`; `table` is
    /// that of the plate.
    ///
    /// # Errors
    /// The number of the tone that is not as asked, from 0, and why.
    pub fn setup(tones: &[Self], like: Setup, table: &DriveTable) -> Result<Setup, (usize, NoSuchTone)> {
        let mut setup = Setup { tones: Vec::new(), ..like };
        for ((number, slot), &Self { asked, level }) in (0..).zip(0..).zip(tones) {
            let position_m = asked.turning_point_m(&setup, level, table).map_err(|error| (number, error))?;
            setup.tones.push(ToneSetup { slot, position_m, level, phase_turns: 0.0 });
        }
        Ok(setup)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::quantity::PlaceOrFrequency;
    use std::sync::Arc;

    #[test]
    fn tones_fill_the_slots_in_their_order_and_a_refusal_has_its_number() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let table = DriveTable::build(&plate, 400e3, 65).unwrap();
        let at = |place_m| AskedPlace::TurningPoint(PlaceOrFrequency::Place(place_m));
        let tone = |asked| ToneRequest { asked, level: 0.5 };
        let like = Setup { glide_s: 0.3, ..Setup::new(plate) };
        let setup = ToneRequest::setup(&[tone(at(0.2)), tone(at(0.1))], like.clone(), &table).unwrap();
        let found: Vec<_> = setup.tones.iter().map(|tone| (tone.slot, tone.position_m)).collect();
        assert_eq!((&found[..], setup.glide_s), (&[(0, 0.2), (1, 0.1)][..], 0.3));
        let refused = ToneRequest::setup(&[tone(at(0.2)), tone(at(9.0))], like, &table);
        assert!(matches!(refused, Err((1, NoSuchTone::OutOfRange(_)))));
    }
}
