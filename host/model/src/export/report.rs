//! The diagnostics report, as text: versions, link, device, counters, table, setup, log. A line is a name, a value
//! and its unit. The report contains no name of the user or the machine.

use crate::jobs::table::TableState;
use crate::setup::Setup;
use crate::setup::file as setup_file;
use slipline_link::protocol::command::TableHeader;
use slipline_link::protocol::event::{Counters, Identity, ResetCause, State, Status, StoredConfig};
use slipline_link::protocol::frame::DecoderCounters;
use slipline_link::{LinkCounters, LinkError, LinkState, Port, RoundTrip, Snapshot, upkeep};
use std::fmt::{Display, Write as _};
use std::time::Duration;

/// Width of the column of names, in characters.
const NAME: usize = 30;

/// A text in titled sections.
#[derive(Default)]
struct Page(String);

impl Page {
    fn title(&mut self, title: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "\n== {title}");
    }

    fn line(&mut self, name: &str, value: impl Display) {
        let _ = writeln!(self.0, "{:NAME$} {value}", format!("{name}:"));
    }

    fn text(&mut self, text: &str) {
        self.0.push_str(text.trim_end());
        self.0.push('\n');
    }
}

/// The report's text.
#[must_use]
pub fn text(snapshot: &Snapshot, setup: &Setup, table: &TableState) -> String {
    let mut page = Page::default();
    let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
    page.line("Slipline", format!("{} on {os} {arch}", env!("CARGO_PKG_VERSION")));
    link(&mut page, snapshot);
    page.title("device");
    match &snapshot.device.identity {
        Some(identity) => device(&mut page, snapshot, identity),
        None => page.text("not connected"),
    }
    page.title("status");
    match &snapshot.drive.status {
        Some(status) => self::status(&mut page, snapshot, status),
        None => page.text("not known"),
    }
    page.title("table on the device");
    match &snapshot.table.report.active {
        Some(header) => self::table(&mut page, header),
        None => page.text("none"),
    }
    page.line("Known knot by knot", yes(snapshot.table.confirmed.is_some()));
    page.line("Upload verified by digest", snapshot.table.upload_verified.map_or("no upload", yes));
    page.line(
        "Upload under way",
        match snapshot.table.upload {
            Some(progress) => format!("{} of {} knots", progress.sent, progress.total),
            None => "no".to_owned(),
        },
    );
    page.line("Knots staged", snapshot.table.report.staged);
    page.title("table for the screen");
    match table {
        TableState::Ready(made) => self::table(&mut page, &made.device_table.header()),
        TableState::Failed(reason) => page.text(reason),
        TableState::Waiting => page.text("waiting for a device"),
        TableState::Making => page.text("being made"),
        TableState::Cancelled => page.text("given up"),
    }
    page.title("setup");
    page.text(&setup_file::write(setup));
    page.title("log");
    let log: Vec<String> = snapshot.record.log.iter().map(ToString::to_string).collect();
    page.text(&log.join("\n"));
    page.title("latest frames");
    let frames: Vec<String> = snapshot.record.frames.iter().map(ToString::to_string).collect();
    page.text(&frames.join("\n"));
    page.0
}

const fn yes(is_so: bool) -> &'static str {
    if is_so { "yes" } else { "no" }
}

fn ms(time: Duration) -> String {
    format!("{:.3} ms", time.as_secs_f64() * 1e3)
}

fn per_cent(per_mille: u16) -> String {
    format!("{:.1} %", f32::from(per_mille) / 10.0)
}

fn link(page: &mut Page, snapshot: &Snapshot) {
    page.title("link");
    let state = match &snapshot.link.state {
        LinkState::Disconnected => "disconnected".to_owned(),
        LinkState::Connecting => "connecting".to_owned(),
        LinkState::Connected => "connected".to_owned(),
        LinkState::Lost(trouble) => format!("lost: {trouble}"),
        LinkState::Reconnecting(LinkError::NoSuchPort(_)) => "waiting for a missing port".to_owned(),
        LinkState::Reconnecting(trouble) => format!("reconnecting: {trouble}"),
    };
    page.line("State", state);
    page.line(
        "Port",
        match &snapshot.link.port {
            None => "none".to_owned(),
            // The path of a port may contain the user's name.
            Some(Port::Unix(_)) => "a Unix socket".to_owned(),
            Some(port) => port.to_string(),
        },
    );
    page.line("Reconnects by itself", yes(snapshot.link.auto_reconnect));
    let trouble = snapshot.link.error.as_ref().map_or_else(|| "none".to_owned(), ToString::to_string);
    page.line("Trouble", trouble);
    let refusal = snapshot.record.last_refusal.as_ref();
    let refusal = refusal.map_or_else(|| "none".to_owned(), |(_, refusal)| refusal.to_string());
    page.line("Last refusal", refusal);
    // Destructured field by field, so that a new counter does not compile until it is reported here.
    let RoundTrip { last, average, worst } = snapshot.link.round_trip;
    page.line("Round trip, last", ms(last));
    page.line("Round trip, average", ms(average));
    page.line("Round trip, worst", ms(worst));
    let LinkCounters { commands, retries, timeouts, superseded, dropped, unmatched } = snapshot.link.counters;
    page.line("Commands sent", commands);
    page.line("Commands repeated", retries);
    page.line("Answers that came too late", timeouts);
    page.line("Drives superseded", superseded);
    page.line("Requests dropped", dropped);
    page.line("Stray answers", unmatched);
    let DecoderCounters { frames, damaged, overlong } = snapshot.link.decoder;
    frame_counts(page, frames, damaged, overlong);
}

