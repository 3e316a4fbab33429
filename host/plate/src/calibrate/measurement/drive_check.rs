//! Check of amplifier and drive by the current of quiet tones, before loud ones are played.
//!
//! Well below the plate's cut-off and the drive's own resonance the drive hardly moves, and its current is that of
//! the blocked drive: I0 = V A/Re for a coil and I0 = V A (-j omega C) for a piezo, with the amplifier's voltage V at
//! full scale and the plate file's actuator A. The judged quantity is rho = I/I0, the median over the frequencies.
//! The remaining motion lowers a coil's current and raises a piezo's.

use super::sensor::{MeasuredPoint, Measurement};
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::signal::AUDIBLE;
use crate::definition::Plate;
use crate::order::median;
use crate::quantity::{OutOfRange, Range};
use crate::quantity::{decibels, number_format::significant};
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::fmt;
use std::ops::RangeInclusive;

/// The tones are these multiples of a fraction of the cut-off, so a comb with that fundamental resolves them.
const MULTIPLES: RangeInclusive<u16> = 3..=10;
/// That fraction for a coil. At 10 % of the cut-off the plate holds the drive: an unsprung coil of twice the wave
/// impedance moves so little that the current of a membrane's coil is within 10 % of the blocked one.
const OF_COIL: f64 = 0.01;
/// The fraction for a piezo. Its blocked current rises with frequency, and below the cut-off exceeds the current that
/// the motion adds.
const OF_PIEZO: f64 = 0.05;
/// Limits of |rho|: below the first there is no drive, above the second a short circuit.
const FEEBLE: f64 = 0.03;
const SHORT: f64 = 4.0;
/// Largest phase of rho for a drive of the stated kind, radians.
const PHASE: f64 = 0.8;

/// The load of the amplifier, as its data sheet states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveLoad {
    /// A voice coil.
    Coil {
        /// Its resistance at rest, ohm (0.01 to 1e5).
        resistance_ohm: f64,
    },
    /// A piezo.
    Piezo {
        /// Its capacitance, farad (1e-13 to 1e-2).
        capacitance_f: f64,
    },
}

/// The circuit from the code to the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveCircuit {
    /// Amplitude of the amplifier's voltage for a code of full scale, volt (1e-3 to 1e4).
    pub full_scale_v: f64,
    /// The load of the amplifier.
    pub load: DriveLoad,
    /// Allowed relative deviation of resistance or capacitance from the stated one (0.05 to 1); 0.25 for a data
    /// sheet.
    pub tolerance: f64,
}

/// The result of the check. `Display` gives a sentence for a user.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveCheck {
    /// The stated drive is connected.
    On,
    /// No current is measured.
    Open,
    /// The current is far too small.
    NoAmplifier {
        /// Measured over expected current.
        share: f64,
    },
    /// The current is far too large, or beyond the input's range.
    Short {
        /// Measured over expected current; a lower limit where the input is clipped.
        share: f64,
    },
    /// The drive differs from the stated one.
    WrongLoad {
        /// Resistance (ohm) or capacitance (farad) that the current corresponds to.
        found: f64,
        /// The stated drive.
        stated: DriveLoad,
    },
    /// The phase of the current does not belong to the stated kind of drive.
    WrongKind {
        /// The stated drive.
        stated: DriveLoad,
    },
    /// The tones are too quiet for a result: the current of a working drive would be below the noise limit.
    TooQuiet {
        /// Required increase of the level, dB.
        louder_db: f64,
    },
}

impl DriveCheck {
    /// Whether louder tones may be played.
    #[must_use]
    pub const fn is_on(&self) -> bool {
        matches!(self, Self::On)
    }
}

impl fmt::Display for DriveCheck {
    fn fmt(&self, text: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |value: f64| significant(value, 2);
        match *self {
            Self::On => write!(text, "The drive is connected and takes the expected current."),
            Self::Open => write!(
                text,
                "No current flows: a wire of the drive is open, its plug is out, or the amplifier is off."
            ),
            Self::NoAmplifier { share } => write!(
                text,
                "The current is {} % of what it should be: the amplifier has no supply or no gain, or it is not between the DAC and the drive.",
                number(100.0 * share)
            ),
            Self::Short { share } => write!(
                text,
                "The current is {} times what it should be or more: the drive or its cable is short-circuited. Switch the amplifier off.",
                number(share)
            ),
            Self::WrongLoad { found, stated: DriveLoad::Coil { resistance_ohm } } => write!(
                text,
                "The coil has {} ohm where {} ohm are stated: it is another coil, or two of them.",
                number(found),
                number(resistance_ohm)
            ),
            Self::WrongLoad { found, stated: DriveLoad::Piezo { capacitance_f } } => write!(
                text,
                "The piezo has {} nF where {} nF are stated: it is another piezo, a broken one, or its cable is too long.",
                number(1e9 * found),
                number(1e9 * capacitance_f)
            ),
            Self::WrongKind { stated: DriveLoad::Coil { .. } } => {
                write!(text, "The current leads the voltage like a capacitor's: this is no coil.")
            }
            Self::WrongKind { stated: DriveLoad::Piezo { .. } } => {
                write!(text, "The current follows the voltage like a resistor's: this is no piezo.")
            }
            Self::TooQuiet { louder_db } => write!(
                text,
                "The tones are too quiet to show whether the drive is on: play them {} dB louder.",
                number(louder_db)
            ),
        }
    }
}

