//! No circle of files: within each crate, what a file uses never leads back to it.
//!
//! A file that is a module's parent declares its children, re-exports their items and calls them; a child may use its
//! parent's items. These two are one unit and are not counted. What is counted is every other use of one file by
//! another: `use` declarations and paths that begin with `crate`, `super` or `self`, to the file that they name and,
//! followed through its re-exports, to the file that defines the item. Unit tests may use anything.

use slipline_tests::source_tree::{PRODUCT, root, rust_files};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A module's place in its crate: empty for the root.
type Module = Vec<String>;

/// One source file.
struct SourceFile {
    /// Its text without comments and unit tests.
    text: String,
    /// What its `use` declarations bring in: the name it has here, and the path.
    imports: Vec<(String, Vec<String>)>,
}

/// The module of a file below the crate's folder of sources.
fn module(folder: &Path, file: &Path) -> Module {
    let inner = file.strip_prefix(folder).expect("below").with_extension("");
    let mut parts: Module = inner.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
        parts.pop();
    }
    parts
}

/// The text up to its unit tests, without comments and texts in quotes.
fn code(text: &str) -> String {
    let product = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let product = product.split("\n#[cfg(test)]\npub(crate) mod tests {").next().unwrap_or_default();
    product.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The names and full paths of a `use` declaration's tree, as `a::{b, c::{self, d as e}}`.
fn tree(text: &str, before: &[String], found: &mut Vec<(String, Vec<String>)>) {
    let text = text.trim();
    if let Some(open) = text.find('{') {
        let head = text[..open].trim_end_matches("::");
        let mut path = before.to_vec();
        path.extend(head.split("::").filter(|part| !part.is_empty()).map(|part| part.trim().to_owned()));
        let inner = &text[open + 1..text.rfind('}').unwrap_or(text.len())];
        let (mut depth, mut start) = (0, 0);
        for (at, letter) in inner.char_indices().chain([(inner.len(), ',')]) {
            match letter {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    if !inner[start..at].trim().is_empty() {
                        tree(&inner[start..at], &path, found);
                    }
                    start = (at + 1).min(inner.len());
                }
                _ => {}
            }
        }
        return;
    }
    let (path, alias) = match text.split_once(" as ") {
        Some((path, alias)) => (path, Some(alias.trim())),
        None => (text, None),
    };
    let mut full = before.to_vec();
    full.extend(path.split("::").map(|part| part.trim().to_owned()).filter(|part| !part.is_empty()));
    if full.len() > 1 && full.last().is_some_and(|last| last == "self") {
        full.pop();
    }
    let name = alias.or(full.last().map(String::as_str)).unwrap_or_default().to_owned();
    found.push((name, full));
}

/// What the `use` declarations of a text bring in.
fn imports(text: &str) -> Vec<(String, Vec<String>)> {
    let mut found = Vec::new();
    let mut rest = text;
    // Declarations begin a line; the word in a sentence does not count.
    while let Some(at) = rest.find("use ") {
        let before = rest[..at].rsplit('\n').next().unwrap_or_default().trim();
        rest = &rest[at + 4..];
        if (before.is_empty() || before == "pub" || (before.starts_with("pub(") && before.ends_with(')')))
            && let Some(end) = rest.find(';')
        {
            tree(&rest[..end], &[], &mut found);
        }
    }
    found
}

/// The paths of a text that begin with `crate`, `super` or `self`, outside of `use` declarations, too.
fn paths(text: &str) -> Vec<Vec<String>> {
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_' || letter == ':';
    text.split(|letter| !is_part(letter))
        .filter(|path| ["crate::", "super::", "self::"].iter().any(|begin| path.starts_with(begin)))
        .map(|path| path.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect())
        .collect()
}

/// The module whose file a path names, and the one whose file defines the item, if they are in the crate.
fn named(crate_of: &BTreeMap<Module, SourceFile>, from: &Module, path: &[String]) -> BTreeSet<Module> {
    [MOST_RE_EXPORTS, 0].into_iter().filter_map(|depth| resolve(crate_of, from, path, depth)).collect()
}

/// Re-exports that are followed one after another.
const MOST_RE_EXPORTS: u8 = 8;

