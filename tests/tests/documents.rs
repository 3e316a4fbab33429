//! The documents agree with the tree: every file and folder they name exists, and the version stands once.

use slipline_tests::source_tree::{PRODUCT, root, rust_files};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Folders that hold no source.
const NOT_SOURCE: [&str; 4] = [".git", "target", ".venv", "__pycache__"];

/// Every file and folder of the tree, relative to its root, with `/` between the names.
fn entries() -> BTreeSet<String> {
    fn walk(folder: &Path, prefix: &str, found: &mut BTreeSet<String>) {
        for entry in fs::read_dir(folder).expect("the tree can be read") {
            let entry = entry.expect("the tree can be read");
            let name = entry.file_name().to_string_lossy().into_owned();
            if NOT_SOURCE.contains(&name.as_str()) {
                continue;
            }
            let path = format!("{prefix}{name}");
            if entry.file_type().expect("a file has a type").is_dir() {
                walk(&entry.path(), &format!("{path}/"), found);
            }
            found.insert(path);
        }
    }
    let mut found = BTreeSet::new();
    walk(&root(), "", &mut found);
    found
}

/// The text of a file of the tree.
fn text(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The text between backticks, line by line, outside of code blocks.
fn code_spans(text: &str) -> Vec<&str> {
    let mut spans = Vec::new();
    let mut is_block = false;
    for line in text.lines() {
        let content = line.trim_start_matches([' ', '/', '!', '#']);
        if content.starts_with("```") {
            is_block = !is_block;
        } else if !is_block {
            spans.extend(content.split('`').skip(1).step_by(2));
        }
    }
    spans
}

/// The targets of the links `[text](target)` that lead to files.
fn links(text: &str) -> Vec<&str> {
    text.split("](")
        .skip(1)
        .filter_map(|rest| rest.split([')', '#']).next())
        .filter(|target| !target.is_empty() && !target.contains("://"))
        .collect()
}

/// Whether a code span names a file or a folder of this tree: by a file's ending, or by the tree's first folder.
fn is_path(span: &str, tops: &BTreeSet<&str>) -> bool {
    let is_name = |name: &str| name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c));
    if !span.trim_end_matches('/').split('/').all(|name| !name.is_empty() && is_name(name)) {
        return false;
    }
    let first = span.split('/').next().expect("split yields one part");
    let is_source = [".rs", ".md"].iter().any(|ending| span.ends_with(ending));
    is_source || (span.contains('/') && tops.contains(first))
}

/// The spans that name no entry of the tree. A span that does not begin at the top may leave the first folders out.
fn missing<'a>(text: &'a str, entries: &BTreeSet<String>) -> Vec<&'a str> {
    let tops = entries.iter().map(String::as_str).filter(|path| !path.contains('/')).collect();
    code_spans(text)
        .into_iter()
        .filter(|span| is_path(span, &tops))
        .filter(|span| {
            let path = span.trim_end_matches('/');
            let end = format!("/{path}");
            !entries.iter().any(|entry| entry == path || entry.ends_with(&end))
        })
        .collect()
}

#[test]
fn every_file_that_a_document_or_a_comment_names_exists() {
    let entries = entries();
    let mut wrong = Vec::new();
    for path in &entries {
        // The changelog describes the past.
        let is_read = [".md", ".rs", ".py", ".toml"].iter().any(|ending| path.ends_with(ending));
        if !is_read || path == "CHANGELOG.md" {
            continue;
        }
        let text = fs::read_to_string(root().join(path)).expect("a source is text");
        wrong.extend(missing(&text, &entries).into_iter().map(|span| format!("{path}: `{span}`")));
        if path.ends_with(".md") {
            let folder = root().join(path).parent().expect("a file lies in a folder").to_owned();
            wrong.extend(
                links(&text)
                    .into_iter()
                    .filter(|target| !folder.join(target).exists())
                    .map(|target| format!("{path}: ({target})")),
            );
        }
    }
    assert!(wrong.is_empty(), "named, and not there:\n{}", wrong.join("\n"));
}

