//! The call of the program: its words become a [`Cli`], or are refused in the program's voice.

use super::command::Cli;
use super::examples;
use super::failure::Failure;
use super::output;
use super::refusal::Refusal;
use super::version;
use clap::error::ErrorKind;
use clap::{CommandFactory as _, FromArgMatches as _};
use std::ffi::OsString;

/// Whether these words ask for JSON, also where the rest of them is refused.
pub fn asks_for_json(words: &[OsString]) -> bool {
    words.iter().take_while(|word| *word != "--").any(|word| word == "--json")
}

impl Cli {
    /// The arguments of these words, the program's name first; help and version are printed, and end the program.
    ///
    /// # Errors
    /// [`Failure`] with exit code 2: the argument that is refused, as it is written, and what is allowed.
    pub fn of_words(words: &[OsString]) -> Result<Self, Failure> {
        let matches =
            command().try_get_matches_from(words).map_err(|error| refused(error, asks_for_json(words)))?;
        let mut cli = Self::from_arg_matches(&matches).map_err(|error| refused(error, false))?;
        if let Some((_, options)) = matches.subcommand() {
            // Not every command has it.
            cli.may_replace = options.try_get_one("force").is_ok_and(|force| force == Some(&true));
        }
        Ok(cli)
    }
}

/// The command line with the examples of each command at the end of its help.
fn command() -> clap::Command {
    Cli::command().mut_subcommands(|command| {
        let Some(examples) = examples::help(command.get_name()) else { return command };
        let text = command.get_after_help().map_or(String::new(), |text| format!("{text}\n\n"));
        command.after_help(text + &examples)
    })
}

/// A refusal of the parser: its text without the parser's own voice.
fn refused(error: clap::Error, as_json: bool) -> Failure {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        // Help and version end the program.
        let printed = if as_json && error.kind() == ErrorKind::DisplayVersion {
            version::print()
        } else {
            output::print_of_parser(&error)
        };
        match printed {
            Ok(()) => std::process::exit(0),
            Err(failure) => return failure,
        }
    }
    let text = error.render().to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let text = text.split("\n\nFor more information").next().unwrap_or_default().trim_end().to_owned();
    match Refusal::of_argument(&error, text.clone()) {
        Some(refusal) => Failure::Refused(Box::new(refusal)),
        None => Failure::Usage(text),
    }
}
