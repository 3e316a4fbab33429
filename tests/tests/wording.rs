//! The words of a refusal have one home. An error carries the field, the value and the range as data; no other file of
//! the product writes "must be" or "allowed are" into a text of its own.

use slipline_tests::source_tree::{PRODUCT, root, rust_files};

/// The words, and the files that may have them in a text.
const HOMES: [(&str, &[&str]); 2] = [
    ("must be", &["host/plate/src/quantity/refusal.rs"]),
    // The device's own refusals, and those of the link, which are made before the device is asked.
    ("allowed are", &["shared/src/refusal.rs", "host/link/src/out_of_range.rs"]),
];

/// The texts in quotes of a source, up to its unit tests; a text over several lines is one.
fn texts(source: &str) -> Vec<String> {
    let source = source.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut found = Vec::new();
    let mut rest = source;
    while let Some(letter) = rest.chars().next() {
        let raw = rest.strip_prefix('r').map(|raw| raw.trim_start_matches('#'));
        if rest.starts_with("//") {
            rest = rest.split_once('\n').map_or("", |(_, after)| after);
        } else if let Some(inner) = raw.and_then(|raw| raw.strip_prefix('"')) {
            let hashes = rest.len() - inner.len() - 2;
            let (text, after) =
                inner.split_once(&format!("\"{}", "#".repeat(hashes))).expect("a raw text ends");
            found.push(text.to_owned());
            rest = after;
        } else if letter == '"' {
            let (text, after) = quoted(&rest[1..]);
            found.push(text);
            rest = after;
        } else if rest.starts_with("'\"'") || rest.starts_with("'\\") {
            // A letter in quotes that could be taken for the beginning of a text.
            rest = rest[2..].split_once('\'').map_or("", |(_, after)| after);
        } else {
            rest = &rest[letter.len_utf8()..];
        }
    }
    found
}

/// The text that begins here, and what follows its closing quote. A line that goes on is joined as the compiler does.
fn quoted(source: &str) -> (String, &str) {
    let mut text = String::new();
    let mut rest = source;
    loop {
        let letter = rest.chars().next().expect("a text ends");
        rest = &rest[letter.len_utf8()..];
        match letter {
            '"' => return (text, rest),
            '\\' if rest.starts_with('\n') => rest = rest.trim_start(),
            '\\' => {
                let escaped = rest.chars().next().expect("something is escaped");
                text.push(escaped);
                rest = &rest[escaped.len_utf8()..];
            }
            letter => text.push(letter),
        }
    }
}

/// The texts of a source that refuse something in words that have their home elsewhere.
fn strays(file: &str, source: &str) -> Vec<String> {
    let is_stray =
        |text: &String| HOMES.iter().any(|(words, homes)| text.contains(words) && !homes.contains(&file));
    texts(source).into_iter().filter(is_stray).collect()
}

#[test]
fn only_the_home_of_refusals_words_them() {
    let mut unused: Vec<&str> = HOMES.iter().flat_map(|(_, homes)| homes.iter().copied()).collect();
    for folder in PRODUCT {
        for path in rust_files(&root().join(folder)) {
            let source = std::fs::read_to_string(&path).expect("a source");
            let file = path.strip_prefix(root()).expect("below").to_string_lossy().replace('\\', "/");
            let strays = strays(&file, &source);
            assert!(strays.is_empty(), "{file}: {strays:?}: use `slipline_plate::quantity::must_be`");
            let has_words =
                texts(&source).iter().any(|text| HOMES.iter().any(|(words, _)| text.contains(words)));
            unused.retain(|home| *home != file || !has_words);
        }
    }
    assert!(unused.is_empty(), "{unused:?} have no such text any more");
}

#[test]
fn a_refusal_of_its_own_is_found_wherever_a_text_may_stand() {
    for source in [
        "#[error(\"{count} tones: must be 1 to 16\")]",
        "format!(\"{text}: must \\\n     be a number\")",
        "let quote = '\"'; let text = \"a \\\" b must be c\";",
        "let escaped = '\\''; let text = r#\"it \"must be\" so\"#;",
        "// a \" in a comment\nlet text = \"level is 2; allowed are 0 to 1\";",
    ] {
        assert_eq!(strays("host/src/cli/any.rs", source).len(), 1, "{source}");
    }
    for source in [
        "// it must be so\nlet text = \"so\";",
        "/// What it \"must be\".\nfn f<'a>(text: &'a str) {}",
        "fn f() {}\n#[cfg(test)]\nmod tests {\n    const TOLD: &str = \"a = 2: must be 1\";\n}",
    ] {
        assert_eq!(strays("host/src/cli/any.rs", source), [""; 0], "{source}");
    }
}
