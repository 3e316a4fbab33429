//! What minor 1 adds: its messages, and the variants that it adds to those of minor 0.

use super::{Example, identity, status};
use slipline_protocol::event::{Accepted, Fault, Faults, Identity, Maintenance, State, Status, StoredConfig};
use slipline_protocol::refusal::Refusal;
use slipline_protocol::{Command, Event};

/// The commands of minor 1.
pub(crate) fn commands() -> Vec<Example<Command>> {
    [("maintenance", Command::Maintenance)].map(|(label, command)| (label.to_owned(), command)).into()
}

/// The events of minor 1.
pub(crate) fn events() -> Vec<Example<Event>> {
    let worn = Maintenance { erasures: 42, erasures_promised: 20_000, brown_out_guarded: true };
    let largest = Maintenance { erasures: u32::MAX, erasures_promised: u32::MAX, brown_out_guarded: false };
    let fallen_back = Status {
        state: State::Fault,
        faults: Faults::NONE.with(Fault::StoreFellBack),
        first_fault: Some(Fault::StoreFellBack),
        ..status()
    };
    let events = [
        ("maintenance-reply", Event::Maintenance(worn)),
        ("maintenance-reply-largest", Event::Maintenance(largest)),
        ("unchanged", Event::Unchanged(Accepted { at: 128_000 })),
        ("refused-disarm-first", Event::Refused(Refusal::DisarmFirst)),
        ("hello-reply-stored-4", Event::Hello(Identity { stored: StoredConfig::FellBack, ..identity() })),
        ("status-reply-fault-9", Event::Status(fallen_back)),
    ];
    events.map(|(label, event)| (label.to_owned(), event)).into()
}
