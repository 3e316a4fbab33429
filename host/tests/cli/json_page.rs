//! `host/JSON.md` and the output of every command have the same fields; every example of the help runs. The page says of a
//! field what a comment above it in its answer says, one name for one quantity over all commands:
//!
//! ```text
//! JSON: the meaning                     of a name that ends in its unit
//! JSON, count: the meaning              of another; the unit is "text", "1", "codes" ..
//! JSON of study, count: the meaning     of this command only; several are joined by "and"
//! JSON `crc`, text: the meaning         where the field is not in the next line
//! ```
//! `SLIPLINE_BLESS=1 cargo test -p slipline --test cli json_page` writes the page again.
#![cfg(unix)]

use super::served::Served;
use super::serving::Serving;
use super::{Sensed, file};
use serde_json::Value;
use slipline::cli::{EXAMPLES, SCHEMA};
use slipline_link::simulator::Options;
use slipline_model::study::StudyResult;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What the examples leave out: objects that are null in them.
const MORE: &[(&str, &str)] = &[
    ("drive", "drive --plate al-bending --turning-point 247mm --level 30% --hold --sensor 210mm --for 500ms"),
    ("simulate", "simulate --plate membrane --turning-point 160mm --sheet --for 50ms"),
    ("check", "check --plate al-sh"),
    ("study", "study figures.toml"),
    ("texture", "texture --plate al-bending --profile profile.csv"),
    (
        "calibrate",
        "calibrate --plate membrane --kind displacement --data near.txt --sensor 32mm --data far.txt --sensor 176mm",
    ),
    ("calibrate --plan", "calibrate --plate membrane --plan --sensor 32mm --sensor 310mm"),
    (
        "measure --harmonics",
        "measure --plate membrane --actual-coil 1%,0.5% --sensor 32mm --harmonics 2 --level 0.8 --out coil.toml",
    ),
    ("profile", "profile write coil-profile.toml"),
    ("--version", "--version"),
];
const COIL: &str = "name = \"coil\"\nmax_sum = 0.4\nlongest_drive_s = 60\n[travel]\nresonance_hz = 60\nquality = 2\nstatic_travel = 0.5\n";

/// Fields by their paths, each with the type of its values other than null.
type Fields = BTreeMap<String, BTreeSet<&'static str>>;

fn collect(value: &Value, path: &str, fields: &mut Fields) {
    let mut leaf = |kind| fields.entry(path.to_owned()).or_default().extend(kind);
    match value {
        Value::Object(inner) => inner.iter().for_each(|(name, value)| {
            let dot = if path.is_empty() { "" } else { "." };
            collect(value, &format!("{path}{dot}{name}"), fields);
        }),
        Value::Array(values) if values.is_empty() => leaf(None),
        Value::Array(values) => values.iter().for_each(|value| {
            let list = if path.ends_with("[]") { path.to_owned() } else { format!("{path}[]") };
            collect(value, &list, fields);
        }),
        Value::Null => leaf(None),
        Value::Bool(_) => leaf(Some("true or false")),
        Value::Number(_) => leaf(Some("number")),
        Value::String(_) => leaf(Some("text")),
    }
}

/// Runs a line of words in a folder and returns its JSON.
fn run(folder: &Path, line: &str) -> Value {
    let _running = line.contains("--sensor").then(Sensed::begin);
    let output = program(folder, line).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(output.status.code(), Some(0 | 3)), "{line}: {error}");
    assert!(!text.contains("-0.0,") && !text.contains("-0.0}") && !text.contains("-0.0]"), "{line}");
    let value: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{line}: {error}: {text}"));
    assert_eq!(value["schema"], SCHEMA, "{line}");
    for name in value["files"].as_array().into_iter().flatten() {
        assert!(folder.join(name.as_str().unwrap()).is_file(), "{line}: {name}");
    }
    value
}

/// The arguments of a line, without --json.
fn arguments(line: &str) -> Vec<&str> {
    line.split(' ').filter(|word| *word != "slipline" && *word != "--json").collect()
}

fn program(folder: &Path, line: &str) -> Command {
    let mut command = super::program(arguments(line));
    command.arg("--json").current_dir(folder).env("XDG_CONFIG_HOME", folder);
    command
}

