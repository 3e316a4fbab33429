//! The recorder: keeps the next snapshot and the journal in it up to date.

use crate::awaited::Awaited;
use crate::channel::Channel;
use crate::error::LinkError;
use crate::foldback::FoldbackSteps;
use crate::journal::{Acknowledged, Change, JOURNAL_ENTRIES, drop_oldest_limit};
use crate::lease::Lease;
use crate::log::{LOG_LINES, LogEntry, Severity};
use crate::request::{Outcome, Ticket};
use crate::snapshot::{DeviceView, DriveView, LinkCounters, LinkState, RoundTrip, Snapshot, TableView};
use crate::trace::FRAMES_KEPT;
use crate::undecided::{Held, Undecided};
use crate::upkeep;
use slipline_protocol::board::{Analogue, BoardReport, BrownOut, ClockReport, FaultTrial, MutePin};
use slipline_protocol::command::{ArmLease, TravelLimit};
use slipline_protocol::event::{Maintenance, ProfileReport, State, Status, TableReport, TriggerReport, Wear};
use slipline_protocol::hold;
use slipline_protocol::units::SampleIndex;
use slipline_protocol::version::Compatibility;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

/// Number of replies over which the round trip is averaged.
const AVERAGE_OVER: u32 = 16;

/// The snapshot under construction, and whether it has changed since the last one was published.
#[derive(Debug, Default)]
pub(crate) struct Recorder {
    pub(crate) view: Snapshot,
    now: Duration,
    entries: u64,
    /// Drives that wait for the trigger input.
    undecided: Undecided,
    pub(crate) lease: Lease,
    /// The requests whose outcomes are kept until their callers have them.
    pub(crate) awaited: Awaited,
    /// Whether anything changed since the last snapshot.
    changed: bool,
    /// Whether a change is worth a repaint.
    needs_repaint: bool,
}

impl Recorder {
    /// Sets the present time.
    pub(crate) const fn set_time(&mut self, now: Duration) {
        self.now = now;
    }

    /// Marks a change that is worth a repaint.
    pub(crate) const fn touch(&mut self) {
        self.changed = true;
        self.needs_repaint = true;
    }

    /// Whether anything changed, and whether a repaint is worthwhile, since the last call.
    pub(crate) fn take_changes(&mut self) -> (bool, bool) {
        if self.needs_repaint {
            self.view.revision += 1;
        }
        (std::mem::take(&mut self.changed), std::mem::take(&mut self.needs_repaint))
    }

    pub(crate) fn log(&mut self, severity: Severity, text: impl Into<String>) {
        let log = Arc::make_mut(&mut self.view.record.log);
        push_bounded(log, LOG_LINES, LogEntry { severity, time: self.now, text: text.into() });
        self.touch();
    }

    /// Records a change that the device has accepted.
    pub(crate) fn acknowledge(&mut self, at: SampleIndex, change: Change) {
        self.enter(at, change, true);
    }

    /// Records a drive or a chord that waits for the trigger input; a rise counts from this index on.
    pub(crate) fn wait_for_trigger(&mut self, from: SampleIndex, drive: Change) {
        // The last report is about an earlier drive.
        self.view.drive.trigger = None;
        self.undecided.wait(from, drive);
    }

    /// Whether the device must be asked for the outcome of a drive that has waited for the trigger input.
    pub(crate) fn must_ask_for_trigger(&self) -> bool {
        let waits = self.view.drive.status.is_some_and(|status| status.state == State::Waiting);
        self.undecided.is_about_several() || (!waits && !self.undecided.is_empty())
    }

    /// Records the device's report on the drive that waits or has waited for the trigger input.
    pub(crate) fn trigger(&mut self, report: TriggerReport) {
        self.view.drive.trigger = Some(report);
        if let Some(began) = report.began {
            self.lease.drive(began);
        }
        let decided = self.undecided.decide(&report);
        self.enter_all(decided);
        self.settle();
        self.touch();
    }

