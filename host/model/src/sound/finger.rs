//! Sound of the amplitudes under a finger.

use super::{Partial, Pitch, Sound};
use crate::field::steady_field::{POINTS, SteadyField, ToneWave};
use crate::field::touch::{Met, mean_over_contact};
use slipline_plate::{Finger, Plate};

/// Amplitude of a tone whose height under the finger is that of level 1, as a share of full scale. The
/// device's sum of levels is at most 1, so the tones of a drive stay below full scale.
const LOUDNESS: f64 = 0.5;
/// Amplitude of the noise of a fast finger on a plate at rest, as a share of full scale.
const NOISE: f64 = 0.05;
/// Speed of a finger that makes this noise, in metres per second; a slower one makes less.
const FAST_M_PER_S: f64 = 0.1;

/// The sound at this finger on this plate: each tone with its amplitude under the finger, and the noise of
/// the sliding, which is less where friction is less. `full_peak_m` is the table's peak at level 1, in
/// metres; `met` is the latest point of the finger's trace. The noise is illustrative.
#[must_use]
pub fn at_finger(
    plate: &Plate,
    field: &SteadyField,
    finger: &Finger,
    full_peak_m: f64,
    met: Option<&Met>,
) -> Sound {
    let (_, highest_hz) = plate.band_hz();
    let frequencies_hz: Vec<f64> = field.tones.iter().map(|wave| wave.tone.frequency_hz).collect();
    let heard_hz = Pitch::of_band(highest_hz).heard_hz(&frequencies_hz);
    let share = |wave: &ToneWave| {
        let amplitude_m = mean_over_contact(plate, finger, |x_m| {
            let at = (x_m / field.length_m * (POINTS - 1) as f64).round() as usize;
            wave.wave.get(at).map_or(0.0, |amplitude| amplitude.norm())
        });
        let share = LOUDNESS * amplitude_m / full_peak_m;
        if share.is_finite() { share.min(1.0) } else { 0.0 }
    };
    let partials = field.tones.iter().zip(heard_hz);
    let partials = partials.map(|(wave, frequency_hz)| Partial {
        slot: wave.tone.slot,
        frequency_hz,
        amplitude: share(wave),
    });
    let noise = met.map_or(0.0, |met| {
        NOISE * (met.speed_m_per_s / FAST_M_PER_S).clamp(0.0, 1.0) * met.friction.unwrap_or(1.0)
    });
    Sound { partials: partials.collect(), noise }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::steady_field::SteadyTone;

    fn field(plate: &Plate, places_m: &[f64], finger: Option<&Finger>) -> SteadyField {
        let tones = places_m.iter().zip(0..).map(|(&x_m, slot)| SteadyTone {
            slot,
            frequency_hz: plate.frequency_for_boundary_hz(x_m),
            peak_m: 1e-4,
        });
        SteadyField::solve_touched(plate, &tones.collect::<Vec<_>>(), finger)
    }

    #[test]
    fn a_finger_sounds_on_the_peak_and_not_beyond_the_boundary() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let field = field(&plate, &[0.18], None);
        let peak_m = field.tones[0].peak_position_m.unwrap();
        let heard = |place_m| at_finger(&plate, &field, &Finger::light(place_m), 1e-4, None).partials[0];
        let at_peak = heard(peak_m);
        assert_eq!(at_peak.frequency_hz, field.tones[0].tone.frequency_hz);
        assert!((0.8 * LOUDNESS..=LOUDNESS).contains(&at_peak.amplitude), "{at_peak:?}");
        assert!(heard(0.3).amplitude < 0.02 * at_peak.amplitude);
    }

    #[test]
    fn each_tone_sounds_at_its_place_and_ultrasound_is_shifted_down() {
        let plate = slipline_plate::preset("al-bending").unwrap();
        let (start, end) = plate.span_m();
        let places = [start + 0.2 * (end - start), start + 0.8 * (end - start)];
        let field = field(&plate, &places, None);
        let beyond_the_first = 0.5 * (places[1] + field.tones[1].peak_position_m.unwrap());
        let sound = at_finger(&plate, &field, &Finger::light(beyond_the_first), 1e-4, None);
        let [first, second] = [0, 1].map(|i| sound.partials[i]);
        assert!(second.amplitude > 5.0 * first.amplitude, "{sound:?}");
        let [low, high] = [first, second].map(|partial| partial.frequency_hz);
        assert!((500.0..high).contains(&low) && high <= 2500.0, "{low} {high}");
    }

    #[test]
    fn a_finger_that_slides_is_heard_and_less_where_friction_is_less() {
        let plate = slipline_plate::preset("al-bending").unwrap();
        let field = SteadyField::default();
        let noise = |speed_m_per_s, friction| {
            let met = Met { time_s: 0.0, place_m: 0.1, amplitude_m: 0.0, friction, felt: 1.0, speed_m_per_s };
            at_finger(&plate, &field, &Finger::light(0.1), 1e-6, Some(&met)).noise
        };
        assert_eq!(noise(0.0, Some(1.0)), 0.0);
        assert_eq!([noise(0.1, None), noise(1.0, Some(1.0))], [NOISE; 2]);
        assert_eq!(noise(0.05, Some(0.5)), 0.25 * NOISE);
        assert!(at_finger(&plate, &field, &Finger::light(0.1), 1e-6, None).is_silent());
    }

    #[test]
    fn a_table_without_a_height_gives_no_sound_out_of_range() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let field = field(&plate, &[0.18], None);
        for full_peak_m in [0.0, f64::NAN, 1e-9] {
            let sound = at_finger(&plate, &field, &Finger::light(0.15), full_peak_m, None);
            assert!((0.0..=1.0).contains(&sound.partials[0].amplitude), "{sound:?}");
        }
    }
}
