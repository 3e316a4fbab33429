//! The snapshot: the state of link and device for the rest of the program, made after every change.

use crate::error::LinkError;
use crate::journal::Acknowledged;
use crate::log::LogEntry;
use crate::port::Port;
use crate::refusal::Refusal;
use crate::request::{Outcome, Ticket};
use crate::table::DeviceTable;
use crate::trace::TracedFrame;
use crate::upkeep;
use slipline_protocol::Command;
use slipline_protocol::board::{Analogue, BoardReport, BrownOut, ClockReport, FaultTrial, MutePin};
use slipline_protocol::command::TravelLimit;
use slipline_protocol::event::{
    AcceptedUntil, Fault, Faults, Identity, Maintenance, ProfileReport, State, Status, TableReport,
    TriggerReport, Wear,
};
use slipline_protocol::frame::DecoderCounters;
use slipline_protocol::hold::{Held, HoldProgress};
use slipline_protocol::limits::MAX_DRIVE_MS;
use slipline_protocol::listen::InputsReport;
use slipline_protocol::version::{Compatibility, Version};
use std::borrow::Cow;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

/// The state of the link.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum LinkState {
    /// No port is open and none is sought. [`LinkView::error`] has the reason, unless the user has requested
    /// it.
    #[default]
    Disconnected,
    /// The port is being opened, or the device has not answered the hello yet.
    Connecting,
    /// The device answers.
    Connected,
    /// The device is lost. It is not looked for: that is switched off, the loss has just been detected, or
    /// the link crashed.
    Lost(LinkError),
    /// The device is lost and being looked for; or it has never answered, because its port is missing
    /// ([`LinkError::NoSuchPort`]), and the port is waited for.
    Reconnecting(LinkError),
}

/// The progress of an upload, in knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct UploadProgress {
    /// Knots that the device has accepted.
    pub sent: u16,
    /// All knots.
    pub total: u16,
}

/// Time from a command to the device's reply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct RoundTrip {
    /// The latest reply.
    pub last: Duration,
    /// A running average over about 16 replies.
    pub average: Duration,
    /// The slowest since the connection began.
    pub worst: Duration,
}

/// The link's own counters since the connection began; they saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct LinkCounters {
    /// Commands sent, repeats not counted.
    pub commands: u32,
    /// Commands sent again because no reply was received in time.
    pub retries: u32,
    /// Replies that were not received in time.
    pub timeouts: u32,
    /// Drive requests that were replaced by a newer one or a stop before they were sent.
    pub superseded: u32,
    /// Requests dropped because there was no connection.
    pub dropped: u32,
    /// Replies that belong to no pending command (late or repeated).
    pub unmatched: u32,
}

/// Everything known about link and device at one moment. Cloning is cheap.
///
/// ```
/// use slipline_link::protocol::event::State;
/// use slipline_link::simulator::loopback::Loopback;
/// use slipline_link::{Change, Request};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut loopback = Loopback::connect(400_000)?;
/// loopback.perform(Request::Refresh, |_| ())?;
/// let snapshot = loopback.view();
/// assert!(snapshot.is_connected() && snapshot.is_simulated());
/// assert_eq!(snapshot.drive.status.map(|status| status.state), Some(State::Armed));
/// // What the device has agreed to, in order.
/// let changes: Vec<&Change> = snapshot.record.journal.iter().map(|entry| &entry.change).collect();
/// assert_eq!(changes.last(), Some(&&Change::Armed));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Snapshot {
    /// Increases with every change that is worth a repaint.
    pub revision: u64,
    /// The link.
    pub link: LinkView,
    /// What the device is and has.
    pub device: DeviceView,
    /// What the device does.
    pub drive: DriveView,
    /// The device's table.
    pub table: TableView,
    /// What has happened.
    pub record: RecordView,
}

/// The link: its port, its state and its counters.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct LinkView {
    /// The state of the link.
    pub state: LinkState,
    /// The port that is open, was open or is sought.
    pub port: Option<Port>,
    /// Whether a lost device is looked for, and a missing port waited for.
    pub auto_reconnect: bool,
    /// Whether this program only observes ([`Request::Observe`](crate::Request::Observe)).
    pub observes_only: bool,
    /// The latest error of the link; `None` while connected.
    pub error: Option<LinkError>,
    /// Time from commands to replies.
    pub round_trip: RoundTrip,
    /// The link's own counters.
    pub counters: LinkCounters,
    /// The counters of this side's decoder.
    pub decoder: DecoderCounters,
    /// Number of times the device was stopped and disarmed because its driver gave no sign of life for
    /// [`SIGN_PATIENCE`](crate::SIGN_PATIENCE); over all connections, saturating.
    pub driver_stalls: u32,
}

