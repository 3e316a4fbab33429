//! The version that the program names, with the commit where it is built from the project's git tree.
//!
//! A package of crates and a copy without git have no commit, so that they build to the same bytes anywhere. Only this crate asks
//! git: the images of the boards have no part in it.
//!
//! With the feature `page` it also lists the files of the built page, which then are in the program.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    // Without another path named, a change of any file of the crate would run this again.
    println!("cargo:rerun-if-changed=build.rs");
    let version = env!("CARGO_PKG_VERSION");
    let commit = commit().map_or(String::new(), |commit| format!(" ({commit})"));
    println!("cargo:rustc-env=SLIPLINE_VERSION={version}{commit}");
    if std::env::var_os("CARGO_FEATURE_PAGE").is_some()
        && let Err(why) = include_page()
    {
        println!(
            "cargo::error=the feature page needs SLIPLINE_PAGE_FOLDER, a folder that .ci/page has built: {why}"
        );
    }
}

/// Writes the list of the page's files, with their bytes. Their places are read by the compiler and are not in the program.
fn include_page() -> Result<(), String> {
    let error = |error: std::io::Error| error.to_string();
    println!("cargo:rerun-if-env-changed=SLIPLINE_PAGE_FOLDER");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("no OUT_DIR")?).join("page_files.rs");
    let folder = std::env::var_os("SLIPLINE_PAGE_FOLDER").ok_or("it is not set")?;
    // This script and the program's file are compiled in different folders.
    let folder = std::fs::canonicalize(folder).map_err(error)?;
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
        .map_err(error)?;
    files.sort();
    if !files.iter().any(|file| file.ends_with("index.html")) {
        return Err("it has no index.html".to_owned());
    }
    let mut list =
        "/// The page in the program: names and bytes.\nconst BUILT_IN: &[(&str, &[u8])] = &[\n".to_owned();
    for file in files {
        let name = file.file_name().and_then(|name| name.to_str()).ok_or("a name that is no text")?;
        let place = file.to_str().ok_or("a place that is no text")?;
        let _ = writeln!(list, "    ({name:?}, include_bytes!({place:?})),");
    }
    list.push_str("];\n");
    std::fs::write(out, list).map_err(error)
}

/// The commit of the project's own tree; `None` without one, or if the crate only lies in the tree of something else.
fn commit() -> Option<String> {
    git(&["ls-files", "--error-unmatch", "Cargo.toml", "../shared/Cargo.toml"])?;
    let commit = git(&["rev-parse", "--short=10", "HEAD"])?;
    let watched = |name: &str| git(&["rev-parse", "--git-path", name]);
    let branch = git(&["symbolic-ref", "--quiet", "HEAD"]);
    // A new commit changes the branch's file; if the branch is packed, it adds a line to the log of HEAD.
    let branch = branch.and_then(|branch| watched(&branch)).filter(|path| Path::new(path).is_file());
    let head = ["HEAD", "logs/HEAD"].iter().take(if branch.is_some() { 1 } else { 2 });
    for path in head.filter_map(|name| watched(name)).chain(branch).filter(|path| Path::new(path).is_file()) {
        println!("cargo:rerun-if-changed={path}");
    }
    Some(commit)
}

/// The output of a git command; `None` if it fails or there is no git.
fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