/// The module whose file defines the item of a path, if it is in the crate. `depth` counts the re-exports followed so far.
fn resolve(
    crate_of: &BTreeMap<Module, SourceFile>,
    from: &Module,
    path: &[String],
    depth: u8,
) -> Option<Module> {
    let mut at = from.clone();
    let mut parts = path.iter().peekable();
    match parts.peek().map(|part| part.as_str()) {
        Some("crate") => {
            at.clear();
            parts.next();
        }
        Some("self") => drop(parts.next()),
        Some("super") => {
            while parts.peek().is_some_and(|part| *part == "super") {
                at.pop();
                parts.next();
            }
        }
        // A child, something that was imported, or another crate.
        Some(first) => {
            let child = [&from[..], &[first.to_owned()]].concat();
            let is_imported =
                crate_of.get(from).is_some_and(|file| file.imports.iter().any(|(name, _)| name == first));
            if !crate_of.contains_key(&child) && !is_imported {
                return None;
            }
        }
        None => return None,
    }
    while let Some(part) = parts.next() {
        let child = [&at[..], std::slice::from_ref(part)].concat();
        if crate_of.contains_key(&child) {
            at = child;
            continue;
        }
        // An item: of this file, or imported into it from another.
        let imported = crate_of.get(&at)?.imports.iter().find(|(name, _)| name == part);
        if let Some((_, path)) = imported.filter(|_| depth < MOST_RE_EXPORTS) {
            let path = [&path[..], &parts.cloned().collect::<Vec<_>>()].concat();
            return resolve(crate_of, &at, &path, depth + 1);
        }
        break;
    }
    Some(at)
}

/// Which file uses which, parents and children left out.
fn uses(crate_of: &BTreeMap<Module, SourceFile>) -> BTreeMap<Module, BTreeSet<Module>> {
    let is_family = |a: &Module, b: &Module| a.starts_with(b) || b.starts_with(a);
    crate_of
        .iter()
        .map(|(from, source)| {
            let paths = source.imports.iter().map(|(_, path)| path.clone()).chain(paths(&source.text));
            let used = paths.flat_map(|path| named(crate_of, from, &path));
            (from.clone(), used.filter(|to| !is_family(from, to)).collect())
        })
        .collect()
}

/// Every file that can be reached from one.
fn reached(uses: &BTreeMap<Module, BTreeSet<Module>>, from: &Module) -> BTreeSet<Module> {
    let mut found = BTreeSet::new();
    let mut next: Vec<&Module> = uses[from].iter().collect();
    while let Some(module) = next.pop() {
        if found.insert(module.clone()) {
            next.extend(&uses[module]);
        }
    }
    found
}

/// The sources of a crate by module; its programs in `bin` are crates of their own.
fn read(folder: &Path) -> BTreeMap<Module, SourceFile> {
    let mut found = rust_files(folder);
    found.retain(|file| !file.strip_prefix(folder).expect("below").iter().any(|part| part == "bin"));
    let source = |file: &PathBuf| {
        let text = code(&std::fs::read_to_string(file).expect("readable"));
        (module(folder, file), SourceFile { imports: imports(&text), text })
    };
    found.iter().map(source).collect()
}

/// The circles of a crate, each as the names of its files' modules.
fn circles(folder: &Path) -> BTreeSet<Vec<String>> {
    let uses = uses(&read(folder));
    let reach: BTreeMap<&Module, BTreeSet<Module>> =
        uses.keys().map(|module| (module, reached(&uses, module))).collect();
    let name = |module: &Module| if module.is_empty() { "crate".to_owned() } else { module.join("::") };
    uses.keys()
        .filter(|module| reach[module].contains(*module))
        .map(|module| {
            let both =
                uses.keys().filter(|other| reach[module].contains(*other) && reach[other].contains(module));
            both.map(name).collect()
        })
        .collect()
}

/// The folders of sources of every crate.
fn crates() -> impl Iterator<Item = &'static str> {
    PRODUCT.into_iter().chain(["tests/src"])
}

#[test]
fn no_crate_has_a_circle_of_files() {
    let mut found = Vec::new();
    for folder in crates() {
        for circle in circles(&root().join(folder)) {
            found.push(format!("{folder}: {}", circle.join(", ")));
        }
    }
    assert!(found.is_empty(), "circles of files: {found:#?}");
}

#[test]
fn every_crate_of_the_workspace_is_looked_at() {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("manifest");
    let members = manifest.lines().find(|line| line.starts_with("members")).expect("members");
    for member in members.split('"').skip(1).step_by(2) {
        assert!(crates().any(|folder| folder == format!("{member}/src")), "{member}");
    }
}

#[test]
fn a_circle_is_found_through_groups_and_re_exports() {
    let source = |text: &str| SourceFile { imports: imports(text), text: text.to_owned() };
    let module = |path: &str| path.split("::").map(str::to_owned).collect::<Module>();
    let crate_of: BTreeMap<Module, SourceFile> = [
        (Vec::new(), source("pub mod a; pub mod b; pub mod c;")),
        (module("a"), source("use crate::{b::Item as Other, std::fmt};\n")),
        (module("b"), source("pub mod inner;\npub use inner::Item;")),
        (module("b::inner"), source("use super::Helper;\nfn f() { crate::c::call() }")),
        (module("c"), source("use super::a;")),
    ]
    .into();
    let uses = uses(&crate_of);
    assert_eq!(
        uses[&module("a")],
        [module("b"), module("b::inner")].into(),
        "named in b, defined in b::inner"
    );
    assert_eq!(uses[&module("b::inner")], [module("c")].into(), "its parent is not counted");
    assert!(reached(&uses, &module("c")).contains(&module("c")));
    assert!(!reached(&uses, &module("b")).contains(&module("b")));
}