    /// The journal is complete up to the status, unless the outcome of a drive is unknown.
    fn settle(&mut self) {
        if !self.must_ask_for_trigger() {
            let reported = self.undecided.waits_still();
            self.enter_all(reported);
            self.view.drive.settled = self.view.drive.status;
        }
    }

    fn enter_all(&mut self, entries: Vec<Held>) {
        for Held { at, change, is_exact } in entries {
            self.write(at, change, is_exact);
        }
    }

    /// Records that the device, which has latched a fault at `at`, has stopped its output by itself. It does
    /// so only once that output is known.
    pub(crate) fn stopped_by_itself(&mut self, at: SampleIndex) {
        if !self.undecided.is_empty() {
            return;
        }
        let latest = self.view.record.journal.iter().rev().find_map(|entry| match entry.change {
            Change::Play(_) => Some(true),
            Change::Session | Change::Disarmed | Change::Stop | Change::EmergencyStop => Some(false),
            Change::Armed | Change::Table(_) | Change::Hold | Change::Limit(_) => None,
        });
        if latest == Some(true) {
            self.enter(at, Change::Stop, false);
        }
    }

    /// Records that the device was armed on a lease.
    pub(crate) fn begin_lease(&mut self, lease: ArmLease, at: SampleIndex) {
        let rate_hz = self.view.device.identity.as_ref().map_or(0, |identity| identity.sample_rate_hz);
        self.lease.begin(lease.lease_ms, rate_hz, at);
    }

    /// Records that the device has disarmed itself because its lease was over, if the status shows that.
    pub(crate) fn end_lease(&mut self, status: &Status) {
        if let Some((length, at)) = self.lease.take_status(status) {
            self.view.drive.lease_over = Some(length);
            self.view.drive.leases_over = self.view.drive.leases_over.saturating_add(1);
            self.enter(at, Change::Disarmed, false);
            let seconds = length.as_secs_f64();
            self.log(Severity::Warning, format!("The device disarmed itself: no drive for {seconds} s."));
        }
    }

    /// Records the steps of the thermal fold-back that a status reports.
    pub(crate) fn fold_back(&mut self, heard: &FoldbackSteps) {
        for &(at, per_mille) in &heard.steps {
            self.enter(at, Change::Limit(per_mille), heard.is_complete);
        }
    }

    fn enter(&mut self, at: SampleIndex, change: Change, is_exact: bool) {
        if self.undecided.is_empty() {
            self.write(at, change, is_exact);
        } else {
            self.undecided.hold(Held { at, change, is_exact });
        }
    }

    fn write(&mut self, at: SampleIndex, change: Change, is_exact: bool) {
        self.entries += 1;
        let journal = Arc::make_mut(&mut self.view.record.journal);
        if matches!(change, Change::Limit(_)) {
            drop_oldest_limit(journal);
        }
        let entry = Arc::new(Acknowledged { number: self.entries, at, change, is_exact });
        push_bounded(journal, JOURNAL_ENTRIES, entry);
        self.touch();
    }

    /// A drive that begins at `from` was reported only after a stop had overtaken it. If the stop has the
    /// later index, it prevails.
    pub(crate) fn stop_again(&mut self, from: SampleIndex) {
        let is_stop = |change: &Change| matches!(change, Change::Stop | Change::EmergencyStop);
        let latest = self.view.record.journal.iter().rev().find(|entry| is_stop(&entry.change));
        if let Some(stop) = latest.filter(|stop| stop.at >= from).cloned() {
            self.acknowledge(stop.at, stop.change.clone());
        }
    }

    /// Records the outcome of a request; the link's own requests have no ticket.
    pub(crate) fn finish(&mut self, ticket: Option<Ticket>, outcome: Outcome) {
        if let Outcome::Refused(refusal) = &outcome {
            self.log(Severity::Warning, refusal.to_string());
        }
        self.finish_unlogged(ticket, outcome);
    }

