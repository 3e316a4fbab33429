//! `slipline manual`: the pages of `man`, one for the program and one for each command.

use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::output;
use clap::{Args, Command};
use clap_mangen::Man;
use serde_json::json;
use std::io::Write as _;
use std::path::PathBuf;

/// `manual`.
#[derive(Debug, Args)]
pub struct ManualArguments {
    /// Folder for the pages, which is created if needed: slipline.1, slipline-drive.1 and so on.
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    out: PathBuf,
    /// Whether existing files may be replaced.
    #[command(flatten)]
    force: ForceArgument,
}

/// Writes the pages of `program`.
pub(super) fn run(arguments: &ManualArguments, program: Command, as_json: bool) -> Result<(), Failure> {
    let pages = pages(program).map_err(Failure::failed)?;
    let names: Vec<_> = pages.iter().map(|(name, _)| name.as_str()).collect();
    let files = Destination::folder(&arguments.out, &names, arguments.force)?;
    for (file, (_, page)) in files.iter().zip(&pages) {
        file.write(|out| Ok(out.write_all(page)?))?;
    }
    output::print(as_json, &json!({ "files": Destination::names(&files) }), |out| {
        writeln!(out, "{} pages are in {}", files.len(), arguments.out.display())
    })
}

/// The pages, each with the name of its file.
fn pages(program: Command) -> std::io::Result<Vec<(String, Vec<u8>)>> {
    // The version stands in the head of each page; a date would differ from day to day.
    let version = program.get_version().unwrap_or_default().to_owned();
    let mut program = program.disable_help_subcommand(true);
    program.build();
    let of = |command: Command| -> std::io::Result<_> {
        // Of a command its name after the program's: slipline-drive.
        let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
        let mut page = Vec::new();
        let man = Man::new(command).title(name.to_uppercase()).source(format!("Slipline {version}"));
        man.manual("Slipline").render(&mut page)?;
        Ok((format!("{name}.1"), page))
    };
    let commands: Vec<_> = program.get_subcommands().cloned().collect();
    std::iter::once(program).chain(commands).map(of).collect()
}