/// The frames that one side has received.
fn frame_counts(page: &mut Page, whole: u32, damaged: u32, overlong: u32) {
    page.line("Frames received", whole);
    page.line("Frames damaged", damaged);
    page.line("Frames too long", overlong);
}

fn device(page: &mut Page, snapshot: &Snapshot, identity: &Identity) {
    let Identity {
        version,
        firmware: (major, minor, patch),
        board,
        build,
        unit: _,
        simulated,
        sample_rate_hz,
        block,
        dac_bits,
        tones,
        max_knots,
        min_glide,
        max_glide,
        dead_man_ms,
        reset,
        stored,
        crash,
    } = identity;
    let glide = |samples: u32| {
        format!("{samples} samples ({:.1} ms)", f64::from(samples) / f64::from(*sample_rate_hz) * 1e3)
    };
    page.line("Board", board);
    page.line("Simulated", yes(*simulated));
    page.line("Firmware", format!("{major}.{minor}.{patch} ({build})"));
    let schema = u32::from_le_bytes(version.schema);
    page.line("Protocol", format!("{}.{}, schema {schema:08x}", version.major, version.minor));
    page.line("Compatibility", snapshot.device.compatibility.map_or("not known", |it| it.sentence()));
    page.line("Unit", snapshot.unit().unwrap_or_default());
    page.line("Sample rate", format!("{sample_rate_hz} Hz"));
    page.line("Block", format!("{block} samples"));
    page.line("DAC", format!("{dac_bits} bits"));
    page.line("Tones at once", tones);
    page.line("Knots of a table, at most", max_knots);
    page.line("Glide, shortest", glide(*min_glide));
    page.line("Glide, longest", glide(*max_glide));
    page.line("Dead-man's time", format!("{dead_man_ms} ms"));
    page.line(
        "Last reset",
        match reset {
            ResetCause::PowerOn => "power came on",
            ResetCause::Pin => "reset pin",
            ResetCause::Software => "asked for by software",
            ResetCause::Watchdog => "watchdog",
            ResetCause::BrownOut => "the supply dipped",
            ResetCause::Panic => "the firmware panicked",
            ResetCause::HardFault => "processor fault",
        },
    );
    page.line(
        "Configuration in flash",
        match stored {
            StoredConfig::Empty => "none",
            StoredConfig::Loaded => "in use",
            StoredConfig::WrongVersion => "of another version, not used",
            StoredConfig::Damaged => "damaged, not used",
            StoredConfig::FellBack => "one copy damaged, the other in use",
        },
    );
    if let Some(maintenance) = &snapshot.device.maintenance {
        page.line("Flash erased", upkeep::wear(maintenance));
        page.line("Brown-out level", upkeep::brown_out_level(maintenance));
    }
    if let Some(wear) = &snapshot.device.wear {
        page.line("Profile's flash erased", upkeep::profile_wear(wear));
    }
    page.line("Last crash", if crash.is_empty() { "none" } else { crash.as_str() });
}

