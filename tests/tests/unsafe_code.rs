//! Unsafe code: the table of firmware/UNSAFE.md names every place, and crates without any forbid it.

use slipline_tests::named_tests::{all_tests, quoted, rows};
use slipline_tests::source_tree::{PRODUCT, files, relative, root};
use std::collections::BTreeMap;
use std::fs;

/// How often `unsafe` stands where: by file and item.
type Places = BTreeMap<(String, String), usize>;

/// A line's code: without what stands in quotes and without a comment.
fn code(line: &str) -> String {
    let outside_quotes: String = line.split('"').step_by(2).collect();
    outside_quotes.split("//").next().unwrap_or_default().to_owned()
}

/// How often a line says `unsafe`; `unsafe_code` and its like are other words.
fn count(code: &str) -> usize {
    code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| *word == "unsafe").count()
}

/// The name after a keyword, if a line has the keyword.
fn name_after<'a>(code: &'a str, keyword: &str) -> Option<&'a str> {
    let words: Vec<&str> = code.split_whitespace().collect();
    let at = words.iter().position(|word| *word == keyword)?;
    words.get(at + 1).and_then(|word| word.split(['(', '<', ':']).next())
}

/// The places in one source. An attribute belongs to the function or variable below it, an implementation is named by
/// trait and type, a block of foreign symbols is `extern`, and anything else belongs to the function around it.
fn places(text: &str) -> BTreeMap<String, usize> {
    let lines: Vec<String> = text.lines().map(code).collect();
    let mut found = BTreeMap::new();
    let mut function = "the file";
    for (number, line) in lines.iter().enumerate() {
        function = name_after(line, "fn").unwrap_or(function);
        let times = count(line);
        if times == 0 {
            continue;
        }
        let item = if line.contains("#[unsafe(") {
            let mut below = lines[number..].iter();
            below.find_map(|line| name_after(line, "fn").or_else(|| name_after(line, "static")))
        } else if let Some((_, implementation)) = line.split_once("impl ") {
            implementation.split(" {").next()
        } else if line.contains("extern") && name_after(line, "fn").is_none() {
            Some("extern")
        } else {
            Some(function)
        };
        *found.entry(item.expect("an item follows its attribute").to_owned()).or_default() += times;
    }
    found
}

/// What the sources of shared, firmware, host and tests hold. This file is about the word and left out.
fn in_the_sources() -> Places {
    let mut found = Places::new();
    for file in
        ["shared", "firmware", "host", "tests"].iter().flat_map(|it| files(&root().join(it), &[".rs"]))
    {
        let name = relative(&file);
        if name == "tests/tests/unsafe_code.rs" {
            continue;
        }
        for (item, times) in places(&fs::read_to_string(file).expect("a source is text")) {
            found.insert((name.clone(), item), times);
        }
    }
    found
}

/// The rows of the page: file, item, times, proof, tests.
fn table() -> Vec<Vec<String>> {
    rows(&fs::read_to_string(root().join("firmware/UNSAFE.md")).expect("the page"), 5)
}

#[test]
fn the_table_names_every_unsafe_place_and_no_other() {
    let mut listed = Places::new();
    for row in table() {
        let place = (row[0].replace('`', ""), row[1].replace('`', ""));
        let times = row[2].parse().expect("a number of times");
        assert!(listed.insert(place, times).is_none(), "twice in the table: {row:?}");
        assert!(row[3].len() >= 10, "no proof: {row:?}");
    }
    let true_places = in_the_sources();
    assert!(true_places.len() > 40, "the search finds the sources");
    let missing: Vec<_> =
        true_places.iter().filter(|(place, times)| listed.get(place) != Some(times)).collect();
    let gone: Vec<_> = listed.iter().filter(|(place, times)| true_places.get(place) != Some(times)).collect();
    assert!(
        missing.is_empty() && gone.is_empty(),
        "not in the table: {missing:#?}\nnot in the sources: {gone:#?}"
    );
}

#[test]
fn every_test_that_the_table_names_exists() {
    let tests = all_tests();
    for row in table() {
        let named: Vec<&str> = quoted(&row[4]).collect();
        assert!(!named.is_empty(), "no test: {row:?}");
        for test in named {
            assert!(tests.contains(test), "{test} is no test");
        }
    }
}

#[test]
fn a_crate_without_unsafe_code_forbids_it() {
    let places = in_the_sources();
    for folder in PRODUCT.iter().copied().chain(["tests/src"]) {
        let has_some = places.keys().any(|(file, _)| file.starts_with(&format!("{folder}/")));
        let roots = ["lib.rs", "main.rs"].map(|name| fs::read_to_string(root().join(folder).join(name)));
        for root_file in roots.into_iter().flatten() {
            let forbids = root_file.lines().any(|line| line == "#![forbid(unsafe_code)]");
            assert_eq!(forbids, !has_some, "{folder}");
        }
    }
    let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("the workspace's manifest");
    assert!(manifest.contains("\nunsafe_code = \"deny\"\n"), "elsewhere it is denied");
}

#[test]
fn every_kind_of_place_is_found_and_words_alone_are_not() {
    let text = r#"
//! unsafe in a comment
#[expect(unsafe_code, reason = "unsafe")]
unsafe impl Sync for Kept {}
#[unsafe(link_section = ".uninit")]
static KEPT: Kept = Kept(0);
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() -> ! {}
unsafe extern "C" {
    static END: u32;
}
fn read(a: u32) {
    // SAFETY: not unsafe
    match unsafe { f() } { _ => unsafe { g() } }
}
"#;
    let found = places(text);
    let found: Vec<_> = found.iter().map(|(item, times)| (item.as_str(), *times)).collect();
    assert_eq!(found, [("HardFault", 3), ("KEPT", 1), ("Sync for Kept", 1), ("extern", 1), ("read", 2)]);
}
