//! The rig that drives the inputs of the simulated device. Without a rig the inputs are at mid-scale.

use crate::rig::PreparedRig;
use slipline_link::simulator::SimulatedInputs;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Mid-scale of an input.
const SILENCE: u16 = 2048;
/// Time that a new rig runs unseen before its crossfade, seconds: most plates have settled by then.
const SETTLES_S: f64 = 0.3;
/// Duration of the crossfade, about that of placing or lifting a finger, seconds.
const TOUCH_S: f64 = 0.05;

/// Shared holder of the rig. Clones share the same rig.
#[derive(Clone, Default)]
pub struct Bench(Arc<Mutex<Rigs>>);

/// The rig on the inputs, and the one that will replace it.
#[derive(Default)]
struct Rigs {
    present: Option<Box<dyn SimulatedInputs>>,
    coming: Option<Coming>,
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
        *self.rigs() = Rigs { present: Some(rig.inputs()), coming: None };
    }

    /// Replaces the rig without a step, as when a finger is placed or lifted: the new rig runs unseen until
    /// its plate has settled, then the inputs crossfade to it.
    pub fn pass_over_to(&self, rig: &PreparedRig, sample_rate_hz: f64) {
        let samples = |seconds: f64| (seconds * sample_rate_hz) as u64;
        let (settled, touch) = (samples(SETTLES_S), samples(TOUCH_S));
        self.rigs().coming = Some(Coming { rig: rig.inputs(), run: 0, settled, touch });
    }

    /// Whether a replacement is in progress.
    #[must_use]
    pub fn is_passing_over(&self) -> bool {
        self.rigs().coming.is_some()
    }

    fn rigs(&self) -> MutexGuard<'_, Rigs> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Rigs {
    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
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
