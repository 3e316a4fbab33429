//! Hum of the mains: at 50 and 60 Hz and their multiples, an input receives what no tone has caused.

/// Frequencies of the world's mains, Hz.
const MAINS_HZ: [f64; 2] = [50.0, 60.0];
/// Distance that every tone keeps from the hum, Hz: the mains drift by 0.2 Hz, and a window of a second resolves the rest.
const GUARD_HZ: f64 = 1.0;
/// Rounding of a frequency that keeps exactly that distance, Hz.
const ROUNDING_HZ: f64 = 1e-6;

/// Whether a tone is too near to the hum.
pub(super) fn is_hum(frequency_hz: f64) -> bool {
    MAINS_HZ.iter().any(|mains_hz| {
        let multiple = (frequency_hz / mains_hz).round().max(1.0);
        (frequency_hz - multiple * mains_hz).abs() < GUARD_HZ - ROUNDING_HZ
    })
}

/// This number of frequencies (2 or more) over a band, uniform in the logarithm of what is away from the hum, rising; `None` for a band
/// that is hum alone.
pub(super) fn away_from_hum(low_hz: f64, high_hz: f64, count: usize) -> Option<Vec<f64>> {
    let clear = clear(low_hz, high_hz);
    let lengths = || clear.iter().map(|(from_hz, to_hz)| (to_hz / from_hz).ln());
    let all: f64 = lengths().sum();
    let (&(first_hz, _), &(_, last_hz)) = (clear.first()?, clear.last()?);
    let frequency_hz = |point: usize| {
        if point + 1 == count {
            return last_hz;
        }
        let mut left = all * point as f64 / (count - 1) as f64;
        for (&(from_hz, to_hz), length) in clear.iter().zip(lengths()) {
            if left <= length {
                return (from_hz * left.exp()).min(to_hz);
            }
            left -= length;
        }
        last_hz
    };
    Some((0..count).map(|point| if point == 0 { first_hz } else { frequency_hz(point) }).collect())
}

/// The stretches of a band that are away from the hum, rising.
fn clear(low_hz: f64, high_hz: f64) -> Vec<(f64, f64)> {
    let multiples = |mains_hz: f64| {
        let first = ((low_hz - GUARD_HZ) / mains_hz).ceil().max(1.0) as u32;
        let last = ((high_hz + GUARD_HZ) / mains_hz).floor().max(0.0) as u32;
        (first..=last).map(move |multiple| f64::from(multiple) * mains_hz)
    };
    let mut hum: Vec<f64> = MAINS_HZ.into_iter().flat_map(multiples).collect();
    hum.sort_by(f64::total_cmp);
    let mut clear = Vec::with_capacity(hum.len() + 1);
    let mut from_hz = low_hz;
    for hum_hz in hum {
        if hum_hz - GUARD_HZ > from_hz {
            clear.push((from_hz, hum_hz - GUARD_HZ));
        }
        from_hz = from_hz.max(hum_hz + GUARD_HZ);
    }
    if high_hz > from_hz {
        clear.push((from_hz, high_hz));
    }
    clear
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{HarmonicsPlan, MeasureError, Plan, Wanted};
    use slipline_plate::preset;
    use slipline_plate::truth::Random;

    const RATE_HZ: f64 = 400e3;

    /// Distance from the nearest multiple of 50 or 60 Hz.
    fn distance_hz(hertz: f64) -> f64 {
        let from = |mains: f64| (hertz - mains * (hertz / mains).round().max(1.0)).abs();
        from(50.0).min(from(60.0))
    }

    #[test]
    fn a_band_is_covered_up_to_its_ends_and_to_the_hum_within_it() {
        assert_eq!(
            clear(45.0, 130.0),
            [(45.0, 49.0), (51.0, 59.0), (61.0, 99.0), (101.0, 119.0), (121.0, 130.0)]
        );
        let found = away_from_hum(45.0, 130.0, 41).unwrap();
        assert_eq!((found[0], found[40]), (45.0, 130.0));
        assert!(found.is_sorted_by(|one, other| one < other), "{found:?}");
        assert_eq!(away_from_hum(49.5, 50.5, 8), None);
    }

    #[test]
    fn no_tone_of_a_measurement_is_within_a_hertz_of_the_hum_over_random_spans() {
        let plate = preset("membrane").unwrap();
        let mut random = Random::new(11);
        let (mut planned, mut tones) = (0, 0);
        for _ in 0..150 {
            let low_hz = 20.0 * random.within(0.0, 5.0).exp();
            let high_hz = low_hz * (1.1 + random.within(0.0, 4.0));
            let points = random.within(8.0, 200.0) as usize;
            let wanted = Wanted { low_hz, high_hz, points, level: 0.5 };
            let plan = match Plan::new(&plate, &wanted, RATE_HZ, 16) {
                Err(MeasureError::Crowded { .. }) => continue,
                plan => plan.unwrap(),
            };
            planned += 1;
            for hertz in plan.combs.iter().flat_map(|comb| comb.frequencies_hz(RATE_HZ)) {
                tones += 1;
                assert!(distance_hz(hertz) > 0.999, "{wanted:?}: {hertz} Hz");
                assert!(hertz > 0.9 * low_hz && hertz < 1.1 * high_hz, "{wanted:?}: {hertz} Hz");
            }
        }
        assert!(planned > 130 && tones > 10_000, "{planned} {tones}");
    }

    #[test]
    fn neither_a_fundamental_nor_its_harmonics_are_within_a_hertz_of_the_hum() {
        for name in ["membrane", "membrane-heavy", "latex-membrane"] {
            let plate = preset(name).unwrap();
            for points in [2, 8, 31, 64] {
                let plan = HarmonicsPlan::new(&plate, points, 0.5, RATE_HZ).unwrap();
                assert!(plan.combs.len() >= points.min(12), "{name} {points}: {}", plan.combs.len());
                for hertz in plan.combs.iter().flat_map(|comb| comb.frequencies_hz(RATE_HZ)) {
                    assert!(distance_hz(hertz) > 0.999, "{name} {points}: {hertz} Hz");
                }
            }
        }
    }
}