    /// Takes a report, with which the request for it is done.
    pub(crate) fn take(&mut self, ticket: Option<Ticket>, report: impl FnOnce(&mut Self)) {
        report(self);
        self.finish(ticket, Outcome::Done { at: 0 });
    }

    /// As [`Recorder::finish`], without a log entry: the caller retries, or reports the refusal itself.
    pub(crate) fn finish_unlogged(&mut self, ticket: Option<Ticket>, outcome: Outcome) {
        if let Outcome::Refused(refusal) = &outcome
            && let Some(ticket) = ticket
        {
            self.view.record.last_refusal = Some((ticket, refusal.clone()));
        }
        if let Outcome::DeviceTooOld = outcome {
            self.log(Severity::Warning, Compatibility::DeviceOlder.sentence());
        }
        if let Outcome::NotConnected = outcome {
            self.view.link.counters.dropped = self.view.link.counters.dropped.saturating_add(1);
        }
        if let Some(ticket) = ticket {
            let outcomes = Arc::make_mut(&mut self.view.record.outcomes);
            outcomes.push_back((ticket, outcome));
            self.awaited.trim(outcomes);
            self.touch();
        }
    }

    /// Stores the device's report on its upkeep, with a log entry for each condition that a person should
    /// correct.
    pub(crate) fn maintenance(&mut self, reported: Maintenance) {
        let before = self.view.device.maintenance.replace(reported);
        if before.is_none()
            && let Some(warning) = upkeep::before_arming(&reported)
        {
            self.log(Severity::Warning, warning);
        }
        if let Some(warning) = upkeep::worn(&reported)
            && before.is_none_or(|before| before.erasures != reported.erasures)
        {
            self.log(Severity::Warning, warning);
        }
        self.touch();
    }

    /// Stores the device's report on its board, with a log entry for what a person should correct.
    pub(crate) fn board(&mut self, reported: BoardReport) {
        if self.view.device.board.replace(reported).is_none()
            && let Some(warning) = upkeep::muted_for_good(&reported)
        {
            self.log(Severity::Warning, warning);
        }
        self.touch();
    }

    /// Stores the device's report on its supply, with a log entry if its reference voltage is wrong.
    pub(crate) fn analogue(&mut self, reported: Analogue) {
        if self.view.device.analogue.replace(reported).is_none()
            && let Some(warning) = upkeep::wrong_reference(&reported)
        {
            self.log(Severity::Warning, warning);
        }
        self.touch();
    }

    /// Stores the device's report on its mute pin.
    pub(crate) fn mute_pin(&mut self, reported: MutePin) {
        self.view.device.mute_pin = Some(reported);
        self.touch();
    }

    /// Stores the device's clocks.
    pub(crate) fn clock(&mut self, reported: ClockReport) {
        self.view.device.clock = Some(reported);
        self.touch();
    }

    /// Stores the device's report on the level of its brown-out reset.
    pub(crate) fn brown_out(&mut self, reported: BrownOut) {
        self.view.device.brown_out = Some(reported);
        if reported.restarts {
            self.log(Severity::Info, "The brown-out level is written: the device restarts with it.");
        }
        self.touch();
    }

    /// Stores the token of a fault on purpose, and how the last one ended.
    pub(crate) fn fault_trial(&mut self, reported: FaultTrial) {
        self.view.device.fault_trial = Some(reported);
        self.touch();
    }

    /// Stores the device's report on the wear of its profile's flash.
    pub(crate) fn wear(&mut self, reported: Wear) {
        self.view.device.wear = Some(reported);
        self.touch();
    }

    /// Stores the device's report on its actuator's profile.
    pub(crate) fn profile(&mut self, reported: ProfileReport) {
        match &reported.profile {
            Some(profile) => {
                let line = format!("The device keeps the limits of its actuator, \"{}\".", profile.name);
                self.log(Severity::Info, line);
            }
            // It needs none.
            None if self.view.is_simulated() => {}
            None => self.log(Severity::Info, "The device keeps no profile of its actuator."),
        }
        self.view.device.profile = Some(Arc::new(reported));
        self.touch();
    }

