//! The file of an actuator's profile: TOML in SI units, as a person writes it.
//!
//! ```
//! use slipline_instrument::profile_file;
//!
//! # fn main() -> Result<(), profile_file::ProfileFileError> {
//! let profile = profile_file::read("name = \"coil on a membrane\"\nmax_sum = 0.8\n[travel]\nresonance_hz = 60.0\nquality = 2.0\nstatic_travel = 0.5\n")?;
//! assert_eq!(profile.max_sum_per_mille, 800);
//! assert_eq!(profile_file::read(&profile_file::write(&profile))?, profile);
//! # Ok(())
//! # }
//! ```

use serde::{Deserialize, Serialize};
use slipline_link::protocol::event::ProfileReport;
use slipline_link::protocol::limits::{
    COIL_TIME_MS, FULL_SINE_PER_MILLE, MAX_DRIVE_MS, MAX_NAME, MAX_RISE_CDB, MIN_DRIVE_MS,
    PROFILE_SUM_PER_MILLE, QUALITY_PER_MILLE, RESONANCE_UHZ, STATIC_TRAVEL_PPM,
};
use slipline_link::protocol::profile::{ActuatorProfile, CoilHeat, TravelLimit};
use slipline_link::protocol::units::CentiDecibel;
use slipline_plate::quantity::must_be;

/// Largest size of a profile's file, bytes.
pub const BYTES_MAX: usize = 16 << 10;

/// Why a text is no profile.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProfileFileError {
    /// It is not TOML, or has a field that is missing, unknown or of another kind.
    #[error("{0}")]
    Toml(String),
    /// The name does not fit.
    #[error("{}", must_be(format_args!("name, bytes = {}", .0), format_args!("1 to {MAX_NAME}")))]
    Name(usize),
    /// A number lies outside its range.
    #[error("{}", must_be(format_args!("{field} = {got}"), format_args!("{min} to {max}")))]
    OutOfRange {
        /// The field.
        field: &'static str,
        /// The number.
        got: f64,
        /// The lowest allowed.
        min: f64,
        /// The highest allowed.
        max: f64,
    },
}

/// The fields of the file; what is left out is as on a device without a profile.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    name: String,
    /// The largest sum of the amplitudes, 1 = full scale.
    // JSON, 1: Largest sum of the tones, over full scale
    #[serde(default = "full")]
    max_sum: f64,
    /// The largest rise of a level hold, dB.
    // JSON: Largest rise of a held tone
    #[serde(default = "largest_rise_db")]
    max_rise_db: f64,
    /// The longest drive without a command of the user, s.
    // JSON: Longest drive without a command
    #[serde(default = "longest_drive_s")]
    longest_drive_s: f64,
    /// JSON of profile, true or false: Whether the board's stop input is used
    #[serde(default)]
    stop_input: bool,
    #[serde(default)]
    coil: Coil,
    travel: Option<Travel>,
}

/// The coil's heat: two time constants, s, and the rise by a full-scale sine, 1 = its limit.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Coil {
    /// JSON: Time constant of the coil's winding
    winding_s: f64,
    /// JSON: Time constant of the coil's body
    body_s: f64,
    /// JSON, 1: Heat of a sine at full scale, over the limit
    full_sine: f64,
}

/// The travel: resonance, Hz, quality factor, and the travel by a steady signal of full scale, 1 = the peak travel.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Travel {
    /// JSON: Resonance of the actuator
    resonance_hz: f64,
    /// JSON, 1: Quality factor of the actuator's resonance
    quality: f64,
    /// JSON, 1: Static travel at full scale, over the peak travel
    static_travel: f64,
}

impl Default for Coil {
    fn default() -> Self {
        // Those of a device without a profile (firmware/app/src/safety/thermal.rs).
        Self { winding_s: 8.0, body_s: 120.0, full_sine: 1.3 }
    }
}

const fn full() -> f64 {
    1.0
}

fn largest_rise_db() -> f64 {
    f64::from(MAX_RISE_CDB) / 100.0
}

fn longest_drive_s() -> f64 {
    f64::from(MAX_DRIVE_MS) / 1000.0
}

/// The device's number of a value, `per` times as large, if it is between the device's limits.
fn scaled<T: Copy + Into<u64> + TryFrom<u64>>(
    field: &'static str,
    got: f64,
    per: f64,
    (min, max): (T, T),
) -> Result<T, ProfileFileError> {
    let (min, max) = (min.into() as f64, max.into() as f64);
    let value = (got * per).round();
    let number = Some(value as u64).filter(|_| (min..=max).contains(&value));
    let number = number.and_then(|number| T::try_from(number).ok());
    number.ok_or(ProfileFileError::OutOfRange { field, got, min: min / per, max: max / per })
}

/// Fields of which a profile's file names one at least, but for its name; files of other kinds name none.
const FIELDS: [&str; 6] = ["max_sum", "max_rise_db", "longest_drive_s", "stop_input", "coil", "travel"];

/// Whether a text has the form of a profile's file. One with a name alone, which is as no profile, is not recognised.
#[must_use]
pub fn is_one(text: &str) -> bool {
    text.parse::<toml::Table>().is_ok_and(|table| FIELDS.iter().any(|&field| table.contains_key(field)))
}

