//! `slipline images`: the boards' images that releases of the program hold.

use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::output;
use clap::Args;
use serde_json::json;
use std::io::Write as _;
use std::path::PathBuf;

#[cfg(feature = "images")]
include!(concat!(env!("OUT_DIR"), "/image_files.rs"));
/// The images in the program: none.
#[cfg(not(feature = "images"))]
const BUILT_IN: &[(&str, &[u8])] = &[];

/// SHA-256 of the image of a board's firmware, if the program holds the image of this build.
pub(super) fn sha256_of(board: &str, build: &str) -> Option<String> {
    sha256_in(BUILT_IN, board, build)
}

/// The same in these files: that of the file that a board is flashed with, which names its board and its build.
fn sha256_in(files: &[(&str, &[u8])], board: &str, build: &str) -> Option<String> {
    let names =
        |bytes: &[u8], text: &str| bytes.windows(text.len().max(1)).any(|part| part == text.as_bytes());
    let of_build = |(name, bytes): &&(&str, &[u8])| {
        let is_flashed = (name.ends_with(".bin") || name.ends_with(".dfu")) && !name.contains("factory-new");
        is_flashed && names(bytes, board) && names(bytes, build)
    };
    let (name, _) = files.iter().find(of_build)?;
    let (_, sums) = files.iter().find(|(name, _)| *name == "SHA256SUMS")?;
    let line = |line: &&str| line.split_whitespace().nth(1) == Some(name);
    let sum = std::str::from_utf8(sums).ok()?.lines().find(line)?.split_whitespace().next()?;
    Some(sum.to_owned())
}

/// `images`.
#[derive(Debug, Args)]
pub struct ImagesArguments {
    /// Folder for the images, which is created if needed. Without this option they are listed.
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Whether existing files may be replaced.
    #[command(flatten)]
    force: ForceArgument,
}

/// Lists the images of the program, or writes them.
pub(super) fn run(arguments: &ImagesArguments, as_json: bool) -> Result<(), Failure> {
    let names: Vec<_> = BUILT_IN.iter().map(|(name, _)| *name).collect();
    if names.is_empty() && arguments.out.is_some() {
        return Err(Failure::usage(
            "there are no images in this program: releases have them, and .ci/images FOLDER in the project's folder builds them",
        ));
    }
    let files = match &arguments.out {
        Some(folder) => Destination::folder(folder, &names, arguments.force)?,
        None => Vec::new(),
    };
    for (file, (_, bytes)) in files.iter().zip(BUILT_IN) {
        file.write(|out| Ok(out.write_all(bytes)?))?;
    }
    // JSON `images`, text: Files of the boards' images in the program; none in a build that is no release
    let value = json!({ "images": names, "files": Destination::names(&files) });
    output::print(as_json, &value, |out| match &arguments.out {
        Some(folder) => writeln!(out, "{} images are in {}", names.len(), folder.display()),
        None if names.is_empty() => writeln!(out, "There are no images in this program: releases have them."),
        None => names.iter().try_for_each(|name| writeln!(out, "{name}")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_of_an_image_is_that_of_its_board_and_build() {
        let files: [(&str, &[u8]); 4] = [
            ("SHA256SUMS", b"11  slipline-a.bin\n22  slipline-b.dfu\n33  slipline-b-factory-new.bin\n"),
            ("slipline-a.bin", b"..board A..v0.1.0.."),
            ("slipline-b-factory-new.bin", b"..board B..v0.1.0.."),
            ("slipline-b.dfu", b"..board B..v0.1.0.."),
        ];
        assert_eq!(sha256_in(&files, "board B", "v0.1.0").as_deref(), Some("22"));
        assert_eq!(sha256_in(&files, "board B", "v0.2.0"), None);
        assert_eq!(sha256_in(&files, "board C", "v0.1.0"), None);
        assert_eq!(sha256_of("board A", "v0.1.0"), None, "this program holds no images");
    }
}
