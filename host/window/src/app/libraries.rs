//! Libraries that the window opens at run time: which of them this system lacks, by the Debian packages that have them.
//!
//! winit and glutin open them by name, so no loader reports them when the program starts, and winit panics about some.

use std::path::{Path, PathBuf};

/// What a window on an X server opens, and the Debian package of each. `README.md` and the package's dependencies list the same.
const LIBRARIES: [(&str, &str); 6] = [
    ("libGL.so.1", "libgl1"),
    ("libEGL.so.1", "libegl1"),
    ("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"),
    ("libXcursor.so.1", "libxcursor1"),
    ("libXi.so.6", "libxi6"),
    ("libX11-xcb.so.1", "libx11-xcb1"),
];
/// In the same folder on a system whose loader searches these folders. Elsewhere nothing is said of the others.
const OF_EVERY_PROGRAM: &str = "libc.so.6";

/// A sentence that names the packages of what is missing, if anything is.
pub(super) fn lacking() -> Option<String> {
    let packages = packages_of_missing(&folders());
    (!packages.is_empty()).then(|| {
        format!(
            "the window needs libraries that are not installed; on Debian and Ubuntu: apt install {}\nThe command line needs none \
             of them: see slipline --help.",
            packages.join(" ")
        )
    })
}

/// The folders that the system's loader searches.
fn folders() -> Vec<PathBuf> {
    let named = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let mut folders: Vec<PathBuf> = std::env::split_paths(&named).collect();
    let entries = |folder: &str| std::fs::read_dir(folder).into_iter().flatten().flatten();
    for file in entries("/etc/ld.so.conf.d") {
        let text = std::fs::read_to_string(file.path()).unwrap_or_default();
        folders.extend(text.lines().filter(|line| line.starts_with('/')).map(PathBuf::from));
    }
    folders.extend(["/lib", "/usr/lib", "/lib64", "/usr/lib64"].map(PathBuf::from));
    folders
}

/// The Debian packages of the libraries that are in none of these folders.
fn packages_of_missing(folders: &[PathBuf]) -> Vec<&'static str> {
    let is_there = |name: &str| folders.iter().any(|folder: &PathBuf| Path::new(folder).join(name).exists());
    if !is_there(OF_EVERY_PROGRAM) {
        return Vec::new();
    }
    LIBRARIES.iter().filter(|(name, _)| !is_there(name)).map(|(_, package)| *package).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_packages_of_missing_libraries_are_named_where_the_loader_s_folders_are_known() {
        let folder = std::env::temp_dir().join(format!("slipline-libraries-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).expect("a folder");
        let folders = [folder.clone()];
        for name in ["libGL.so.1", "libXi.so.6", "libX11-xcb.so.1"] {
            std::fs::write(folder.join(name), "").expect("a file");
        }
        assert!(packages_of_missing(&folders).is_empty(), "a system with other folders");
        std::fs::write(folder.join(OF_EVERY_PROGRAM), "").expect("a file");
        assert_eq!(packages_of_missing(&folders), ["libegl1", "libxkbcommon-x11-0", "libxcursor1"]);
        std::fs::remove_dir_all(folder).expect("removed");
    }
}
