//! What is served: the files of a folder, or those that were built into the program.

use super::super::failure::Failure;
use flate2::read::GzDecoder;
use std::borrow::Cow;
use std::io::Read as _;
use std::path::{Path, PathBuf};

#[cfg(feature = "page")]
include!(concat!(env!("OUT_DIR"), "/page_files.rs"));
/// The page in the program: none.
#[cfg(not(feature = "page"))]
const BUILT_IN: &[(&str, &[u8])] = &[];

/// Where the README's command builds the page, from the project's folder.
const BUILT: &str = "target/page";
/// The file of the address that ends with a slash.
const INDEX: &str = "index.html";

/// The files of a page.
#[derive(Debug)]
pub(super) enum Contents {
    BuiltIn,
    Folder(PathBuf),
}

impl Contents {
    /// The page of this folder, else that of the program, else the one that was built here.
    pub(super) fn find(folder: Option<&Path>) -> Result<Self, Failure> {
        let holds_page = |folder: &Path| folder.join(INDEX).is_file();
        match folder {
            Some(folder) if holds_page(folder) => Ok(Self::Folder(folder.to_owned())),
            Some(folder) => {
                let allowed = format!("a folder with a built page, which has {INDEX}; .ci/page builds one");
                Err(Failure::value("--folder <FOLDER>", &folder.display().to_string(), allowed))
            }
            None if !BUILT_IN.is_empty() => Ok(Self::BuiltIn),
            None if holds_page(Path::new(BUILT)) => Ok(Self::Folder(BUILT.into())),
            None => Err(Failure::Usage(format!(
                "there is no page in this program and none in {BUILT}: build it by .ci/page in the project's folder, or name a \
                 built one by --folder"
            ))),
        }
    }

    /// The folder, unless the files are in the program.
    pub(super) fn folder(&self) -> Option<&Path> {
        match self {
            Self::BuiltIn => None,
            Self::Folder(folder) => Some(folder),
        }
    }

    /// The name of the file that an address means; `None` where it is no address of a page, such as one that would lead out
    /// of the folder. Names of a page's files need no escapes.
    pub(super) fn named(address: &str) -> Option<String> {
        let path = address.split(['?', '#']).next()?.strip_prefix('/')?;
        let (folders, last) =
            path.rsplit_once('/').map_or((None, path), |(folders, last)| (Some(folders), last));
        let last = if last.is_empty() { INDEX } else { last };
        let is_plain = |part: &str| {
            let is_in_names = |byte: u8| byte.is_ascii_alphanumeric() || b"._-".contains(&byte);
            !part.is_empty() && !part.starts_with('.') && part.bytes().all(is_in_names)
        };
        let mut parts = folders.into_iter().flat_map(|folders| folders.split('/')).chain([last]);
        parts.clone().all(is_plain).then(|| parts.by_ref().collect::<Vec<_>>().join("/"))
    }

    /// The file of this name as `gzip` has packed it, if it was built so.
    pub(super) fn read_packed(&self, name: &str) -> Option<Cow<'static, [u8]>> {
        self.stored(&format!("{name}.gz"))
    }

    /// The bytes of the file of this name, unpacked where only the packed one is there; `None` where there is none.
    pub(super) fn read(&self, name: &str) -> Option<Cow<'static, [u8]>> {
        self.stored(name).or_else(|| {
            let mut bytes = Vec::new();
            GzDecoder::new(&*self.read_packed(name)?).read_to_end(&mut bytes).ok()?;
            Some(Cow::Owned(bytes))
        })
    }

    fn stored(&self, name: &str) -> Option<Cow<'static, [u8]>> {
        match self {
            Self::BuiltIn => {
                let (_, bytes) = BUILT_IN.iter().find(|(of, _)| *of == name)?;
                Some(Cow::Borrowed(bytes))
            }
            Self::Folder(folder) => std::fs::read(folder.join(name)).ok().map(Cow::Owned),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_means_a_file_below_the_folder() {
        for (address, name) in [
            ("/", "index.html"),
            ("/?a=1", "index.html"),
            ("/page.0123456789abcdef.js", "page.0123456789abcdef.js"),
            ("/fonts/", "fonts/index.html"),
            ("/fonts/a-b_c.ttf?x#y", "fonts/a-b_c.ttf"),
        ] {
            assert_eq!(Contents::named(address).as_deref(), Some(name), "{address}");
        }
        for address in [
            "",
            "index.html",
            "//etc/passwd",
            "/../Cargo.toml",
            "/fonts/../../Cargo.toml",
            "/%2e%2e/Cargo.toml",
            "/.git/config",
            "/..\\Cargo.toml",
            "/c:/x",
            "http://elsewhere/",
            "/a\0b",
            "/ü",
        ] {
            assert_eq!(Contents::named(address), None, "{address}");
        }
    }
}
