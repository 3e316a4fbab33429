//! `slipline page`: serves the built page to browsers of this computer.

mod contents;
mod server;

use super::failure::Failure;
use super::output;
use crate::signals;
use clap::Args;
use contents::Contents;
use serde_json::json;
use server::PageServer;
use slipline_plate::quantity::only;
use std::net::SocketAddr;
use std::path::PathBuf;

/// `page`.
#[derive(Debug, Args)]
pub struct PageArguments {
    /// Folder of the built page. Without this option: the page in the program, which releases have, else target/page.
    #[arg(long, value_name = "FOLDER")]
    folder: Option<PathBuf>,
    /// Address of the page: a loopback address, 127.0.0.0 to 127.255.255.255 or [::1], and a port; with port 0 the
    /// system chooses one.
    #[arg(long, value_name = "ADDRESS", value_parser = loopback, default_value = "127.0.0.1:8765")]
    listen: SocketAddr,
}

/// Parses an address that no other computer reaches.
fn loopback(text: &str) -> Result<SocketAddr, String> {
    let parsed =
        text.trim().parse().ok().filter(|address: &SocketAddr| address.ip().to_canonical().is_loopback());
    // Serving other computers needs a server with a certificate; without one a browser has no service worker.
    let allowed = "an address that only this computer reaches, 127.0.0.0 to 127.255.255.255 or [::1], and a port, such as 127.0.0.1:8765";
    parsed.ok_or_else(|| only(allowed))
}

/// Serves until the program is interrupted.
pub(super) fn run(arguments: &PageArguments, as_json: bool) -> Result<(), Failure> {
    let contents = Contents::find(arguments.folder.as_deref())?;
    let server = PageServer::bind(arguments.listen)?;
    let ending = server.ending();
    let _closing = signals::end_normally_by(move || ending.end());
    let address = server.address();
    let folder = contents.folder().map(|folder| folder.display().to_string());
    // JSON `address`, text: Where a browser finds the page
    // JSON `folder`, text: Folder of the page; null where it is in the program
    output::print(as_json, &json!({ "address": address, "folder": folder }), |out| {
        let of = folder.as_deref().map_or(String::new(), |folder| format!(" of {folder}"));
        writeln!(out, "The page{of} is at {address}. Ctrl-C ends it.")
    })?;
    server.serve(&contents);
    Ok(())
}
