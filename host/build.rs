//! The version that the program names, with the commit where it is built from the project's git tree.
//!
//! A package of crates and a copy without git have no commit, so that they build to the same bytes anywhere. Only this crate asks
//! git: the images of the boards have no part in it.
//!
//! With the features `page` and `images` it also lists the files of the built page and of the boards' images, which then are in
//! the program.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    // Without another path named, a change of any file of the crate would run this again.
    println!("cargo:rerun-if-changed=build.rs");
    let version = env!("CARGO_PKG_VERSION");
    let commit = commit().unwrap_or_default();
    let in_brackets = if commit.is_empty() { String::new() } else { format!(" ({commit})") };
    println!("cargo:rustc-env=SLIPLINE_COMMIT={commit}");
    println!("cargo:rustc-env=SLIPLINE_VERSION={version}{in_brackets}");
    for folder in [
        Included { feature: "page", of: "/// The page in the program", makes: ".ci/page", has: "index.html" },
        Included {
            feature: "images",
            of: "/// The images in the program",
            makes: ".ci/images",
            has: "SHA256SUMS",
        },
    ] {
        let name = folder.feature.to_uppercase();
        if std::env::var_os(format!("CARGO_FEATURE_{name}")).is_some()
            && let Err(why) = folder.include()
        {
            println!(
                "cargo::error=the feature {} needs SLIPLINE_{name}_FOLDER, a folder that {} has built: {why}",
                folder.feature, folder.makes
            );
        }
    }
}

/// A folder whose files are in the program by a feature; SLIPLINE_.._FOLDER names it.
struct Included {
    feature: &'static str,
    of: &'static str,
    makes: &'static str,
    /// A file by which the folder is known.
    has: &'static str,
}

impl Included {
    /// Writes the list of the folder's files, with their bytes. Their places are read by the compiler and are not in the program.
    fn include(&self) -> Result<(), String> {
        let error = |error: std::io::Error| error.to_string();
        let variable = format!("SLIPLINE_{}_FOLDER", self.feature.to_uppercase());
        println!("cargo:rerun-if-env-changed={variable}");
        let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("no OUT_DIR")?);
        let folder = std::env::var_os(variable).ok_or("it is not set")?;
        // This script and the program's file are compiled in different folders.
        let folder = std::fs::canonicalize(folder).map_err(error)?;
        println!("cargo:rerun-if-changed={}", folder.display());
        let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
            .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
            .map_err(error)?;
        files.sort();
        if !files.iter().any(|file| file.ends_with(self.has)) {
            return Err(format!("it has no {}", self.has));
        }
        let mut list = format!("{}: names and bytes.\nconst BUILT_IN: &[(&str, &[u8])] = &[\n", self.of);
        // Of a file and its copy packed by `gzip` the program holds the packed one.
        let packed: BTreeSet<PathBuf> = files
            .iter()
            .filter(|file| file.extension().is_some_and(|end| end == "gz"))
            .map(|file| file.with_extension(""))
            .collect();
        for file in files.iter().filter(|file| !packed.contains(*file)) {
            let name = file.file_name().and_then(|name| name.to_str()).ok_or("a name that is no text")?;
            let place = file.to_str().ok_or("a place that is no text")?;
            let _ = writeln!(list, "    ({name:?}, include_bytes!({place:?})),");
        }
        list.push_str("];\n");
        // The name of the file of this list, for each feature: page_files.rs, image_files.rs.
        let name = format!("{}_files.rs", self.feature.trim_end_matches('s'));
        std::fs::write(out.join(name), list).map_err(error)
    }
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
