//! tests/RELIABILITY.md is true to the tree: it has its rows, and each test that it names exists.

use slipline_tests::named_tests::{all_tests, quoted, rows};
use slipline_tests::source_tree::root;
use std::collections::BTreeSet;

/// The rows that were found weak once, or whose tests had not been seen red; each must stay in the table.
const ROWS: [&str; 39] = [
    "R-06", "R-20", "R-23", "R-32", "R-36", "R-37", "R-38", "R-43", "R-44", "R-50", "R-51", "R-53", "R-54",
    "R-55", "R-56", "R-57", "R-60", "R-61", "R-63", "R-64", "R-66", "R-67", "R-68", "R-69", "R-70", "R-71",
    "R-72", "R-73", "R-76", "R-77", "R-78", "R-79", "R-80", "R-81", "R-82", "R-88", "R-89", "R-93", "R-94",
];

/// Row, requirement, test, mutation.
fn table() -> Vec<Vec<String>> {
    rows(&std::fs::read_to_string(root().join("tests/RELIABILITY.md")).expect("the page"), 4)
}

#[test]
fn every_row_that_was_weak_has_a_test_that_was_seen_red() {
    let table = table();
    let rows: BTreeSet<&str> = table.iter().map(|row| row[0].as_str()).collect();
    assert_eq!(rows, ROWS.into());
    for row in &table {
        assert!(row[1].len() > 10 && row[3].len() > 20, "{row:?}");
        assert!(row[3].contains('`'), "the mutation names its file: {row:?}");
    }
}

#[test]
fn every_test_that_the_table_names_exists() {
    let tests = all_tests();
    for row in table() {
        let named: Vec<&str> = quoted(&row[2]).collect();
        assert!(!named.is_empty(), "no test: {row:?}");
        for test in named {
            assert!(tests.contains(test) || test.starts_with(".ci/run "), "{test} is no test");
        }
    }
}