    /// Stores the device's report on the actuator's travel limit.
    pub(crate) fn travel_limit(&mut self, limit: Option<TravelLimit>) {
        self.view.drive.travel_limit = limit;
        let line = if limit.is_some() {
            "The device limits the actuator's travel."
        } else {
            "The device does not limit the actuator's travel: the plate names no peak travel."
        };
        self.log(Severity::Info, line);
        self.touch();
    }

    /// Stores the state of the level hold.
    pub(crate) fn hold(&mut self, reported: Option<hold::Held>) {
        if self.view.drive.hold.as_deref() != reported.as_ref() {
            self.view.drive.hold = reported.map(Arc::new);
            self.touch();
        }
    }

    /// Stores a status of the device.
    pub(crate) fn status(&mut self, status: Status) {
        let seen = |status: &Status| {
            let mut seen = *status;
            seen.now = 0;
            seen.counters.frames = 0;
            // Only a change of a percent counts, as displayed: the heat falls for minutes after the last
            // tone.
            seen.heat_per_mille = seen.heat_per_mille.saturating_add(5) / 10;
            seen
        };
        if let Some(before) = self.view.drive.status {
            for fault in status.faults.iter().filter(|&fault| !before.faults.contains(fault)) {
                let text = self.view.fault_text(fault);
                self.log(Severity::Error, format!("Fault: {text}."));
            }
        }
        let was_flattened = self.view.flattened().is_some();
        if self.view.drive.status.as_ref().map(seen) != Some(seen(&status)) {
            self.touch();
        }
        self.view.drive.status = Some(status);
        if let Some(caution) = self.view.flattened().filter(|_| !was_flattened) {
            self.log(Severity::Warning, caution);
        }
        self.view.drive.status_time = self.now;
        self.settle();
        self.changed = true;
    }

    /// Stores the device's report on its table: a table that the device no longer holds is no longer known.
    pub(crate) fn table(&mut self, report: TableReport) {
        self.view.table.confirmed.take_if(|known| report.active != Some(known.header()));
        self.view.table.report = report;
        self.touch();
    }

    pub(crate) fn round_trip(&mut self, took: Duration) {
        let trip = &mut self.view.link.round_trip;
        trip.last = took;
        trip.worst = trip.worst.max(took);
        trip.average = if trip.average.is_zero() {
            took
        } else {
            (trip.average * (AVERAGE_OVER - 1) + took) / AVERAGE_OVER
        };
        self.changed = true;
    }

    /// Counts a drive that was replaced by a newer one or a stop before it was sent.
    pub(crate) const fn superseded(&mut self) {
        self.view.link.counters.superseded = self.view.link.counters.superseded.saturating_add(1);
    }

    /// Counts a drive that ended because the driving program gave no sign of life.
    pub(crate) const fn driver_stalled(&mut self) {
        self.view.link.driver_stalls = self.view.link.driver_stalls.saturating_add(1);
        self.touch();
    }

    pub(crate) fn link(&mut self, link: LinkState) {
        if self.view.link.state != link {
            self.view.link.state = link;
            self.touch();
        }
    }

    /// Copies the channel's counters and takes its traced frames.
    pub(crate) fn count(&mut self, channel: &mut Channel) {
        let traced = channel.take_traced();
        if !traced.is_empty() {
            let frames = Arc::make_mut(&mut self.view.record.frames);
            frames.extend(traced.into_iter().map(Arc::new));
            frames.drain(..frames.len().saturating_sub(FRAMES_KEPT));
            self.changed = true;
        }
        let sent = channel.counters();
        let before = (self.view.link.counters, self.view.link.decoder);
        let LinkCounters { superseded, dropped, .. } = self.view.link.counters;
        self.view.link.counters = LinkCounters { superseded, dropped, ..sent };
        self.view.link.decoder = channel.decoder();
        self.changed |= before != (self.view.link.counters, self.view.link.decoder);
    }

