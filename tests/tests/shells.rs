//! A shell of the instrument (the window, the command line) hands over what its user does, and shows what the instrument
//! reports: it names no request to the link, and keeps no bag of the state of what runs.

use slipline_tests::source_tree::root;
use std::path::{Path, PathBuf};

/// The Rust sources under a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// The lines of code that name this type of the link or the instrument: by a path, or in a `use`.
fn naming(text: &str, krate: &str, name: &str) -> Vec<String> {
    let product = text.split("#[cfg(test)]").next().unwrap_or_default();
    let code: Vec<&str> =
        product.lines().map(str::trim_start).filter(|line| !line.starts_with("//")).collect();
    let joined = code.join(" ");
    let statements = joined.split(';').filter(|it| it.contains(krate));
    let is_name = |statement: &&str| {
        statement.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == name)
            && statement.trim_start().starts_with("use ")
            || statement.contains(&format!("{krate}::{name}"))
    };
    statements.filter(is_name).map(str::to_owned).collect()
}

#[test]
fn the_window_names_no_request_and_no_procedure() {
    let sources = sources(&root().join("host/window/src"));
    assert!(sources.len() > 50, "{}", sources.len());
    for path in sources {
        let text = std::fs::read_to_string(&path).expect("a source");
        for (krate, name) in [("slipline_link", "Request"), ("slipline_instrument", "Procedure")] {
            let found = naming(&text, krate, name);
            assert!(found.is_empty(), "{}: {found:?}", path.display());
        }
    }
}

#[test]
fn the_command_line_names_no_request_no_worker_and_no_outcome() {
    let sources = sources(&root().join("host/src/cli"));
    assert!(sources.len() > 30, "{}", sources.len());
    for path in sources {
        let text = std::fs::read_to_string(&path).expect("a source");
        for name in ["Request", "Worker", "Outcome"] {
            let found = naming(&text, "slipline_link", name);
            assert!(found.is_empty(), "{}: {found:?}", path.display());
        }
    }
}

#[test]
fn what_names_a_request_is_found() {
    assert_eq!(naming("use slipline_link::{Port, Request};\nfn f() {}", "slipline_link", "Request").len(), 1);
    assert_eq!(naming("fn f() { slipline_link::Request::Stop; }", "slipline_link", "Request").len(), 1);
    let others =
        "use slipline_link::{DriveRequest};\nuse slipline_plate::design::Request;\n// slipline_link::Request";
    assert!(naming(others, "slipline_link", "Request").is_empty());
}

#[test]
fn the_app_has_fifteen_fields_at_most() {
    let text = std::fs::read_to_string(root().join("host/window/src/app.rs")).expect("the app");
    let fields =
        text.split("pub struct App {").nth(1).and_then(|rest| rest.split("\n}").next()).expect("its fields");
    let count =
        fields.lines().filter(|line| line.contains(": ") && !line.trim_start().starts_with("//")).count();
    assert!((5..=15).contains(&count), "{count}: {fields}");
}
