//! The version that the program names, with the commit where it is built from the project's git tree.
//!
//! A package of crates and a copy without git have no commit, so that they build to the same bytes anywhere. Only this crate asks
//! git: the images of the boards have no part in it.

use std::path::Path;
use std::process::Command;

fn main() {
    // Without another path named, a change of any file of the crate would run this again.
    println!("cargo:rerun-if-changed=build.rs");
    let version = env!("CARGO_PKG_VERSION");
    let commit = commit().map_or(String::new(), |commit| format!(" ({commit})"));
    println!("cargo:rustc-env=SLIPLINE_VERSION={version}{commit}");
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
