//! A speaker that records what is played, and that a test can break.

use slipline_model::sound::Sound;
use slipline_window::sound::{Speaker, SpeakerState};
use std::cell::{Cell, RefCell};
use std::rc::Rc;

/// A speaker that records what is played.
#[derive(Clone, Default)]
pub(crate) struct FakeSpeaker {
    /// What was played last, and its volume.
    pub(crate) played: Rc<RefCell<(Sound, f32)>>,
    /// Its state.
    pub(crate) state: Rc<RefCell<SpeakerState>>,
    /// How often it was to try again.
    pub(crate) retries: Rc<Cell<usize>>,
}

impl FakeSpeaker {
    /// The sum of the amplitudes that are played.
    pub(crate) fn loudness(&self) -> f64 {
        self.played.borrow().0.partials.iter().map(|partial| partial.amplitude).sum()
    }
}

impl Speaker for FakeSpeaker {
    fn play(&self, sound: Sound, volume: f32) {
        *self.played.borrow_mut() = (sound, volume);
    }

    fn state(&self) -> SpeakerState {
        self.state.borrow().clone()
    }

    fn retry(&self) {
        self.retries.set(self.retries.get() + 1);
        *self.state.borrow_mut() = SpeakerState::Closed;
    }
}
