//! The motor between the amplifier and the driven end, and its current through the shunt.
//!
//! With time as e^(-j omega t), U the amplifier's voltage and v the velocity of the driven end:
//!
//! ```text
//! voice coil   I = (U - Bl v)/Re,           force Bl I      the file's resistance holds (Bl)^2/Re
//! piezo        I = -j omega C U + N v,      force N U
//! ```
//! The actuator of a plate file, if any, is modelled in front of both as the amplifier's own response: it
//! scales U.

use slipline_plate::{Complex64, DriveEnd, Plate};
use std::f64::consts::TAU;

/// Plates below this frequency have a voice coil, plates above it a piezo.
const COIL_BELOW_HZ: f64 = 1e3;
/// Re of a voice coil, ohm.
const COIL_OHM: f64 = 4.0;
/// Share of the file's resistance that is the coil's electrical damping.
const ELECTRICAL_SHARE: f64 = 0.5;
/// Voltage of a piezo at DAC full scale.
const PIEZO_V: f64 = 60.0;
/// Least ratio of a piezo's capacitive current to the current by the free wave's motion, and to that by the plate's motion in the band
/// of the drive check. A plate that is soft below its cut-off would be taken for another piezo.
const CAPACITIVE: f64 = 6.0;
const CAPACITIVE_HELD: f64 = 4.0;

/// How a motor turns current and voltage into force and motion.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Transducer {
    /// A coil in a magnet's field.
    Coil {
        /// Re, ohm.
        resistance_ohm: f64,
        /// Bl, N/A.
        force_factor_n_per_a: f64,
    },
    /// A piezo: a capacitance that exerts a force.
    Piezo {
        /// C, farad.
        capacitance_f: f64,
        /// N, newton per volt, which is coulomb per metre.
        force_factor_n_per_v: f64,
    },
}

/// A motor behind an amplifier of constant voltage.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Motor {
    /// Its kind and values.
    pub transducer: Transducer,
    /// The amplifier's voltage at DAC full scale.
    pub full_scale_v: f64,
}

impl Motor {
    /// A motor that exerts the force of the plate file on this plate: a voice coil of 4 ohm, whose electrical
    /// damping is half of the file's resistance, or from 1 kHz on a piezo.
    ///
    /// A plate file without a source states no force: its motor has the force of the wave at full scale.
    #[must_use]
    pub fn of(plate: &Plate) -> Self {
        let (low_hz, high_hz) = plate.band_hz();
        let omega = TAU * 0.5 * (low_hz + high_hz);
        let metres = plate.spec().full_scale_m;
        let source = if let DriveEnd::Source(source) = plate.spec().drive_end { Some(source) } else { None };
        let at_hz = source.map_or(omega / TAU, |source| source.at_frequency_hz);
        let impedance = plate.wave_impedance_n_s_per_m(at_hz).filter(|z| *z > 0.0);
        // Force that launches a wave of full scale: 2 omega Z. An unknown Z of 1 N s/m changes the scale of
        // force only.
        let force_n = 2.0 * TAU * at_hz * impedance.unwrap_or(1.0) * metres;
        if high_hz >= COIL_BELOW_HZ {
            let force_factor_n_per_v = force_n / PIEZO_V;
            let capacitance_f = CAPACITIVE * force_factor_n_per_v * metres / PIEZO_V;
            let transducer = Transducer::Piezo { capacitance_f, force_factor_n_per_v };
            return Self { transducer, full_scale_v: PIEZO_V };
        }
        let resistance = source.map(|source| source.impedance.resistance_n_s_per_m).filter(|r| *r > 0.0);
        let electrical = ELECTRICAL_SHARE * resistance.or(impedance).unwrap_or(1.0);
        // A source without resistance has a coil with little damping.
        let damps = source.is_none() || resistance.is_some();
        let force_factor_n_per_a = (electrical * COIL_OHM).sqrt() * if damps { 1.0 } else { 0.03 };
        Self {
            transducer: Transducer::Coil { resistance_ohm: COIL_OHM, force_factor_n_per_a },
            full_scale_v: force_n * COIL_OHM / force_factor_n_per_a,
        }
    }

    /// The same on a plate whose driven end moves by at most `deflection_m` at full scale in the band of the drive check: a piezo is
    /// so large that its own current outweighs that of the motion.
    #[must_use]
    pub(super) fn on_plate_that_yields(self, deflection_m: f64) -> Self {
        let Transducer::Piezo { capacitance_f, force_factor_n_per_v } = self.transducer else { return self };
        let least_f = CAPACITIVE_HELD * force_factor_n_per_v * deflection_m / self.full_scale_v;
        let transducer =
            Transducer::Piezo { capacitance_f: capacitance_f.max(least_f), force_factor_n_per_v };
        Self { transducer, ..self }
    }

    /// Band of the drive check, as shares of the plate's cut-off: there the plate hardly moves.
    pub(super) const fn held(&self) -> (f64, f64) {
        match self.transducer {
            Transducer::Coil { .. } => (0.02, 0.12),
            Transducer::Piezo { .. } => (0.1, 0.55),
        }
    }

    /// The current per code of 1, in ampere, if the driven end moves with `velocity` (m/s per code of 1);
    /// `amplifier` is the response of the plate file's actuator.
    #[must_use]
    pub fn current_a(&self, frequency_hz: f64, amplifier: Complex64, velocity: Complex64) -> Complex64 {
        let voltage = amplifier * self.full_scale_v;
        match self.transducer {
            Transducer::Coil { resistance_ohm, force_factor_n_per_a } => {
                (voltage - force_factor_n_per_a * velocity) / resistance_ohm
            }
            Transducer::Piezo { capacitance_f, force_factor_n_per_v } => {
                Complex64::new(0.0, -TAU * frequency_hz * capacitance_f) * voltage
                    + force_factor_n_per_v * velocity
            }
        }
    }
}