/// Reads a profile's file.
///
/// # Errors
/// [`ProfileFileError`], with the field and its range. No text makes this function panic.
pub fn read(text: &str) -> Result<ActuatorProfile, ProfileFileError> {
    let fields: Fields = toml::from_str(text)
        .map_err(|error| ProfileFileError::Toml(error.to_string().trim_end().to_owned()))?;
    let bytes = fields.name.len();
    let name = Some(fields.name.as_str()).filter(|name| !name.is_empty());
    let name = name.and_then(|name| name.try_into().ok()).ok_or(ProfileFileError::Name(bytes))?;
    let Fields { max_sum, max_rise_db, longest_drive_s, coil, .. } = fields;
    let travel = fields.travel.map(|travel| {
        Ok(TravelLimit {
            resonance_uhz: scaled("travel.resonance_hz", travel.resonance_hz, 1e6, RESONANCE_UHZ)?,
            quality_per_mille: scaled("travel.quality", travel.quality, 1e3, QUALITY_PER_MILLE)?,
            static_ppm: scaled("travel.static_travel", travel.static_travel, 1e6, STATIC_TRAVEL_PPM)?,
        })
    });
    let rise: u16 = scaled("max_rise_db", max_rise_db, 1e2, (0, MAX_RISE_CDB.unsigned_abs()))?;
    let drives_ms = (MIN_DRIVE_MS, MAX_DRIVE_MS);
    Ok(ActuatorProfile {
        name,
        max_sum_per_mille: scaled("max_sum", max_sum, 1e3, PROFILE_SUM_PER_MILLE)?,
        travel: travel.transpose()?,
        heat: CoilHeat {
            winding_ms: scaled("coil.winding_s", coil.winding_s, 1e3, COIL_TIME_MS)?,
            body_ms: scaled("coil.body_s", coil.body_s, 1e3, COIL_TIME_MS)?,
            full_sine_per_mille: scaled("coil.full_sine", coil.full_sine, 1e3, FULL_SINE_PER_MILLE)?,
        },
        max_rise: CentiDecibel(rise.cast_signed()),
        max_drive_ms: scaled("longest_drive_s", longest_drive_s, 1e3, drives_ms)?,
        has_stop_input: fields.stop_input,
    })
}

/// Writes a profile as such a file.
#[must_use]
pub fn write(profile: &ActuatorProfile) -> String {
    toml::to_string(&fields(profile)).unwrap_or_default()
}

#[derive(Debug, Serialize)]
struct ProfileAnswer {
    stored: String,
    profile: Option<Fields>,
}

/// The fields of `slipline profile --json`.
#[must_use]
pub fn answer(report: &ProfileReport) -> impl Serialize + use<> {
    ProfileAnswer { stored: format!("{:?}", report.stored), profile: report.profile.as_ref().map(fields) }
}

/// The values of a profile, with the names and in the units of such a file.
fn fields(profile: &ActuatorProfile) -> Fields {
    let heat = &profile.heat;
    Fields {
        name: profile.name.as_str().to_owned(),
        max_sum: f64::from(profile.max_sum_per_mille) / 1e3,
        max_rise_db: f64::from(profile.max_rise.0) / 1e2,
        longest_drive_s: f64::from(profile.max_drive_ms) / 1e3,
        stop_input: profile.has_stop_input,
        coil: Coil {
            winding_s: f64::from(heat.winding_ms) / 1e3,
            body_s: f64::from(heat.body_ms) / 1e3,
            full_sine: f64::from(heat.full_sine_per_mille) / 1e3,
        },
        travel: profile.travel.map(|travel| Travel {
            resonance_hz: travel.resonance_uhz as f64 / 1e6,
            quality: f64::from(travel.quality_per_mille) / 1e3,
            static_travel: f64::from(travel.static_ppm) / 1e6,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_link::protocol::limits::MAX_DRIVE_MS;

    #[test]
    fn a_name_alone_is_a_device_without_a_profile() {
        let profile = read("name = \"none\"").unwrap();
        assert_eq!((profile.max_sum_per_mille, profile.max_drive_ms), (1000, MAX_DRIVE_MS));
        assert_eq!((profile.max_rise, profile.travel), (CentiDecibel(MAX_RISE_CDB), None));
        let heat = CoilHeat { winding_ms: 8000, body_ms: 120_000, full_sine_per_mille: 1300 };
        assert_eq!((profile.heat, profile.has_stop_input), (heat, false));
    }

    #[test]
    fn a_profile_is_recognised_by_any_of_its_fields_and_no_other_text_is() {
        let whole = write(&read("name = \"x\"\nmax_sum = 0.5").unwrap());
        for text in ["max_sum = 2.0", "name = \"x\"\n[travel]\nquality = 2.0", whole.as_str()] {
            assert!(is_one(text), "{text}");
        }
        for text in ["name = \"x\"", "max_sum = ", "", "[plate]\nmax_sum = 1.0"] {
            assert!(!is_one(text), "{text}");
        }
    }

    #[test]
    fn a_bad_field_of_a_profile_is_named_with_its_range() {
        let says = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(says("name = \"x\"\nmax_sum = 1.2"), "max_sum = 1.2: must be 0.001 to 1");
        assert_eq!(says("name = \"x\"\nmax_rise_db = -1"), "max_rise_db = -1: must be 0 to 20");
        assert_eq!(says("name = \"x\"\nlongest_drive_s = nan"), "longest_drive_s = NaN: must be 1 to 600");
        assert_eq!(says("name = \"x\"\n[coil]\nwinding_s = 0.5"), "coil.winding_s = 0.5: must be 1 to 3600");
        assert_eq!(says("name = \"\""), "name, bytes = 0: must be 1 to 24");
        assert_eq!(says(&format!("name = \"{}\"", "x".repeat(25))), "name, bytes = 25: must be 1 to 24");
        assert!(says("nam = \"x\"").contains("unknown field `nam`"));
        assert!(says("max_sum = 1.0").contains("missing field `name`"));
        assert!(says("name = \"x\"\n[travel]\nquality = 2.0").contains("missing field `resonance_hz`"));
    }
}
