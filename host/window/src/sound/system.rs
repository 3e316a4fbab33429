//! The system's sound card: a thread that opens it for the first sound and closes it after a silence.

use super::mix::Mix;
use super::output;
use super::{Speaker, SpeakerState};
use slipline_model::sound::{Sound, Synth};
use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// The system's sound card.
pub struct SystemSpeaker {
    mix: Arc<Mix>,
    state: Arc<Mutex<SpeakerState>>,
    /// Wakes the thread that opens the card.
    open: SyncSender<()>,
}

impl SystemSpeaker {
    /// Starts the thread. `wake` is called whenever the state changes.
    ///
    /// # Errors
    /// When the system cannot start a thread.
    pub fn new(wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::with(wake, output::run)
    }

    /// As [`Self::new`], with another card: `run` fills its samples from the source until [`SampleSource::fill`] returns `false`.
    pub(super) fn with(
        wake: impl Fn() + Send + 'static,
        run: impl Fn(&dyn Fn(), SampleSource) -> anyhow::Result<()> + Send + 'static,
    ) -> io::Result<Self> {
        let mix = Arc::new(Mix::new(Instant::now()));
        let state = Arc::default();
        let (open, opened) = sync_channel(1);
        let thread =
            Thread { mix: Arc::clone(&mix), state: Arc::clone(&state), opened, wake: Box::new(wake) };
        std::thread::Builder::new().name("slipline-sound".to_owned()).spawn(move || thread.run(run))?;
        Ok(Self { mix, state, open })
    }
}

impl Speaker for SystemSpeaker {
    fn play(&self, sound: Sound, volume: f32) {
        let is_heard = !sound.is_silent();
        self.mix.set(sound, volume, Instant::now());
        if is_heard && self.state() == SpeakerState::Closed {
            // Full: it is asked already.
            let _ = self.open.try_send(());
        }
    }

    fn state(&self) -> SpeakerState {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn retry(&self) {
        set(&self.state, SpeakerState::Closed);
    }
}

fn set(state: &Mutex<SpeakerState>, to: SpeakerState) {
    *state.lock().unwrap_or_else(PoisonError::into_inner) = to;
}

/// Where a card gets its samples.
pub(super) struct SampleSource {
    mix: Arc<Mix>,
    synth: Option<Synth>,
}

impl SampleSource {
    /// Fills `samples` at this rate in Hz, which must not change; returns `false` when the silence has lasted long enough to
    /// close the card.
    pub(super) fn fill(&mut self, rate_hz: f64, samples: &mut [f32]) -> bool {
        let now = Instant::now();
        let synth = self.synth.get_or_insert_with(|| Synth::new(rate_hz));
        self.mix.fill(synth, samples, now);
        !(synth.is_silent() && self.mix.is_idle(now))
    }
}

struct Thread {
    mix: Arc<Mix>,
    state: Arc<Mutex<SpeakerState>>,
    opened: Receiver<()>,
    wake: Box<dyn Fn() + Send>,
}

impl Thread {
    /// Runs until the app is gone.
    fn run(self, run: impl Fn(&dyn Fn(), SampleSource) -> anyhow::Result<()>) {
        let report = |state| {
            set(&self.state, state);
            (self.wake)();
        };
        while self.opened.recv().is_ok() {
            report(SpeakerState::Opening);
            let source = SampleSource { mix: Arc::clone(&self.mix), synth: None };
            match run(&|| report(SpeakerState::Playing), source) {
                Ok(()) => report(SpeakerState::Closed),
                Err(error) => report(SpeakerState::Failed(error.to_string())),
            }
        }
    }
}
