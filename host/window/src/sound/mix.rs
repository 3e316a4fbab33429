//! What the app last said that sounds, as the system's callback asks for its samples.

use slipline_model::sound::{Sound, Synth};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long a sound goes on without a word from the app.
pub(super) const PATIENCE: Duration = Duration::from_millis(300);
/// After so long a silence the sound card is let go.
pub(super) const IDLE: Duration = Duration::from_secs(10);

/// What sounds, shared by the app and the callback.
pub(super) struct Mix(Mutex<Told>);

struct Told {
    sound: Sound,
    volume: f32,
    at: Instant,
    /// When it last was something that is heard.
    heard_at: Instant,
}

impl Mix {
    /// Silent from now on.
    pub(super) fn new(now: Instant) -> Self {
        Self(Mutex::new(Told { sound: Sound::default(), volume: 0.0, at: now, heard_at: now }))
    }

    /// Sounds from now on.
    pub(super) fn tell(&self, sound: Sound, volume: f32, now: Instant) {
        let mut told = self.lock();
        if !sound.is_silent() {
            told.heard_at = now;
        }
        (told.sound, told.volume, told.at) = (sound, volume, now);
    }

    /// Whether nothing has been heard for so long that the sound card can be let go.
    pub(super) fn is_idle(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.lock().heard_at) >= IDLE
    }

    /// The next samples, each -1..=1.
    pub(super) fn fill(&self, synth: &mut Synth, samples: &mut [f32], now: Instant) {
        let told = self.lock();
        let is_stale = now.saturating_duration_since(told.at) >= PATIENCE;
        let (sound, volume) =
            if is_stale { (Sound::default(), 0.0) } else { (told.sound.clone(), told.volume) };
        drop(told);
        synth.render(&sound, f64::from(volume), samples);
    }

    /// No code that holds the lock can panic; whoever did would leave whole values.
    fn lock(&self) -> MutexGuard<'_, Told> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
