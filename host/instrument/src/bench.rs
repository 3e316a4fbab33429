//! The rig that drives the inputs of the simulated device. Without a rig the inputs are at mid-scale.
//!
//! A plate costs a tenth of a core, so while nobody listens the rig rests and the inputs are at mid-scale, too. The latest
//! codes are kept meanwhile: the rig plays them before it is sampled again, so its plate has settled on the present drive.

mod elsewhere;

pub use elsewhere::BenchChange;

use crate::rig::PreparedRig;
use slipline_link::simulator::SimulatedInputs;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Mid-scale of an input.
const SILENCE: u16 = 2048;
/// Time that a new rig runs unseen before its crossfade, seconds: most plates have settled by then.
const SETTLES_S: f64 = 0.3;
/// Duration of the crossfade, about that of placing or lifting a finger, seconds.
const TOUCH_S: f64 = 0.05;
/// Blocks that are kept while the rig rests: a third of a second at 400 kS/s.
const MISSED: usize = 1024;
/// Duration of a tap on the plate, and of each of its knocks, in blocks: half a second and 2.6 ms at 400 kS/s.
const TAP: usize = 1500;
const KNOCK: usize = 8;
/// Height of a knock, in codes.
const KNOCK_CODES: i32 = 800;

/// Shared holder of the rig. Clones share the same rig.
#[derive(Clone, Default)]
pub struct Bench(Arc<Mutex<Rigs>>);

/// The rig on the inputs, and the one that will replace it.
#[derive(Default)]
struct Rigs {
    present: Option<Box<dyn SimulatedInputs>>,
    coming: Option<Coming>,
    is_resting: bool,
    /// The latest codes that a resting rig has not played, and whether the output was muted.
    missed: VecDeque<([u16; 128], bool)>,
    /// Blocks that a tap still lasts.
    tapped: usize,
    /// The bench of another worker, which does as this one.
    elsewhere: Option<elsewhere::Elsewhere>,
}

/// A rig that runs beside the present one until it replaces it.
struct Coming {
    rig: Box<dyn SimulatedInputs>,
    /// Samples run so far; samples before the crossfade begins; samples of the crossfade.
    run: u64,
    settled: u64,
    touch: u64,
}

impl Bench {
    /// The inputs of a simulated device that is connected to this bench.
    #[must_use]
    pub fn inputs(&self) -> Box<dyn SimulatedInputs> {
        Box::new(Wires(self.clone()))
    }

    /// Replaces the rig at once by another that is at rest.
    pub fn put(&self, rig: &PreparedRig) {
        let mut rigs = self.rigs();
        if let Some(elsewhere) = &mut rigs.elsewhere {
            return elsewhere.put(rig.copy());
        }
        rigs.put(rig.inputs());
    }

    /// Replaces the rig without a step, as when a finger is placed or lifted: the new rig runs unseen until
    /// its plate has settled, then the inputs crossfade to it.
    pub fn pass_over_to(&self, rig: &PreparedRig, sample_rate_hz: f64) {
        let mut rigs = self.rigs();
        if let Some(elsewhere) = &mut rigs.elsewhere {
            return elsewhere.pass_over_to(rig.copy(), sample_rate_hz);
        }
        rigs.pass_over_to(rig.inputs(), sample_rate_hz);
    }

    /// Lets the rig rest, or resumes its sampling.
    pub fn rest(&self, is_resting: bool) {
        let mut rigs = self.rigs();
        if let Some(elsewhere) = &mut rigs.elsewhere {
            return elsewhere.rest(is_resting);
        }
        rigs.is_resting = is_resting;
    }

    /// Taps on the plate, at its driven end.
    pub fn tap(&self) {
        let mut rigs = self.rigs();
        if let Some(elsewhere) = &mut rigs.elsewhere {
            return elsewhere.tap();
        }
        rigs.tapped = TAP;
    }

    /// Whether a replacement is in progress.
    #[must_use]
    pub fn is_passing_over(&self) -> bool {
        let rigs = self.rigs();
        if let Some(elsewhere) = &rigs.elsewhere {
            return elsewhere.is_passing_over();
        }
        rigs.coming.is_some()
    }

    /// Whether a plate is computed with the codes: it takes most of what the simulated device takes.
    #[must_use]
    pub fn is_heard(&self) -> bool {
        let rigs = self.rigs();
        rigs.present.is_some() && !rigs.is_resting
    }

    fn rigs(&self) -> MutexGuard<'_, Rigs> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Rigs {
    fn put(&mut self, rig: Box<dyn SimulatedInputs>) {
        (self.present, self.coming) = (Some(rig), None);
        self.missed.clear();
    }

