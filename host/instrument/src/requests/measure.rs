//! A measurement that is asked for.

use crate::measure::circuit::TOLERANCE;
use crate::measure::{Bandwidths, KnownDrive, Wanted};
use crate::rig::PreparedRig;
use slipline_plate::Plate;
use slipline_plate::calibrate::{DriveCircuit, DriveLoad};
use thiserror::Error;

/// The frequencies and the level of a measurement; what is absent is that of [`Wanted::of`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frequencies {
    /// Lowest frequency, Hz.
    pub low_hz: Option<f64>,
    /// Highest frequency, Hz.
    pub high_hz: Option<f64>,
    /// Number of frequencies.
    pub points: Option<usize>,
    /// Largest sum of all tones' amplitudes, as a share of full scale.
    pub level: Option<f64>,
}

impl Frequencies {
    /// These frequencies on a plate. They are not checked: the plan of the measurement refuses them.
    #[must_use]
    pub fn on(&self, plate: &Plate) -> Wanted {
        let usual = Wanted::of(plate);
        Wanted {
            low_hz: self.low_hz.unwrap_or(usual.low_hz),
            high_hz: self.high_hz.unwrap_or(usual.high_hz),
            points: self.points.unwrap_or(usual.points),
            level: self.level.unwrap_or(usual.level),
        }
    }
}

/// A measurement with the device's own inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasureRequest {
    /// The frequencies and the level.
    pub frequencies: Frequencies,
    /// Whether one tone glides through the band, instead of combs of tones.
    pub is_sweep: bool,
    /// The drive circuit, by which quiet tones check before that the drive is on.
    pub known: Option<KnownDrive>,
}

impl MeasureRequest {
    /// The drive circuit to check: the stated one, else that of the simulated device's rig.
    #[must_use]
    pub fn known_with(&self, rig: Option<&PreparedRig>) -> Option<KnownDrive> {
        self.known.or_else(|| rig.map(PreparedRig::known_drive))
    }
}

/// A drive circuit of which some values are missing, or which drives both a coil and a piezo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the drive circuit is incomplete: it has an amplifier, a shunt, and a coil or a piezo")]
pub struct IncompleteCircuit;

/// The drive circuit of data sheets: all values or none. `amplifier_v` is the voltage at the DAC's full scale, `shunt_a` the
/// current at the end of the input's range; the load is a coil in ohms or a piezo in farads. Bandwidths belong to a whole circuit.
///
/// # Errors
/// [`IncompleteCircuit`].
pub fn circuit_of(
    amplifier_v: Option<f64>,
    coil_ohm: Option<f64>,
    piezo_f: Option<f64>,
    shunt_a: Option<f64>,
    bandwidths: Bandwidths,
) -> Result<Option<KnownDrive>, IncompleteCircuit> {
    let has_none = amplifier_v.is_none() && shunt_a.is_none() && bandwidths == Bandwidths::default();
    let load = match (coil_ohm, piezo_f) {
        (None, None) if has_none => return Ok(None),
        (Some(resistance_ohm), None) => DriveLoad::Coil { resistance_ohm },
        (None, Some(capacitance_f)) => DriveLoad::Piezo { capacitance_f },
        _ => return Err(IncompleteCircuit),
    };
    let (Some(full_scale_v), Some(full_scale_a)) = (amplifier_v, shunt_a) else {
        return Err(IncompleteCircuit);
    };
    let circuit = DriveCircuit { full_scale_v, load, tolerance: TOLERANCE };
    Ok(Some(KnownDrive { circuit, full_scale_a, bandwidths }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circuit_has_all_values_or_none() {
        let none = Bandwidths::default();
        let all = |coil, piezo| circuit_of(Some(2.0), coil, piezo, Some(1.65), none);
        let load = |found: Result<Option<KnownDrive>, _>| found.unwrap().unwrap().circuit.load;
        assert_eq!(load(all(Some(4.0), None)), DriveLoad::Coil { resistance_ohm: 4.0 });
        assert_eq!(load(all(None, Some(220e-9))), DriveLoad::Piezo { capacitance_f: 220e-9 });
        assert_eq!(circuit_of(None, None, None, None, none), Ok(None));
        for incomplete in [
            all(None, None),
            all(Some(4.0), Some(220e-9)),
            circuit_of(None, Some(4.0), None, Some(1.65), none),
            circuit_of(Some(2.0), Some(4.0), None, None, none),
            circuit_of(None, None, None, Some(1.65), none),
            circuit_of(None, None, None, None, Bandwidths { amplifier_hz: Some(1e5), filter_hz: None }),
        ] {
            assert_eq!(incomplete, Err(IncompleteCircuit));
        }
    }
}
