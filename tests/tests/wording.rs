//! The words of a refusal have one home. An error carries the field, the value and the range as data; no other file of
//! the product writes "must be" or "allowed are" into a text of its own.
//!
//! Pages, comments, texts and names of tests are plain English: subject, verb, object, and a sentence says who acts.

use slipline_tests::source_tree::{PRODUCT, files, relative, root, rust_files};
use std::path::{Path, PathBuf};

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
            let file = relative(&path);
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

/// Turns that a reader had to read twice, and what to write. A full stop or a comma is a word here.
const RIDDLES: [(&str, &str); 26] = [
    ("is what", "name the thing: `A sends B`, not `B is what A sends`"),
    ("are what", "name the things"),
    ("that there is", "existing, available, or leave it out"),
    ("that there are", "existing, available, or leave it out"),
    ("what there is", "the present value, the existing ones"),
    ("that is there", "present, existing, actual"),
    ("is there .", "exists"),
    ("is there ,", "exists"),
    ("is there already", "exists already"),
    ("is not there", "does not exist, is missing"),
    ("are there .", "exist"),
    ("are there ,", "exist"),
    ("anew", "again, or restart"),
    ("be had", "is possible, reachable"),
    ("told", "reported, shown, stated"),
    ("tells", "reports, shows, determines"),
    ("hears of", "receives, sees"),
    ("comes of it", "results"),
    ("gives way to", "may be replaced by"),
    ("as soon as ever", "at once"),
    ("in vain", "without effect"),
    ("nobody is left", "say what then happens"),
    ("that was asked for", "requested"),
    ("are asked for", "are requested"),
    ("whatever is", "every, any, or name the things"),
    ("what is not", "name the things: unclear columns, unmodelled modes"),
];

/// The files with prose below the workspace's folders, and its first two pages. The changelog describes the past, and
/// this file has the list.
fn files_with_prose() -> Vec<PathBuf> {
    let mut found = ["README.md", "CONTRIBUTING.md"].map(|page| root().join(page)).to_vec();
    for folder in ["shared", "firmware", "host", "tests"] {
        let files = files(&root().join(folder), &[".rs", ".md", ".py"]).into_iter();
        found.extend(files.filter(|file| !file.ends_with("wording.rs")));
    }
    found
}

/// The text without what stands between two signs: code in a sentence, or what a text leaves open.
fn without(text: &str, open: char, close: char) -> String {
    let mut kept = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once(open) {
        let Some((_, behind)) = after.split_once(close) else { break };
        kept.push_str(before);
        kept.push(' ');
        rest = behind;
    }
    kept + rest
}

/// The sentences of a source or a page, in lower case, with one blank between words and around each stop. What is no
/// prose ends a sentence.
fn sentences(path: &Path, source: &str) -> String {
    let ending = path.extension().unwrap_or_default();
    let mut lines = Vec::new();
    let mut is_inside = false;
    let mut is_test = false;
    for line in source.lines() {
        let content = line.trim();
        let line = if ending == "md" {
            is_inside ^= content.starts_with("```");
            if is_inside { ".".to_owned() } else { without(content, '`', '`') }
        } else if ending == "py" {
            let is_text = is_inside || content.starts_with('#') || content.contains("\"\"\"");
            is_inside ^= content.matches("\"\"\"").count() == 1;
            if is_text { without(content, '`', '`') } else { ".".to_owned() }
        } else if content.starts_with("//") {
            without(content.trim_start_matches(['/', '!']), '`', '`')
        } else {
            let texts = content.split('"').skip(1).step_by(2).map(|text| without(text, '{', '}'));
            let name =
                content.strip_prefix("fn ").filter(|_| is_test).and_then(|name| name.split('(').next());
            is_test = content == "#[test]" || is_test && content.starts_with('#');
            format!(
                ". {} . {}",
                texts.collect::<Vec<_>>().join(" . "),
                name.unwrap_or_default().replace('_', " ")
            )
        };
        lines.push(line);
    }
    let mut words = String::from(" ");
    for letter in lines.join(" ").chars().flat_map(char::to_lowercase) {
        match letter {
            '.' | ',' | ';' | ':' => words.extend([' ', letter, ' ']),
            letter if letter.is_alphanumeric() || letter == '-' || letter == '\'' => words.push(letter),
            _ => words.push(' '),
        }
    }
    format!(" {} ", words.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// The riddles of a source or a page, each with the words around it and what to write.
fn riddles(path: &Path, source: &str) -> Vec<String> {
    let sentences = sentences(path, source);
    let mut found = Vec::new();
    for (riddle, instead) in RIDDLES {
        for (at, _) in sentences.match_indices(&format!(" {riddle} ")) {
            let before: Vec<&str> = sentences[..at].split(' ').collect();
            let around = before[before.len().saturating_sub(8)..].join(" ");
            found.push(format!("{around} {riddle} ..: {instead}"));
        }
    }
    for sentence in sentences.split(" . ") {
        if sentence.trim_start().starts_with("to ") && sentence.contains(" is to ") {
            found.push(format!("{sentence}: say who acts, not `to do A is to do B`"));
        }
    }
    found
}

#[test]
fn no_page_comment_text_or_test_name_is_a_riddle() {
    let files = files_with_prose();
    assert!(files.len() > 1000, "{} files", files.len());
    let mut wrong = Vec::new();
    for path in files {
        let source = std::fs::read_to_string(&path).expect("a source is text");
        let file = relative(&path);
        wrong.extend(riddles(&path, &source).into_iter().map(|riddle| format!("{file}: {riddle}")));
    }
    assert!(wrong.is_empty(), "{} riddles:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn a_riddle_is_found_in_pages_comments_texts_and_test_names_and_not_in_code() {
    for (file, source) in [
        ("a.md", "The line\nis what the window shows."),
        ("a.md", "To press the button is to stop the device."),
        ("a.rs", "    // The plate that\n    // is there of the two."),
        ("a.rs", "let text = \"cannot be had\";"),
        ("a.rs", "#[test]\n#[ignore = \"long\"]\nfn a_fault_is_told() {}"),
        ("a.py", "def f():\n    \"\"\"Begins\n    anew.\"\"\""),
    ] {
        assert_eq!(riddles(Path::new(file), source).len(), 1, "{file}: {source}");
    }
    for (file, source) in [
        ("a.md", "```\nis there.\n```\n`what is there.` Is there one?"),
        ("a.rs", "fn told() {}\nlet told = format!(\"{told}\"); // Restarts."),
        ("a.py", "told = anew"),
    ] {
        assert_eq!(riddles(Path::new(file), source), [""; 0], "{file}: {source}");
    }
}
