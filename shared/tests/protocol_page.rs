//! PROTOCOL.md, made from the message tables, and the proof that its tables say how the frames are read.

mod examples;

use examples::{SEQUENCE, SESSION, commands_of, events_of};
use slipline_protocol::event::Fault;
use slipline_protocol::frame::CRC;
use slipline_protocol::refusal::Refusal;
use slipline_protocol::schema::{FieldRow, MessageRow, Shape, VariantRow};
use slipline_protocol::version::{MAJOR, MINOR, Minor, SCHEMA};
use slipline_protocol::{Command, Decoder, Event, limits};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

const PROSE: &str = include_str!("protocol_page/prose.md");
/// The session in bytes: recorded and compared by `tests/tests/transcripts.rs`.
const SESSION_IN_BYTES: &str = include_str!("protocol_page/session.txt");

/// Every example: its label, the message's id and name, and the frame.
fn frames() -> Vec<(String, u8, Vec<u8>)> {
    let minor = Minor::OURS;
    let commands = (0..=MINOR)
        .flat_map(commands_of)
        .map(|(label, it)| (label, it.id(), it.frame_for(minor, SESSION, SEQUENCE).unwrap().to_vec()));
    let events = (0..=MINOR)
        .flat_map(events_of)
        .map(|(label, it)| (label, it.id(), it.frame_for(minor, SESSION, SEQUENCE).unwrap().to_vec()));
    commands.chain(events).collect()
}

fn rows() -> impl Iterator<Item = &'static MessageRow> {
    Command::TABLE.iter().chain(Event::TABLE)
}

/// Reads bodies by their shape alone, as a person would with the page.
struct Reader {
    body: std::vec::IntoIter<u8>,
    /// Path and value of every field.
    fields: Vec<(String, String)>,
    /// Type and number of every variant.
    variants: BTreeSet<(&'static str, u8)>,
}

impl Reader {
    fn of(frame: &[u8]) -> Self {
        let mut decoder = Decoder::new();
        let body = frame.iter().find_map(|&byte| decoder.push(byte, |frame| frame.body.to_vec())).unwrap();
        Self { body: body.into_iter(), fields: Vec::new(), variants: BTreeSet::new() }
    }

    fn byte(&mut self) -> u8 {
        self.body.next().expect("the body is long enough")
    }

    fn varint(&mut self) -> u64 {
        let (mut value, mut shift) = (0, 0);
        loop {
            let byte = self.byte();
            value |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if byte < 0x80 {
                return value;
            }
        }
    }

    fn zigzag(&mut self) -> i64 {
        let value = self.varint();
        (value >> 1) as i64 ^ -((value & 1) as i64)
    }

    fn note(&mut self, path: &str, value: impl std::fmt::Display) {
        self.fields.push((path.to_owned(), value.to_string()));
    }

    fn read(&mut self, path: &str, shape: &Shape) {
        match *shape {
            Shape::U8 => {
                let value = self.byte();
                self.note(path, value);
            }
            Shape::U16 | Shape::U32 | Shape::U64 => {
                let value = self.varint();
                self.note(path, value);
            }
            Shape::I16 | Shape::I64 => {
                let value = self.zigzag();
                self.note(path, value);
            }
            Shape::Bool => {
                let value = self.byte() == 1;
                self.note(path, value);
            }
            Shape::Option(inner) => match self.byte() {
                0 => self.note(path, "none"),
                _ => self.read(path, inner),
            },
            Shape::Array(count, Shape::U8) => {
                let bytes: String = (0..count).map(|_| format!("{:02x}", self.byte())).collect();
                self.note(path, bytes);
            }
            Shape::Array(count, inner) => {
                (0..count).for_each(|at| self.read(&format!("{path}[{at}]"), inner));
            }
            Shape::List(most, inner) => {
                let count = self.varint() as usize;
                assert!(count <= most);
                if count == 0 {
                    self.note(path, "empty");
                }
                (0..count).for_each(|at| self.read(&format!("{path}[{at}]"), inner));
            }
            Shape::Text(most) => {
                let length = self.varint() as usize;
                assert!(length <= most);
                let bytes = (0..length).map(|_| self.byte()).collect();
                let text = String::from_utf8(bytes).expect("UTF-8");
                self.note(path, format_args!("\"{text}\""));
            }
            Shape::Struct(_, fields) => self.fields(path, fields),
            Shape::Enum(name, variants) => {
                let number = self.varint();
                let variant = &variants[number as usize];
                self.variants.insert((name, variant.number));
                self.note(path, format_args!("{number} ({})", variant.name));
                self.fields(path, variant.fields);
            }
        }
    }

