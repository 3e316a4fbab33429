//! A finger on the plate in the app: its properties, and the amplitudes under it in the last seconds.
//!
//! All values are illustrative: fingers differ, and so does what they feel.

mod trace;

pub(crate) use trace::mean_over_contact;
pub use trace::{Met, TRACE_S, Trace, Under};

use slipline_plate::{Finger, Plate, RespondError};

/// The kind of touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Touch {
    /// No finger.
    #[default]
    None,
    /// A finger that feels and takes nothing: it has no impedance, so the plate moves as without it.
    Ideal,
    /// A finger that strokes.
    Light,
    /// A finger that presses.
    Firm,
}

impl Touch {
    /// The finger at a place, in metres from the driven end.
    #[must_use]
    pub fn at(self, place_m: f64) -> Option<Finger> {
        match self {
            Self::None => None,
            Self::Ideal => Some(Finger { resistance_n_s_per_m: 0.0, mass_kg: 0.0, ..Finger::light(place_m) }),
            Self::Light => Some(Finger::light(place_m)),
            Self::Firm => Some(Finger::firm(place_m)),
        }
    }

    /// Whether the plate moves otherwise under it.
    #[must_use]
    pub const fn loads(self) -> bool {
        match self {
            Self::None | Self::Ideal => false,
            Self::Light | Self::Firm => true,
        }
    }
}

/// Why this plate cannot be touched, if so: its file lacks the mass that moves with the wave.
#[must_use]
pub fn refusal(plate: &Plate) -> Option<RespondError> {
    let (low_hz, _) = plate.band_hz();
    Finger::light(0.0).load(plate, low_hz).err()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::steady_field::{SteadyField, SteadyTone};

    #[test]
    fn a_firm_finger_takes_the_peak_down_and_a_light_one_less() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let tone = SteadyTone { slot: 0, frequency_hz: plate.frequency_for_boundary_hz(0.18), peak_m: 1e-4 };
        let solved = |finger: Option<Finger>| SteadyField::solve_touched(&plate, &[tone], finger.as_ref());
        let peak_m = solved(None).tones[0].peak_position_m.unwrap();
        let height_m = |touch: Touch| solved(touch.at(peak_m)).bound_at(peak_m);
        let [none, ideal, light, firm] = [Touch::None, Touch::Ideal, Touch::Light, Touch::Firm].map(height_m);
        assert!((ideal / none - 1.0).abs() < 1e-9 && !Touch::Ideal.loads() && Touch::Light.loads());
        assert!((none / 1e-4 - 1.0).abs() < 0.01 && firm < 0.2 * none && firm < light && light < none);
    }

    #[test]
    fn a_plate_whose_file_does_not_state_its_weight_is_refused_by_the_fields_name() {
        let plate = slipline_plate::preset("membrane").unwrap();
        assert_eq!(refusal(&plate), None);
        let text = plate.to_toml().replace("tension_n_per_m = 40.0\n", "");
        let untold = Plate::from_toml(&text).unwrap();
        assert!(refusal(&untold).unwrap().to_string().contains("tension_n_per_m"));
    }
}
