//! `slipline --version --json`: the version, its commit, and how this program was installed.

use super::failure::Failure;
use super::output;
use serde_json::json;
use std::path::Path;

/// How a program was installed, by what lies around it. Each package manager leaves its own records beside the file:
///
/// | way | records |
/// |---|---|
/// | `deb` | the package's documents, of a program in `/usr/bin` |
/// | `wheel` | `slipline-*.dist-info` in the environment's `site-packages` |
/// | `cargo` | `.crates.toml` beside the folder `bin` |
/// | `source` | `.cargo-lock`, in a target folder of cargo |
/// | `archive` | none of these |
fn installed_by(program: &Path, documents: &Path) -> &'static str {
    let Some(folder) = program.parent() else { return "archive" };
    let around = folder.parent().unwrap_or(folder);
    if folder == Path::new("/usr/bin") && documents.is_dir() {
        "deb"
    } else if is_in_environment(around) {
        "wheel"
    } else if around.join(".crates.toml").is_file() {
        "cargo"
    } else if folder.join(".cargo-lock").is_file() {
        "source"
    } else {
        "archive"
    }
}

/// Whether the package of Python lies in this environment: in `lib/python3.*/site-packages`, on Windows in `Lib/site-packages`.
fn is_in_environment(environment: &Path) -> bool {
    let names = |folder: &Path| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).collect::<Vec<_>>()
    };
    let is_ours = |path: &Path| {
        path.file_name()
            .and_then(|name| name.to_str())
            .is_some_and(|name| name.starts_with("slipline-") && name.ends_with(".dist-info"))
    };
    let libraries = ["lib", "Lib"].map(|name| environment.join(name));
    let pythons = libraries.iter().flat_map(|library| names(library)).chain(libraries.clone());
    pythons.flat_map(|python| names(&python.join("site-packages"))).any(|path| is_ours(&path))
}

/// Prints the version as JSON.
pub(super) fn print() -> Result<(), Failure> {
    let commit = Some(env!("SLIPLINE_COMMIT")).filter(|commit| !commit.is_empty());
    let program = std::env::current_exe().and_then(|path| path.canonicalize()).map_err(Failure::failed)?;
    let value = json!({
        // JSON of --version, text: Version of the program
        "version": env!("CARGO_PKG_VERSION"),
        // JSON, text: Commit that the program was built from; null where it was built outside the project's tree
        "commit": commit,
        // JSON, text: deb, wheel, cargo, source or archive: by the records around the program
        "installed": installed_by(&program, Path::new("/usr/share/doc/slipline")),
        // JSON, text: File of the program that runs
        "program": program.display().to_string(),
    });
    output::print(true, &value, |_| Ok(()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    /// An empty folder of this name.
    fn empty(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("slipline-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn the_way_of_installation_is_read_from_the_records_around_the_program() {
        let root = empty("installed");
        let documents = root.join("doc");
        let usr = Path::new("/usr/bin/slipline");
        assert_eq!(installed_by(usr, &documents), "archive");
        std::fs::create_dir(&documents).unwrap();
        assert_eq!(installed_by(usr, &documents), "deb");
        for (record, way) in [
            ("bin/slipline.txt", "archive"),
            ("lib/python3.12/site-packages/slipline-0.1.0.dist-info/METADATA", "wheel"),
            ("Lib/site-packages/slipline-0.1.0.dist-info/METADATA", "wheel"),
            ("lib/python3.12/site-packages/another-0.1.0.dist-info/METADATA", "archive"),
            (".crates.toml", "cargo"),
            ("bin/.cargo-lock", "source"),
        ] {
            let environment = empty("environment");
            let record = environment.join(record);
            std::fs::create_dir_all(record.parent().unwrap()).unwrap();
            std::fs::write(record, "").unwrap();
            // A package beside which another copy lies is not that one's.
            assert_eq!(installed_by(&environment.join("bin/slipline"), &documents), way, "{way}");
            std::fs::remove_dir_all(environment).unwrap();
        }
        std::fs::remove_dir_all(root).unwrap();
    }
}
