//! Messages between the page's thread and the device worker, and states for the page's script.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use slipline_instrument::bench::BenchChange;
use slipline_link::{Port, PortInfo, Request, SnapshotUpdate, Ticket};
use std::io;

/// A message of the page's thread to the device worker.
#[derive(Serialize, Deserialize)]
pub(crate) enum ToDevice {
    /// Carry out this request.
    Request(Ticket, Request),
    /// Do this at the bench of the simulated device's inputs.
    Bench(BenchChange),
}

/// A message of the device worker to the page's thread.
#[derive(Serialize, Deserialize)]
pub(crate) enum FromDevice {
    /// The changes of link and device.
    Update(Box<SnapshotUpdate>),
    /// The bench has passed over to another rig.
    PassedOver,
    /// The ports that exist now.
    Ports(Vec<PortInfo>),
    /// The user has chosen this port in the browser's list.
    Chosen(Port),
}

/// A message as bytes. What the types here hold can always be written.
pub(crate) fn bytes(message: &impl Serialize) -> Vec<u8> {
    postcard::to_extend(message, Vec::new()).unwrap_or_default()
}

/// The message in these bytes; `None` if they are not one of this build.
pub(crate) fn read<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    postcard::from_bytes(bytes).ok()
}

/// A state as JSON. What the types here hold can always be written.
pub(crate) fn json(state: &impl Serialize) -> String {
    let mut written = Vec::new();
    let done = state.serialize(&mut serde_json::Serializer::with_formatter(&mut written, Plain));
    done.ok().and_then(|()| String::from_utf8(written).ok()).unwrap_or_default()
}

/// Writes numbers as the standard library does, whose tables the page has anyway: serde_json has 10 kB of its own.
struct Plain;

impl serde_json::ser::Formatter for Plain {
    fn write_f64<W: ?Sized + io::Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        write!(writer, "{value}")
    }
}
