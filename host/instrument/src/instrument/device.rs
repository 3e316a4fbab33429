//! The device as the app controls it: its port, the effects of a new snapshot, and the table and drive that
//! are sent to it. The [`autopilot`] decides when the app sends something without a user action.

use super::{Instrument, TableJob, TableMade, TableState};
use crate::autopilot;
use crate::changes::Changes;
use crate::hold::HoldEnd;
use slipline_link::protocol::command::Drive;
use slipline_link::protocol::event::{Fault, State};
use slipline_link::protocol::limits::MAX_DRIVE_MS;
use slipline_link::{
    Outcome, Played, Port, Refusal, Request, SIGN_PATIENCE, Snapshot, Sounding, Ticket, capitalized,
};
use slipline_model::setup::{MAX_TONES, edit};
use slipline_model::sounding;
use slipline_model::texture;
use std::sync::Arc;

/// Time before the device's limit of a drive at which a simulated one is paused.
const PAUSE_BEFORE_MS: u32 = 5000;

impl Instrument {
    /// Connects to a port.
    pub fn connect(&mut self, port: Port) {
        self.autopilot.connecting(&port);
        self.end_hold(HoldEnd::LinkLost);
        // The connection is tried again, so the message about the earlier failure is obsolete.
        self.notices.connected();
        self.connect_sent = Some(self.link.send(Request::Connect(port)));
    }

    pub(crate) fn update_snapshot(&mut self) {
        let snapshot = self.link.snapshot();
        let before = std::mem::replace(&mut self.snapshot, snapshot);
        if before.revision == self.snapshot.revision {
            let now = |snapshot: &Snapshot| snapshot.status.map(|status| status.now);
            if self.playback.sounding.is_some() && now(&before) != now(&self.snapshot) {
                self.follow();
            }
            return;
        }
        if self.snapshot.is_connected() {
            self.notices.connected();
        } else {
            // Nothing sounds any more, so messages about refused drives are obsolete.
            self.notices.settle();
        }
        let changes = Changes::between(&before, &self.snapshot);
        if let Some((ticket, refusal)) = &changes.refused {
            self.report_refusal(*ticket, refusal);
        }
        if changes.state {
            self.notices.state_changed();
        }
        self.report_remaining_faults();
        match changes.drive_time_over {
            Some(true) => self.report_drive_time(),
            Some(false) => self.notices.cleared(),
            None => {}
        }
        if changes.lease_over {
            self.report_lease();
        }
        if changes.stalled {
            self.report_stall();
        }
        self.ask_for_table();
        self.run_autopilot(&changes);
        self.update_playback();
    }

    /// The table for the plate on the screen, once it is finished.
    pub(crate) fn screen_table(&self) -> Option<&Arc<TableMade>> {
        self.table.made().filter(|made| Arc::ptr_eq(&made.plate, &self.setup.plate))
    }

    /// Reports a refusal of the device to the user, unless it is handled here.
    fn report_refusal(&mut self, ticket: Ticket, refusal: &Refusal) {
        if self.goes_by_rest(ticket, refusal) || self.live.awaits(ticket) || self.level.holding.awaits(ticket)
        {
            return;
        }
        if self.connect_sent == Some(ticket) {
            self.notices.miss(capitalized(&refusal.to_string()));
        } else if self.latest_drive == Some(ticket) {
            self.notices.refuse_drive(format!("Refused: {refusal}"));
        } else {
            self.notices.refuse(format!("Refused: {refusal}"));
        }
    }

    /// Reports that the device stopped at the end of its drive time, and what to do.
    fn report_drive_time(&mut self) {
        let next = if autopilot::drive_clears_fault(&self.snapshot) {
            "Press Drive to resume."
        } else {
            "Press Clear fault, then arm and drive it again."
        };
        let time = self.snapshot.fault_text(Fault::DriveTime);
        self.notices.stopped(format!("Stopped after {time}. {next}"));
    }

    /// Stops a simulated drive shortly before the device's own limit would make a fault of it. Every change of the drive
    /// restarts its time, on the device as on the host.
    pub(crate) fn pause_unwatched(&mut self) {
        let (Some(identity), Some(status)) = (&self.snapshot.identity, self.snapshot.status) else { return };
        let may_sound = status.state == State::Driving && self.autopilot.wants_drive();
        if !may_sound || !self.snapshot.is_simulated() {
            return;
        }
        let lasts = u64::from(identity.sample_rate_hz) * u64::from(MAX_DRIVE_MS - PAUSE_BEFORE_MS) / 1000;
        let drive = sounding::sounding(&self.snapshot);
        if drive.is_some_and(|drive| status.now >= drive.began.saturating_add(lasts)) {
            self.autopilot.stopped();
            self.link.send(Request::Stop);
            let minutes = MAX_DRIVE_MS / 60_000;
            self.notices
                .pause(format!("Paused: nothing was changed for {minutes} minutes. Press Drive to resume."));
        }
    }

    /// Reports that the device has disarmed itself because nothing was driven for as long as its lease.
    fn report_lease(&mut self) {
        let minutes = self.snapshot.lease_over.unwrap_or_default().as_secs_f64() / 60.0;
        self.autopilot.stopped();
        self.notices.stopped(format!(
            "Disarmed: nothing was changed for {minutes} minutes. Arm it, then press Drive to resume."
        ));
    }

