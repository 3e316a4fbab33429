//! Watch over the driver: the program's loop that uses the device, a window's event loop or a command's
//! waiting loop.
//!
//! The worker's own thread sends the keep-alives, so the device's dead-man does not notice a hanging window:
//! the coil would stay driven, and STOP could not be pressed. So while the device is armed, a sign of life is
//! requested four times a second; after a second without one the device is stopped and disarmed.
//!
//! A program that steps a [`Connection`](crate::connection::Connection) itself does not need this watch: when
//! it hangs, no keep-alive is sent, and the dead-man ends the drive.

use crate::commands::CommandQueue;
use crate::log::Severity;
use crate::recorder::Recorder;
use slipline_protocol::limits::DEAD_MAN_MS;
use std::time::Duration;

/// Time between two requests for a sign of life while the device is armed.
pub const SIGN_PERIOD: Duration = Duration::from_millis(250);
/// Time without a sign of life after which the device is stopped and disarmed. It equals the device's own dead-man time
/// for a silent computer.
pub const SIGN_PATIENCE: Duration = Duration::from_millis(DEAD_MAN_MS as u64);
// Three consecutive signs may be lost or late.
const _: () = assert!(SIGN_PATIENCE.as_millis() >= 4 * SIGN_PERIOD.as_millis());

/// The action that is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Due {
    Nothing,
    /// Request a sign of life.
    Ask,
    /// Stop and disarm; `is_first`: the first time since the last sign of life.
    Stop {
        is_first: bool,
    },
}

/// The times of the signs of life, while the device is armed. For a simulated device they are counted from
/// the first sign.
#[derive(Debug, Default)]
pub(crate) struct DriverWatch {
    armed: Option<Armed>,
    /// Whether any sign of life has been given.
    has_signed: bool,
    /// A sign of life is requested, and the caller has not taken the request yet.
    is_asking: bool,
}

#[derive(Debug)]
struct Armed {
    /// When the latest sign of life was given, or the device was armed.
    since: Duration,
    ask_at: Duration,
    stop_at: Duration,
}

impl DriverWatch {
    /// Records that the driver was alive at this time.
    pub(crate) fn sign(&mut self, at: Duration) {
        self.has_signed |= !at.is_zero();
        if let Some(armed) = &mut self.armed
            && at > armed.since
        {
            armed.since = at;
            armed.stop_at = at + SIGN_PATIENCE;
        }
    }

    /// Whether a sign of life has been requested since the last call.
    pub(crate) const fn take_question(&mut self) -> bool {
        std::mem::replace(&mut self.is_asking, false)
    }

    /// Requests a sign of life, and ends the drive if none is given.
    pub(crate) fn watch(&mut self, queue: &mut CommandQueue, recorder: &mut Recorder, now: Duration) {
        // The link arms a simulated device automatically, also while the window is still being opened.
        if !self.has_signed
            && recorder.view.may_arm_unasked()
            && let Some(armed) = &mut self.armed
        {
            (armed.since, armed.stop_at) = (now, now + SIGN_PATIENCE);
        }
        match self.step(recorder.view.is_armed(), now) {
            Due::Nothing => {}
            Due::Ask => self.is_asking = true,
            Due::Stop { is_first } => {
                queue.abandon(recorder, now);
                if is_first {
                    let seconds = SIGN_PATIENCE.as_secs_f64();
                    let text = format!(
                        "The program that drives gave no sign of life for {seconds} s: stopped and disarmed."
                    );
                    tracing::warn!("{text}");
                    recorder.log(Severity::Error, text);
                    recorder.driver_stalled();
                }
            }
        }
    }

    /// Returns what is due. `is_armed`: whether the device can be driven.
    fn step(&mut self, is_armed: bool, now: Duration) -> Due {
        if !is_armed {
            self.armed = None;
            return Due::Nothing;
        }
        // No sign was requested before the device was armed, so the time counts from here.
        let armed = self.armed.get_or_insert(Armed { since: now, ask_at: now, stop_at: now + SIGN_PATIENCE });
        if now >= armed.stop_at {
            let is_first = armed.stop_at == armed.since + SIGN_PATIENCE;
            // The stop is repeated as long as the device stays armed.
            armed.stop_at = now + SIGN_PATIENCE;
            return Due::Stop { is_first };
        }
        if now >= armed.ask_at {
            armed.ask_at = now + SIGN_PERIOD;
            return Due::Ask;
        }
        Due::Nothing
    }

    /// When [`DriverWatch::step`] must be called next.
    pub(crate) fn deadline(&self) -> Option<Duration> {
        self.armed.as_ref().map(|armed| armed.ask_at.min(armed.stop_at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    /// Due actions with the time in milliseconds, stepped at its own deadlines; each request is answered by a
    /// sign until `hangs_at`.
    fn run(watch: &mut DriverWatch, from_ms: u64, to_ms: u64, hangs_at: u64) -> Vec<(u64, Due)> {
        let mut seen = Vec::new();
        let mut now = ms(from_ms);
        while now < ms(to_ms) {
            let due = watch.step(true, now);
            if due != Due::Nothing {
                seen.push((now.as_millis() as u64, due));
            }
            if due == Due::Ask && now < ms(hangs_at) {
                watch.sign(now + ms(1));
            }
            now = watch.deadline().unwrap().max(now + ms(1));
        }
        seen
    }

    #[test]
    fn a_sign_is_asked_for_four_times_a_second_while_armed_and_never_else() {
        let mut watch = DriverWatch::default();
        assert_eq!((watch.step(false, ms(0)), watch.deadline()), (Due::Nothing, None));
        let seen = run(&mut watch, 5000, 15_000, 15_000);
        assert_eq!(seen.len(), 40);
        assert!(seen.iter().all(|(_, due)| *due == Due::Ask), "{seen:?}");
        assert_eq!((watch.step(false, ms(15_000)), watch.deadline()), (Due::Nothing, None));
    }

    #[test]
    fn after_a_second_without_a_sign_it_is_stopped_and_again_each_second_while_it_stays_armed() {
        let mut watch = DriverWatch::default();
        let seen = run(&mut watch, 0, 4500, 1100);
        let stops: Vec<_> = seen.iter().filter(|(_, due)| *due != Due::Ask).collect();
        let (first, later) = (Due::Stop { is_first: true }, Due::Stop { is_first: false });
        // The last sign was given at 1001 ms.
        assert_eq!(stops, [&(2001, first), &(3001, later), &(4001, later)]);
        // A driver that recovers and hangs again.
        watch.sign(ms(4600));
        assert_eq!(watch.step(true, ms(5599)), Due::Ask);
        assert_eq!(watch.step(true, ms(5600)), first);
    }

    #[test]
    fn the_second_counts_from_the_arming_and_not_from_a_sign_before_it() {
        let mut watch = DriverWatch::default();
        watch.step(true, ms(0));
        watch.sign(ms(10));
        watch.step(false, ms(20));
        assert_eq!(watch.step(true, ms(60_000)), Due::Ask);
        assert_eq!(watch.step(true, ms(60_999)), Due::Ask);
        assert_eq!(watch.step(true, ms(61_000)), Due::Stop { is_first: true });
    }
}
