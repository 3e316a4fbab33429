//! A link with fixed snapshots that records the requests.

use crate::session::Session;
use slipline_instrument::Link;
use slipline_link::protocol::event::State;
use slipline_link::{Request, Snapshot, Ticket};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

/// A link with fixed snapshots that records the requests.
#[derive(Clone)]
pub(crate) struct FixedLink {
    /// The first snapshot.
    pub(crate) snapshot: Arc<Snapshot>,
    /// The snapshot that replaces it later.
    later: Rc<RefCell<Option<Arc<Snapshot>>>>,
    /// The requests.
    pub(crate) sent: Rc<RefCell<Vec<Request>>>,
}

/// Link and device while the simulated device drives.
pub(crate) fn driving() -> Snapshot {
    (**Session::driving().instrument.drive.snapshot()).clone()
}

/// A device with a real plate on it, in this state.
pub(crate) fn real_device(state: State) -> FixedLink {
    let mut snapshot = driving();
    let mut identity = (**snapshot.device.identity.as_ref().unwrap()).clone();
    identity.simulated = false;
    snapshot.device.identity = Some(Arc::new(identity));
    // Nothing is known of a profile, so nothing is asked about it.
    snapshot.device.profile = None;
    snapshot.drive.status.as_mut().unwrap().state = state;
    snapshot.revision += 1;
    FixedLink::of(snapshot)
}

impl FixedLink {
    /// A link with this snapshot.
    pub(crate) fn of(snapshot: Snapshot) -> Self {
        Self { snapshot: Arc::new(snapshot), later: Rc::default(), sent: Rc::default() }
    }

    /// Replaces the snapshot from now on.
    pub(crate) fn become_known(&self, mut snapshot: Snapshot) {
        snapshot.revision = self.snapshot().revision + 1;
        *self.later.borrow_mut() = Some(Arc::new(snapshot));
    }
}

impl Link for FixedLink {
    fn send(&self, request: Request) -> Ticket {
        // A line of the log goes to no device.
        if !matches!(request, Request::Note(..)) {
            self.sent.borrow_mut().push(request);
        }
        Ticket(self.sent.borrow().len() as u64)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        let later = self.later.borrow().clone();
        later.unwrap_or_else(|| Arc::clone(&self.snapshot))
    }
}
