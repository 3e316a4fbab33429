//! The first turns of a start, while the link's thread has not begun with the connection.

use crate::pluggable_port::SteppedLink;
use crate::session::Session;
use slipline_instrument::{Jobs, Link};
use slipline_link::protocol::event::State;
use slipline_link::{Request, Severity, Snapshot, Ticket};
use std::cell::Cell;
use std::sync::Arc;

/// A link whose thread is late: these many snapshots are from before the connection, each with another change.
struct LateLink {
    link: SteppedLink,
    late: u64,
    seen: Cell<u64>,
}

impl Link for LateLink {
    fn send(&self, request: Request) -> Ticket {
        self.link.send(request)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        let seen = self.seen.get() + 1;
        self.seen.set(seen);
        if seen > self.late {
            return self.link.snapshot();
        }
        // No revision of the real one.
        Arc::new(Snapshot { revision: u64::MAX - seen, ..Snapshot::default() })
    }
}

#[test]
fn a_plate_is_driven_from_the_start_however_late_the_link_begins_with_the_connection() {
    for late in [0, 1, 2, 5] {
        let link = |worker| -> Box<dyn Link> {
            Box::new(LateLink { link: SteppedLink(worker), late, seen: Cell::new(0) })
        };
        let mut session = Session::with(link, Jobs::inline());
        session.pass(2000);
        assert_eq!(session.state(), Some(State::Driving), "{late} snapshots from before the connection");
    }
}

#[test]
fn drive_stop_and_emergency_stop_are_lines_of_the_log_at_info() {
    let mut session = Session::driving();
    session.instrument.press_stop();
    session.pass(1500);
    session.instrument.start();
    session.pass(500);
    session.instrument.press_stop();
    session.instrument.press_stop();
    session.pass(500);
    let snapshot = session.instrument.drive.snapshot();
    let lines = snapshot.record.log.iter().filter(|entry| entry.severity == Severity::Info);
    let lines: Vec<&str> = lines.map(|entry| entry.text.as_str()).collect();
    let of_user = ["Drive.", "Stop.", "Emergency stop."];
    let said: Vec<&str> = lines.into_iter().filter(|line| of_user.contains(line)).collect();
    assert_eq!(said, ["Stop.", "Drive.", "Stop.", "Emergency stop."]);
}