fn status(page: &mut Page, snapshot: &Snapshot, status: &Status) {
    let Status {
        state,
        faults,
        first_fault,
        first_fault_at,
        now,
        sum_per_mille,
        heat_per_mille,
        foldback_per_mille,
        // For programs that replay the codes, not for a reader.
        foldback_before_per_mille: _,
        foldback_changes,
        table_crc,
        counters,
    } = status;
    page.line(
        "State",
        match state {
            State::Idle => "idle",
            State::Armed => "armed",
            State::Driving => "driving",
            State::Stopping => "stopping",
            State::Fault => "fault",
            State::SafeMode => "safe mode",
            State::Waiting => "waiting for the trigger",
        },
    );
    page.line("Faults", faults);
    page.line(
        "First fault",
        match first_fault {
            Some(fault) => format!("{} at sample {first_fault_at}", fault.text()),
            None => "none".to_owned(),
        },
    );
    page.line("Sample index", now);
    page.line("Known since", format!("{:.3} s after the start", snapshot.drive.status_time.as_secs_f64()));
    page.line("Sum of tones, of full scale", per_cent(*sum_per_mille));
    page.line("Heat, of its limit", per_cent(*heat_per_mille));
    page.line("Left by the heat limit", per_cent(*foldback_per_mille));
    page.line("Changes of the heat limit", foldback_changes);
    page.line("Table", format!("{table_crc:08x}"));
    let Counters { frames, crc_errors, overlong, duplicates, dropped, underruns, clips, max_cycles } =
        counters;
    frame_counts(page, *frames, *crc_errors, *overlong);
    page.line("Frames repeated", duplicates);
    page.line("Answers or commands dropped", dropped);
    page.line("Underruns", underruns);
    page.line("Samples clipped", clips);
    page.line(
        "Cycles of a block, at most",
        match max_cycles {
            0 => "not counted".to_owned(),
            cycles => cycles.to_string(),
        },
    );
}

fn table(page: &mut Page, header: &TableHeader) {
    let TableHeader { knots, span_start_um, span_end_um, sample_rate_hz, crc } = header;
    let mm = |um: &u32| format!("{:.3} mm", f64::from(*um) * 1e-3);
    page.line("Digest", format!("{crc:08x}"));
    page.line("Knots", knots);
    page.line("Span from", mm(span_start_um));
    page.line("Span to", mm(span_end_um));
    page.line("Made for", format!("{sample_rate_hz} Hz"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn setup() -> Setup {
        Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()))
    }

    #[test]
    fn every_line_is_a_name_and_a_value_as_a_person_writes_them() {
        let identity = Identity {
            version: slipline_link::protocol::version::Version::OURS,
            firmware: (1, 2, 3),
            board: "nucleo".try_into().unwrap(),
            build: "abc".try_into().unwrap(),
            unit: [7; 12],
            simulated: false,
            sample_rate_hz: 400_000,
            block: 128,
            dac_bits: 12,
            tones: 16,
            max_knots: 1025,
            min_glide: 2000,
            max_glide: 4_000_000,
            dead_man_ms: 500,
            reset: ResetCause::BrownOut,
            stored: StoredConfig::Loaded,
            crash: "".try_into().unwrap(),
        };
        let status = Status { heat_per_mille: 125, now: 12_800, ..Status::default() };
        let mut snapshot = Snapshot::default();
        snapshot.device.identity = Some(Arc::new(identity));
        snapshot.drive.status = Some(status);
        let text = text(&snapshot, &setup(), &TableState::Making);
        for (name, value) in [
            ("Board", "nucleo"),
            ("Firmware", "1.2.3 (abc)"),
            ("Glide, shortest", "2000 samples (5.0 ms)"),
            ("Last reset", "the supply dipped"),
            ("Last crash", "none"),
            ("Heat, of its limit", "12.5 %"),
            ("Sample index", "12800"),
            ("Round trip, average", "0.000 ms"),
        ] {
            let line = text.lines().find(|line| line.starts_with(&format!("{name}:"))).unwrap_or(name);
            assert_eq!(line[NAME.min(line.len())..].trim(), value, "{name}");
        }
        for rust in ["Some(", "None", "{", "Disconnected", "_per_mille", "Duration"] {
            let before_setup = text.split("== setup").next().unwrap();
            assert!(!before_setup.contains(rust), "{rust}: {before_setup}");
        }
    }

    #[test]
    fn a_drive_that_waits_is_not_reported_as_one_that_sounds() {
        let status = Status { state: State::Waiting, ..Status::default() };
        let mut waiting = Snapshot::default();
        waiting.drive.status = Some(status);
        let text = text(&waiting, &setup(), &TableState::Waiting);
        let mut states = text.lines().filter(|line| line.starts_with("State:"));
        assert!(states.any(|line| line.ends_with("waiting for the trigger")), "{text}");
    }

    #[test]
    fn the_report_says_what_is_unknown() {
        let text = text(&Snapshot::default(), &setup(), &TableState::Waiting);
        for part in ["not connected", "not known", "waiting for a device", "Port:", "== log"] {
            assert!(text.contains(part), "{part}");
        }
    }
}