    /// Clears the state of a device that is no longer connected.
    pub(crate) fn forget_device(&mut self, error: Option<LinkError>) {
        let reported = self.undecided.give_up();
        self.enter_all(reported);
        self.lease.end();
        let view = &mut self.view;
        view.device = DeviceView::default();
        let DriveView { status_time, leases_over, lease_over, .. } = view.drive;
        view.drive = DriveView { status_time, leases_over, lease_over, ..DriveView::default() };
        let upload_verified = view.table.upload_verified;
        view.table = TableView { upload_verified, ..TableView::default() };
        view.link.error = error;
        self.touch();
    }

    /// Resets the counters of a connection.
    pub(crate) fn begin(&mut self) {
        let dropped = self.view.link.counters.dropped;
        self.view.link.counters = LinkCounters { dropped, ..LinkCounters::default() };
        self.view.link.round_trip = RoundTrip::default();
        self.view.table.upload_verified = None;
        self.touch();
    }
}

fn push_bounded<T>(list: &mut VecDeque<T>, limit: usize, item: T) {
    if list.len() >= limit {
        list.pop_front();
    }
    list.push_back(item);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::JOURNAL_LIMITS;
    use crate::table::DeviceTable;

    #[test]
    fn a_limit_that_changes_for_minutes_does_not_push_out_the_drive() {
        let mut recorder = Recorder::default();
        recorder.acknowledge(0, Change::Armed);
        for at in 1..1000 {
            recorder.acknowledge(at, Change::Limit(at as u16));
        }
        let journal = &recorder.view.record.journal;
        assert_eq!(journal.front().map(|entry| &entry.change), Some(&Change::Armed));
        assert_eq!(journal.len(), 1 + JOURNAL_LIMITS);
        assert_eq!(
            journal.back().map(|entry| (entry.number, &entry.change)),
            Some((1000, &Change::Limit(999)))
        );
    }

    #[test]
    fn what_a_person_should_mend_is_logged_at_the_first_word_of_it_and_wear_with_each_erasure() {
        let mut recorder = Recorder::default();
        let reported =
            |erasures| Maintenance { erasures, erasures_promised: 20_000, brown_out_guarded: false };
        let mut warnings = |erasures| {
            let before = recorder.view.record.log.len();
            recorder.maintenance(reported(erasures));
            let new = recorder.view.record.log.iter().skip(before);
            let texts = new.filter(|line| line.severity == Severity::Warning).map(|line| line.text.clone());
            texts.collect::<Vec<_>>().join("\n")
        };
        let first = warnings(20_000);
        assert!(first.contains("brown-out level of this board is not set"), "{first}");
        assert!(!first.contains("erased"), "{first}");
        assert_eq!(warnings(20_000), "");
        let worn = warnings(20_001);
        assert!(worn.contains("erased 20001 times") && !worn.contains("brown-out"), "{worn}");
        assert_eq!(warnings(20_001), "");
        assert!(warnings(20_002).contains("erased 20002 times"));
    }

    #[test]
    fn a_table_is_known_for_as_long_as_the_device_names_it() {
        let table = |hz: f64| {
            let knots = [(2.0 * hz, 1.0), (hz, 1.0)];
            Arc::new(DeviceTable::from_knots((0.1, 0.2), 400e3, knots, 1e-6).unwrap())
        };
        let (known, other) = (table(20e3), table(21e3));
        let mut recorder = Recorder::default();
        recorder.view.table.confirmed = Some(known.clone());
        for (active, is_known) in [(Some(known.header()), true), (Some(other.header()), false)] {
            recorder.table(TableReport { active, staged: 0 });
            assert_eq!(recorder.view.table.report.active, active);
            assert_eq!(recorder.view.table.confirmed.is_some(), is_known);
        }
    }
}
