//! `slipline figures`.

use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::output;
use clap::Args;
use serde_json::json;
use slipline_model::export::figures::{Format, paper_figure};
use slipline_plate::{paper, physics};
use std::io::Write as _;
use std::path::PathBuf;

/// `figures`.
#[derive(Debug, Args)]
pub struct FiguresArguments {
    /// The folder to write into; it is created if needed.
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgument,
}

pub(super) fn run(arguments: &FiguresArguments, as_json: bool) -> Result<(), Failure> {
    let mut figures = paper::figures().map_err(Failure::failed)?;
    figures.extend(physics::figures().map_err(Failure::failed)?);
    let names: Vec<String> = figures
        .iter()
        .flat_map(|figure| ["svg", "png", "csv"].map(|ending| format!("{}.{ending}", figure.stem)))
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let files = Destination::folder(&arguments.out, &names, arguments.force)?;
    let mut written = Vec::new();
    for (figure, files) in figures.iter().zip(files.chunks_exact(3)) {
        let [svg, png, csv] = files else { continue };
        let drawing = paper_figure(figure);
        let painted = drawing.file(Format::Png).map_err(Failure::failed)?;
        svg.write(|out| Ok(out.write_all(drawing.svg().as_bytes())?))?;
        png.write(|out| Ok(out.write_all(&painted)?))?;
        csv.write(|out| Ok(out.write_all(figure.to_csv().as_bytes())?))?;
        written.push((figure, [svg, png, csv].map(|file| file.path().display().to_string())));
    }
    let entries = written.iter().map(|(figure, [svg, png, csv])| {
        // JSON `csv`, text: File with the numbers of the figure
        // JSON `number`, count: Number of the paper's figure; null for other figures
        // JSON `png`, text: File with the figure as a picture
        // JSON `svg`, text: File with the figure as vectors
        // JSON `title`, text: Title of the figure
        json!({ "number": figure.number, "name": figure.stem, "title": figure.title, "svg": svg, "png": png, "csv": csv })
    });
    let value = json!({
        "figures": entries.collect::<Vec<_>>(),
        "files": Destination::names(&files),
    });
    output::print(as_json, &value, |out| {
        for (figure, paths) in &written {
            writeln!(out, "{}", figure.heading())?;
            for path in paths {
                writeln!(out, "  {path}")?;
            }
        }
        Ok(())
    })
}
