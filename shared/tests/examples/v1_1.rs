//! What minor 1 adds: its messages, and the variants that it adds to those of minor 0.

use super::{Example, identity, status};
use heapless::Vec;
use slipline_protocol::command::{Apply, Drive, TravelLimit, TravelSetting};
use slipline_protocol::event::{
    Accepted, Fault, Faults, Identity, Maintenance, State, Status, StoredConfig, TriggerReport,
};
use slipline_protocol::refusal::{Field, Refusal};
use slipline_protocol::units::CentiDecibel;
use slipline_protocol::{Command, Event};

/// The commands of minor 1.
pub(crate) fn commands() -> std::vec::Vec<Example<Command>> {
    let at_trigger =
        Drive { tones: Vec::new(), master: CentiDecibel(0), glide: 2000, apply: Apply::AtTrigger };
    let commands = [
        ("maintenance", Command::Maintenance),
        ("set-travel-limit", Command::SetTravelLimit(limited())),
        ("set-travel-limit-none", Command::SetTravelLimit(TravelSetting { limit: None })),
        ("travel-limit", Command::TravelLimit),
        ("trigger", Command::Trigger),
        ("drive-at-trigger", Command::Drive(at_trigger)),
    ];
    commands.map(|(label, command)| (label.to_owned(), command)).into()
}

fn limited() -> TravelSetting {
    let limit = TravelLimit { resonance_uhz: 43_200_000, quality_per_mille: 2500, static_ppm: 1_800_000 };
    TravelSetting { limit: Some(limit) }
}

/// The events of minor 1.
pub(crate) fn events() -> std::vec::Vec<Example<Event>> {
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
        ("status-reply-state-6", Event::Status(Status { state: State::Waiting, ..status() })),
        ("trigger-reply", Event::Trigger(TriggerReport { waits: true, began: None })),
        ("trigger-reply-began", Event::Trigger(TriggerReport { waits: false, began: Some(128_000) })),
        ("travel-limit-reply", Event::TravelLimit(limited())),
        ("travel-limit-reply-none", Event::TravelLimit(TravelSetting { limit: None })),
        (
            "refused-travel",
            Event::Refused(Refusal::Travel { travel_per_mille: 1340, allowed_per_mille: 746 }),
        ),
        ("refused-out-of-range-resonance", out_of_range(Field::Resonance)),
        ("refused-out-of-range-quality", out_of_range(Field::Quality)),
        ("refused-out-of-range-static-travel", out_of_range(Field::StaticTravel)),
    ];
    events.map(|(label, event)| (label.to_owned(), event)).into()
}

fn out_of_range(field: Field) -> Event {
    Event::Refused(Refusal::OutOfRange { field, min: 1, max: 1_000_000_000, got: 0 })
}
