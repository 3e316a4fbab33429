//! Signs of life from the driver (a window's or a command's loop), for a connection that is stepped on a thread of its own.

use super::Connection;
use crate::driver_watch::DriverWatch;
use crate::transport::Opener;
use std::time::Duration;

impl<O: Opener> Connection<O> {
    /// Requires signs of life from now on. While the device is armed, [`Connection::take_sign_wanted`]
    /// requests one every [`SIGN_PERIOD`](crate::SIGN_PERIOD); after [`SIGN_PATIENCE`](crate::SIGN_PATIENCE)
    /// without one the device is stopped and disarmed.
    pub fn watch_driver(&mut self) {
        self.driver = Some(DriverWatch::default());
    }

    /// Records that the driver was alive at this time.
    pub fn sign_of_life(&mut self, at: Duration) {
        if let Some(driver) = &mut self.driver {
            driver.sign(at);
        }
    }

    /// Whether a sign of life has been requested since the last call.
    pub fn take_sign_wanted(&mut self) -> bool {
        self.driver.as_mut().is_some_and(DriverWatch::take_question)
    }
}
