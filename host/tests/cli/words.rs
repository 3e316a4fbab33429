//! Words of help, JSON and pages: a number is a felt edge or a turning point, never a boundary alone.

use super::{design, json, said};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Sentences of help that name the phenomenon, without a number.
const PHENOMENON: [&str; 3] = [
    "Drag the boundary on a tapered plate.",
    "Rate the sharpness, speed and number of a plate's boundaries over their turning points",
    "One boundary, by its turning point (120mm) or its frequency (126Hz)",
];

#[test]
fn help_names_felt_edges_and_turning_points() {
    let all = said(&["--help"]);
    let commands = all.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1);
    let commands: Vec<&str> = commands
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(commands.len() > 15, "{commands:?}");
    let pages = commands.iter().map(|command| said(&["help", command]));
    for page in pages.chain([all.clone()]) {
        // It is wrapped to the terminal's width.
        let words = page.split_whitespace().collect::<Vec<_>>().join(" ");
        let rest = PHENOMENON.iter().fold(words, |words, allowed| words.replace(allowed, ""));
        assert!(!rest.to_lowercase().contains("boundar"), "{page}");
        assert!(!page.contains("--boundary") && !page.contains("--tone "), "{page}");
    }
}

/// All field names of a value.
fn names(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, value)| {
            found.push(name.clone());
            names(value, found);
        }),
        Value::Array(values) => values.iter().for_each(|value| names(value, found)),
        _ => {}
    }
}

#[test]
fn no_field_of_json_is_a_boundary() {
    let checked = json(&["check", "--plate", "membrane", "--turning-point", "120mm"]);
    let designed: Value = serde_json::from_slice(&design(&["--json"]).stdout).unwrap();
    for value in [&checked, &designed] {
        let mut found = Vec::new();
        names(value, &mut found);
        assert!(found.iter().any(|name| name == "turning_point_m"), "{found:?}");
        assert!(!found.iter().any(|name| name.contains("boundar")), "{found:?}");
    }
    // The fields that the commands write themselves.
    let folders =
        ["src/cli", "src/cli/page"].map(|folder| Path::new(env!("CARGO_MANIFEST_DIR")).join(folder));
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).unwrap());
    for path in entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_file()) {
        let text = std::fs::read_to_string(&path).unwrap();
        for line in text.lines() {
            let field = line.split_once("\":").and_then(|(before, _)| before.rsplit('"').next());
            assert!(!field.is_some_and(|field| field.contains("boundar")), "{}: {line}", path.display());
        }
    }
}

/// The pages that a user reads.
fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let folders = ["", "host", "host/plate", "host/python", "host/window/web", "firmware", "shared"];
    let folders = folders.map(|folder| root.join(folder));
    let mut found = Vec::new();
    for folder in folders {
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        found.extend(files.filter(|path| path.extension().is_some_and(|extension| extension == "md")));
    }
    // It says what changed, in the words of then.
    found.retain(|path| !path.ends_with("CHANGELOG.md"));
    found
}

#[test]
fn no_page_gives_a_boundary_a_number_or_names_the_options_that_are_gone() {
    let pages = pages();
    assert!(pages.len() > 6, "{pages:?}");
    for path in pages {
        let text = std::fs::read_to_string(&path).unwrap();
        for (number, line) in (1..).zip(text.lines()) {
            let place = format!("{}:{number}: {line}", path.display());
            assert!(!line.contains("--boundary") && !line.contains("--tone "), "{place}");
            for (at, word) in line.match_indices("boundary ") {
                let rest = &line[at + word.len()..];
                let rest = ["at ", "is ", "of ", "= "]
                    .iter()
                    .find_map(|word| rest.strip_prefix(word))
                    .unwrap_or(rest);
                let digits = rest.chars().take_while(char::is_ascii_digit).count();
                assert!(digits == 0 || !rest[digits..].trim_start().starts_with("mm"), "{place}");
            }
        }
    }
}