/// The first line of a command that only a signal ends, and what is found meanwhile.
fn serving<T>(folder: &Path, line: &str, meanwhile: impl FnOnce(&Value) -> T) -> (Value, T) {
    let serving = Serving::start(folder, &arguments(line));
    let first = serving.1.clone();
    let found = meanwhile(&first);
    assert_eq!(serving.end("-TERM").code(), Some(0));
    (first, found)
}

/// What a drive that follows one line says of it.
fn followed(folder: &Path, line: &str) -> Value {
    let mut command = program(folder, "drive --plate membrane --felt-edge 250mm --stdin");
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(line.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    serde_json::from_str(text.lines().next().unwrap()).unwrap()
}

/// The fields of all commands, in the order of the examples.
fn fields_of_all() -> Vec<(&'static str, Fields)> {
    let folder = file("json-page");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("study.toml"), include_str!("../../assets/study.toml")).unwrap();
    let mut all: Vec<(&str, Fields)> = Vec::new();
    let mut add = |label: &'static str, value: &Value| {
        let at = all.iter().position(|(name, _)| *name == label).unwrap_or_else(|| {
            all.push((label, Fields::new()));
            all.len() - 1
        });
        collect(value, "", &mut all[at].1);
    };
    for (command, lines) in EXAMPLES {
        for line in *lines {
            match *command {
                "serve" => {
                    let info =
                        |it: &Value| run(&folder, &format!("info --port {}", it["port"].as_str().unwrap()));
                    let (offered, info) = serving(&folder, line, info);
                    add("serve", &offered);
                    add("info", &info);
                }
                "watch" => add("watch", &serving(&folder, line, |_| ()).0),
                "page" => {
                    std::fs::create_dir_all(folder.join("target/page")).unwrap();
                    std::fs::write(folder.join("target/page/index.html"), "").unwrap();
                    // Another program may have the port of the example.
                    let line = format!("{line} --listen 127.0.0.1:0");
                    add("page", &serving(&folder, &line, |_| ()).0);
                }
                "calibrate" if line.contains("--plan") => add("calibrate --plan", &run(&folder, line)),
                command => add(command, &run(&folder, line)),
            }
        }
    }
    std::fs::write(folder.join("profile.csv"), "0,0\n0.1,1\n0.25,1\n0.3,0\n").unwrap();
    std::fs::write(folder.join("coil-profile.toml"), COIL).unwrap();
    let figures = format!("results = {:?}\ncount = 10", StudyResult::ALL.map(StudyResult::name));
    let study = include_str!("../../assets/study.toml").replace("count = 1000", &figures);
    std::fs::write(folder.join("figures.toml"), study.replace("[0.12, ", "[")).unwrap();
    std::fs::write(folder.join("near.txt"), include_str!("../../plate/tests/cases/table_ok_near.txt"))
        .unwrap();
    std::fs::write(folder.join("far.txt"), include_str!("../../plate/tests/cases/table_ok_far.txt")).unwrap();
    let board = Served::new("json-page.sock", Options::default());
    for (label, line) in MORE {
        // Pressed since the device has started.
        board.device.lock().unwrap().press_button(*label == "profile");
        let port = if *label == "profile" { format!(" --port {}", board.port) } else { String::new() };
        add(label, &run(&folder, &format!("{line}{port}")));
    }
    add("drive --stdin", &followed(&folder, "turning-point 160mm\n"));
    std::fs::remove_dir_all(&folder).unwrap();
    for (_, fields) in &mut all {
        // A field that is null in one run and an object in another is an object.
        let paths: Vec<String> = fields.keys().cloned().collect();
        let is_object = |path: &str| {
            paths.iter().any(|other| {
                other.strip_prefix(path).is_some_and(|rest| rest.starts_with('.') || rest.starts_with("[]"))
            })
        };
        fields.retain(|path, kinds| !(kinds.is_empty() && is_object(path)));
    }
    all
}

/// The units by which names end, the longer ones first.
const UNITS: &[(&str, &str)] = &[
    ("_n_s_per_m", "N s/m"),
    ("_n_per_m", "N/m"),
    ("_per_m", "1/m"),
    ("_samples", "samples"),
    ("_db", "dB"),
    ("_v", "V"),
    ("_kg", "kg"),
    ("_hz", "Hz"),
    ("_s", "s"),
    ("_m", "m"),
];

