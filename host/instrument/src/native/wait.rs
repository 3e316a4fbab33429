//! Waits of a program that drives a device.

use super::client::{BlockingLink, Client, GLANCE};
use super::error::ClientError;
use slipline_link::{LinkState, Snapshot, TriggerOutcome};
use std::sync::Arc;
use std::time::Duration;

impl<W: BlockingLink> Client<W> {
    /// Fails if the device no longer carries out the drive.
    ///
    /// # Errors
    /// [`ClientError::Lost`], [`ClientError::Gone`], [`ClientError::Stopped`], and those of [`Client::check_attended`].
    pub fn check_drives(&self) -> Result<(), ClientError> {
        self.check_attended()?;
        self.check_link()?;
        self.check_faults()
    }

    /// The state of link and device after the device has answered.
    ///
    /// # Errors
    /// A request's error; [`ClientError::Lost`] and [`ClientError::Gone`] where another thread has closed the link since.
    pub fn refreshed(&self) -> Result<Arc<Snapshot>, ClientError> {
        self.refresh()?;
        self.check_link()
    }

    /// The state of the link, if it has a device or is about to.
    fn check_link(&self) -> Result<Arc<Snapshot>, ClientError> {
        let snapshot = self.snapshot();
        match &snapshot.link.state {
            LinkState::Lost(error) | LinkState::Reconnecting(error) => Err(ClientError::Lost(error.clone())),
            LinkState::Disconnected => Err(ClientError::Gone),
            LinkState::Connecting | LinkState::Connected => Ok(snapshot),
        }
    }

    /// Waits until the device is at this sample index. Returns whether it is: `false` if `goes_on` has ended the wait.
    ///
    /// # Errors
    /// Those of [`Client::check_drives`].
    pub fn wait_until(
        &self,
        at_samples: u64,
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<bool, ClientError> {
        let rate_hz = f64::from(self.identity()?.sample_rate_hz);
        loop {
            self.check_drives()?;
            let now = self.refresh()?;
            if now >= at_samples {
                return Ok(true);
            }
            if !goes_on() {
                return Ok(false);
            }
            let left_s = (at_samples - now) as f64 / rate_hz;
            self.pause(Duration::from_secs_f64(left_s.min(GLANCE.as_secs_f64())));
        }
    }

    /// Waits until a drive that was accepted at `from` begins after the trigger input has risen; returns the sample index at
    /// which it began, or `None` if `goes_on` has ended the wait.
    ///
    /// # Errors
    /// [`ClientError::Dropped`], and those of [`Client::check_drives`].
    pub fn wait_for_trigger(
        &self,
        from: u64,
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<Option<u64>, ClientError> {
        loop {
            self.check_drives()?;
            match self.snapshot().trigger_outcome(from) {
                TriggerOutcome::Waits if goes_on() => self.pause(GLANCE),
                TriggerOutcome::Waits => return Ok(None),
                TriggerOutcome::Began(at) => return Ok(Some(at)),
                TriggerOutcome::Dropped => return Err(ClientError::Dropped),
            }
        }
    }
}
