//! The layout is the architecture: the crates' arrows, one lint table, no stray files at the top.

use slipline_tests::source_tree::{root, rust_files};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// What cargo says of the workspace.
fn metadata() -> serde_json::Value {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("cargo prints JSON")
}

/// The workspace's crates and the arrows between them; an arrow is (user, used).
fn crates_and_arrows() -> (BTreeSet<String>, BTreeSet<(String, String)>) {
    let metadata = metadata();
    let mut crates = BTreeSet::new();
    let mut arrows = BTreeSet::new();
    for package in metadata["packages"].as_array().expect("packages") {
        let name = package["name"].as_str().expect("name").to_owned();
        for dependency in package["dependencies"].as_array().expect("dependencies") {
            let used = dependency["name"].as_str().expect("name");
            if used.starts_with("slipline") {
                arrows.insert((name.clone(), used.to_owned()));
            }
        }
        crates.insert(name);
    }
    (crates, arrows)
}

#[test]
fn the_crates_have_exactly_the_arrows_of_the_design() {
    let (crates, arrows) = crates_and_arrows();
    let expected = [
        "slipline-protocol",
        "slipline-dds",
        "slipline-app",
        "slipline-stm32",
        "slipline-qemu",
        "slipline",
        "slipline-link",
        "slipline-model",
        "slipline-instrument",
        "slipline-plate",
        "slipline-python",
        "slipline-window",
        "slipline-page",
        // Writes the script that loads the page; knows nothing of the others.
        "slipline-page-bindgen",
        "slipline-tests",
    ];
    assert_eq!(crates, expected.map(str::to_owned).into());
    let expected = [
        ("slipline-app", "slipline-dds"),
        ("slipline-app", "slipline-protocol"),
        ("slipline-stm32", "slipline-app"),
        ("slipline-qemu", "slipline-app"),
        ("slipline-link", "slipline-app"),
        ("slipline-link", "slipline-protocol"),
        ("slipline-model", "slipline-link"),
        ("slipline-model", "slipline-plate"),
        ("slipline-instrument", "slipline-link"),
        ("slipline-instrument", "slipline-model"),
        ("slipline-instrument", "slipline-plate"),
        ("slipline", "slipline-instrument"),
        ("slipline", "slipline-link"),
        ("slipline", "slipline-model"),
        ("slipline", "slipline-plate"),
        ("slipline", "slipline-window"),
        // Not linked: for the features that its dependencies have in `cargo test`.
        ("slipline-python", "slipline"),
        ("slipline-python", "slipline-instrument"),
        ("slipline-python", "slipline-link"),
        ("slipline-python", "slipline-model"),
        ("slipline-python", "slipline-plate"),
        ("slipline-window", "slipline-instrument"),
        ("slipline-window", "slipline-link"),
        ("slipline-window", "slipline-model"),
        ("slipline-window", "slipline-plate"),
        ("slipline-page", "slipline-instrument"),
        ("slipline-page", "slipline-link"),
        ("slipline-page", "slipline-model"),
        ("slipline-page", "slipline-plate"),
        ("slipline-page", "slipline-window"),
        ("slipline-tests", "slipline"),
        ("slipline-tests", "slipline-app"),
        ("slipline-tests", "slipline-instrument"),
        ("slipline-tests", "slipline-link"),
        ("slipline-tests", "slipline-model"),
        ("slipline-tests", "slipline-protocol"),
        ("slipline-tests", "slipline-plate"),
    ];
    assert_eq!(arrows, expected.map(|(user, used)| (user.to_owned(), used.to_owned())).into());
}

/// The folders of the crates, relative to the workspace.
fn folders() -> BTreeSet<String> {
    let metadata = metadata();
    let packages = metadata["packages"].as_array().expect("packages");
    let manifests = packages.iter().map(|package| package["manifest_path"].as_str().expect("path"));
    manifests
        .map(|manifest| {
            let folder = Path::new(manifest).parent().expect("a manifest lies in a folder");
            let root = root().canonicalize().expect("the workspace exists");
            folder.strip_prefix(root).expect("it lies in the workspace").to_string_lossy().replace('\\', "/")
        })
        .collect()
}

#[test]
fn every_crate_takes_its_lints_from_the_one_table() {
    for folder in folders() {
        let manifest = std::fs::read_to_string(root().join(&folder).join("Cargo.toml")).expect("manifest");
        assert!(manifest.contains("[lints]\nworkspace = true"), "{folder}");
    }
}