/// What the device is and has.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct DeviceView {
    /// The device's identity, while connected.
    pub identity: Option<Arc<Identity>>,
    /// Whether its firmware and this program are compatible, while connected.
    pub compatibility: Option<Compatibility>,
    /// What it has found on its board, while connected; `None` with a protocol older than 1.3. Read at the start.
    pub board: Option<BoardReport>,
    /// What it has found of its analogue supply, while connected; `None` with a protocol older than 1.3. Read at the start.
    pub analogue: Option<Analogue>,
    /// Its mute pin, as it was read last ([`Request::MutePin`](crate::Request::MutePin)); `None` before that.
    pub mute_pin: Option<MutePin>,
    /// Its clocks, as they were read last ([`Request::ReadClock`](crate::Request::ReadClock)); `None` before that.
    pub clock: Option<ClockReport>,
    /// The level of its brown-out reset, as it was read or written last ([`Request::BrownOut`](crate::Request::BrownOut)); `None` before
    /// that.
    pub brown_out: Option<BrownOut>,
    /// The token of a fault on purpose, and how the last one ended ([`Request::FaultToken`](crate::Request::FaultToken)); `None` before
    /// that.
    pub fault_trial: Option<FaultTrial>,
    /// The capabilities of its inputs, while connected; `None` with a protocol older than 1.3. Read at the start.
    pub inputs: Option<InputsReport>,
    /// The profile of its actuator, while connected; `None` with a protocol older than 1.3. Read at the start and after each write.
    pub profile: Option<Arc<ProfileReport>>,
    /// The wear of its flash and the guard of its supply, while connected; `None` with a device of protocol
    /// 1.0, which does not report it. Read at the start and after each write to the flash.
    pub maintenance: Option<Maintenance>,
    /// The wear of its profile's flash, and the tables that it still stores in a row, while connected; `None` with a protocol older
    /// than 1.3. Read at the start and after each write to the flash.
    pub wear: Option<Wear>,
}

/// What the device does: its state, its drive and its level hold.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct DriveView {
    /// Its status, while connected; requested every fifth of a second.
    pub status: Option<Status>,
    /// The status up to which the journal is complete. It is the latest one, unless a drive that waited for
    /// the trigger input may have begun before it and the device has not yet reported whether and where.
    pub settled: Option<Status>,
    /// When the status was received, since the worker was started. With the sample rate it gives the present
    /// sample index.
    pub status_time: Duration,
    /// The device's last report on the drive that waits, or waited, for the trigger input; requested when a
    /// drive no longer waits.
    pub trigger: Option<TriggerReport>,
    /// The state of the level hold, or its last state when it ended; `None` before the first one of a
    /// connection and after its end by [`HoldRequest::OFF`](crate::HoldRequest::OFF). Requested ten times a
    /// second while it is on.
    pub hold: Option<Arc<Held>>,
    /// The limit of the actuator's travel that the device has accepted in this session; `None` without a
    /// limit.
    pub travel_limit: Option<TravelLimit>,
    /// Begin and end of the drive that was accepted last, if its glide takes longer than asked; `None` otherwise, and with a device
    /// of a protocol older than 1.3, which does not report it.
    pub glide_until: Option<AcceptedUntil>,
    /// Number of times a device disarmed itself because its lease was over ([`Request::ArmFor`](crate::Request::ArmFor)); over all
    /// connections, saturating.
    pub leases_over: u32,
    /// The lease that was over last.
    pub lease_over: Option<Duration>,
}

/// The device's table and its upload.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct TableView {
    /// The device's table, as it was last read back.
    pub report: TableReport,
    /// The device's table with its knots: this program has it, and the device's digest matches. `None` while
    /// the device holds none, or one of another program.
    pub confirmed: Option<Arc<DeviceTable>>,
    /// The progress of an upload.
    pub upload: Option<UploadProgress>,
    /// Whether the device holds the table of the last upload by its digest, read back; `None` while there was none.
    pub upload_verified: Option<bool>,
}

