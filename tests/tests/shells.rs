//! A shell of the instrument (the window, the command line) hands over what its user does, and shows what the instrument
//! reports: it names no request to the link, and keeps no bag of the state of what runs.

use slipline_tests::source_tree::{files, root};
use std::collections::{BTreeMap, BTreeSet};

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
    let sources = files(&root().join("host/window/src"), &[".rs"]);
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
    let sources = files(&root().join("host/src/cli"), &[".rs"]);
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

/// What a text's code takes from a module above it: how many levels above, and the first name of each path.
fn taken_from_above(text: &str) -> Vec<(usize, String)> {
    let product = text.split("#[cfg(test)]").next().unwrap_or_default();
    let code = product.lines().map(str::trim).filter(|line| !line.starts_with("//")).collect::<String>();
    let mut taken = Vec::new();
    let mut rest = code.as_str();
    while let Some((_, path)) = rest.split_once("super::") {
        let mut path = path;
        let mut levels = 1;
        while let Some(further) = path.strip_prefix("super::") {
            (path, levels) = (further, levels + 1);
        }
        rest = path;
        let mut depth = 0;
        let mut is_first = true;
        let mut name = String::new();
        // The list in braces with the lists inside it, or one path.
        for character in path.chars() {
            match character {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => is_first = true,
                _ => {}
            }
            let is_word = character.is_alphanumeric() || character == '_';
            if is_word && is_first && depth <= 1 {
                name.push(character);
            } else if !name.is_empty() {
                taken.push((levels, std::mem::take(&mut name)));
                is_first = false;
            }
            if depth == 0 && !is_word {
                break;
            }
        }
    }
    taken
}

#[test]
fn what_a_file_takes_from_above_is_found() {
    let text = "use super::{\n    argument::{self, Typed},\n    output,\n};\nuse super::super::failure::Failure;\n\
                // super::nothing\npub(super) fn f() { super::rig::prepared(); }\n\
                #[cfg(test)]\nmod tests { use super::*; }";
    let expected = [(1, "argument"), (1, "output"), (2, "failure"), (1, "rig")];
    assert_eq!(taken_from_above(text), expected.map(|(levels, name)| (levels, name.to_owned())));
}

/// The files of the command line beside its `mod.rs`, by the module of each in it, and the modules that each uses.
fn modules_of_the_command_line() -> BTreeMap<String, BTreeSet<String>> {
    let folder = root().join("host/src/cli");
    let mut modules: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for path in files(&folder, &[".rs"]).into_iter().filter(|path| *path != folder.join("mod.rs")) {
        let inside = path.strip_prefix(&folder).expect("a file of the command line").with_extension("");
        let levels = inside.components().count();
        let module = inside.iter().next().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("a source");
        assert!(!text.contains("crate::cli"), "{}: name the module by super", path.display());
        let used = taken_from_above(&text).into_iter().filter(|(above, _)| *above == levels);
        modules.entry(module).or_default().extend(used.map(|(_, name)| name));
    }
    assert!(modules.len() > 30, "{}", modules.len());
    modules
}

#[test]
fn no_file_of_the_command_line_uses_an_item_that_the_module_above_it_defines() {
    let modules = modules_of_the_command_line();
    for (module, used) in &modules {
        let items: Vec<_> = used.iter().filter(|name| !modules.contains_key(*name)).collect();
        assert!(items.is_empty(), "{module} uses {items:?} of mod.rs: name the module where they are");
    }
}

#[test]
fn no_files_of_the_command_line_use_each_other_in_a_circle() {
    let mut left = modules_of_the_command_line();
    loop {
        let leaves: Vec<String> = left
            .iter()
            .filter(|(_, used)| used.iter().all(|name| !left.contains_key(name)))
            .map(|(module, _)| module.clone())
            .collect();
        if leaves.is_empty() {
            break;
        }
        left.retain(|module, _| !leaves.contains(module));
    }
    assert!(left.is_empty(), "these use each other: {left:?}");
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
