//! The workspace's own files, for the tests of its layout and of what its sources say.

use std::path::{Path, PathBuf};

/// The folders of the product's sources, from the root.
pub const PRODUCT: [&str; 14] = [
    "shared/src",
    "firmware/app/src",
    "firmware/dds/src",
    "firmware/stm32/src",
    "firmware/qemu/src",
    "host/src",
    "host/link/src",
    "host/model/src",
    "host/instrument/src",
    "host/plate/src",
    "host/window/src",
    "host/window/web/src",
    "host/window/web/bindgen/src",
    "host/python/src",
];

/// The workspace's root.
///
/// # Panics
/// If `tests/` does not lie in the workspace.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests/ lies in the workspace").to_owned()
}

/// The name of a file of the tree from its root, with `/` between the folders.
///
/// # Panics
/// If it is no file of the tree.
#[must_use]
pub fn relative(file: &Path) -> String {
    file.strip_prefix(root()).expect("in the tree").to_string_lossy().replace('\\', "/")
}

/// Every file of a folder and those below it whose name ends in one of these ways, without what programs have made.
///
/// # Panics
/// If the folder cannot be read.
#[must_use]
pub fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            if !["target", ".venv", "__pycache__", "node_modules"].contains(&name.as_str()) {
                found.extend(files(&path, endings));
            }
        } else if endings.iter().any(|ending| name.ends_with(ending)) {
            found.push(path);
        }
    }
    found
}

/// Every Rust file of a folder and those below it, files of unit tests left out.
///
/// # Panics
/// If the folder cannot be read.
#[must_use]
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let is_of_tests = |file: &Path| {
        let mut parts = file.strip_prefix(folder).expect("below").iter();
        parts.any(|part| Path::new(part).file_stem().is_some_and(|stem| stem == "tests"))
    };
    files(folder, &[".rs"]).into_iter().filter(|file| !is_of_tests(file)).collect()
}
