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

/// Every Rust file of a folder and those below it, files of unit tests left out.
///
/// # Panics
/// If the folder cannot be read.
#[must_use]
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.file_stem().is_some_and(|stem| stem == "tests") {
            continue;
        }
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}