/// The inner attributes of a crate's root files: of its library, of its program, or of both.
fn root_attributes(folder: &str) -> Vec<String> {
    let attributes = |text: String| {
        let code = text.lines().filter(|line| !line.starts_with("//"));
        code.take_while(|line| !line.contains("mod ") && !line.contains("use ")).collect::<String>()
    };
    let source = root().join(folder).join("src");
    let roots = ["lib.rs", "main.rs"].map(|name| std::fs::read_to_string(source.join(name)));
    let found: Vec<String> = roots.into_iter().flatten().map(attributes).collect();
    assert!(!found.is_empty(), "{folder} has neither lib.rs nor main.rs");
    found
}

#[test]
fn every_product_crate_warns_of_unwrap_and_expect() {
    // The crates of the tests may; all of them lie under tests/.
    for folder in folders().iter().filter(|folder| !folder.starts_with("tests")) {
        for lints in root_attributes(folder) {
            assert!(
                lints.contains("clippy::unwrap_used") && lints.contains("clippy::expect_used"),
                "{folder}"
            );
        }
    }
}

#[test]
fn every_crate_of_the_browser_build_is_checked_for_what_a_browser_lacks() {
    let gate = std::fs::read_to_string(root().join(".ci/run")).expect("the gate's script");
    // A crate that is no_std cannot name what a browser lacks; the others have the lint.
    for (folder, package, lint) in [
        ("shared", "slipline-protocol", "no_std"),
        ("firmware/app", "slipline-app", "no_std"),
        ("firmware/dds", "slipline-dds", "no_std"),
        ("host/plate", "slipline-plate", "clippy::disallowed_methods"),
        ("host/link", "slipline-link", "clippy::disallowed_methods"),
        ("host/model", "slipline-model", "clippy::disallowed_methods"),
        ("host/instrument", "slipline-instrument", "clippy::disallowed_methods"),
        ("host/window", "slipline-window", "clippy::disallowed_methods"),
        ("host/window/web", "slipline-page", "clippy::disallowed_methods"),
    ] {
        assert!(root_attributes(folder).iter().all(|attributes| attributes.contains(lint)), "{folder}");
        assert!(gate.contains(&format!("-p {package}")), "{package} is part of the gate's step wasm");
    }
}

/// The crates that the shells stand on, as far as they exist.
const BELOW_THE_SHELLS: [&str; 3] = ["host/link", "host/model", "host/instrument"];

#[test]
fn the_crates_below_the_shells_give_typed_errors() {
    // A shell acts on the variant of an error and words it in its own way; a text can only be shown.
    let text_error = ["String>", "&'static str>", "Box<str>>"].map(|text| format!(", {text}"));
    for folder in BELOW_THE_SHELLS.iter().filter(|folder| root().join(folder).exists()) {
        let files = rust_files(&root().join(folder).join("src"));
        assert!(!files.is_empty(), "{folder} has no sources");
        for file in files {
            let text = std::fs::read_to_string(&file).expect("a source file");
            // A long signature is broken into lines, the last of which ends with a comma.
            let code = text.split_whitespace().collect::<Vec<_>>().join(" ").replace(", >", ">");
            for (at, _) in code.match_indices("Result<") {
                let result = generic(&code[at..]);
                assert!(
                    !text_error.iter().any(|error| result.ends_with(error)),
                    "{}: {result}: the error has no type of its own",
                    file.display()
                );
            }
        }
    }
}

/// A generic type at the beginning of a text, up to the bracket that closes it.
fn generic(text: &str) -> &str {
    let mut depth = 0;
    let end = text.char_indices().find(|&(at, character)| {
        let is_arrow = text[..at].ends_with(['-', '=']);
        match character {
            '<' => depth += 1,
            '>' if !is_arrow => depth -= 1,
            _ => return false,
        }
        depth == 0
    });
    end.map_or(text, |(at, _)| &text[..=at])
}

#[test]
fn no_crate_that_uses_the_link_has_a_wildcard_over_an_enum() {
    let shells = ["host", "host/window", "host/window/web", "host/python"];
    for folder in ["host/link", "host/model", "host/instrument"].into_iter().chain(shells) {
        let is_checked = |lints: &String| lints.contains("warn(clippy::wildcard_enum_match_arm)");
        assert!(!root().join(folder).exists() || root_attributes(folder).iter().all(is_checked), "{folder}");
    }
}

