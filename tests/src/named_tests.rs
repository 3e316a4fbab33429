//! The tests that a document names, and the tests that exist.

use crate::source_tree::{files, root};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The functions of one file that a test runner runs: in Rust those under `#[test]`, in Python those named `test_..`.
#[must_use]
pub fn tests_in(path: &Path, text: &str) -> BTreeSet<String> {
    let name = |line: &str, keyword: &str| {
        let rest = line.trim_start().trim_start_matches("pub ").strip_prefix(keyword)?;
        Some(rest.split(['(', '<']).next().unwrap_or(rest).to_owned())
    };
    let mut found = BTreeSet::new();
    let mut is_test = false;
    for line in text.lines() {
        if path.extension().is_some_and(|extension| extension == "py") {
            found.extend(name(line, "def ").filter(|name| name.starts_with("test_")));
        } else if line.trim() == "#[test]" {
            is_test = true;
        } else if let Some(function) = name(line, "fn ")
            && std::mem::take(&mut is_test)
        {
            found.insert(function);
        }
    }
    found
}

/// Every test of the tree, in Rust and in Python, by its function's name.
///
/// # Panics
/// If the tree cannot be read.
#[must_use]
pub fn all_tests() -> BTreeSet<String> {
    let folders = ["shared", "firmware", "host", "tests"].iter();
    let all = folders.flat_map(|folder| files(&root().join(folder), &[".rs", ".py"]));
    all.flat_map(|path| tests_in(&path, &fs::read_to_string(&path).expect("a source is text"))).collect()
}

/// The rows of a page's tables that have `columns` columns, without head and rule.
#[must_use]
pub fn rows(page: &str, columns: usize) -> Vec<Vec<String>> {
    let cells = |line: &str| -> Vec<String> {
        line.trim_matches('|').split(" | ").map(|cell| cell.trim().to_owned()).collect()
    };
    let lines = page.lines().filter(|line| line.starts_with("| "));
    lines.map(cells).filter(|cells| cells.len() == columns).skip(1).collect()
}

/// The texts between backticks in a cell of a table.
pub fn quoted(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_function_that_no_runner_runs_is_no_test() {
        let rust = "fn helper() {}\n#[test]\n#[ignore]\nfn a_test() {\n    fn inner() {}\n}\n// #[test]\nfn other() {}\n";
        assert_eq!(tests_in(Path::new("a.rs"), rust), BTreeSet::from(["a_test".to_owned()]));
        let python = "def helper():\n    pass\n\ndef test_it(rig):\n    pass\n";
        assert_eq!(tests_in(Path::new("a.py"), python), BTreeSet::from(["test_it".to_owned()]));
    }

    #[test]
    fn a_tables_rows_come_without_head_and_rule() {
        let page = "text\n\n| a | b |\n|---|---|\n| `x` | y, `z` |\n\n| other |\n|---|\n| row |\n";
        assert_eq!(rows(page, 2), [["`x`", "y, `z`"]]);
        assert_eq!(quoted("y, `z` and `w`").collect::<Vec<_>>(), ["z", "w"]);
    }
}
