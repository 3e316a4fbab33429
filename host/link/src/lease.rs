//! The lease of the connected device: how long it stays armed without a drive.
//!
//! The device ends it by itself and without a fault. Its status then shows an idle device whose disarming no request explains.

use slipline_protocol::event::{State, Status};
use slipline_protocol::units::SampleIndex;
use std::time::Duration;

/// The lease that the device has accepted last.
#[derive(Debug, Default)]
pub(crate) struct Lease {
    length: Duration,
    samples: u64,
    /// The index at which it is over; `None` while the device is not armed on a lease.
    ends: Option<SampleIndex>,
}

impl Lease {
    /// The device was armed on a lease at `at`.
    pub(crate) fn begin(&mut self, length_ms: u32, sample_rate_hz: u32, at: SampleIndex) {
        self.length = Duration::from_millis(length_ms.into());
        self.samples = u64::from(sample_rate_hz) * u64::from(length_ms) / 1000;
        self.ends = Some(at.saturating_add(self.samples));
    }

    /// A drive begins at `at`, and the lease with it again, if it is not over before.
    pub(crate) fn drive(&mut self, at: SampleIndex) {
        self.ends =
            self.ends.map(|ends| if at < ends { ends.max(at.saturating_add(self.samples)) } else { ends });
    }

    /// The device was disarmed by a request.
    pub(crate) const fn end(&mut self) {
        self.ends = None;
    }

    /// Takes a status into account: if the device has disarmed itself at the end of its lease, the lease and its end.
    pub(crate) fn take_status(&mut self, status: &Status) -> Option<(Duration, SampleIndex)> {
        let is_disarmed = match status.state {
            State::Idle | State::Fault | State::SafeMode => true,
            State::Armed | State::Driving | State::Stopping | State::Waiting => false,
        };
        let ends = self.ends.take_if(|_| is_disarmed)?;
        (status.state == State::Idle && status.now >= ends).then_some((self.length, ends))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(state: State, now: SampleIndex) -> Status {
        Status { state, now, ..Status::default() }
    }

    #[test]
    fn only_an_idle_device_past_its_lease_reports_an_expired_lease() {
        let second = (Duration::from_secs(1), 8100);
        let cases = [
            (State::Armed, 9000, None),
            (State::Stopping, 9000, None),
            (State::Idle, 8099, None),
            (State::Idle, 8100, Some(second)),
            (State::Fault, 9000, None),
        ];
        for (state, now, found) in cases {
            let mut lease = Lease::default();
            lease.begin(1000, 8000, 100);
            assert_eq!(lease.take_status(&status(state, now)), found, "{state:?} at {now}");
            let is_over = matches!(state, State::Idle | State::Fault);
            assert_eq!(lease.take_status(&status(State::Idle, 9000)).is_none(), is_over, "once");
        }
    }

    #[test]
    fn a_drive_restarts_the_lease_and_a_disarm_ends_it() {
        let mut lease = Lease::default();
        lease.drive(50);
        assert_eq!(lease.take_status(&status(State::Idle, u64::MAX)), None, "none was asked for");
        lease.begin(1000, 8000, 0);
        lease.drive(4000);
        lease.drive(2000);
        assert_eq!(lease.take_status(&status(State::Idle, 12_000)), Some((Duration::from_secs(1), 12_000)));
        lease.begin(1000, 8000, 0);
        lease.drive(8000);
        assert_eq!(
            lease.take_status(&status(State::Idle, 8000)),
            Some((Duration::from_secs(1), 8000)),
            "too late"
        );
        lease.begin(1000, 8000, 0);
        lease.end();
        assert_eq!(lease.take_status(&status(State::Idle, u64::MAX)), None);
    }
}
