//! A random plate near a nominal one, as an unknown truth for tests and for a simulated rig.

use crate::definition::{
    Actuator, Air, DriveEnd, Impedance, Plate, PlateError, Resonator, Source, Taper, Travel,
};
use std::f64::consts::TAU;

/// Random numbers that are the same on every machine: SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Random(u64);

impl Random {
    /// A generator with this seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 random bits.
    pub const fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number, uniform from `low` to `high`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number, uniform in the logarithm from `low` to `high`, both above 0.
    pub fn factor(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }

    /// A normal deviate of mean 0 and variance 1.
    pub fn normal(&mut self) -> f64 {
        self.normals()[0]
    }

    /// Two independent normal deviates of mean 0 and variance 1 (Box and Muller).
    pub fn normals(&mut self) -> [f64; 2] {
        let (size, turn) = ((-2.0 * self.within(1e-300, 1.0).ln()).sqrt(), TAU * self.within(0.0, 1.0));
        let (sine, cosine) = turn.sin_cos();
        [size * cosine, size * sine]
    }
}

/// A true plate near `nominal`, with the spread of a workshop: wave speed within 5 % of the nominal one, loss x0.5 to
/// 2.5, ln(W0/W) within 0.4 %, W0 within 0.3 %, a source with 0.4 to 2.5 times the matched resistance and with mass
/// and stiffness, an actuator with a resonance, and the coefficient of its air, if it has one, within 10 %.
///
/// A plate whose file does not state its wave impedance keeps its driven end. The random numbers after these remain
/// unused: a rig uses them for its delay and gain.
///
/// # Errors
/// [`PlateError`] if the random plate is out of range.
pub fn near(nominal: &Plate, random: &mut Random) -> Result<Plate, PlateError> {
    let mut spec = nominal.with_wave_speed(random.within(0.95, 1.05))?.spec().clone();
    spec.loss_factor = (spec.loss_factor * random.factor(0.5, 2.5)).min(crate::limits::LOSS_FACTOR.high);
    let (rate, width) = (random.within(0.996, 1.004), random.within(0.997, 1.003));
    // ln(W0/W) scales with `rate`, W0 with `width`.
    let narrowed = |start: f64, half_width: f64| width * start * (half_width / start).powf(rate);
    match &mut spec.taper {
        Taper::Exponential { half_width_m, rate_per_m } => {
            *rate_per_m *= rate;
            *half_width_m *= width;
        }
        Taper::Linear { half_width_m, end_half_width_m } => {
            *end_half_width_m = narrowed(*half_width_m, *end_half_width_m);
            *half_width_m *= width;
        }
        Taper::Sampled { points } => {
            let start = points.first().map_or(1.0, |point| point[1]);
            points.iter_mut().for_each(|point| point[1] = narrowed(start, point[1]));
        }
    }
    let drive = DriveSpread::of(nominal);
    if let Some(source) = drive.source {
        let resistance = random.factor(RESISTANCE.0, RESISTANCE.1);
        let reactances = [(); 2].map(|()| random.within(REACTANCE.0, REACTANCE.1));
        let impedance = [resistance, reactances[0], reactances[1]];
        spec.drive_end = DriveEnd::Source(source.with(impedance));
    }
    let (resonance, quality) = (random.factor(RESONANCE.0, RESONANCE.1), random.factor(QUALITY.0, QUALITY.1));
    spec.actuator = Some(drive.actuator(resonance, quality));
    if let Some(Air::Around { mounting, .. }) = &mut spec.air {
        let (alpha, _) = mounting.coefficient();
        *mounting = mounting.found(alpha * random.factor(0.9, 1.0 / 0.9), mounting.distant());
    }
    Plate::new(spec)
}

/// Resistances of a source over the matched one, uniform in the logarithm.
pub(crate) const RESISTANCE: (f64, f64) = (0.4, 2.5);
/// Reactances of its mass and of its stiffness in the middle of the band, over that resistance; uniform.
pub(crate) const REACTANCE: (f64, f64) = (0.0, 1.0);
/// Resonances of an actuator over the middle of the band, and its quality factors; both uniform in the logarithm.
pub(crate) const RESONANCE: (f64, f64) = (0.5, 2.0);
pub(crate) const QUALITY: (f64, f64) = (0.7, 5.0);

/// The spread of the drives that a workshop may put on a plate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DriveSpread {
    /// The middle of the band, Hz.
    pub(crate) middle_hz: f64,
    /// `None` for a plate whose file does not state its wave impedance: it keeps its driven end.
    pub(crate) source: Option<SourceSpread>,
    travel: Option<Travel>,
}

/// The spread of the sources.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SourceSpread {
    /// Angular frequency of the middle of the band, rad/s.
    pub(crate) omega: f64,
    /// The matched resistance, N s/m.
    pub(crate) matched: f64,
    /// The driven end on which they act, with zero impedance.
    pub(crate) end: Source,
}

impl DriveSpread {
    pub(crate) fn of(nominal: &Plate) -> Self {
        let (low_hz, high_hz) = nominal.band_hz();
        let (spec, middle_hz) = (nominal.spec(), 0.5 * (low_hz + high_hz));
        let source = nominal.wave_impedance_n_s_per_m(middle_hz).map(|impedance| {
            let soft = Source::soft(&spec.model, middle_hz);
            let (slope, lead_in) = match spec.drive_end {
                DriveEnd::Source(source) => (source.slope, source.lead_in),
                DriveEnd::DisplacementAndSlope { slope } => (Some(slope), None),
                _ => (soft.slope, None),
            };
            // With a lead-in the match is a source of low impedance, 0.3 of Z; without one, a damper of Z.
            let matched = if lead_in.is_some() { 0.3 * impedance } else { impedance };
            SourceSpread { omega: TAU * middle_hz, matched, end: Source { slope, lead_in, ..soft } }
        });
        let travel = spec.actuator.as_ref().and_then(|it| it.resonator()).and_then(|it| it.travel);
        Self { middle_hz, source, travel }
    }

