//! The sound that the app has set last; the system's callback renders its samples.

use slipline_model::sound::{Sound, Synth};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Time for which a sound continues when the app does not set it again.
pub(super) const PATIENCE: Duration = Duration::from_millis(300);
/// Silence after which the sound card is closed.
pub(super) const IDLE: Duration = Duration::from_secs(10);

/// The present sound, shared by the app and the callback.
pub(super) struct Mix(Mutex<Latest>);

struct Latest {
    sound: Sound,
    volume: f32,
    at: Instant,
    /// Time of the last audible sound.
    heard_at: Instant,
}

impl Mix {
    /// Silent from now on.
    pub(super) fn new(now: Instant) -> Self {
        Self(Mutex::new(Latest { sound: Sound::default(), volume: 0.0, at: now, heard_at: now }))
    }

    /// Sets the sound from now on.
    pub(super) fn set(&self, sound: Sound, volume: f32, now: Instant) {
        let mut latest = self.lock();
        if !sound.is_silent() {
            latest.heard_at = now;
        }
        (latest.sound, latest.volume, latest.at) = (sound, volume, now);
    }

    /// Whether the silence has lasted for [`IDLE`], so that the sound card can be closed.
    pub(super) fn is_idle(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.lock().heard_at) >= IDLE
    }

    /// The next samples, each -1..=1.
    pub(super) fn fill(&self, synth: &mut Synth, samples: &mut [f32], now: Instant) {
        let latest = self.lock();
        let is_stale = now.saturating_duration_since(latest.at) >= PATIENCE;
        let (sound, volume) =
            if is_stale { (Sound::default(), 0.0) } else { (latest.sound.clone(), latest.volume) };
        drop(latest);
        synth.render(&sound, f64::from(volume), samples);
    }

    /// A poisoned lock is used as it is: no code that holds it can panic, and each value is whole by itself.
    fn lock(&self) -> MutexGuard<'_, Latest> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
