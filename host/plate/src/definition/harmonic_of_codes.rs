//! Harmonics of a drive as tones of the DAC: what measures them and what cancels them are codes.

use crate::definition::harmonics::Harmonics;
use crate::definition::plate::Plate;
use crate::definition::sample_rate::hold_droop;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, TAU};

/// The tone of the DAC that cancels a harmonic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Companion {
    /// Its frequency over that of the tone: 2 or 3.
    pub order: u8,
    /// Its DAC amplitude over that of the tone.
    pub ratio: f64,
    /// Its phase at the start, turns (0 to 1), if the tone begins at 0 turns as a sine; `order` times the tone's phase is added to it.
    pub phase_turns: f64,
}

impl Plate {
    /// The harmonic of the drive, as of [`Harmonics::ratio`], of codes that are a tone of the amplitude 1 at `order` times the
    /// frequency, in phase with `order` times the phase of a fundamental of the amplitude 1: the response of hold and actuator at
    /// `order` times the frequency over that at the frequency. A calibration's correction is part of both.
    #[must_use]
    pub fn harmonic_of_codes(&self, order: u8, frequency_hz: f64, sample_rate_hz: f64) -> Complex64 {
        let response = |hz: f64| self.drive_response(hz) * hold_droop(hz, sample_rate_hz);
        let fundamental = response(frequency_hz);
        let turned = Complex64::cis(f64::from(order) * fundamental.arg()) * fundamental.norm();
        response(f64::from(order) * frequency_hz) / turned
    }

    /// The harmonic of the drive over the fundamental, a lag as a positive argument, of one that is that of codes
    /// d sin(n p + s) beside the fundamental a sin(p); `codes` is d/a e^(js).
    #[must_use]
    pub fn harmonic_of_sines(
        &self,
        order: u8,
        frequency_hz: f64,
        sample_rate_hz: f64,
        codes: Complex64,
    ) -> Complex64 {
        // a sin(p) = a cos(q) with q = p - 90 degrees, and d sin(n p + s) = d cos(n q + s + (n - 1) 90 degrees).
        let lead = codes * Complex64::cis(f64::from(order - 1) * FRAC_PI_2);
        lead.conj() * self.harmonic_of_codes(order, frequency_hz, sample_rate_hz)
    }

    /// The tones of the DAC that cancel the stated harmonics of a tone of this level; none where the file states none.
    #[must_use]
    pub fn companions(&self, frequency_hz: f64, level: f64, sample_rate_hz: f64) -> Vec<Companion> {
        let Some(harmonics) = &self.spec().harmonics else { return Vec::new() };
        let of_order = |order: u8| {
            let drive = harmonics.ratio(order, frequency_hz, level)?;
            let lead = (drive / self.harmonic_of_codes(order, frequency_hz, sample_rate_hz)).conj();
            // As a sine again, and opposite.
            let codes = -lead * Complex64::cis(-f64::from(order - 1) * FRAC_PI_2);
            let phase_turns = (codes.arg() / TAU).rem_euclid(1.0);
            Some(Companion { order, ratio: codes.norm(), phase_turns })
        };
        Harmonics::ORDERS.into_iter().filter_map(of_order).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::actuator::{Actuator, Resonator};
    use crate::definition::presets::preset;
    use crate::definition::response_curve::ResponseCurve;
    use crate::definition::spec::PlateSpec;

    fn flat(db: f64, lead: f64) -> Option<ResponseCurve> {
        Some(ResponseCurve { points: vec![[50.0, db, lead], [500.0, db, lead]] })
    }

    #[test]
    fn companions_are_the_opposite_of_the_harmonics_that_codes_would_show() {
        // Behind a coil with a resonance in the band, with harmonics that lead by 40 and -70 degrees.
        let harmonics = Harmonics { level: 0.8, second: flat(-40.0, 40.0), third: flat(-46.0, -70.0) };
        let actuator = Actuator::Resonator(Resonator { resonance_hz: 150.0, quality: 3.0, travel: None });
        let spec = preset("membrane").expect("a preset").spec().clone();
        let plate = PlateSpec { harmonics: Some(harmonics.clone()), actuator: Some(actuator), ..spec };
        let plate = Plate::new(plate).expect("valid");
        for hz in [90.0, 140.0, 210.0] {
            for Companion { order, ratio, phase_turns } in plate.companions(hz, 0.8, 400e3) {
                let opposite = -Complex64::from_polar(ratio, TAU * phase_turns);
                let shown = plate.harmonic_of_sines(order, hz, 400e3, opposite);
                let stated = harmonics.ratio(order, hz, 0.8).expect("stated");
                assert!((shown - stated).norm() < 1e-12, "{hz} {order}: {shown} for {stated}");
            }
        }
        assert_eq!(preset("membrane").expect("a preset").companions(90.0, 1.0, 400e3), []);
    }

    #[test]
    fn a_companion_cancels_the_drive_of_a_coil_in_time() {
        // u + 0.02 u^2 of codes u = a sin p has -0.01 a^2 cos 2p of second harmonic: as cosines a lead of 0 degrees.
        let harmonics = Harmonics { level: 0.5, second: flat(20.0 * 0.005_f64.log10(), 0.0), third: None };
        let spec = preset("membrane").expect("a preset").spec().clone();
        let plate = Plate::new(PlateSpec { harmonics: Some(harmonics), ..spec }).expect("valid");
        let companions = plate.companions(100.0, 0.5, 400e3);
        let [Companion { order: 2, ratio, phase_turns }] = companions[..] else { panic!("{companions:?}") };
        for i in 0..40 {
            let p = TAU * f64::from(i) / 40.0;
            let u = 0.5 * p.sin();
            let harmonic = 0.02 * u * u - 0.01 * 0.25;
            let companion = 0.5 * ratio * (2.0 * p + TAU * phase_turns).sin();
            assert!((harmonic + companion).abs() < 1e-6, "{p}: {harmonic} {companion}");
        }
    }
}
