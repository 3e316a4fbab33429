//! What a new snapshot of link and device means for the user: refusals, faults, and the end of a drive.

use super::Drive;
use crate::autopilot;
use crate::changes::Changes;
use crate::instrument::outbox::Outbox;
use slipline_link::protocol::event::{Fault, State};
use slipline_link::{Outcome, Refusal, SIGN_PATIENCE, Snapshot, Ticket};
use slipline_model::setup::Setup;

/// The news of a snapshot.
pub(crate) enum News {
    /// Nothing at all.
    None,
    /// The device's clock has advanced.
    Clock,
    /// More has changed.
    Changes(Changes),
}

/// Why the connected device stopped by itself, and what helps; `None` without a fault.
#[must_use]
pub fn fault_sentence(snapshot: &Snapshot) -> Option<String> {
    let status =
        snapshot.drive.status.filter(|status| status.state == State::Fault && snapshot.is_connected())?;
    let faults = snapshot.faults_text(status.faults);
    Some(format!("Stopped: {faults}. Clear the fault once its cause is gone."))
}

impl Drive {
    /// Takes the link's latest snapshot.
    pub(crate) fn take_snapshot(&mut self) -> News {
        let snapshot = self.link.snapshot();
        let before = std::mem::replace(&mut self.snapshot, snapshot);
        if before.revision != self.snapshot.revision {
            return News::Changes(Changes::between(&before, &self.snapshot));
        }
        let [before, now] =
            [&before, &self.snapshot].map(|snapshot| snapshot.drive.status.map(|status| status.now));
        if before == now { News::None } else { News::Clock }
    }

    /// Reports changes to the user, and requests the table for another device. `is_awaited` says whether another room handles
    /// the outcome of a request.
    pub(crate) fn report(
        &mut self,
        changes: &Changes,
        setup: &Setup,
        is_awaited: impl Fn(Ticket) -> bool,
        out: &mut Outbox,
    ) {
        if self.snapshot.is_connected() {
            out.connected();
        } else {
            // Nothing sounds any more, so messages about refused drives are obsolete.
            out.settle();
        }
        if let Some((ticket, refusal)) = &changes.refused
            && !self.goes_by_rest(*ticket, refusal, setup)
            && !is_awaited(*ticket)
        {
            self.report_refusal(*ticket, refusal, out);
        }
        if changes.state {
            out.state_changed();
        }
        if changes.state || changes.faults {
            match fault_sentence(&self.snapshot) {
                Some(sentence) => out.fault(sentence),
                None if changes.faults => out.cleared(),
                None => {}
            }
        }
        self.report_remaining_faults(out);
        match changes.drive_time_over {
            Some(true) => self.report_drive_time(out),
            Some(false) => out.cleared(),
            None => {}
        }
        if changes.lease_over {
            self.report_lease(out);
        }
        if changes.stalled {
            self.report_stall(out);
        }
        self.ask_for_table();
    }

    fn report_refusal(&self, ticket: Ticket, refusal: &Refusal, out: &mut Outbox) {
        if self.tickets.connect == Some(ticket) {
            out.miss(slipline_link::capitalized(&refusal.to_string()));
        } else if self.tickets.latest_drive == Some(ticket) {
            out.refuse_drive(format!("Refused: {refusal}"));
        } else {
            out.refuse(format!("Refused: {refusal}"));
        }
    }

    /// Reports that the device stopped at the end of its drive time, and what to do.
    fn report_drive_time(&self, out: &mut Outbox) {
        let next = if autopilot::drive_clears_fault(&self.snapshot) {
            "Press Drive to resume."
        } else {
            "Press Clear fault, then arm and drive it again."
        };
        let time = self.snapshot.fault_text(Fault::DriveTime);
        out.stopped(format!("Stopped after {time}. {next}"));
    }

    /// Reports that the device has disarmed itself because nothing was driven for as long as its lease.
    fn report_lease(&mut self, out: &mut Outbox) {
        let minutes = self.snapshot.drive.lease_over.unwrap_or_default().as_secs_f64() / 60.0;
        self.give_up();
        out.stopped(format!(
            "Disarmed: nothing was changed for {minutes} minutes. Arm it, then press Drive to resume."
        ));
    }

    /// Reports that the link has ended the drive because this window did not respond.
    fn report_stall(&mut self, out: &mut Outbox) {
        self.give_up();
        let next = if self.snapshot.is_simulated() { "Press" } else { "Arm it, then press" };
        let seconds = SIGN_PATIENCE.as_secs_f64();
        out.hung(format!(
            "The window did not respond for {seconds} s, so the drive was stopped and the device disarmed. \
             {next} Drive to resume."
        ));
    }

    /// Reports faults that remain after they were cleared: their cause still exists.
    fn report_remaining_faults(&mut self, out: &mut Outbox) {
        let Some(ticket) = self.tickets.clear else { return };
        let Some(status) = self.snapshot.drive.status else { return };
        match self.snapshot.outcome(ticket) {
            // A status from before the clearing does not show its result.
            Some(Outcome::Done { at }) if status.now >= *at => {
                self.tickets.clear = None;
                if !status.faults.is_empty() {
                    let faults = self.snapshot.faults_text(status.faults);
                    let text = format!("Not cleared: {faults}. Its cause persists.");
                    out.hinder(text);
                }
            }
            Some(Outcome::Done { .. }) | None => {}
            Some(_) => self.tickets.clear = None,
        }
    }
}
