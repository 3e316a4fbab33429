//! Differences between two snapshots of link and device.

use slipline_link::protocol::event::{Fault, Faults};
use slipline_link::{Refusal, Snapshot, Ticket};

/// What has changed since the previous snapshot. The default: nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// The request that the device has refused.
    pub refused: Option<(Ticket, Refusal)>,
    /// The state of link or device has changed.
    pub state: bool,
    /// `true`: the device has stopped at the end of its drive time; `false`: that fault is cleared.
    pub drive_time_over: Option<bool>,
    /// The link has ended the drive because the driving program did not respond.
    pub stalled: bool,
    /// The device has disarmed itself because its lease was over.
    pub lease_over: bool,
    /// The device's table has changed.
    pub table: bool,
    /// The device's faults have changed.
    pub faults: bool,
}

impl Changes {
    /// The changes from `before` to `now`.
    #[must_use]
    pub fn between(before: &Snapshot, now: &Snapshot) -> Self {
        let latest = |snapshot: &Snapshot| snapshot.record.last_refusal.as_ref().map(|(ticket, _)| *ticket);
        let faults = |snapshot: &Snapshot| snapshot.drive.status.map_or(Faults::NONE, |status| status.faults);
        let is_over = |snapshot: &Snapshot| faults(snapshot).contains(Fault::DriveTime);
        let state = |snapshot: &Snapshot| snapshot.drive.status.map(|status| status.state);
        let table = |snapshot: &Snapshot| snapshot.table.report.active.map(|header| header.crc);
        Self {
            refused: now.record.last_refusal.clone().filter(|_| latest(before) != latest(now)),
            state: before.link.state != now.link.state || state(before) != state(now),
            drive_time_over: (is_over(before) != is_over(now)).then(|| is_over(now)),
            stalled: before.link.driver_stalls != now.link.driver_stalls,
            lease_over: before.drive.leases_over != now.drive.leases_over,
            table: table(before) != table(now),
            faults: faults(before) != faults(now),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_link::LinkState;
    use slipline_link::protocol::event::{State, Status};

    #[test]
    fn each_change_is_reported_once() {
        let mut before = Snapshot::default();
        before.link.state = LinkState::Connected;
        let status =
            Status { state: State::Fault, faults: Faults::NONE.with(Fault::DriveTime), ..Status::default() };
        let refused = Some((Ticket(3), Refusal::UnexpectedReply));
        let mut now = before.clone();
        now.drive.status = Some(status);
        now.record.last_refusal = refused.clone();
        (now.link.driver_stalls, now.drive.leases_over) = (1, 1);
        let first = Changes {
            refused,
            state: true,
            drive_time_over: Some(true),
            stalled: true,
            lease_over: true,
            table: false,
            faults: true,
        };
        assert_eq!(Changes::between(&before, &now), first);
        assert_eq!(Changes::between(&now, &now), Changes::default());
        assert_eq!(Changes::between(&now, &before).drive_time_over, Some(false));
    }
}