/// The folders of the product's and the tests' sources that hold two files or more, one or two levels below `src/`.
fn folders_of_sources() -> BTreeSet<String> {
    let mut files: BTreeMap<String, usize> = BTreeMap::new();
    for top in PRODUCT.into_iter().chain(["tests/src"]) {
        for file in rust_files(&root().join(top)) {
            let folder = file.parent().expect("a file lies in a folder").strip_prefix(root()).expect("below");
            let depth = folder.components().count() - Path::new(top).components().count();
            if (1..=2).contains(&depth) {
                *files.entry(folder.display().to_string()).or_default() += 1;
            }
        }
    }
    files.into_iter().filter(|&(_, count)| count > 1).map(|(folder, _)| folder).collect()
}

#[test]
fn every_folder_of_sources_has_a_row_in_the_map() {
    let page = fs::read_to_string(root().join("CONTRIBUTING.md")).expect("the page is there");
    let rows: String = page.lines().filter(|line| line.starts_with("| ")).collect();
    let missing: Vec<_> =
        folders_of_sources().into_iter().filter(|folder| !rows.contains(&format!("`{folder}"))).collect();
    assert!(missing.is_empty(), "no row of CONTRIBUTING.md leads there:\n{}", missing.join("\n"));
}

#[test]
fn a_name_of_a_file_that_is_not_there_is_found() {
    let entries: BTreeSet<String> = ["shared", "shared/src", "shared/src/frame.rs"].map(str::to_owned).into();
    // Written with another quote, for this file is read by the test above, too.
    let spans = |text: &str| text.replace('\'', "`");
    let good = spans("'shared/src/frame.rs', 'frame.rs', 'shared/src/', 'a/b', 'x.toml'");
    assert!(missing(&good, &entries).is_empty());
    let bad = spans("'shared/src/frames.rs' and 'trouble.rs' and 'shared/wire'\n'''text\n'old.rs'\n'''\n");
    assert_eq!(missing(&bad, &entries), ["shared/src/frames.rs", "trouble.rs", "shared/wire"]);
    assert_eq!(links("[a](b/c.md#d) [e](https://f.rs) [g](#h)"), ["b/c.md"]);
}

/// What is wrong with the files of commands that are run in order: one that is written twice, one that is read and not there.
fn wrong_files(commands: &[&str]) -> Vec<String> {
    let mut written: BTreeSet<&str> = BTreeSet::new();
    let mut wrong = Vec::new();
    for command in commands {
        let words: Vec<&str> = command.split_whitespace().collect();
        for pair in words.windows(2) {
            let [option, file] = pair else { continue };
            let folder = file.split('/').next().unwrap_or(file);
            match *option {
                "--out" | "--figure" | "--csv" | "--wav" if !written.insert(file) => {
                    wrong.push(format!("{file} is there already: {command}"));
                }
                "--plate" | "--actual-plate" | "--setup" | "--data" | "--played"
                    if file.contains('.') && !written.contains(file) && !written.contains(folder) =>
                {
                    wrong.push(format!("{file} is not there: {command}"));
                }
                _ => {}
            }
        }
    }
    wrong
}

#[test]
fn the_readmes_commands_find_their_files_and_write_each_once() {
    // `.ci/run readme` runs the commands of these pages, in this order.
    let page = ["README.md", "host/COMMANDS.md"].map(text).concat();
    let commands: Vec<&str> = page
        .split("```sh\n")
        .skip(1)
        .filter_map(|block| block.split("```").next())
        .flat_map(str::lines)
        .filter_map(|line| line.strip_prefix("cargo run -- "))
        .map(|line| line.split('#').next().unwrap_or(line).trim())
        .collect();
    assert!(commands.len() > 10, "{commands:?}");
    assert!(wrong_files(&commands).is_empty(), "{:#?}", wrong_files(&commands));
    let bad = ["measure --out a.csv", "sweep --out a.csv", "calibrate --plate my.toml --data b.csv"];
    assert_eq!(wrong_files(&bad).len(), 3);
    assert!(
        wrong_files(&["design --out d", "check --plate d/plate.toml", "check --plate membrane"]).is_empty()
    );
}

#[test]
fn the_readme_stays_short() {
    let page = text("README.md");
    let lines = page.lines().count();
    assert!(lines <= 200, "{lines} lines: move what is not for a first reader");
}

#[test]
fn the_version_stands_in_one_place() {
    // `.ci/release` changes it there, and every crate, the firmware among them, takes it from there.
    for path in entries().iter().filter(|path| path.ends_with("/Cargo.toml")) {
        let manifest = fs::read_to_string(root().join(path)).expect("a manifest is text");
        assert!(manifest.contains("\nversion.workspace = true\n"), "{path}");
    }
}
