//! The actuator's profile: what the actuator of a board bears. A device keeps it in its flash, and it is in force for every host.

use crate::limits::{
    COIL_TIME_MS, FULL_SINE_PER_MILLE, MAX_DRIVE_MS, MAX_NAME, MAX_RISE_CDB, MIN_DRIVE_MS,
    PROFILE_SUM_PER_MILLE, QUALITY_PER_MILLE, RESONANCE_UHZ, STATIC_TRAVEL_PPM,
};
use crate::schema::body;
use crate::units::CentiDecibel;
use heapless::String;

body! {
    /// The actuator as a mass on a spring, and how far it may move. A tone of amplitude a (1 = full scale) and frequency f
    /// moves it by `a static_ppm / sqrt((1 - r^2)^2 + (r/Q)^2)` millionths of its peak travel, r = f/f0.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct TravelLimit {
        /// Its resonance f0.
        pub resonance_uhz: u64 ["uHz", RESONANCE_UHZ.0, RESONANCE_UHZ.1],
        /// The quality factor Q of the resonance, in thousandths.
        pub quality_per_mille: u32 ["1/1000", QUALITY_PER_MILLE.0, QUALITY_PER_MILLE.1],
        /// How far a steady signal of full scale would hold it from its rest.
        pub static_ppm: u32 ["1e-6 of the peak travel", STATIC_TRAVEL_PPM.0, STATIC_TRAVEL_PPM.1],
    }
}

body! {
    /// The coil's heat: two masses that a current warms, each by half. The rise of each follows the power with its time constant.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct CoilHeat {
        /// The time constant of the winding.
        pub winding_ms: u32 ["ms", COIL_TIME_MS.0, COIL_TIME_MS.1],
        /// The time constant of the body.
        pub body_ms: u32 ["ms", COIL_TIME_MS.0, COIL_TIME_MS.1],
        /// The rise that a sine of full scale would reach.
        pub full_sine_per_mille: u16 ["1/1000 of its limit", FULL_SINE_PER_MILLE.0, FULL_SINE_PER_MILLE.1],
    }
}

body! {
    /// The actuator's profile.
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct ActuatorProfile {
        /// Its name.
        pub name: String<MAX_NAME> [""],
        /// The largest sum of the amplitudes of tones; of a chord the largest peak.
        pub max_sum_per_mille: u16 ["1/1000 of full scale", PROFILE_SUM_PER_MILLE.0, PROFILE_SUM_PER_MILLE.1],
        /// The limit of the travel, which holds beside that of a session.
        pub travel: Option<TravelLimit> [""],
        /// The coil's heat.
        pub heat: CoilHeat [""],
        /// The largest rise of a level hold.
        pub max_rise: CentiDecibel ["1/100 dB", 0, MAX_RISE_CDB],
        /// The longest drive without a command of the user.
        pub max_drive_ms: u32 ["ms", MIN_DRIVE_MS, MAX_DRIVE_MS],
        /// Whether a stop input is fitted: a contact that is closed while the amplifier may be on.
        pub has_stop_input: bool [""],
    }
}

/// Bytes that a profile takes as [`ActuatorProfile::write`] writes it, at most.
pub const PROFILE_BYTES: usize = 96;

impl ActuatorProfile {
    /// Writes it as it goes over the wire, and returns its length in bytes; `None` if it does not fit.
    #[must_use]
    pub fn write(&self, buffer: &mut [u8; PROFILE_BYTES]) -> Option<usize> {
        postcard::to_slice(self, buffer).ok().map(|used| used.len())
    }

    /// Reads what [`ActuatorProfile::write`] has written; what follows is ignored.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        postcard::take_from_bytes(bytes).ok().map(|(profile, _)| profile)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_profile_fits_its_place() {
        let mut name = String::new();
        while name.push('x').is_ok() {}
        let travel =
            TravelLimit { resonance_uhz: u64::MAX, quality_per_mille: u32::MAX, static_ppm: u32::MAX };
        let heat = CoilHeat { winding_ms: u32::MAX, body_ms: u32::MAX, full_sine_per_mille: u16::MAX };
        let profile = ActuatorProfile {
            name,
            max_sum_per_mille: u16::MAX,
            travel: Some(travel),
            heat,
            max_rise: CentiDecibel(i16::MIN),
            max_drive_ms: u32::MAX,
            has_stop_input: true,
        };
        let mut place = [0xff; PROFILE_BYTES];
        assert_eq!(profile.write(&mut place), Some(71));
        assert_eq!(ActuatorProfile::read(&place), Some(profile));
        assert_eq!(ActuatorProfile::read(&place[..70]), None);
    }
}
