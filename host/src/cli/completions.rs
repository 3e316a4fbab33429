//! `slipline completions`: the completion of words in a shell.

use super::failure::Failure;
use super::output;
use clap::Args;
use clap_complete::Shell;
use serde_json::json;

/// `completions`.
#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell: its script goes to the standard output.
    #[arg(value_name = "SHELL", value_enum)]
    shell: Shell,
}

/// Prints the script by which a shell completes the words of `program`.
pub(super) fn run(
    arguments: &CompletionsArguments,
    mut program: clap::Command,
    as_json: bool,
) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut program, "slipline", &mut script);
    let script = String::from_utf8(script).map_err(Failure::failed)?;
    // JSON `script`, text: The script
    // JSON `shell`, text: The shell
    let value = json!({ "shell": arguments.shell.to_string(), "script": script });
    output::print(as_json, &value, |out| write!(out, "{script}"))
}
