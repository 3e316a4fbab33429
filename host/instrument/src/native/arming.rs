//! The conditions for arming a board.

use super::client::{BlockingLink, Client};
use super::error::ClientError;
use slipline_link::upkeep;

/// Which warnings about its board the user accepts; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ArmingConsent {
    /// That its brown-out level is not set.
    pub despite_brown_out_level: bool,
    /// That it keeps no profile of its actuator.
    pub despite_no_profile: bool,
}

impl<W: BlockingLink> Client<W> {
    /// Checks that the device may be armed: its brown-out level is set and it keeps a profile of its actuator, or the user
    /// accepts that it does not. A simulated device and firmware older than protocol 1.3 need no profile.
    ///
    /// # Errors
    /// [`ClientError::Unguarded`] and [`ClientError::NoProfile`], with the warning for the user.
    pub fn may_be_armed(&self, consent: ArmingConsent) -> Result<(), ClientError> {
        let snapshot = self.snapshot();
        let warning = snapshot.device.maintenance.as_ref().and_then(upkeep::before_arming);
        if let Some(warning) = warning.filter(|_| !consent.despite_brown_out_level) {
            return Err(ClientError::Unguarded(warning));
        }
        if snapshot.lacks_profile() && !consent.despite_no_profile {
            return Err(ClientError::NoProfile);
        }
        Ok(())
    }
}
