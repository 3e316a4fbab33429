//! Whether the watchdog may be fed: only if the renderer, the link and the safety checks have all run since last time.
//! If not, the amplifier is muted at once; the watchdog comes later.

use crate::mailbox::Pulses;

/// Compares the tasks' counters. Call it every 100 ms. The watchdog's period must be at least twice that, and longer than
/// the longest erasure of the flash while one is under way.
#[derive(Clone, Copy, Debug, Default)]
pub struct Supervisor {
    last: Pulses,
}

impl Supervisor {
    /// Before the first comparison.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: Pulses { renderer: 0, link: 0, safety: 0 } }
    }

    /// Whether all three have moved since the last time this was true.
    pub fn may_feed(&mut self, now: Pulses) -> bool {
        let all = now.renderer != self.last.renderer
            && now.link != self.last.link
            && now.safety != self.last.safety;
        if all {
            self.last = now;
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_stalled_task_ends_the_feeding_of_the_watchdog() {
        let mut supervisor = Supervisor::new();
        let pulses = |renderer, link, safety| Pulses { renderer, link, safety };
        assert!(supervisor.may_feed(pulses(1, 1, 1)));
        assert!(!supervisor.may_feed(pulses(1, 2, 2)));
        assert!(!supervisor.may_feed(pulses(9, 1, 2)));
        assert!(!supervisor.may_feed(pulses(9, 9, 1)));
        assert!(supervisor.may_feed(pulses(9, 9, 9)));
        assert!(supervisor.may_feed(pulses(u32::MAX, 0, 8)), "a wrapped count has moved too");
    }
}
