//! A link with fixed snapshots that records the requests.

use slipline_link::{Request, Snapshot, Ticket};
use slipline_window::app::Link;
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
