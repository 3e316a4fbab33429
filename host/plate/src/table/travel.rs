//! The peak travel in a table: all gains are lowered together, so that equal level still means equal peak.

use crate::definition::plate::Plate;
use crate::definition::travel::Travel;
use crate::quantity::decibels;

/// Largest travel of a table at level 1, as a fraction of the peak travel. The rest is a margin for the device, which
/// computes the travel in 32-bit floats and adds 0.001 for safety.
pub(crate) const USED: f64 = 0.998;

/// Travel of the actuator by a table's tones at level 1.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TableTravel {
    /// The actuator's resonance, Hz.
    pub resonance_hz: f64,
    /// The quality factor of the resonance.
    pub quality: f64,
    /// Distance from rest under a constant signal at DAC full scale, as a fraction of the peak travel.
    pub static_share: f64,
    /// Largest steady travel of one tone on the span, as a fraction of the peak travel (0 to 1).
    pub largest_share: f64,
    /// Factor on all gains that keeps the peak travel; 1 if they need not be lowered.
    pub scale: f64,
}

impl TableTravel {
    /// Lowers `gain` where a tone at level 1 would exceed the plate's peak travel anywhere on the span. A tone glides
    /// from knot to knot, so between two knots the larger gain is taken with the largest travel.
    pub(super) fn limit(plate: &Plate, frequency_hz: &[f64], gain: &mut [f64]) -> Option<Self> {
        let actuator = plate.spec().actuator.as_ref()?.resonator()?;
        let Travel { peak_m, static_m } = actuator.travel?;
        let mut largest: f64 = 0.0;
        for (ends_hz, gains) in frequency_hz.windows(2).zip(gain.windows(2)) {
            let share = actuator.largest_travel_share(ends_hz[0], ends_hz[1])?;
            largest = largest.max(gains[0].max(gains[1]) * share);
        }
        let scale = scale(largest);
        gain.iter_mut().for_each(|gain| *gain *= scale);
        Some(Self {
            resonance_hz: actuator.resonance_hz,
            quality: actuator.quality,
            static_share: static_m / peak_m,
            largest_share: largest * scale,
            scale,
        })
    }

    /// Reduction of the table's level by the limit, dB (0 or more).
    pub fn lowered_db(&self) -> f64 {
        -decibels(self.scale)
    }
}

/// The factor that reduces the largest travel, as a fraction of the peak travel, to [`USED`].
pub(crate) fn scale(largest_share: f64) -> f64 {
    (USED / largest_share).min(1.0)
}

#[cfg(test)]
mod tests {
    use crate::{Actuator, DriveTable, Plate, Resonator, Travel, preset};

    fn membrane(travel: Option<Travel>) -> Plate {
        let mut spec = preset("membrane").expect("preset").spec().clone();
        spec.actuator = Some(Actuator::Resonator(Resonator { resonance_hz: 100.0, quality: 4.0, travel }));
        Plate::new(spec).expect("plate")
    }

    fn table(travel: Option<Travel>) -> DriveTable {
        DriveTable::build(&membrane(travel), 400e3, 129).expect("a table")
    }

    #[test]
    fn a_table_beyond_the_peak_travel_is_lowered_as_a_whole_and_only_as_far_as_needed() {
        let (free, limited) = (table(None), table(Some(Travel { peak_m: 1e-3, static_m: 8e-3 })));
        let travel = limited.travel().expect("limited");
        assert_eq!(free.travel(), None);
        assert_eq!((travel.resonance_hz, travel.quality, travel.static_share), (100.0, 4.0, 8.0));
        assert!(travel.scale < 0.9 && (travel.largest_share - super::USED).abs() < 1e-12, "{travel:?}");
        for (free, limited) in free.knots().iter().zip(limited.knots()) {
            assert!((limited.gain / free.gain - travel.scale).abs() < 1e-12);
            assert_eq!(limited.frequency_hz, free.frequency_hz);
        }
        let lowered = limited.peak_at_full_scale_m() / free.peak_at_full_scale_m();
        assert!((lowered - travel.scale).abs() < 1e-12, "the stated level is lowered as well");
        assert!(limited.worst_error_db() < free.worst_error_db() + 1e-9);
    }

    #[test]
    fn no_place_of_a_table_moves_the_actuator_farther_than_its_peak_travel() {
        let plate = membrane(Some(Travel { peak_m: 1e-3, static_m: 20e-3 }));
        let table = DriveTable::build(&plate, 400e3, 129).expect("a table");
        let actuator = *plate.spec().actuator.as_ref().and_then(Actuator::resonator).expect("set");
        let (start, end) = plate.span_m();
        let shares = (0..=4000).map(|i| {
            let x = start + (end - start) * f64::from(i) / 4000.0;
            table.gain(x) * actuator.travel_share(table.frequency_hz(x)).expect("limited")
        });
        let largest = shares.fold(0.0, f64::max);
        assert!(largest <= super::USED + 1e-12 && largest > 0.95, "{largest}");
    }

    #[test]
    fn a_resonance_between_two_knots_counts_with_its_peak_and_the_larger_of_their_gains() {
        let spec = preset("membrane").expect("preset").spec().clone();
        let travel = Some(Travel { peak_m: 1e-3, static_m: 1e-3 });
        let sharp = Resonator { resonance_hz: 150.0, quality: 60.0, travel };
        let plate = Plate::new(crate::PlateSpec { actuator: Some(Actuator::Resonator(sharp)), ..spec })
            .expect("plate");
        for gains in [[0.2, 0.8], [0.8, 0.2]] {
            let mut limited = gains;
            let found = super::TableTravel::limit(&plate, &[50.0, 200.0], &mut limited).expect("a limit");
            assert!((found.scale - super::USED / (60.0 * 0.8)).abs() < 1e-4, "{found:?}");
            for i in 0..=1500 {
                let part = f64::from(i) / 1500.0;
                let gain = limited[0] + part * (limited[1] - limited[0]);
                let share = sharp.travel_share(50.0 + part * 150.0).expect("limited");
                assert!(gain * share <= super::USED + 1e-12, "{part}: {}", gain * share);
            }
        }
    }

    #[test]
    fn a_table_within_the_peak_travel_keeps_its_levels_to_the_last_bit() {
        let (free, wide) = (table(None), table(Some(Travel { peak_m: 0.1, static_m: 1e-3 })));
        let travel = wide.travel().expect("limited");
        assert_eq!((travel.scale, travel.lowered_db()), (1.0, 0.0));
        assert!(travel.largest_share < 0.05);
        assert_eq!(wide.knots(), free.knots());
        assert_eq!(wide.peak_at_full_scale_m(), free.peak_at_full_scale_m());
    }
}
