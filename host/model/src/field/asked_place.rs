//! The place by which a tone is asked for, and the turning point of this tone.
//!
//! ```text
//! turning point, frequency --the plate's span, band--> turning point
//! felt edge ---------------table, level, feeling-----> turning point (edge_reach)
//! ```

use super::edge_reach::{NoFeltEdge, turning_point_of};
use crate::setup::Setup;
use slipline_plate::quantity::{OutOfRange, PlaceOrFrequency, Range};
use slipline_plate::{DriveTable, Plate};

/// The place that defines a tone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AskedPlace {
    /// The place where a finger feels it end, in metres from the driven end.
    FeltEdge(f64),
    /// The place where its wave turns, or its frequency.
    TurningPoint(PlaceOrFrequency),
}

/// Why no tone is as asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoSuchTone {
    /// The turning point is outside the plate's span, or the frequency outside its band.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// No tone of this level has this felt edge, in metres.
    #[error("{}", .1.sentence(format_args!("felt_edge_m = {} m", .0)))]
    NoFeltEdge(f64, NoFeltEdge),
}

/// The turning point in metres, within the plate's span: this place, or that of the tone of this frequency.
///
/// # Errors
/// [`OutOfRange`] with the plate's span or band.
pub fn turning_point_on(asked: PlaceOrFrequency, plate: &Plate) -> Result<f64, OutOfRange> {
    let (start_m, end_m) = plate.span_m();
    match asked {
        PlaceOrFrequency::Place(place_m) => {
            OutOfRange::check("turning_point_m", place_m, Range::new(start_m, end_m, "m"))?;
            Ok(place_m)
        }
        PlaceOrFrequency::Frequency(hz) => {
            let (low_hz, high_hz) = plate.band_hz();
            let range = Range::new(low_hz, high_hz, "Hz");
            let place_m = plate.turning_point_m(hz).filter(|_| range.contains(hz));
            let refused = OutOfRange { field: "frequency_hz", value: hz, range };
            place_m.map(|place_m| place_m.clamp(start_m, end_m)).ok_or(refused)
        }
    }
}

impl AskedPlace {
    /// The turning point in metres of the tone of this level, on the plate of a setup and for its feeling; `table` is that of
    /// the plate.
    ///
    /// # Errors
    /// [`NoSuchTone`]
    pub fn turning_point_m(self, setup: &Setup, level: f64, table: &DriveTable) -> Result<f64, NoSuchTone> {
        match self {
            Self::TurningPoint(asked) => Ok(turning_point_on(asked, &setup.plate)?),
            Self::FeltEdge(place_m) => turning_point_of(setup, level, table, place_m)
                .map_err(|refusal| NoSuchTone::NoFeltEdge(place_m, refusal)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn one_tone_is_found_by_its_felt_edge_its_turning_point_and_its_frequency() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let table = DriveTable::build(&plate, 400e3, 65).unwrap();
        let setup = Setup::new(Arc::clone(&plate));
        let turns = |at: AskedPlace| at.turning_point_m(&setup, 0.8, &table);
        let place = |place_m| AskedPlace::TurningPoint(PlaceOrFrequency::Place(place_m));
        let tone = |hz| AskedPlace::TurningPoint(PlaceOrFrequency::Frequency(hz));
        assert_eq!(turns(place(0.16)), Ok(0.16));
        let by_frequency_m = turns(tone(plate.frequency_for_boundary_hz(0.16))).unwrap();
        assert!((by_frequency_m - 0.16).abs() < 1e-9, "{by_frequency_m}");
        let by_edge_m = turns(AskedPlace::FeltEdge(0.21)).unwrap();
        assert!((0.1..0.21).contains(&by_edge_m), "{by_edge_m}");

        for (asked, words) in [
            (place(0.4), "turning_point_m = 0.4 m: must be "),
            (place(f64::NAN), "turning_point_m = NaN m: must be "),
            (tone(1.0), "frequency_hz = 1 Hz: must be "),
            (AskedPlace::FeltEdge(0.01), "felt_edge_m = 0.01 m: must be "),
        ] {
            let refusal = turns(asked).unwrap_err().to_string();
            assert!(refusal.starts_with(words), "{refusal}");
        }
    }
}
