//! The drive: the link, the latest snapshot of it, the table of the setup's plate, and the requests that have the device sound
//! the setup. The [`autopilot`] decides when something is sent without a user action. It knows no other room: a setup is
//! passed to it.

mod device_intent;
mod reports;
mod start;
mod stop_presses;
mod table;

pub use device_intent::DeviceIntent;
pub(crate) use reports::News;
pub use reports::fault_sentence;
pub(crate) use start::Obstacle;
pub use start::SAFE_MODE;

use super::outbox::Outbox;
use super::shell::Link;
use super::work::Jobs;
use crate::autopilot::{self, Autopilot};
use crate::changes::Changes;
use slipline_link::protocol::command;
use slipline_link::protocol::event::State;
use slipline_link::protocol::limits::MAX_DRIVE_MS;
use slipline_link::{
    ChordRequest, LinkState, Played, Port, Refusal, Request, Severity, Snapshot, Sounding, Ticket,
};
use slipline_model::companions::with_companions;
use slipline_model::jobs::table::{TableMade, TableState};
use slipline_model::setup::{MAX_TONES, Setup, edit};
use slipline_model::{sounding, texture};
use slipline_plate::{DriveTable, Plate};
use std::cell::OnceCell;
use std::mem::take;
use std::sync::Arc;
use stop_presses::StopPresses;
use table::Table;

/// Time before the device's limit of a drive at which a simulated one is paused.
const PAUSE_BEFORE_MS: u32 = 5000;
/// The sample rate that is assumed until a device reports its own, in Hz.
pub(super) const USUAL_RATE_HZ: f64 = 400e3;

/// The device, and the drive that it should play.
pub struct Drive {
    link: Box<dyn Link>,
    snapshot: Arc<Snapshot>,
    autopilot: Autopilot,
    tickets: Tickets,
    table: Table,
    /// The setup's tones as a chord; the setup or its table has not changed since.
    chord: OnceCell<Option<ChordRequest>>,
    stop_presses: StopPresses,
}

/// The latest requests whose outcomes are handled.
#[derive(Default)]
struct Tickets {
    /// The latest request for a connection.
    connect: Option<Ticket>,
    /// The port of a request for a connection that the link has not begun with.
    connecting: Option<Port>,
    /// The latest drive, until a refusal of it is handled.
    drive: Option<Ticket>,
    /// The latest drive.
    latest_drive: Option<Ticket>,
    /// The latest request to clear faults, until its result is known.
    clear: Option<Ticket>,
}

impl Drive {
    /// A drive of this plate, not connected to a device; it takes its queue from `jobs`.
    pub(crate) fn new(link: Box<dyn Link>, plate: &Arc<Plate>, jobs: &mut Jobs) -> Self {
        Self {
            link,
            snapshot: Arc::default(),
            autopilot: Autopilot::default(),
            tickets: Tickets::default(),
            table: Table::of(Arc::clone(plate), take(&mut jobs.tables)),
            chord: OnceCell::new(),
            stop_presses: StopPresses::default(),
        }
    }

    /// The state of link and device.
    #[must_use]
    pub const fn snapshot(&self) -> &Arc<Snapshot> {
        &self.snapshot
    }

    pub(crate) fn sample_rate_hz(&self) -> f64 {
        self.snapshot.sample_rate_hz().unwrap_or(USUAL_RATE_HZ)
    }

    pub(crate) fn send(&self, request: Request) -> Ticket {
        self.link.send(request)
    }

    /// Writes a line to the log.
    pub(crate) fn note(&self, severity: Severity, text: String) {
        self.send(Request::Note(severity, text));
    }

    /// The state of the table for the setup's plate.
    pub(crate) const fn table(&self) -> &TableState {
        self.table.state()
    }

    /// The share of the table's computation that is done, 0..=1, while it is under way.
    pub(crate) fn table_progress(&self) -> Option<f32> {
        self.table.progress()
    }

    /// The table for the setup's plate, once it is finished.
    pub(crate) fn table_made(&self) -> Option<&Arc<TableMade>> {
        self.table.made()
    }

    /// The same table in physical units.
    pub(crate) fn drive_table(&self) -> Option<&DriveTable> {
        self.table_made().map(|made| &made.drive_table)
    }

    /// The peak at level 1 and full master, in metres; `None` until the plate's table is finished.
    pub fn full_peak_m(&self) -> Option<f64> {
        self.drive_table().map(|table| table.peak_at_full_scale_m())
    }

    /// Whether the device holds the table of the setup's plate.
    pub(crate) fn is_table_there(&self) -> bool {
        let on_device = self.snapshot.table.report.active.map(|header| header.crc);
        self.table_made().is_some_and(|made| on_device == Some(made.device_table.crc()))
    }

