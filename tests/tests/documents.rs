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
    assert!(wrong.is_empty(), "named, but missing:\n{}", wrong.join("\n"));
}

/// What a crate's page must name, below its `src/`, without an ending: each file beside the root file, and each folder
/// one or two levels down that holds two files or more.
fn rooms(sources: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut files: BTreeMap<String, usize> = BTreeMap::new();
    for file in rust_files(sources) {
        let name = file.strip_prefix(sources).expect("below").with_extension("");
        let name = name.to_string_lossy().replace('\\', "/");
        match name.rsplit_once('/') {
            Some((folder, _)) if folder.split('/').count() <= 2 => {
                *files.entry(folder.to_owned()).or_default() += 1;
            }
            None if name != "lib" && name != "main" => {
                found.insert(name);
            }
            _ => {}
        }
    }
    found.extend(files.into_iter().filter(|&(_, count)| count > 1).map(|(folder, _)| folder));
    found
}

/// The names, without endings, at the begin of the items below "Rooms" on a crate's page: those before the first colon.
fn named_rooms(page: &str) -> BTreeSet<String> {
    let lines = page.lines().take_while(|line| line.starts_with("//!"));
    let page = lines.map(|line| line.trim_start_matches("//!").trim()).collect::<Vec<_>>().join("\n");
    let rooms = page.split("# Rooms\n").nth(1).unwrap_or_default().replace("`,\n`", "`, `");
    let lists = rooms.split("\n- `").skip(1).filter_map(|item| item.split("`:").next());
    lists
        .flat_map(|names| names.split("`, `"))
        .map(|name| name.trim_end_matches('/').trim_end_matches(".rs").to_owned())
        .collect()
}

/// The file that a crate's page stands in: that of its library, or of its program.
fn root_file(sources: &str) -> String {
    let library = format!("{sources}/lib.rs");
    if root().join(&library).exists() { library } else { format!("{sources}/main.rs") }
}

#[test]
fn the_page_of_each_crate_names_its_files_and_folders() {
    for sources in PRODUCT.into_iter().chain(["tests/src"]) {
        let page = text(&root_file(sources));
        let named = named_rooms(&page);
        let rooms = rooms(&root().join(sources));
        let is_below = |folder: &String| page.contains(&format!("`{folder}/"));
        let missing: Vec<_> = rooms.iter().filter(|room| !named.contains(*room) && !is_below(room)).collect();
        assert!(missing.is_empty(), "{} names no room {missing:?}", root_file(sources));
        let exists = |room: &String| {
            let path = root().join(sources).join(room);
            path.exists() || path.with_extension("rs").exists()
        };
        let gone: Vec<_> = named.iter().filter(|room| !exists(room)).collect();
        assert!(gone.is_empty(), "{} names {gone:?}, which do not exist", root_file(sources));
    }
}

#[test]
fn the_rooms_of_a_page_are_the_names_before_the_colon() {
    // Written with another quote, for the first test reads this file, too.
    let page = "//! - 'no.rs': above\n//! # Rooms\n//!\n//! - 'a.rs',\n//!   'b/': see 'c.rs': it\n//! - 'd/e/': 'f'\n";
    let page = page.replace('\'', "`");
    assert_eq!(named_rooms(&page), ["a", "b", "d/e"].map(str::to_owned).into());
}

#[test]
fn the_table_of_the_contributors_leads_to_the_page_of_each_crate_and_stays_short() {
    let page = text("CONTRIBUTING.md");
    let table = page.split("| I want to change |").nth(1).and_then(|rest| rest.split("\n\n").next());
    let rows: Vec<&str> = table.expect("the table").lines().skip(2).collect();
    assert!(rows.len() <= 20, "{} rows", rows.len());
    for row in &rows {
        assert!(row.chars().count() <= 120, "{row}");
    }
    // The program that writes the page's script is one file.
    for sources in PRODUCT.into_iter().chain(["tests/src"]).filter(|sources| !sources.contains("bindgen")) {
        let root_file = format!("`{}`", root_file(sources));
        assert!(rows.iter().any(|row| row.contains(&root_file)), "no row leads to {root_file}");
    }
}

#[test]
fn the_readme_stays_short() {
    let page = text("README.md");
    let lines = page.lines().count();
    assert!(lines <= 200, "{lines} lines: move all that a first reader does not need");
}

#[test]
fn a_missing_file_that_a_page_names_is_found() {
    let entries: BTreeSet<String> = ["shared", "shared/src", "shared/src/frame.rs"].map(str::to_owned).into();
    // Written with another quote, for this file is read by the test above, too.
    let spans = |text: &str| text.replace('\'', "`");
    let good = spans("'shared/src/frame.rs', 'frame.rs', 'shared/src/', 'a/b', 'x.toml'");
    assert!(missing(&good, &entries).is_empty());
    let bad = spans("'shared/src/frames.rs' and 'trouble.rs' and 'shared/wire'\n'''text\n'old.rs'\n'''\n");
    assert_eq!(missing(&bad, &entries), ["shared/src/frames.rs", "trouble.rs", "shared/wire"]);
    assert_eq!(links("[a](b/c.md#d) [e](https://f.rs) [g](#h)"), ["b/c.md"]);
}

/// What is wrong with the files of commands that are run in order: one written twice, one read that does not exist.
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
                    wrong.push(format!("{file} exists already: {command}"));
                }
                "--plate" | "--actual-plate" | "--setup" | "--data" | "--played"
                    if file.contains('.') && !written.contains(file) && !written.contains(folder) =>
                {
                    wrong.push(format!("{file} does not exist: {command}"));
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
fn the_version_stands_in_one_place() {
    // `.ci/release` changes it there, and every crate, the firmware among them, takes it from there.
    for path in entries().iter().filter(|path| path.ends_with("/Cargo.toml")) {
        let manifest = fs::read_to_string(root().join(path)).expect("a manifest is text");
        assert!(manifest.contains("\nversion.workspace = true\n"), "{path}");
    }
    // A registry knows no paths: the crates ask for each other by the same version.
    let manifest = text("Cargo.toml");
    let (_, version) = manifest.split_once("\nversion = \"").expect("a version");
    let version = version.split('"').next().expect("split yields one part");
    let ours: Vec<_> = manifest.lines().filter(|line| line.starts_with("slipline")).collect();
    assert!(ours.len() > 8, "{ours:?}");
    for line in ours.iter().filter(|line| line.contains(" = { path = ")) {
        assert!(line.contains(&format!("version = \"{version}\"")), "{line}");
    }
}

#[test]
fn readme_window_and_debian_package_name_the_same_libraries() {
    let readme = text("README.md");
    let (_, list) = readme.split_once("window needs `").expect("the list");
    let listed: BTreeSet<&str> = list.split('`').next().expect("its end").split_whitespace().collect();
    assert!(listed.len() > 4, "{listed:?}");
    let control = text("host/package/control");
    let depends = control.lines().find_map(|line| line.strip_prefix("Depends: ")).expect("dependencies");
    let depends: BTreeSet<&str> = depends.split(", ").filter_map(|item| item.split(' ').next()).collect();
    // What every program in Rust is linked with.
    let linked: BTreeSet<&str> = ["libc6", "libgcc-s1"].into();
    assert_eq!(depends, &listed | &linked);
    let window = text("host/window/src/app/libraries.rs");
    let (_, table) = window.split_once("LIBRARIES: ").expect("the table");
    let table = table.split("];").next().expect("its end");
    let named: BTreeSet<&str> = table.lines().filter_map(|line| line.split('"').nth(3)).collect();
    assert_eq!(named, listed);
}