/// What has happened: commands, outcomes, log and frames.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct RecordView {
    /// The commands that the device has accepted, oldest first.
    pub journal: Arc<VecDeque<Arc<Acknowledged>>>,
    /// The outcomes of the latest requests and of those for which a caller waits, oldest first.
    pub outcomes: Arc<VecDeque<(Ticket, Outcome)>>,
    /// The last refusal, with its request.
    pub last_refusal: Option<(Ticket, Refusal)>,
    /// The log, oldest first.
    pub log: Arc<VecDeque<LogEntry>>,
    /// The latest frames in both directions, oldest first; at most [`FRAMES_KEPT`](crate::FRAMES_KEPT), and none unless
    /// [`Connection::keep_frames`](crate::connection::Connection::keep_frames) was called, as the worker does.
    pub frames: Arc<VecDeque<Arc<TracedFrame>>>,
}

impl Snapshot {
    /// Whether the device reports that it is simulated.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        self.device.identity.as_ref().is_some_and(|identity| identity.simulated)
    }

    /// How firmware and this program differ, if no drive is possible.
    #[must_use]
    pub fn mismatch(&self) -> Option<Compatibility> {
        self.device.compatibility.filter(|compatibility| !compatibility.may_drive())
    }

    /// The device's sample rate in Hz.
    #[must_use]
    pub fn sample_rate_hz(&self) -> Option<f64> {
        Some(f64::from(self.device.identity.as_ref()?.sample_rate_hz))
    }

    /// Whether the device may be armed without a request of the user: only a simulated one, because it moves
    /// no real plate, and only if this program does not merely observe. The link arms such a device after the handshake
    /// and after its faults were cleared; Drive arms it if it has been disarmed since.
    #[must_use]
    pub fn may_arm_unasked(&self) -> bool {
        self.is_simulated() && !self.link.observes_only
    }

    /// Whether the device's firmware knows the command of this name; older firmware may not.
    fn knows(&self, command: &str) -> bool {
        let since = Command::TABLE.iter().find(|row| row.name == command).map_or(u8::MAX, |row| row.since);
        let identity = self.device.identity.as_ref();
        identity.is_some_and(|identity| Version::OURS.shared_minor(identity.version).has(since))
    }

    /// Whether the device's firmware can limit the actuator's travel; older firmware cannot.
    #[must_use]
    pub fn can_limit_travel(&self) -> bool {
        self.knows("SetTravelLimit")
    }

    /// Whether the device's firmware can set its chip's brown-out level; older firmware cannot.
    #[must_use]
    pub fn sets_brown_out_level(&self) -> bool {
        self.knows("BrownOut")
    }

    /// Whether the device's firmware can play chords; older firmware cannot.
    #[must_use]
    pub fn can_play_chords(&self) -> bool {
        self.knows("Chord")
    }

    /// Whether a drive can wait for the device's trigger input; `None` with a device of protocol 1.1 or 1.2, which does not
    /// report it.
    #[must_use]
    pub fn has_trigger_input(&self) -> Option<bool> {
        let knows_it = Version::OURS.shared_minor(self.device.identity.as_ref()?.version).has(1);
        if knows_it { self.device.board.map(|board| board.trigger_input) } else { Some(false) }
    }

    /// How long the glide of the drive that was accepted last takes, in seconds, if that is longer than asked.
    #[must_use]
    pub fn stretched_glide_s(&self) -> Option<f64> {
        let (glide, identity) = (self.drive.glide_until?, self.device.identity.as_ref()?);
        Some(glide.until.saturating_sub(glide.at) as f64 / f64::from(identity.sample_rate_hz))
    }

    /// Whether the device can keep a profile of its actuator: a real one of protocol 1.3 or newer. A simulated one needs none.
    #[must_use]
    pub fn keeps_profile(&self) -> bool {
        !self.is_simulated() && self.device.profile.is_some()
    }

    /// Whether the device has reported that it keeps no profile of its actuator, although it can.
    #[must_use]
    pub fn lacks_profile(&self) -> bool {
        self.keeps_profile() && self.device.profile.as_ref().is_some_and(|report| report.profile.is_none())
    }

    /// The share of a block's time that the longest block since the device's start took; `None` where the device does not report its
    /// processor's clock: with a protocol older than 1.3, and simulated.
    #[must_use]
    pub fn worst_block(&self) -> Option<f64> {
        let (board, identity, status) =
            (self.device.board?, self.device.identity.as_ref()?, self.drive.status?);
        let block_s = f64::from(identity.block) / f64::from(identity.sample_rate_hz);
        (board.core_hz > 0)
            .then(|| f64::from(status.counters.max_cycles) / (f64::from(board.core_hz) * block_s))
    }

    /// The share of full scale within which the DAC's output is linear, 0 to 1; 1 where the device does not report it: with a protocol
    /// older than 1.3.
    #[must_use]
    pub fn linear_share(&self) -> f64 {
        let reported = self.device.analogue.map_or(0, |it| it.linear_per_mille);
        if (1..1000).contains(&reported) { f64::from(reported) / 1e3 } else { 1.0 }
    }

    /// The caution that the tones that sound add up to more than the linear share of the DAC's output, if they do.
    #[must_use]
    pub fn flattened(&self) -> Option<String> {
        let share = self.linear_share();
        let sum = f64::from(self.drive.status?.sum_per_mille) / 1e3;
        (sum > share).then(|| upkeep::beyond_linear(sum, share))
    }

    /// The travel limit with the lower resonance, of the session's and the profile's that the device enforces: it
    /// makes glides longer.
    pub(crate) fn slowest_limit(&self) -> Option<TravelLimit> {
        let profile = self.device.profile.as_ref().and_then(|report| report.profile.as_ref()?.travel);
        [self.drive.travel_limit, profile].into_iter().flatten().min_by_key(|limit| limit.resonance_uhz)
    }

    /// The longest drive without a command of the user.
    #[must_use]
    pub(crate) fn longest_drive(&self) -> Duration {
        let profile = self.device.profile.as_ref().and_then(|report| report.profile.as_ref());
        Duration::from_millis(profile.map_or(MAX_DRIVE_MS, |profile| profile.max_drive_ms).into())
    }

    /// A fault in words; the longest drive is that of the actuator's profile, and a damaged store says whose it is and what to do.
    #[must_use]
    pub fn fault_text(&self, fault: Fault) -> Cow<'static, str> {
        if fault == Fault::StoreDamaged {
            let stored = self.device.profile.as_ref().map(|report| report.stored);
            return Cow::Borrowed(upkeep::damaged_store(stored));
        }
        let longest = self.longest_drive();
        if fault == Fault::DriveTime && longest != Duration::from_millis(MAX_DRIVE_MS.into()) {
            return Cow::Owned(format!("{} s without a command", longest.as_secs_f64()));
        }
        Cow::Borrowed(fault.text())
    }

    /// Faults in words; `none` without any.
    #[must_use]
    pub fn faults_text(&self, faults: Faults) -> String {
        if faults.is_empty() {
            return faults.to_string();
        }
        faults.iter().map(|fault| self.fault_text(fault)).collect::<Vec<_>>().join(", ")
    }

    /// Whether the device has inputs that it can measure; older firmware and a board without them have none.
    #[must_use]
    pub fn can_listen(&self) -> bool {
        self.device.inputs.is_some_and(|inputs| inputs.inputs > 0)
    }

    /// Whether a level hold is on, by the device's last report.
    #[must_use]
    pub fn is_holding(&self) -> bool {
        self.drive.hold.as_ref().is_some_and(|hold| hold.progress == HoldProgress::On)
    }

    /// Whether the device limits the actuator's travel as this table requires, or does not support it.
    #[must_use]
    pub fn limits_travel_for(&self, table: &DeviceTable) -> bool {
        self.drive.travel_limit == table.travel_limit() || !self.can_limit_travel()
    }

    /// Whether the device answers.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.link.state == LinkState::Connected
    }

    /// Whether the device takes drives: unmuted, whatever it plays, by its last report.
    #[must_use]
    pub fn is_armed(&self) -> bool {
        self.drive.status.is_some_and(|status| {
            matches!(status.state, State::Armed | State::Waiting | State::Driving | State::Stopping)
        })
    }

    /// The outcome of a request; `None` while it runs, and once the outcome is no longer kept. After a crash of the link it is
    /// [`Outcome::NotConnected`] instead of `None`.
    #[must_use]
    pub fn outcome(&self, ticket: Ticket) -> Option<&Outcome> {
        let has_crashed = self.link.state == LinkState::Lost(LinkError::Crashed);
        let ended =
            self.record.outcomes.iter().rev().find(|(of, _)| *of == ticket).map(|(_, outcome)| outcome);
        ended.or(has_crashed.then_some(&Outcome::NotConnected))
    }

    /// The chip's unique id in hexadecimal, while connected.
    #[must_use]
    pub fn unit(&self) -> Option<String> {
        self.device
            .identity
            .as_ref()
            .map(|identity| identity.unit.iter().map(|byte| format!("{byte:02x}")).collect())
    }
}
