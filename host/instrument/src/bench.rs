//! What the inputs of the simulated device are wired to: the rig that was put together last. Without one they show nothing.

use crate::rig::PreparedRig;
use slipline_link::simulator::SimulatedInputs;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Mid-scale of an input.
const SILENCE: u16 = 2048;
/// For how long a rig runs unseen before it takes the other's place: most plates have settled then.
const SETTLES_S: f64 = 0.3;
/// How long a finger takes to come, or to go.
const TOUCH_S: f64 = 0.05;

/// The place of the rig. Cloning is cheap: all clones have one rig.
#[derive(Clone, Default)]
pub struct Bench(Arc<Mutex<Rigs>>);

/// The rig that is seen, and the one that comes.
#[derive(Default)]
struct Rigs {
    present: Option<Box<dyn SimulatedInputs>>,
    coming: Option<Coming>,
}

/// A rig that runs beside the present one.
struct Coming {
    rig: Box<dyn SimulatedInputs>,
    /// Samples it has run, from which on it begins to be seen, and how many that takes.
    run: u64,
    settled: u64,
    touch: u64,
}

impl Bench {
    /// The inputs of a simulated device at this bench.
    #[must_use]
    pub fn inputs(&self) -> Box<dyn SimulatedInputs> {
        Box::new(Wires(self.clone()))
    }

    /// Puts another rig in the place of the present one; it is at rest.
    pub fn put(&self, rig: &PreparedRig) {
        *self.rigs() = Rigs { present: Some(rig.inputs()), coming: None };
    }

    /// Has another rig take the present one's place while it sounds, as a finger comes or goes: it runs unseen until its plate
    /// has settled, and then what the inputs show goes over to it by and by.
    pub fn pass_over_to(&self, rig: &PreparedRig, sample_rate_hz: f64) {
        let samples = |seconds: f64| (seconds * sample_rate_hz) as u64;
        let (settled, touch) = (samples(SETTLES_S), samples(TOUCH_S));
        self.rigs().coming = Some(Coming { rig: rig.inputs(), run: 0, settled, touch });
    }

    /// Whether another rig takes the present one's place.
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

/// Wires from the bench to the device.
struct Wires(Bench);

impl SimulatedInputs for Wires {
    fn inputs(&self) -> usize {
        2
    }

    fn delay_ns(&self) -> i32 {
        // What every rig states.
        0
    }

    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        self.0.rigs().sample(codes, muted, sensed);
    }
}
