//! The window of a device that has stopped at the end of its drive time.

use crate::real_device;
use crate::test_app::opened;
use eframe::egui::FullOutput;
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::{Fault, Faults, State};
use std::sync::Arc;

#[test]
fn a_stop_at_the_end_of_the_drive_time_is_reported_and_a_real_device_is_cleared_first() {
    for is_simulated in [true, false] {
        let mut link = real_device(State::Fault);
        let snapshot = Arc::make_mut(&mut link.snapshot);
        snapshot.drive.status.as_mut().unwrap().faults = Faults::NONE.with(Fault::DriveTime);
        Arc::make_mut(snapshot.device.identity.as_mut().unwrap()).simulated = is_simulated;
        let mut window = opened(link, [1280.0, 800.0]);
        assert!(window.query_by_label("State: fault: 10 minutes without a command").is_some());
        assert_eq!(window.query_by_label("Clear fault").is_some(), !is_simulated);
        assert_eq!(window.query_by_label("Drive").is_some(), is_simulated);
        assert!(window.query_by_label_contains("Stopped after 10 minutes without a command.").is_some());
        let shows = |output: &FullOutput| {
            let words = crate::plots::words(output);
            words.iter().any(|(words, _)| words == "fault: 10 minutes without a command")
        };
        assert!(shows(window.output()));
        // In a narrow bar the tooltip has the cause, and nothing is pushed out of the window.
        window.set_size([640.0, 480.0].into());
        window.run_steps(5);
        assert!(!shows(window.output()) && window.get_by_label("STOP").rect().right() <= 640.0);
    }
}