#[test]
fn the_top_level_holds_nothing_but_the_agreed_entries() {
    let listed = Command::new("git").args(["ls-files"]).current_dir(root()).output();
    let names: Vec<String> = match listed {
        Ok(listed) if listed.status.success() => {
            let paths = String::from_utf8_lossy(&listed.stdout).into_owned();
            paths.lines().filter_map(|path| path.split('/').next()).map(str::to_owned).collect()
        }
        // An exported tree, or a machine without git: what lies there, but for what cargo makes.
        _ => {
            let entries = std::fs::read_dir(root()).expect("the tree can be read");
            let names =
                entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
            names.filter(|name| name != "target").collect()
        }
    };
    let top: BTreeSet<String> = names.into_iter().filter(|name| !name.starts_with('.')).collect();
    let agreed = [
        "CHANGELOG.md",
        "CONTRIBUTING.md",
        "Cargo.lock",
        "Cargo.toml",
        "LICENSE-APACHE",
        "LICENSE-MIT",
        "README.md",
        "clippy.toml",
        "deny.toml",
        "firmware",
        "host",
        "rust-toolchain.toml",
        "shared",
        "tests",
    ];
    assert_eq!(top, agreed.map(str::to_owned).into());
}

#[test]
fn no_network_listener_of_the_gui_toolkit_is_compiled_in() {
    // egui's inspection server listens on a TCP port without authentication.
    let lock = std::fs::read_to_string(root().join("Cargo.lock")).expect("lockfile");
    assert!(!lock.contains("egui_inspection"));
}

#[test]
fn cargo_run_means_the_app() {
    // The README's first command. With several programs and no default, or two of them, cargo refuses to choose.
    let metadata = metadata();
    let packages = metadata["packages"].as_array().expect("packages");
    let defaults: Vec<_> = packages.iter().filter_map(|package| package["default_run"].as_str()).collect();
    assert_eq!(defaults, ["slipline"]);
}

/// The rooms of the instrument, each with those that it uses: a room is a folder, and its type has the same name.
const ROOMS: [(&str, &[&str]); 4] =
    [("desk", &[]), ("drive", &[]), ("lab", &["desk", "drive"]), ("screen", &["desk", "drive", "lab"])];

/// The Rust files of a folder of the instrument, each with its path and its lines that are not comments.
fn instrument_files(folder: &str) -> Vec<(String, String)> {
    let files = rust_files(&root().join("host/instrument/src/instrument").join(folder));
    let code = |file: &Path| {
        let text = std::fs::read_to_string(file).expect("a source file");
        let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        code.collect::<Vec<_>>().join("\n")
    };
    let files: Vec<_> = files.iter().map(|file| (file.display().to_string(), code(file))).collect();
    assert!(!files.is_empty(), "{folder} has no sources");
    files
}

/// The fields of a struct, a line each.
fn fields<'a>(code: &'a str, name: &str) -> Vec<&'a str> {
    let (_, body) = code.split_once(&format!("struct {name} {{\n")).unwrap_or_else(|| panic!("no {name}"));
    body.lines().take_while(|line| *line != "}").map(str::trim).collect()
}

#[test]
fn each_room_of_the_instrument_is_whole_and_uses_no_other_but_those_of_the_design() {
    let all = instrument_files("");
    let parts = |name: &str| all.iter().filter(|(_, code)| code.contains(&format!("impl {name} {{"))).count();
    let (_, hub) = all.iter().find(|(path, _)| path.ends_with("instrument/mod.rs")).expect("the instrument");
    let of_instrument = fields(hub, "Instrument");
    assert!(of_instrument.len() <= 8, "{of_instrument:?}");
    assert!(parts("Instrument") <= 5, "the instrument itself only joins the rooms");
    for (room, used) in ROOMS {
        let name = format!("{}{}", room[..1].to_uppercase(), &room[1..]);
        let files = instrument_files(room);
        let own = files.iter().filter(|(_, code)| code.contains(&format!("impl {name} {{"))).count();
        assert!(
            own <= 5 && own == parts(&name),
            "{name} stands in {own} files of its own, {} in all",
            parts(&name)
        );
        for (path, code) in files {
            for field in
                if code.contains(&format!("struct {name} {{")) { fields(&code, &name) } else { Vec::new() }
            {
                assert!(!field.starts_with("pub"), "{path}: {field}: a room's fields are its own");
            }
            if path.ends_with("tests.rs") {
                continue;
            }
            for (other, _) in ROOMS.iter().filter(|(other, _)| *other != room) {
                for prefix in ["super::", "instrument::"] {
                    for (at, path_of_other) in code.match_indices(&format!("{prefix}{other}::")) {
                        let item = &code[at + path_of_other.len()..];
                        let is_face = item.starts_with(|first: char| first.is_uppercase() || first == '{');
                        assert!(used.contains(other) && is_face, "{path} reaches into {other}");
                    }
                }
            }
            let names = code.split(|character: char| !character.is_alphanumeric() && character != '_');
            assert!(
                !names.into_iter().any(|name| name == "Instrument"),
                "{path}: a room knows no instrument"
            );
        }
    }
}
