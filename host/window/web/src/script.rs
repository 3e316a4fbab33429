//! For tests: the script of a user that the window's tests and the instrument's play, played in a browser. Every request, change
//! and job passes through the bytes in which they reach the workers. Time is virtual.

use crate::message::{self, FromDevice, ToDevice};
use crate::pluggable_port::SteppedLink;
use crate::session::Session;
use crate::{user, work};
use slipline_instrument::Link;
use slipline_link::{Request, Snapshot, SnapshotUpdate, Ticket};
use std::cell::RefCell;
use std::sync::Arc;
use wasm_bindgen::prelude::wasm_bindgen;

/// The link of a page's thread, with the device worker's end in the same thread.
struct Posted {
    link: SteppedLink,
    /// What the device worker has sent, and what the page's thread has made of it.
    published: RefCell<Snapshot>,
    taken: RefCell<Arc<Snapshot>>,
}

impl Link for Posted {
    fn send(&self, request: Request) -> Ticket {
        // The link below numbers requests as the page's thread does.
        match message::read(&message::bytes(&ToDevice::Request(Ticket::default(), request))) {
            Some(ToDevice::Request(_, request)) => self.link.send(request),
            _ => Ticket::default(),
        }
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        let newer = self.link.snapshot();
        let update = SnapshotUpdate::between(&self.published.borrow(), &newer);
        let sent = message::bytes(&FromDevice::Update(Box::new(update)));
        self.published.replace(Snapshot::clone(&newer));
        if let Some(FromDevice::Update(update)) = message::read(&sent) {
            let taken = Arc::new(update.apply(&self.taken.borrow()));
            self.taken.replace(taken);
        }
        Arc::clone(&self.taken.borrow())
    }
}

/// Plays the script; returns its requests in words and the digests of all codes, a line each.
#[wasm_bindgen(js_name = playScript)]
pub fn play_script() -> String {
    let link = |worker| Posted {
        link: SteppedLink(worker),
        published: RefCell::default(),
        taken: RefCell::default(),
    };
    let mut session = Session::with(|worker| Box::new(link(worker)), work::jobs_at_once());
    user::play(&mut session).join("\n")
}