/// The unit and the meaning of each name; one that only one command has is behind this command and a colon.
type Meanings = BTreeMap<String, (String, String)>;

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

/// What the comments of the answers say.
fn meanings() -> Meanings {
    let host = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut meanings = Meanings::new();
    for file in ["src", "plate/src", "model/src", "instrument/src"].map(|it| sources(&host.join(it))).concat()
    {
        let source = std::fs::read_to_string(&file).unwrap();
        let lines: Vec<&str> = source.lines().map(str::trim).collect();
        let comment = |at: usize| Some(lines.get(at)?.strip_prefix("//")?.trim_start_matches('/').trim());
        let first = |at: usize| comment(at).filter(|text| text.starts_with("JSON"));
        for (at, begin) in (0..lines.len()).filter_map(|at| Some((at, first(at)?))) {
            let more = (at + 1..).take_while(|at| first(*at).is_none()).map_while(comment);
            let text = std::iter::once(begin).chain(more).collect::<Vec<_>>().join(" ");
            let (head, meaning) =
                text.split_once(": ").unwrap_or_else(|| panic!("{}: {text}", file.display()));
            let (head, unit) = head.split_once(", ").unwrap_or((head, ""));
            let (head, commands) = head.split_once(" of ").unwrap_or((head, ""));
            let field = lines[at..].iter().find(|line| !line.starts_with(['/', '#'])).unwrap();
            let field = field.split(':').next().unwrap().rsplit(' ').next().unwrap();
            let name = head.strip_prefix("JSON `").unwrap_or(field).trim_matches(['`', '"']);
            for command in commands.split(" and ") {
                let name =
                    [command, name].into_iter().filter(|it| !it.is_empty()).collect::<Vec<_>>().join(":");
                let other = meanings.insert(name.clone(), (unit.to_owned(), meaning.to_owned()));
                assert!(other.is_none(), "{}: {name} has a meaning elsewhere, too", file.display());
            }
        }
    }
    meanings
}

/// The name of a field of a command, its unit and its meaning.
fn meaning<'a>(meanings: &'a Meanings, command: &str, path: &str) -> (&'a str, &'a str, &'a str) {
    let name = path.trim_end_matches("[]").rsplit('.').next().unwrap();
    let own = meanings.get_key_value(&format!("{command}:{name}"));
    let found = own.or_else(|| meanings.get_key_value(name));
    let (key, (unit, meaning)) = found.unwrap_or_else(|| panic!("{command}: {path} has no meaning"));
    let ending = UNITS.iter().find(|(ending, _)| name.ends_with(ending)).map(|(_, unit)| *unit);
    assert!(unit.is_empty() == (ending.is_some() && unit != "bit/s"), "{name}: {unit}");
    (key, if unit.is_empty() { ending.unwrap() } else { unit }, meaning)
}

fn page() -> String {
    let mut page = include_str!("json_page/prose.md").to_owned();
    let meanings = meanings();
    let mut used = BTreeSet::new();
    for (command, fields) in fields_of_all() {
        let _ = write!(page, "\n## `slipline {command}`\n\n| Field | Unit | Meaning |\n|---|---|---|\n");
        for (path, kinds) in fields {
            let (name, unit, meaning) = meaning(&meanings, command, &path);
            let wanted = if matches!(unit, "text" | "true or false") { unit } else { "number" };
            assert!(kinds.iter().all(|kind| *kind == wanted), "{command}: {path} is {kinds:?}, not {unit}");
            let _ = writeln!(page, "| `{path}` | {unit} | {meaning} |");
            used.insert(name);
        }
    }
    let unused: Vec<_> = meanings.keys().filter(|name| !used.contains(name.as_str())).collect();
    assert!(unused.is_empty(), "no command has these: {unused:?}");
    page
}

#[test]
fn every_example_runs_and_the_page_lists_every_field_of_every_command() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("JSON.md");
    let page = page();
    if std::env::var_os("SLIPLINE_BLESS").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let stands = std::fs::read_to_string(&path).unwrap();
    for (number, (is, wanted)) in (1..).zip(stands.lines().zip(page.lines())) {
        assert_eq!(is, wanted, "JSON.md:{number}: write it again with SLIPLINE_BLESS=1");
    }
    assert_eq!(stands.lines().count(), page.lines().count(), "JSON.md: write it again with SLIPLINE_BLESS=1");
}
