//! Audible pitch of a plate's tones.

use slipline_plate::order;

/// Difference of two tones below which their beat is felt, in Hz: their difference is kept.
const BEATS_HZ: f64 = 500.0;
/// Tones above this frequency are inaudible to some people, in Hz.
const HEARD_HZ: f64 = 10_000.0;
/// The top of a plate's band is shifted below this frequency, in Hz, where the ear is most sensitive.
const COMFORTABLE_HZ: f64 = 2_500.0;

/// The downward shift of a plate's tones in octaves. It is the same for all tones of a plate, so that
/// intervals are kept and the pitch follows a moving boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pitch {
    octaves: u8,
}

impl Pitch {
    /// The shift for a plate whose band ends at this frequency, in Hz: zero if all of it is audible.
    #[must_use]
    pub(crate) fn of_band(highest_hz: f64) -> Self {
        let mut pitch = Self { octaves: 0 };
        if highest_hz > HEARD_HZ {
            while highest_hz / pitch.factor() > COMFORTABLE_HZ && pitch.octaves < 32 {
                pitch.octaves += 1;
            }
        }
        pitch
    }

    /// The divisor of frequencies: a power of two.
    #[must_use]
    pub fn factor(self) -> f64 {
        f64::from(self.octaves).exp2()
    }

    /// The audible frequencies, in Hz, in the same order. Of tones that beat, the lowest is shifted and the
    /// others keep their difference from it, so that the beat is heard at the rate at which it is felt.
    #[must_use]
    pub(crate) fn heard_hz(self, frequencies_hz: &[f64]) -> Vec<f64> {
        let mut order: Vec<usize> = (0..frequencies_hz.len()).collect();
        order::sort_by(&mut order, |&one, &other| frequencies_hz[one].total_cmp(&frequencies_hz[other]));
        let mut heard = vec![0.0; frequencies_hz.len()];
        let mut lowest_hz = f64::NEG_INFINITY;
        for i in order {
            let frequency_hz = frequencies_hz[i];
            // `false` for the first: its distance is infinite.
            let beats = frequency_hz - lowest_hz < BEATS_HZ;
            if !beats {
                lowest_hz = frequency_hz;
            }
            heard[i] = lowest_hz / self.factor() + (frequency_hz - lowest_hz);
        }
        heard
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn audible_bands_are_heard_as_they_are_and_ultrasound_octaves_lower() {
        assert_eq!(Pitch::of_band(250.0).heard_hz(&[60.0, 90.0]), [60.0, 90.0]);
        let ultrasound = Pitch::of_band(40_000.0);
        assert_eq!(ultrasound.factor(), 16.0);
        assert_eq!(ultrasound.heard_hz(&[40_000.0, 20_000.0]), [2500.0, 1250.0]);
    }

    #[test]
    fn a_beat_is_heard_at_its_own_rate() {
        let ultrasound = Pitch::of_band(40_000.0);
        let heard = ultrasound.heard_hz(&[28_180.0, 28_000.0, 32_000.0]);
        assert_eq!(heard, [1930.0, 1750.0, 2000.0]);
    }

    #[test]
    fn no_frequency_makes_the_shift_fail() {
        assert_eq!(Pitch::of_band(f64::INFINITY).octaves, 32);
        assert_eq!(Pitch::of_band(f64::NAN).octaves, 0);
        assert!(Pitch::of_band(40e3).heard_hz(&[f64::NAN, 1.0])[1] > 0.0);
        assert!(Pitch::of_band(40e3).heard_hz(&[]).is_empty());
    }
}
