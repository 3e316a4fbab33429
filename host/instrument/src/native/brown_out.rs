//! The level of a board's brown-out reset, which the board itself writes into its chip's option bytes.

use super::client::{BlockingLink, Client};
use super::error::ClientError;
use slipline_link::protocol::board::{BrownOut, BrownOutOrder};
use slipline_link::{Port, Request};
use std::time::Duration;

/// By then the device has restarted: it does so within 0.1 s of its answer.
const RESTARTED: Duration = Duration::from_secs(1);
/// How often, and how far apart, it is looked for then. A USB device must be found by its computer first.
const LOOKS: u32 = 20;
const BETWEEN_LOOKS: Duration = Duration::from_millis(250);

impl<W: BlockingLink> Client<W> {
    /// Reads the level.
    ///
    /// # Errors
    /// A request's error.
    pub fn brown_out_level(&self) -> Result<BrownOut, ClientError> {
        self.order(false)
    }

    /// Has the device at this port write the level that its board needs, if the present one is lower, waits until it has restarted, and
    /// compares its option bytes with those that it wrote. `restarts` says whether it has written.
    ///
    /// The caller asks its user first ([`upkeep::OPTION_BYTES_RISK`](slipline_link::upkeep::OPTION_BYTES_RISK)).
    ///
    /// # Errors
    /// [`ClientError::OptionsDiffer`], and a request's error: refused unless the device is disarmed, the board's user button is held and
    /// all else is as the device wants it.
    pub fn raise_brown_out_level(&self, port: &Port) -> Result<BrownOut, ClientError> {
        let written = self.order(true)?;
        if !written.restarts {
            return Ok(written);
        }
        self.disconnect();
        self.pause(RESTARTED);
        let mut connected = self.observe(port);
        for _ in 0..LOOKS {
            if connected.is_ok() {
                break;
            }
            self.pause(BETWEEN_LOOKS);
            connected = self.observe(port);
        }
        connected?;
        let found = self.order(false)?;
        if found.options != written.options {
            return Err(ClientError::OptionsDiffer { written: written.options, found: found.options });
        }
        Ok(BrownOut { restarts: true, ..found })
    }

    fn order(&self, is_written: bool) -> Result<BrownOut, ClientError> {
        self.perform(Request::BrownOut(BrownOutOrder { is_written }))?;
        self.snapshot().device.brown_out.ok_or(ClientError::Gone)
    }
}