    /// Reports that the link has ended the drive because this window did not respond.
    fn report_stall(&mut self) {
        self.autopilot.stopped();
        let next = if self.snapshot.is_simulated() { "Press" } else { "Arm it, then press" };
        let seconds = SIGN_PATIENCE.as_secs_f64();
        self.notices.hung(format!(
            "The window did not respond for {seconds} s, so the drive was stopped and the device disarmed. \
             {next} Drive to resume."
        ));
    }

    /// Reports faults that remain after they were cleared: their cause still exists.
    fn report_remaining_faults(&mut self) {
        let Some(ticket) = self.clear_sent else { return };
        let Some(status) = self.snapshot.status else { return };
        match self.snapshot.outcome(ticket) {
            // A status from before the clearing does not show its result.
            Some(Outcome::Done { at }) if status.now >= *at => {
                self.clear_sent = None;
                if !status.faults.is_empty() {
                    let faults = self.snapshot.faults_text(status.faults);
                    let text = format!("Not cleared: {faults}. Its cause persists.");
                    self.notices.hinder(text);
                }
            }
            Some(Outcome::Done { .. }) | None => {}
            Some(_) => self.clear_sent = None,
        }
    }

    pub(crate) fn run_autopilot(&mut self, changes: &Changes) {
        let made = self.screen_table().cloned();
        for action in self.autopilot.update(changes, &self.snapshot, made.as_deref(), self.attention.uploads)
        {
            match action {
                autopilot::Action::Upload(table) => {
                    self.link.send(Request::Upload(table));
                }
                autopilot::Action::Drive => self.send_drive(),
            }
        }
    }

    /// Requests the table for the plate on the screen and the device's rate, unless that was done already.
    pub(crate) fn ask_for_table(&mut self) {
        let Some(identity) = &self.snapshot.identity else { return };
        let rate = identity.sample_rate_hz;
        let is_asked = self
            .table_asked
            .as_ref()
            .is_some_and(|(plate, asked)| Arc::ptr_eq(plate, &self.setup.plate) && *asked == rate);
        if is_asked {
            return;
        }
        self.table_asked = Some((Arc::clone(&self.setup.plate), rate));
        self.table = TableState::Making;
        self.jobs.tables.ask(TableJob {
            plate: Arc::clone(&self.setup.plate),
            sample_rate_hz: f64::from(rate),
            max_knots: usize::from(identity.max_knots),
        });
    }

    /// Stores a finished table, unless the screen shows another plate by now.
    pub(crate) fn take_table(&mut self) {
        let Some(table) = self.jobs.tables.take() else { return };
        let is_current = table.made().is_none_or(|made| Arc::ptr_eq(&made.plate, &self.setup.plate));
        if is_current {
            self.background.keep(&table);
            self.table = table;
            self.edges_m.clear();
            self.forget_prediction();
            self.run_autopilot(&Changes::default());
            self.update_playback();
        }
    }

    /// The request form that plays the setup. A chord that the device would refuse at any loudness is played
    /// as a drive, whose bound is the sum of its amplitudes.
    fn playing(&self) -> Sounding {
        let chosen = self.screen_table().map(|made| {
            texture::sounding(&self.setup, self.chord().cloned(), &made.device_table, &self.snapshot)
        });
        chosen.and_then(Result::ok).unwrap_or_else(|| Sounding::Drive(edit::drive(&self.setup)))
    }

    /// Number of tones that begin, end, or have another place than in this drive. A drag moves one.
    fn tones_moved_from(&self, drive: &Drive) -> usize {
        let Some(made) = self.screen_table() else { return 0 };
        let place = |slot: u8| {
            let tone = self.setup.tone(slot)?;
            made.device_table.position(tone.position_m)
        };
        let before = |slot: u8| drive.tones.iter().find(|tone| tone.slot == slot).map(|tone| tone.position);
        (0..MAX_TONES as u8).filter(|&slot| place(slot) != before(slot)).count()
    }

    pub(crate) fn send_drive(&mut self) {
        let next = self.playing();
        let sounding = sounding::sounding(&self.snapshot).map(|sounding| sounding.played);
        let by_rest = match (&next, &sounding) {
            // A chord begins in silence; a following sound waits for its fade-out. A chord's tones lie in
            // other slots than those of a drive and would glide across the plate.
            (Sounding::Chord(_), _) | (_, Some(Played::Chord(_) | Played::Comb(_))) => true,
            // The tones of a texture, an undo or an opened setup would also glide across the plate, and might
            // be too loud on the way.
            (_, Some(Played::Drive(drive))) => self.tones_moved_from(drive) > 1,
            (_, None) => false,
        };
        if by_rest {
            self.link.send(Request::Stop);
        }
        let ticket = self.link.send(Request::Play(next));
        self.drive_sent = Some(ticket);
        self.latest_drive = Some(ticket);
    }

    /// Whether a refused drive is sent again from rest. The device refuses a glide that would be too loud on
    /// its way, with the old levels at the new places, although the tones fit at their targets. Without this
    /// retry the screen and the plate would differ until the user stops the drive.
    fn goes_by_rest(&mut self, refused: Ticket, refusal: &Refusal) -> bool {
        let fits = self.table.headroom_sum(&self.setup) <= 1.0;
        let helps = autopilot::rest_helps(refusal);
        if self.drive_sent != Some(refused) || !helps || !fits || !self.autopilot.may_drive(&self.snapshot) {
            return false;
        }
        self.link.send(Request::Stop);
        self.send_drive();
        // If the device also refuses the drive from rest, the reason is another.
        self.drive_sent = None;
        true
    }
}