    /// The actuator with this resonance over the middle of the band.
    pub(crate) fn actuator(&self, resonance: f64, quality: f64) -> Actuator {
        let resonance_hz = self.middle_hz * resonance;
        Actuator::Resonator(Resonator { resonance_hz, quality, travel: self.travel })
    }
}

impl SourceSpread {
    /// The source with this resistance, mass and stiffness, in the units of [`RESISTANCE`] and [`REACTANCE`].
    pub(crate) fn with(&self, [resistance, mass, stiffness]: [f64; 3]) -> Source {
        let impedance = Impedance {
            resistance_n_s_per_m: self.matched * resistance,
            mass_kg: mass * self.matched / self.omega,
            stiffness_n_per_m: stiffness * self.matched * self.omega,
        };
        Source { impedance, ..self.end }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::presets;

    #[test]
    fn twenty_truths_of_each_preset_are_plates_within_the_stated_spread_and_none_is_another() {
        for preset in presets() {
            let nominal = preset.plate().expect("a preset");
            let mut before = nominal.clone();
            for seed in 0..20 {
                let plate = near(&nominal, &mut Random::new(seed)).expect("a plate");
                assert_eq!(near(&nominal, &mut Random::new(seed)).as_ref(), Ok(&plate), "the same again");
                assert_ne!(plate, before, "{} {seed}", preset.name);
                let share = plate.frequency_for_boundary_hz(0.5 * plate.length_m())
                    / nominal.frequency_for_boundary_hz(0.5 * plate.length_m());
                // In bending the frequency is proportional to the square of the phase speed.
                assert!((0.88..1.13).contains(&share), "{} {seed}: {share}", preset.name);
                let width = plate.half_width_m(0.0) / nominal.half_width_m(0.0);
                assert!((0.997..=1.003).contains(&width), "{} {seed}: {width}", preset.name);
                let fall = |it: &Plate| (it.half_width_m(0.0) / it.half_width_m(it.length_m())).ln();
                let rate = fall(&plate) / fall(&nominal);
                assert!((0.996..=1.004).contains(&rate), "{} {seed}: {rate}", preset.name);
                let loss = plate.spec().loss_factor / nominal.spec().loss_factor;
                assert!((0.5..=2.5).contains(&loss), "{} {seed}: {loss}", preset.name);
                before = plate;
            }
        }
    }

    #[test]
    fn every_taper_is_drawn_alike() {
        let nominal = crate::preset("membrane").expect("a preset");
        let places: Vec<f64> = (0..=8).map(|i| 0.04 * f64::from(i)).collect();
        let points = places.iter().map(|&x| [x, nominal.half_width_m(x)]).collect();
        let mut spec = nominal.spec().clone();
        spec.taper = Taper::Sampled { points };
        let sampled = Plate::new(spec.clone()).expect("a plate");
        spec.taper = Taper::Linear { half_width_m: 0.05, end_half_width_m: nominal.half_width_m(0.32) };
        let linear = Plate::new(spec).expect("a plate");
        let drawn = |plate: &Plate| near(plate, &mut Random::new(5)).expect("a plate");
        for &x in &places {
            let ratio = drawn(&sampled).half_width_m(x) / drawn(&nominal).half_width_m(x);
            assert!((ratio - 1.0).abs() < 1e-9, "{x}: {ratio}");
        }
        for x in [0.0, 0.32] {
            let ratio = drawn(&linear).half_width_m(x) / drawn(&nominal).half_width_m(x);
            assert!((ratio - 1.0).abs() < 1e-9, "{x}: {ratio}");
        }
    }

    #[test]
    fn the_numbers_are_uniform_and_normal() {
        let mut random = Random::new(7);
        let (mut mean, mut square, mut product) = (0.0, 0.0, 0.0);
        let count = 20_000;
        for _ in 0..count {
            let [a, b] = random.normals();
            mean += a + b;
            square += a * a + b * b;
            product += a * b;
            let factor = random.factor(0.5, 2.0);
            assert!((0.5..=2.0).contains(&factor));
        }
        let each = 1.0 / f64::from(count);
        assert!((0.5 * mean * each).abs() < 0.02 && (0.5 * square * each - 1.0).abs() < 0.02);
        assert!((product * each).abs() < 0.02);
    }

    #[test]
    fn the_air_of_a_true_plate_is_another_and_a_plate_without_it_keeps_none() {
        let still = presets::preset("membrane").expect("a preset");
        assert_eq!(near(&still, &mut Random::new(7)).expect("a plate").spec().air, None);
        let spec = crate::PlateSpec { air: Some(Air::ROOM), ..still.spec().clone() };
        let nominal = Plate::new(spec).expect("a plate");
        let alpha = |seed: u64| {
            let truth = near(&nominal, &mut Random::new(seed)).expect("a plate");
            truth.spec().air.and_then(|air| air.mounting()).expect("air").coefficient().0
        };
        let ratios = [1, 2, 3].map(|seed| alpha(seed) / 1.3);
        assert!(ratios.iter().all(|ratio| (0.9..1.0 / 0.9).contains(ratio)), "{ratios:?}");
        assert!(ratios[0] != ratios[1] && ratios[1] != ratios[2], "{ratios:?}");
    }
}
