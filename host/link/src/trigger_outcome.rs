//! What has become of a drive that waits for the trigger input.

use crate::snapshot::Snapshot;

/// What has become of a drive that waits for the trigger input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriggerOutcome {
    /// It waits, or the device has not reported on it yet.
    Waits,
    /// It began at this sample index.
    Began(u64),
    /// It was dropped before the input rose: by a stop, another drive or a fault.
    Dropped,
}

impl Snapshot {
    /// What has become of the latest drive that waits for the trigger input; `from` is the index of its acceptance, from which
    /// a rise counts.
    #[must_use]
    pub fn trigger_outcome(&self, from: u64) -> TriggerOutcome {
        match self.drive.trigger {
            None => TriggerOutcome::Waits,
            Some(report) if report.waits => TriggerOutcome::Waits,
            Some(report) => match report.began.filter(|&began| began > from) {
                Some(began) => TriggerOutcome::Began(began),
                None => TriggerOutcome::Dropped,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulator::loopback::Loopback;
    use crate::{DeviceTable, DriveRequest, Request, Sounding};
    use slipline_protocol::command::Apply;
    use std::sync::Arc;

    fn outcome_after(loopback: &mut Loopback, blocks: u64, from: u64) -> TriggerOutcome {
        loopback.pass(blocks * 128, |_| ());
        loopback.perform(Request::Refresh, |_| ()).unwrap();
        loopback.pass(100 * 128, |_| ());
        loopback.view().trigger_outcome(from)
    }

    #[test]
    fn each_of_two_drives_that_wait_for_the_trigger_has_its_own_outcome() {
        let mut loopback = Loopback::connect(400_000).unwrap();
        let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
        let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
        loopback.use_table(Arc::new(table)).unwrap();
        let wait = |loopback: &mut Loopback, place_m: f64| {
            let drive = Sounding::Drive(DriveRequest::at(&[(place_m, 0.5)])).beginning(Apply::AtTrigger);
            loopback.play(drive, |_| ()).unwrap()
        };

        let first = wait(&mut loopback, 0.03);
        assert_eq!(outcome_after(&mut loopback, 10, first), TriggerOutcome::Waits);
        loopback.raise_trigger();
        let TriggerOutcome::Began(began) = outcome_after(&mut loopback, 10, first) else {
            panic!("{:?}", loopback.view().drive.trigger)
        };
        assert!(began > first);

        // The report on the first drive says nothing of the second.
        let second = wait(&mut loopback, 0.06);
        assert!(second > began);
        assert_eq!(loopback.view().trigger_outcome(second), TriggerOutcome::Waits);
        assert_eq!(outcome_after(&mut loopback, 10, second), TriggerOutcome::Waits);
        loopback.perform(Request::Stop, |_| ()).unwrap();
        assert_eq!(outcome_after(&mut loopback, 100, second), TriggerOutcome::Dropped);
    }
}