    /// The setup's tones as a chord, if they are one that the device can play with its plate's table.
    pub(crate) fn chord(&self, setup: &Setup) -> Option<&ChordRequest> {
        let made = self.table_made().filter(|_| self.snapshot.can_play_chords())?;
        let chord = self.chord.get_or_init(|| {
            #[cfg(test)]
            super::tests::count(&super::tests::CHORDS);
            texture::chord_of(setup, &made.device_table)
        });
        chord.as_ref()
    }

    /// Connects to a port.
    pub(crate) fn connect(&mut self, port: Port) {
        self.autopilot.connecting(&port);
        self.tickets.connecting = Some(port.clone());
        self.tickets.connect = Some(self.send(Request::Connect(port)));
    }

    /// Whether the snapshot is older than the latest request for a connection: what it says of the link is no loss.
    fn is_before_connection(&mut self) -> bool {
        let link = &self.snapshot.link;
        let has_begun = matches!(link.state, LinkState::Connecting | LinkState::Connected)
            && link.port == self.tickets.connecting;
        if has_begun || self.tickets.connect.is_some_and(|ticket| self.snapshot.outcome(ticket).is_some()) {
            self.tickets.connecting = None;
        }
        self.tickets.connecting.is_some()
    }

    /// Whether the user wants the plate driven.
    pub(crate) fn is_wanted(&self) -> bool {
        self.autopilot.wants_drive()
    }

    /// The setup has changed: it is sent at once if the plate is driven, unless it is sent later; with another plate once the
    /// device holds its table.
    pub(crate) fn use_setup(&mut self, setup: &Setup, has_new_plate: bool, is_sent_later: bool) {
        self.forget_chord();
        if has_new_plate {
            self.table.use_plate(&setup.plate);
            self.autopilot.setup_replaced();
            self.ask_for_table();
        } else if !is_sent_later && self.may_play() {
            self.play(setup);
        }
    }

    /// Whether the plate is driven, so that a change of the setup is sent.
    pub(crate) fn may_play(&self) -> bool {
        self.autopilot.may_drive(&self.snapshot)
    }

    fn forget_chord(&mut self) {
        self.chord = OnceCell::new();
    }

    /// Requests the table for the setup's plate and the device's rate, unless that was done already.
    fn ask_for_table(&mut self) {
        if let Some(identity) = &self.snapshot.device.identity {
            self.table.ask(identity);
        }
    }

    /// Computes the table whose computation was cancelled.
    pub fn make_table(&mut self) {
        self.table.forget_request();
        self.ask_for_table();
    }

    /// Stores a finished table; returns whether there is one for the setup's plate.
    pub(crate) fn take_table(&mut self) -> bool {
        let is_new = self.table.take();
        if is_new {
            self.forget_chord();
        }
        is_new
    }

    /// Cancels the computation of the table; returns the table from before if it is that of another plate.
    pub(crate) fn cancel_table(&mut self) -> Option<Arc<TableMade>> {
        self.table.cancel()
    }

    /// Restores a table whose plate is in the setup again.
    pub(crate) fn restore_table(&mut self, kept: Arc<TableMade>) {
        self.table.restore(kept);
        self.forget_chord();
    }

    /// Sends the table for the setup's plate, once it is finished.
    pub fn upload(&self) {
        if let Some(made) = self.table.state().made() {
            self.send(Request::Upload(Arc::clone(&made.device_table)));
        }
    }

    /// Sends what the autopilot decides after these changes.
    pub(crate) fn run_autopilot(&mut self, changes: &Changes, setup: &Setup, uploads: bool) {
        if self.is_before_connection() {
            return;
        }
        let made = self.table_made().cloned();
        for action in self.autopilot.update(changes, &self.snapshot, made.as_deref(), uploads) {
            match action {
                autopilot::Action::Upload(table) => {
                    self.send(Request::Upload(table));
                }
                autopilot::Action::Drive => self.play(setup),
            }
        }
    }

    /// The request form that plays the setup. A chord that the device would refuse at any loudness is played
    /// as a drive, whose bound is the sum of its amplitudes.
    fn playing(&self, setup: &Setup) -> Sounding {
        let chosen = self.table_made().map(|made| {
            texture::sounding(setup, self.chord(setup).cloned(), &made.device_table, &self.snapshot)
        });
        chosen.and_then(Result::ok).unwrap_or_else(|| Sounding::Drive(edit::drive(setup)))
    }

    /// Number of tones of the setup that begin, end, or have another place than in this drive. A drag moves one.
    fn tones_moved_from(&self, drive: &command::Drive, setup: &Setup) -> usize {
        let Some(made) = self.table_made() else { return 0 };
        let place = |slot: u8| {
            let tone = setup.tone(slot)?;
            made.device_table.position(tone.position_m)
        };
        let before = |slot: u8| drive.tones.iter().find(|tone| tone.slot == slot).map(|tone| tone.position);
        (0..MAX_TONES as u8).filter(|&slot| place(slot) != before(slot)).count()
    }