    fn pass_over_to(&mut self, rig: Box<dyn SimulatedInputs>, sample_rate_hz: f64) {
        let samples = |seconds: f64| (seconds * sample_rate_hz) as u64;
        self.coming = Some(Coming { rig, run: 0, settled: samples(SETTLES_S), touch: samples(TOUCH_S) });
    }

    /// The codes, with the knocks of a tap.
    fn knocked(&mut self, codes: &[u16; 128]) -> [u16; 128] {
        if self.tapped == 0 {
            return *codes;
        }
        self.tapped -= 1;
        let knock = if (self.tapped / KNOCK).is_multiple_of(2) { KNOCK_CODES } else { -KNOCK_CODES };
        codes.map(|code| (i32::from(code) + knock).clamp(0, 4095) as u16)
    }

    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        if self.is_resting && self.present.is_some() {
            if self.missed.len() == MISSED {
                self.missed.pop_front();
            }
            self.missed.push_back((*codes, muted));
            *sensed = [[SILENCE; 128]; 2];
            return;
        }
        for (codes, muted) in std::mem::take(&mut self.missed) {
            if let Some(rig) = &mut self.present {
                rig.sample(&codes, muted, sensed);
            }
        }
        let codes = &self.knocked(codes);
        match &mut self.present {
            Some(rig) => rig.sample(codes, muted, sensed),
            None => *sensed = [[SILENCE; 128]; 2],
        }
        let Some(coming) = &mut self.coming else { return };
        let mut other = [[SILENCE; 128]; 2];
        coming.rig.sample(codes, muted, &mut other);
        for (sensed, other) in sensed.iter_mut().zip(&other) {
            for (n, (code, other)) in (coming.run..).zip(sensed.iter_mut().zip(other)) {
                let share = n.saturating_sub(coming.settled) as f64 / coming.touch.max(1) as f64;
                let share = share.min(1.0);
                *code = ((1.0 - share) * f64::from(*code) + share * f64::from(*other)).round() as u16;
            }
        }
        coming.run += 128;
        if coming.run >= coming.settled + coming.touch {
            self.present = self.coming.take().map(|coming| coming.rig);
        }
    }
}

/// Inputs of the device, connected to the bench.
struct Wires(Bench);

impl SimulatedInputs for Wires {
    fn inputs(&self) -> usize {
        2
    }

    fn delay_ns(&self) -> i32 {
        // All rigs state this delay.
        0
    }

    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        self.0.rigs().sample(codes, muted, sensed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rig that shows how many blocks it has run, and the first code of the latest.
    struct Counting(u16);

    impl SimulatedInputs for Counting {
        fn inputs(&self) -> usize {
            2
        }

        fn sample(&mut self, codes: &[u16; 128], _muted: bool, sensed: &mut [[u16; 128]; 2]) {
            self.0 += 1;
            *sensed = [[self.0; 128], *codes];
        }
    }

    fn run(rigs: &mut Rigs, code: u16) -> [u16; 2] {
        let mut sensed = [[0; 128]; 2];
        rigs.sample(&[code; 128], false, &mut sensed);
        [sensed[0][0], sensed[1][0]]
    }

    #[test]
    fn a_resting_rig_costs_nothing_and_catches_up_before_it_is_sampled() {
        let mut rigs = Rigs { present: Some(Box::new(Counting(0))), ..Rigs::default() };
        assert_eq!(run(&mut rigs, 3000), [1, 3000]);
        rigs.is_resting = true;
        for _ in 0..3 {
            assert_eq!(run(&mut rigs, 3100), [SILENCE; 2]);
        }
        rigs.is_resting = false;
        assert_eq!(run(&mut rigs, 3200), [5, 3200]);
        rigs.is_resting = true;
        for _ in 0..3 * MISSED {
            run(&mut rigs, 3100);
        }
        rigs.is_resting = false;
        assert_eq!(run(&mut rigs, 3200), [6 + MISSED as u16, 3200], "no more than it needs to settle");
    }

    #[test]
    fn a_tap_knocks_for_half_a_second_within_the_range_of_the_codes() {
        let mut rigs = Rigs { present: Some(Box::new(Counting(0))), tapped: TAP, ..Rigs::default() };
        let codes: Vec<u16> = (0..=TAP).map(|_| run(&mut rigs, 2048)[1]).collect();
        assert!(codes.contains(&2848) && codes.contains(&1248), "{:?}", &codes[..20]);
        assert_eq!(codes[TAP], 2048);
        rigs.tapped = TAP;
        assert!((0..TAP).all(|_| run(&mut rigs, 4000)[1] <= 4095));
    }
}
