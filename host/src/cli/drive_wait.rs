//! Waiting at a drive that sounds, or for the trigger at which it begins.

use super::device::Device;
use super::failure::Failure;
use super::input_lines::Wake;
use slipline_link::{Snapshot, TriggerOutcome};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Time between two checks of the device's state.
const GLANCE: Duration = Duration::from_millis(100);

/// Waits until the drive has begun after a trigger that counts from this sample index; returns the index and
/// time of its beginning, or `None` if the user interrupts.
pub(super) fn wait_for_trigger(
    device: &Device,
    interruption: &Receiver<Wake>,
    from: u64,
) -> Result<Option<(u64, Instant)>, Failure> {
    let rate_hz = f64::from(device.identity()?.sample_rate_hz);
    let is_over = watch(device, (interruption, &mut |_| Ok(false)), |snapshot| {
        Ok(if snapshot.trigger_outcome(from) == TriggerOutcome::Waits { GLANCE } else { Duration::ZERO })
    })?;
    if !is_over {
        return Ok(None);
    }
    let snapshot = device.snapshot();
    let TriggerOutcome::Began(began) = snapshot.trigger_outcome(from) else {
        return Err(Failure::failed("the device dropped the drive before the trigger"));
    };
    let now = snapshot.drive.status.map_or(began, |status| status.now);
    let since = Duration::from_secs_f64(now.saturating_sub(began) as f64 / rate_hz);
    Ok(Some((began, Instant::now().checked_sub(since).unwrap_or_else(Instant::now))))
}

/// What wakes the program, and what follows it: returns whether the drive goes on.
type Wakes<'a> = (&'a Receiver<Wake>, &'a mut dyn FnMut(Wake) -> Result<bool, Failure>);

/// Waits until the time since `begin` is over or what wakes the program ends the drive, and calls `each` at every check.
pub(super) fn wait_for_end(
    device: &Device,
    wakes: Wakes<'_>,
    begin: Instant,
    duration_s: Option<f64>,
    mut each: impl FnMut(&Snapshot) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let duration = duration_s.map(Duration::from_secs_f64);
    watch(device, wakes, |snapshot| {
        each(snapshot)?;
        Ok(duration.map_or(GLANCE, |duration| duration.saturating_sub(begin.elapsed())))
    })
    .map(drop)
}

/// Waits until no time is `left` or what wakes the program ends the drive, and checks the device meanwhile; returns whether
/// the time is over.
fn watch(
    device: &Device,
    (interruption, follow): Wakes<'_>,
    mut left: impl FnMut(&Snapshot) -> Result<Duration, Failure>,
) -> Result<bool, Failure> {
    loop {
        // Checked first, so that a drive that failed is not reported as complete.
        device.check_drives()?;
        let left = left(&device.snapshot())?;
        if left.is_zero() {
            return Ok(true);
        }
        match interruption.recv_timeout(left.min(GLANCE)) {
            Ok(wake) => {
                if !follow(wake)? {
                    return Ok(device.check_attended().map(|()| false)?);
                }
            }
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(GLANCE),
            Err(RecvTimeoutError::Timeout) => {}
        }
        device.sign_of_life();
    }
}
