//! Procedures on a device that a program awaits: armed, run to their end or stopped, and disarmed.

use super::ClientError;
use super::client::{BlockingLink, Client, GLANCE};
use crate::measure::{MeasureError, Procedure, Prompt, Run, Verified, Verifying};
use crate::selftest::{SelftestReport, SelftestRequest, Selftesting};
use slipline_link::protocol::limits::LEASE_MS;
use slipline_plate::Plate;
use std::time::Duration;

/// The longest lease, for procedures.
const LONGEST_LEASE: Duration = Duration::from_millis(LEASE_MS.1 as u64);

impl<W: BlockingLink> Client<W> {
    /// Arms the device, runs a procedure to its end, and disarms the device, also where the procedure fails or another thread
    /// stops it. `watch` receives the progress, 0 to 1.
    ///
    /// # Errors
    /// [`ClientError::Procedure`], [`ClientError::StoppedByCall`], [`ClientError::Stopped`] and a request's errors.
    pub fn run<P: Procedure>(
        &self,
        procedure: P,
        mut watch: impl FnMut(f64),
    ) -> Result<P::Found, ClientError> {
        self.arm_for(Some(LONGEST_LEASE))?;
        let found = self.carry_out(procedure, |share, _| watch(share));
        if found.is_err() {
            // The reason is the procedure's; a device that is gone stops by itself.
            let _ = self.disarm();
            return found;
        }
        self.disarm()?;
        found
    }

    /// Runs a procedure to its end. `watch` receives the progress, 0 to 1, and what a person is asked.
    fn carry_out<P: Procedure>(
        &self,
        procedure: P,
        mut watch: impl FnMut(f64, Option<Prompt>),
    ) -> Result<P::Found, ClientError> {
        let stops = self.stops();
        let mut run = Run::of(procedure);
        let mut cancelled = None;
        let mut sent = Vec::new();
        loop {
            let snapshot = self.snapshot();
            if self.link().take_interruption() {
                cancelled = Some(ClientError::Interrupted);
            } else if cancelled.is_none() && self.stops() != stops {
                cancelled = Some(ClientError::StoppedByCall);
            }
            if cancelled.is_some() {
                run.cancel();
            }
            let goes_on = run.turn(&snapshot, |request| {
                let ticket = self.link().send_awaited(request);
                sent.push(ticket);
                ticket
            });
            sent.retain(|&ticket| {
                let is_needed = goes_on && run.awaits(ticket);
                if !is_needed {
                    self.link().release(ticket);
                }
                is_needed
            });
            if !goes_on {
                break;
            }
            watch(run.progress(snapshot.drive.status.map_or(0, |status| status.now)), run.prompt());
            if let Some(ticket) = run.awaited() {
                let _ = self.link().wait(ticket, GLANCE);
            }
        }
        if let Some(cancelled) = cancelled {
            return Err(cancelled);
        }
        self.check_attended()?;
        let found = run.finish();
        if let Err(MeasureError::Fault(_)) = found {
            self.check_faults()?;
        }
        Ok(found?)
    }

    /// Tests the board, which is disarmed then, with its mute pin low except where the request says that the amplifier is unplugged.
    /// `watch` receives the progress, 0 to 1, and what a person is asked.
    ///
    /// # Errors
    /// Those of [`Client::run`]; what the board does not do is in the report.
    pub fn selftest(
        &self,
        request: SelftestRequest,
        watch: impl FnMut(f64, Option<Prompt>),
    ) -> Result<SelftestReport, ClientError> {
        self.attend();
        self.carry_out(Selftesting::new(request), watch)
    }

    /// Arms the device, which holds the table of this plate, plays this number of tones, 1 to 16, and compares the codes of
    /// four windows of this length ([`verify_windows_s`](crate::measure::verify_windows_s)) with the mirror's; then it stops and
    /// disarms the device.
    ///
    /// # Errors
    /// [`ClientError::NotComparable`], and those of [`Client::run`].
    pub fn verify(&self, plate: &Plate, tones: u8, window_s: f64) -> Result<Verified, ClientError> {
        let rate_hz = f64::from(self.identity()?.sample_rate_hz);
        let verified = self.run(Verifying::new(plate, tones, window_s, rate_hz), |_| ());
        if let Err(
            ClientError::Stopped(_) | ClientError::Procedure(MeasureError::Fault(_) | MeasureError::Unknown),
        ) = verified
        {
            let fault = self.snapshot().drive.status.and_then(|status| status.first_fault);
            return Err(ClientError::NotComparable(fault));
        }
        verified
    }
}
