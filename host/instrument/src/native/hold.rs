//! The level hold of a drive.

use super::client::{BlockingLink, Client, GLANCE};
use super::error::ClientError;
use crate::hold::{Holding, Standing};
use slipline_plate::Plate;
use std::sync::Arc;

impl<W: BlockingLink> Client<W> {
    /// Sends the pending requests of a level hold whose tones rest.
    pub fn turn_hold(&self, holding: &mut Holding, plate: &Arc<Plate>) {
        while let Some(request) = holding.turn(&self.snapshot(), plate, true) {
            let ticket = self.send_of_hold(request, |ticket| holding.awaits(ticket));
            holding.sent(ticket);
        }
    }

    /// Measures the tones that sound on the untouched plate, and holds these levels with this largest rise
    /// ([`MAX_RISE`](crate::hold::MAX_RISE)). `since` is the sample index at which their drive began, if known. Returns whether
    /// they are held: `false` if `goes_on` has ended the wait.
    ///
    /// # Errors
    /// [`ClientError::NotHeld`], and those of [`Client::check_attended`].
    pub fn hold(
        &self,
        holding: &mut Holding,
        plate: &Arc<Plate>,
        max_rise_db: f64,
        since: Option<u64>,
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<bool, ClientError> {
        holding.switch_on(plate, max_rise_db, since);
        loop {
            if !goes_on() {
                return self.check_attended().map(|()| false);
            }
            self.turn_hold(holding, plate);
            let snapshot = self.snapshot();
            match holding.standing(&snapshot) {
                Standing::Holding(_) => return Ok(true),
                Standing::Off(end) => {
                    self.check_attended()?;
                    return Err(ClientError::NotHeld(end.cloned()));
                }
                Standing::Waiting | Standing::Silent | Standing::Changing | Standing::Listening(_) => {}
            }
            self.check_attended()?;
            self.pause(GLANCE);
        }
    }
}