    fn fields(&mut self, path: &str, fields: &[FieldRow]) {
        for field in fields {
            let path = if path.is_empty() { field.name.to_owned() } else { format!("{path}.{}", field.name) };
            self.read(&path, field.shape);
        }
    }
}

#[test]
fn every_frozen_frame_can_be_read_by_the_tables_of_the_page() {
    let mut seen = BTreeSet::new();
    for (label, id, frame) in frames() {
        let row = rows().find(|row| row.id == id).unwrap();
        let mut reader = Reader::of(&frame);
        if let Some(shape) = row.body {
            reader.read("", shape);
        }
        assert_eq!(reader.body.next(), None, "{label}: nothing is left");
        seen.extend(reader.variants);
    }
    // So each variant has its bytes in the file of its minor, and one added without `since` is noticed.
    for (name, variants) in types().into_values().filter_map(|shape| match shape {
        Shape::Enum(name, variants) => Some((*name, *variants)),
        _ => None,
    }) {
        for variant in variants {
            assert!(seen.contains(&(name, variant.number)), "{name}::{} has no frozen bytes", variant.name);
        }
    }
}

#[test]
fn an_answer_is_never_newer_than_its_command() {
    for command in Command::TABLE {
        let answer = command.answer.expect("every command has an answer");
        let event = Event::TABLE.iter().find(|event| event.name == answer);
        assert!(event.is_some_and(|event| event.since <= command.since), "{}", command.name);
    }
}

/// Every type with a name that stands in a body, by name.
fn types() -> BTreeMap<&'static str, &'static Shape> {
    fn visit(shape: &'static Shape, found: &mut BTreeMap<&'static str, &'static Shape>) {
        match shape {
            Shape::Option(inner) | Shape::Array(_, inner) | Shape::List(_, inner) => visit(inner, found),
            Shape::Struct(name, fields) => {
                found.insert(name, shape);
                fields.iter().for_each(|field| visit(field.shape, found));
            }
            Shape::Enum(name, variants) => {
                found.insert(name, shape);
                variants.iter().flat_map(|it| it.fields).for_each(|field| visit(field.shape, found));
            }
            _ => {}
        }
    }
    let mut found = BTreeMap::new();
    rows().filter_map(|row| row.body).for_each(|shape| visit(shape, &mut found));
    found
}

/// The minor of the first message or variant that carries a type.
fn first_minor(wanted: &str) -> u8 {
    fn visit(shape: &Shape, minor: u8, wanted: &str, found: &mut Option<u8>) {
        match shape {
            Shape::Option(inner) | Shape::Array(_, inner) | Shape::List(_, inner) => {
                visit(inner, minor, wanted, found);
            }
            Shape::Struct(name, fields) => {
                if *name == wanted {
                    *found = Some(found.map_or(minor, |before| before.min(minor)));
                }
                fields.iter().for_each(|field| visit(field.shape, minor, wanted, found));
            }
            Shape::Enum(name, variants) => {
                if *name == wanted {
                    *found = Some(found.map_or(minor, |before| before.min(minor)));
                }
                for variant in *variants {
                    let minor = minor.max(variant.since);
                    variant.fields.iter().for_each(|field| visit(field.shape, minor, wanted, found));
                }
            }
            _ => {}
        }
    }
    let mut found = None;
    rows().for_each(|row| row.body.iter().for_each(|shape| visit(shape, row.since, wanted, &mut found)));
    found.expect("a type of a message")
}

#[test]
fn a_type_is_as_old_as_the_first_message_that_carries_it() {
    // `Apply` came with `Drive`, though later messages have it, too; the others came with the message named.
    let types =
        [("Apply", 0), ("Knot", 0), ("TravelLimit", 1), ("ChordTone", 2), ("CombTone", 3), ("HoldLoss", 3)];
    for (name, minor) in types {
        assert_eq!(first_minor(name), minor, "{name}");
    }
}

fn type_name(shape: &Shape) -> String {
    match *shape {
        Shape::U8 => "u8".to_owned(),
        Shape::U16 => "u16".to_owned(),
        Shape::U32 => "u32".to_owned(),
        Shape::U64 => "u64".to_owned(),
        Shape::I16 => "i16".to_owned(),
        Shape::I64 => "i64".to_owned(),
        Shape::Bool => "bool".to_owned(),
        Shape::Option(inner) => format!("option of {}", type_name(inner)),
        Shape::Array(count, inner) => format!("array of {count} {}", type_name(inner)),
        Shape::List(most, inner) => format!("list of {}, at most {most}", type_name(inner)),
        Shape::Text(most) => format!("text, at most {most} bytes"),
        Shape::Struct(name, _) | Shape::Enum(name, _) => format!("[{name}](#{})", name.to_lowercase()),
    }
}

/// Documentation as plain Markdown: the links into the code become the names.
fn plain(doc: &[&str]) -> String {
    let mut text = doc.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
    while let Some(from) = text.find("[`") {
        let name_end = text[from..].find("`]").map(|at| from + at).expect("a link has an end");
        let name = text[from + 2..name_end].to_owned();
        let rest = &text[name_end + 2..];
        let after = if rest.starts_with('(') { rest.find(')').map_or(0, |at| at + 1) } else { 0 };
        text = format!("{}`{name}`{}", &text[..from], &rest[after..]);
    }
    text.replace('|', "\\|")
}

fn range(field: &FieldRow) -> String {
    field.range.map_or_else(|| "any".to_owned(), |(min, max)| format!("{min} to {max}"))
}

fn field_table(page: &mut String, fields: &[FieldRow]) {
    writeln!(page, "\n| field | type | unit | range | meaning |\n|---|---|---|---|---|").unwrap();
    for field in fields {
        let (name, unit, doc) = (field.name, field.unit, plain(field.doc));
        writeln!(page, "| `{name}` | {} | {unit} | {} | {doc} |", type_name(field.shape), range(field))
            .unwrap();
    }
}

fn variant_table(page: &mut String, variants: &[VariantRow]) {
    writeln!(page, "\n| number | name | since | carries | meaning |\n|---|---|---|---|---|").unwrap();
    for variant in variants {
        let carries: Vec<String> = variant
            .fields
            .iter()
            .map(|field| {
                let unit = if field.unit.is_empty() { String::new() } else { format!(" ({})", field.unit) };
                format!("`{}`: {}{unit}, {}", field.name, type_name(field.shape), plain(field.doc))
            })
            .collect();
        let VariantRow { number, since, name, doc, .. } = variant;
        let carries = carries.join(" ");
        writeln!(page, "| {number} | `{name}` | {MAJOR}.{since} | {carries} | {} |", plain(doc)).unwrap();
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn message(page: &mut String, row: &MessageRow) {
    let MessageRow { id, since, name, doc, body, answer } = row;
    writeln!(page, "\n### `{id:02x}` {name}\n\n{}", plain(doc)).unwrap();
    let answer = answer.map_or_else(String::new, |answer| {
        format!(" Answered by `{answer}`{}.", if answer == "Hello" { "" } else { ", or by `Refused`" })
    });
    writeln!(page, "\nSince {MAJOR}.{since}.{answer}").unwrap();
    match body {
        None => writeln!(page, "\nNo body.").unwrap(),
        Some(Shape::Struct(_, fields)) => field_table(page, fields),
        Some(shape @ Shape::Enum(..)) => writeln!(page, "\nThe body is a {}.", type_name(shape)).unwrap(),
        Some(shape) => writeln!(page, "\nThe body is one {}: the token.", type_name(shape)).unwrap(),
    }
    let (_, _, frame) =
        frames().into_iter().find(|(_, of, _)| of == id).expect("every message has an example");
    writeln!(page, "\nExample: `{}`", hex(&frame)).unwrap();
    let mut reader = Reader::of(&frame);
    if body.is_some() {
        let body = hex(reader.body.as_slice());
        writeln!(page, "\nIts body is `{body}`: {}.", fields_of(&mut reader, row)).unwrap();
    }
}

fn page() -> String {
    let (_, _, status) = frames().into_iter().find(|(label, ..)| label == "status").unwrap();
    let values = [
        ("version", format!("{MAJOR}.{MINOR}")),
        ("max_body", limits::MAX_BODY.to_string()),
        ("crc_check", format!("{:08x}", CRC.checksum(b"123456789"))),
        ("example_status", hex(&status)),
        ("reply_timeout_ms", limits::REPLY_TIMEOUT_MS.to_string()),
        ("max_retries", limits::MAX_RETRIES.to_string()),
        ("keep_alive_period_ms", limits::KEEP_ALIVE_PERIOD_MS.to_string()),
        ("dead_man_ms", limits::DEAD_MAN_MS.to_string()),
        ("dead_man_ramp_ms", limits::DEAD_MAN_RAMP_MS.to_string()),
        ("bootloader_wait_ms", (2 * limits::TRANSMIT_TIMEOUT_MS).to_string()),
        ("transmit_timeout_ms", limits::TRANSMIT_TIMEOUT_MS.to_string()),
        ("table_glide_ms", (4 * limits::MIN_GLIDE_MS).to_string()),
        ("stop_ramp_ms", limits::STOP_RAMP_MS.to_string()),
        ("emergency_ramp_ms", limits::EMERGENCY_RAMP_MS.to_string()),
        ("max_drive_min", (limits::MAX_DRIVE_MS / 60_000).to_string()),
        ("desk_stop_s", (limits::DESK_STOP_MS / 1000).to_string()),
        ("hand_s", (limits::HAND_MS / 1000).to_string()),
        ("stores", limits::STORES.to_string()),
        ("lease_min_s", (limits::LEASE_MS.0 / 1000).to_string()),
        ("lease_max_s", (limits::LEASE_MS.1 / 1000).to_string()),
        ("max_knots", limits::MAX_KNOTS.to_string()),
        ("max_knot_step", limits::MAX_KNOT_STEP.to_string()),
        ("chunk_knots", limits::CHUNK_KNOTS.to_string()),
        ("staging_timeout_ms", limits::STAGING_TIMEOUT_MS.to_string()),
        ("max_apply_ahead_ms", limits::MAX_APPLY_AHEAD_MS.to_string()),
        ("chord_longest", (1u32 << limits::CHORD_PERIOD_LOG2.1).to_string()),
        ("chord_sum", limits::MAX_CHORD_SUM_PER_MILLE.to_string()),
        ("max_capture_values", limits::MAX_CAPTURE_VALUES.to_string()),
        ("captured_values", limits::CAPTURED_VALUES.to_string()),
        ("max_at_rise_s", (limits::MAX_AT_RISE_MS / 1000).to_string()),
        ("hold_pause_blocks", limits::HOLD_PAUSE_BLOCKS.to_string()),
        ("foldback_period_ms", limits::FOLDBACK_PERIOD_MS.to_string()),
        ("foldback_periods", limits::FOLDBACK_PERIODS.to_string()),
        ("schema", hex(&SCHEMA.to_le_bytes())),
    ];
    let mut page = PROSE.trim_end().replace("{session}", session_in_bytes().trim_end());
    for (name, value) in values {
        let hole = format!("{{{name}}}");
        assert!(page.contains(&hole), "the text does not use {hole}");
        page = page.replace(&hole, &value);
    }
    assert!(!page.replace(CONTENTS, "").contains('{'), "the text asks for a value that is not given");
    page.push('\n');
    for (title, table) in [("Commands", Command::TABLE), ("Events", Event::TABLE)] {
        writeln!(page, "\n## {title}").unwrap();
        table.iter().for_each(|row| message(&mut page, row));
    }
    writeln!(page, "\n## Types").unwrap();
    for (name, shape) in types() {
        // A type that is the body of a message stands above.
        let is_body = rows().any(|row| row.body == Some(shape));
        match shape {
            Shape::Struct(_, fields) if !is_body || name == "TableHeader" => {
                writeln!(page, "\n### {name}\n\nSince {MAJOR}.{}.", first_minor(name)).unwrap();
                field_table(&mut page, fields);
            }
            Shape::Enum(_, variants) => {
                writeln!(page, "\n### {name}\n\nSince {MAJOR}.{}.", first_minor(name)).unwrap();
                variant_table(&mut page, variants);
            }
            _ => {}
        }
    }
    writeln!(page, "\n### Faults\n\nA u32; bit `n` stands for the fault numbered `n`.").unwrap();
    writeln!(page, "\n| bit | fault | text |\n|---|---|---|").unwrap();
    for &fault in Fault::ALL {
        writeln!(page, "| {} | `{fault:?}` | {} |", fault as u8, fault.text()).unwrap();
    }
    writeln!(page, "\n## What each minor added").unwrap();
    (1..=MINOR).for_each(|minor| additions(&mut page, minor));
    page.replace(CONTENTS, contents(&page).trim_end())
}

/// Where the contents stand in the text.
const CONTENTS: &str = "{contents}";

/// A line for each chapter, with the messages and types in it.
fn contents(page: &str) -> String {
    let link = |heading: &str| {
        let text: String = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect();
        format!("[{heading}](#{})", text.to_lowercase().replace(' ', "-"))
    };
    let mut contents = String::new();
    for chapter in page.split("\n## ").skip(1) {
        let (heading, text) = chapter.split_once('\n').unwrap_or((chapter, ""));
        let parts: Vec<String> =
            text.lines().filter_map(|line| line.strip_prefix("### ")).map(link).collect();
        let parts = if parts.is_empty() { String::new() } else { format!(": {}", parts.join(", ")) };
        writeln!(contents, "- {}{parts}", link(heading)).unwrap();
    }
    contents
}

#[test]
fn the_contents_lead_to_each_chapter_and_each_message() {
    let contents = contents(
        "# A\n\n## A session, step by step\n\n## Commands\n\n### `01` Hello\n\n### `02` KeepAlive\n",
    );
    let wanted = "- [A session, step by step](#a-session-step-by-step)\n\
                  - [Commands](#commands): [`01` Hello](#01-hello), [`02` KeepAlive](#02-keepalive)\n";
    assert_eq!(contents, wanted);
    let page = page();
    for row in rows() {
        let line = format!("[`{:02x}` {}](#{:02x}-{})", row.id, row.name, row.id, row.name.to_lowercase());
        assert!(page.contains(&line), "{line}");
    }
}

/// The recorded session as a table: who writes, the bytes, and what they say.
fn session_in_bytes() -> String {
    let mut table = "| from | bytes | meaning |\n|---|---|---|\n".to_owned();
    for line in SESSION_IN_BYTES.lines().filter(|line| !line.starts_with('#')) {
        let (sign, value) = line.split_once(' ').expect("a sign and a value");
        let from = match sign {
            "+" => {
                writeln!(table, "| | | {value} blocks pass |").unwrap();
                continue;
            }
            ">" => "host",
            _ => "device",
        };
        let bytes: Vec<u8> = (0..value.len())
            .step_by(2)
            .map(|at| u8::from_str_radix(&value[at..at + 2], 16).expect("hexadecimal"))
            .collect();
        let mut decoder = Decoder::new();
        let (session, sequence, id) = bytes
            .iter()
            .find_map(|&byte| decoder.push(byte, |it| (it.header.session, it.header.sequence, it.header.id)))
            .expect("a frame");
        let row = rows().find(|row| row.id == id).expect("a message");
        let fields = fields_of(&mut Reader::of(&bytes), row);
        let fields = if fields.is_empty() { fields } else { format!(": {fields}") };
        let name = row.name;
        writeln!(
            table,
            "| {from} | `{value}` | `{name}`, session {session:08x}, sequence {sequence:04x}{fields} |"
        )
        .unwrap();
    }
    table
}

/// The fields of a body with their values.
fn fields_of(reader: &mut Reader, row: &MessageRow) -> String {
    if let Some(shape) = row.body {
        reader.read("", shape);
    }
    let fields: Vec<String> = reader
        .fields
        .iter()
        .map(|(path, value)| if path.is_empty() { value.clone() } else { format!("{path} = {value}") })
        .collect();
    fields.join(", ")
}

/// What a minor added, a line each.
fn additions(page: &mut String, minor: u8) {
    writeln!(page, "\n### {MAJOR}.{minor}\n").unwrap();
    for (kind, table) in [("command", Command::TABLE), ("event", Event::TABLE)] {
        for MessageRow { id, name, doc, .. } in table.iter().filter(|row| row.since == minor) {
            writeln!(page, "- the {kind} `{id:02x}` `{name}`: {}", plain(doc)).unwrap();
        }
    }
    for (name, variants) in types().into_values().filter_map(|shape| match shape {
        Shape::Enum(name, variants) => Some((*name, *variants)),
        _ => None,
    }) {
        for VariantRow { number, name: variant, doc, .. } in variants.iter().filter(|it| it.since == minor) {
            writeln!(page, "- {name} {number} `{variant}`: {}", plain(doc)).unwrap();
        }
    }
}

#[test]
fn each_minor_has_added_something() {
    for minor in 1..=MINOR {
        let mut text = String::new();
        additions(&mut text, minor);
        assert!(text.contains("- "), "{MAJOR}.{minor} adds nothing");
    }
}

#[test]
fn the_reference_page_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("PROTOCOL.md");
    if std::env::var_os("SLIPLINE_BLESS").is_some() {
        std::fs::write(&path, page()).unwrap();
    }
    let stands = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(stands == page(), "PROTOCOL.md is not what the tables say: write it again with SLIPLINE_BLESS=1");
}

#[test]
fn every_refusal_has_a_row() {
    let of_minor_0 = Refusal::ROWS.iter().filter(|row| row.since == 0);
    assert_eq!(of_minor_0.count(), 23, "a new one says since which minor it stands");
}
