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
