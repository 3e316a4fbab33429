//! One driven end of a plate in bending for many sources: reflection and launched wave.

use super::DrivenEnd;
use super::clamped;
use super::reflection::entering;
use crate::definition::plate::Plate;
use crate::definition::source::Source;
use num_complex::Complex64;

/// The straight strip of the driven end's width at one frequency; everything that does not depend on the source is
/// computed once.
pub(crate) struct SourceEnd<'a> {
    plate: &'a Plate,
    frequency_hz: f64,
    /// k with loss, 1/m.
    wavenumber: Complex64,
    /// Z, N s/m.
    impedance: f64,
    clamped: Option<clamped::Sourced<'a>>,
}

/// Reflection and launched wave of a driven end.
pub(crate) struct Scattering {
    /// |r| of the returning wave.
    pub(crate) reflected: f64,
    /// Logarithm of the level of the wave that a unit drive launches into an infinite strip: the root of its power,
    /// in an arbitrary unit that does not depend on the wave speed.
    pub(crate) launched_ln: f64,
}

impl<'a> SourceEnd<'a> {
    /// `losses` are the loss factors of the lead-ins to try. `None` if the wave of `frequency_hz` cannot enter.
    pub(crate) fn new(plate: &'a Plate, frequency_hz: f64, losses: &[f64]) -> Option<Self> {
        let wavenumber = entering(plate, frequency_hz)?;
        let impedance = plate.wave_impedance_n_s_per_m(frequency_hz)?;
        let clamped =
            plate.spec().model.is_clamped().then(|| clamped::Sourced::new(plate, frequency_hz, 0.0, losses));
        Some(Self { plate, frequency_hz, wavenumber, impedance, clamped })
    }

    /// The end with `source` in place of the plate's own drive end.
    pub(crate) fn scattering(&self, source: &Source) -> Scattering {
        let end = match &self.clamped {
            Some(clamped) => clamped.with(source),
            None => DrivenEnd::sourced(self.plate, self.frequency_hz, 0.0, source),
        };
        let reflected = end.reflection(self.wavenumber).norm();
        // p = t e^(jkx) satisfies alpha p + beta p' = drive, and its power is proportional to Z |t|^2.
        let launched = end.drive / (end.alpha + Complex64::I * self.wavenumber * end.beta);
        Scattering { reflected, launched_ln: launched.norm().ln() + 0.5 * self.impedance.ln() }
    }
}
