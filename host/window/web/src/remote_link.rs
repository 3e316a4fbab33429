//! The link of the page's thread: it posts requests to the device worker and keeps a copy of its snapshot.

use crate::host::Host;
use crate::message::{self, FromDevice, ToDevice};
use slipline_instrument::Link;
use slipline_instrument::bench::Bench;
use slipline_link::{LinkError, LinkState, Port, PortInfo, Request, Snapshot, Ticket};
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::Arc;

/// The link; clones are the same one.
#[derive(Clone)]
pub(crate) struct RemoteLink(Rc<Inner>);

struct Inner {
    host: Rc<Host>,
    /// The bench of the simulated device, which is in the device worker.
    bench: Bench,
    /// The latest request's number.
    last: Cell<u64>,
    snapshot: RefCell<Arc<Snapshot>>,
    ports: RefCell<Vec<PortInfo>>,
    /// Whether the window has not seen these ports yet.
    are_ports_new: Cell<bool>,
    /// The port that the user has chosen in the browser's list.
    chosen: RefCell<Option<Port>>,
}

impl RemoteLink {
    pub(crate) fn new(host: Rc<Host>, bench: Bench) -> Self {
        Self(Rc::new(Inner {
            host,
            bench,
            last: Cell::new(0),
            snapshot: RefCell::default(),
            ports: RefCell::new(vec![PortInfo::simulated()]),
            are_ports_new: Cell::new(false),
            chosen: RefCell::default(),
        }))
    }

    /// Takes an update of the device worker.
    pub(crate) fn update(&self, bytes: &[u8]) {
        match message::read(bytes) {
            Some(FromDevice::Update(update)) => {
                let newer = update.apply(&self.snapshot());
                self.0.snapshot.replace(Arc::new(newer));
            }
            Some(FromDevice::PassedOver) => self.0.bench.passed_over(),
            Some(FromDevice::Ports(ports)) => {
                self.0.ports.replace(ports);
                self.0.are_ports_new.set(true);
            }
            Some(FromDevice::Chosen(port)) => {
                self.0.chosen.replace(Some(port));
            }
            None => {}
        }
    }

    /// The ports that the device worker can open, the simulated device first.
    pub(crate) fn ports(&self) -> Vec<PortInfo> {
        self.0.ports.borrow().clone()
    }

    /// Whether there are other ports than at the last call, and the port that the user has chosen since.
    pub(crate) fn take_port_news(&self) -> (bool, Option<Port>) {
        (self.0.are_ports_new.take(), self.0.chosen.take())
    }

    /// Sends what was done at the bench. It goes before each request, too: a measurement must find its rig.
    pub(crate) fn send_bench(&self) {
        for change in self.0.bench.take_changes() {
            self.0.host.post_device(&message::bytes(&ToDevice::Bench(change)));
        }
    }

    /// The device worker has failed: no later request is carried out.
    pub(crate) fn crash(&self) {
        let mut newer = Snapshot::clone(&self.snapshot());
        newer.revision += 1;
        newer.link.state = LinkState::Lost(LinkError::Crashed);
        newer.link.error = Some(LinkError::Crashed);
        (newer.drive.status, newer.drive.settled) = (None, None);
        self.0.snapshot.replace(Arc::new(newer));
    }
}

impl Link for RemoteLink {
    fn send(&self, request: Request) -> Ticket {
        self.send_bench();
        let ticket = Ticket(self.0.last.get() + 1);
        self.0.last.set(ticket.0);
        self.0.host.post_device(&message::bytes(&ToDevice::Request(ticket, request)));
        ticket
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        Arc::clone(&self.0.snapshot.borrow())
    }
}
