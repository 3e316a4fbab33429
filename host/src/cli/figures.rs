//! `slipline figures`.

use super::destination::{Destination, ForceArgument};
use super::{Failure, output};
use crate::figures::write_all;
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

/// `figures`.
#[derive(Debug, Args)]
pub struct FiguresArguments {
    /// The folder to write into; it is made if it is not there.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgument,
}

pub(super) fn run(arguments: &FiguresArguments, as_json: bool) -> Result<(), Failure> {
    // Every name a figure of the paper may have.
    let names: Vec<String> =
        (1..=99).flat_map(|n| [format!("fig{n:02}.png"), format!("fig{n:02}.csv")]).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Destination::folder(&arguments.out, &names, arguments.force)?;
    let written = write_all(&arguments.out).map_err(Failure::failed)?;
    output::print(as_json, &json!({ "figures": &written }), |out| {
        for figure in &written {
            writeln!(out, "Fig. {}: {}", figure.number, figure.title)?;
            writeln!(out, "  {}", figure.png.display())?;
            writeln!(out, "  {}", figure.csv.display())?;
        }
        Ok(())
    })
}
