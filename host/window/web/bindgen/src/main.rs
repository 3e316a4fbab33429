//! Writes the script that loads the page's WebAssembly, and the WebAssembly as the script needs it.
//!
//! `slipline-page-bindgen FILE.wasm FOLDER`: run by `.ci/page`.

#![forbid(unsafe_code)]
#![warn(clippy::expect_used, clippy::unwrap_used)]

use anyhow::Context as _;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args_os().skip(1);
    let input = arguments.next().context("no WebAssembly is named")?;
    let folder = arguments.next().context("no folder is named")?;
    Bindgen::new().input_path(input).web(true)?.typescript(false).generate(folder)
}