/// The frequencies at which [`check_drive`] needs the current, Hz: 3 to 10 % of the plate's cut-off for a coil, 15 to
/// 50 % for a piezo. They are multiples of their spacing.
#[must_use]
pub fn drive_check_hz(plate: &Plate, load: &DriveLoad) -> Vec<f64> {
    let share = match load {
        DriveLoad::Coil { .. } => OF_COIL,
        DriveLoad::Piezo { .. } => OF_PIEZO,
    };
    MULTIPLES.map(|multiple| f64::from(multiple) * share * plate.cut_off_hz()).collect()
}

/// Checks the drive of `plate` by the current of quiet tones. `current` holds the current over the code at the
/// frequencies of [`drive_check_hz`], in ampere or with its ampere per unit of response.
///
/// ```
/// use slipline_plate::Complex64;
/// use slipline_plate::calibrate::{
///     DriveCircuit, DriveCheck, DriveLoad, MeasuredPoint, Measurement, SensorKind, check_drive, drive_check_hz,
/// };
///
/// let plate = slipline_plate::preset("membrane").unwrap();
/// let load = DriveLoad::Coil { resistance_ohm: 4.0 };
/// let circuit = DriveCircuit { full_scale_v: 2.0, load, tolerance: 0.25 };
/// let point = |frequency_hz| MeasuredPoint {
///     frequency_hz,
///     response: Complex64::new(0.5, 0.01),
///     noise: 0.001,
///     headroom_db: Some(20.0),
/// };
/// let points = drive_check_hz(&plate, &load).into_iter().map(point).collect();
/// let current = Measurement::at(0.0, SensorKind::Displacement, points);
/// assert_eq!(check_drive(&plate, &circuit, &current), Ok(DriveCheck::On));
/// ```
///
/// # Errors
/// A number that is out of its range.
pub fn check_drive(
    plate: &Plate,
    circuit: &DriveCircuit,
    current: &Measurement,
) -> Result<DriveCheck, CalibrateError> {
    current.check()?;
    circuit.check()?;
    let ampere = current.unit_per_response.unwrap_or(1.0);
    let actuator =
        |hz: f64| plate.spec().actuator.as_ref().map_or(Complex64::ONE, |actuator| actuator.response(hz));
    let expected = |point: &MeasuredPoint| circuit.blocked(point.frequency_hz) * actuator(point.frequency_hz);
    let above_noise = |point: &MeasuredPoint, signal: f64| signal / (point.noise * ampere);
    let points = &current.points;
    // Largest signal-to-noise ratio of a working drive.
    let best = points.iter().map(|point| above_noise(point, expected(point).norm())).fold(0.0, f64::max);
    if best < AUDIBLE / FEEBLE {
        return Ok(DriveCheck::TooQuiet { louder_db: decibels(AUDIBLE / FEEBLE / best) });
    }
    let shares = points.iter().map(|point| point.response.norm() * ampere / expected(point).norm()).collect();
    let share = median(shares).unwrap_or_default();
    if points.iter().any(|point| point.headroom_db.is_some_and(|headroom| headroom <= 0.0)) {
        return Ok(DriveCheck::Short { share });
    }
    if points.iter().all(|point| above_noise(point, point.response.norm() * ampere) < AUDIBLE) {
        return Ok(DriveCheck::Open);
    }
    if share < FEEBLE {
        return Ok(DriveCheck::NoAmplifier { share });
    }
    if share > SHORT {
        return Ok(DriveCheck::Short { share });
    }
    let sum: Complex64 = points.iter().map(|point| point.response * ampere / expected(point)).sum();
    // Squared, because the sign of the shunt's signal depends on its wiring.
    if (sum * sum).arg().abs() > 2.0 * PHASE {
        return Ok(DriveCheck::WrongKind { stated: circuit.load });
    }
    let most = 1.0 + circuit.tolerance;
    if (most.recip()..=most).contains(&share) {
        return Ok(DriveCheck::On);
    }
    let found = match circuit.load {
        DriveLoad::Coil { resistance_ohm } => resistance_ohm / share,
        DriveLoad::Piezo { capacitance_f } => capacitance_f * share,
    };
    Ok(DriveCheck::WrongLoad { found, stated: circuit.load })
}

impl DriveCircuit {
    fn check(&self) -> Result<(), OutOfRange> {
        OutOfRange::check("full_scale_v", self.full_scale_v, Range::new(1e-3, 1e4, "V"))?;
        OutOfRange::check("tolerance", self.tolerance, Range::new(0.05, 1.0, ""))?;
        match self.load {
            DriveLoad::Coil { resistance_ohm } => {
                OutOfRange::check("resistance_ohm", resistance_ohm, Range::new(0.01, 1e5, "ohm"))
            }
            DriveLoad::Piezo { capacitance_f } => {
                OutOfRange::check("capacitance_f", capacitance_f, Range::new(1e-13, 1e-2, "F"))
            }
        }
    }

    /// The current of a blocked drive, ampere per code of full scale.
    fn blocked(&self, frequency_hz: f64) -> Complex64 {
        match self.load {
            DriveLoad::Coil { resistance_ohm } => Complex64::from(self.full_scale_v / resistance_ohm),
            DriveLoad::Piezo { capacitance_f } => {
                Complex64::new(0.0, -TAU * frequency_hz * capacitance_f * self.full_scale_v)
            }
        }
    }
}