    /// Sends the setup's tones.
    pub(crate) fn play(&mut self, setup: &Setup) {
        let next = self.playing(setup);
        let sounding = sounding::sounding(&self.snapshot).map(|sounding| sounding.played);
        let by_rest = match (&next, &sounding) {
            // A chord begins in silence; a following sound waits for its fade-out. A chord's tones lie in
            // other slots than those of a drive and would glide across the plate.
            (Sounding::Chord(_), _) | (_, Some(Played::Chord(_) | Played::Comb(_))) => true,
            // The tones of a texture, an undo or an opened setup would also glide across the plate, and might
            // be too loud on the way.
            (_, Some(Played::Drive(drive))) => self.tones_moved_from(drive, setup) > 1,
            (_, None) => false,
        };
        if by_rest {
            self.send(Request::Stop);
        }
        let ticket = self.send(Request::Play(next));
        self.tickets.drive = Some(ticket);
        self.tickets.latest_drive = Some(ticket);
    }

    /// Plays the setup's tones from rest with companions that cancel the harmonics of the drive, until they change; or reports the
    /// obstacle.
    pub(crate) fn cancel_harmonics(&mut self, setup: &Setup, out: &mut Outbox) {
        let Some(made) = self.table_made().filter(|_| self.may_play() && self.is_table_there()) else {
            return out.hinder("Press Drive first: the harmonics of what sounds are cancelled.".to_owned());
        };
        match with_companions(setup, &made.device_table) {
            Ok(comb) => {
                self.send(Request::Stop);
                self.tickets.latest_drive = Some(self.send(Request::Play(Sounding::Comb(comb))));
                out.post("Companions cancel the drive's harmonics until a tone changes.".to_owned());
            }
            Err(reason) => out.hinder(format!("{}.", slipline_link::capitalized(&reason.to_string()))),
        }
    }

    /// Whether a refused drive is sent again from rest. The device refuses a glide that would be too loud on
    /// its way, with the old levels at the new places, although the tones fit at their targets. Without this
    /// retry the screen and the plate would differ until the user stops the drive.
    fn goes_by_rest(&mut self, refused: Ticket, refusal: &Refusal, setup: &Setup) -> bool {
        let fits = self.table().headroom_sum(setup) <= 1.0;
        let helps = autopilot::rest_helps(refusal);
        if self.tickets.drive != Some(refused) || !helps || !fits || !self.may_play() {
            return false;
        }
        self.send(Request::Stop);
        self.play(setup);
        // If the device also refuses the drive from rest, the reason is another.
        self.tickets.drive = None;
        true
    }

    /// The drive is no longer wanted: only the user can drive again.
    pub(crate) fn give_up(&mut self) {
        self.autopilot.stopped();
    }

    /// Ends the drive for every source.
    pub(crate) fn end(&mut self, stop: Request) {
        self.give_up();
        self.send(stop);
    }

    /// Disarms a real device after a stop. The simulated device stays armed: nothing real moves, and it would be armed again
    /// automatically. A device of another version accepts no command but the stop.
    pub(crate) fn disarm_real(&self) {
        let may_drive = self.snapshot.mismatch().is_none();
        if self.snapshot.is_connected() && !self.snapshot.is_simulated() && may_drive {
            self.send(Request::Disarm);
        }
    }

    /// Records a press of STOP; returns whether it is the second of two that mean an emergency stop.
    pub(crate) fn is_second_stop(&mut self, now_s: f64) -> bool {
        self.stop_presses.is_second(now_s)
    }

    /// Whether a key of STOP also leaves pages and fields, so that it is no first press: nothing sounds, and nothing real could
    /// move. The device is simulated, connected, without a fault, and no drive is wanted.
    pub(crate) fn is_known_to_be_silent(&self, now_s: f64) -> bool {
        let state = self.snapshot.drive.status.map(|status| status.state);
        self.snapshot.is_connected()
            && self.snapshot.is_simulated()
            && matches!(state, Some(State::Idle | State::Armed))
            && !self.is_wanted()
            && !self.stop_presses.has_first(now_s)
    }

    /// Stops a simulated drive shortly before the device's own limit would make a fault of it. Every change of the drive
    /// restarts the time, on the device as here.
    pub(crate) fn pause_unwatched(&mut self, out: &mut Outbox) {
        let Snapshot { device, drive, .. } = &*self.snapshot;
        let (Some(identity), Some(status)) = (&device.identity, drive.status) else { return };
        let may_sound = status.state == State::Driving && self.is_wanted();
        if !may_sound || !self.snapshot.is_simulated() {
            return;
        }
        let lasts = u64::from(identity.sample_rate_hz) * u64::from(MAX_DRIVE_MS - PAUSE_BEFORE_MS) / 1000;
        let drive = sounding::sounding(&self.snapshot);
        if drive.is_some_and(|drive| status.now >= drive.began.saturating_add(lasts)) {
            self.end(Request::Stop);
            let minutes = MAX_DRIVE_MS / 60_000;
            out.pause(format!("Paused: nothing was changed for {minutes} minutes. Press Drive to resume."));
        }
    }
}

#[cfg(test)]
mod tests;
