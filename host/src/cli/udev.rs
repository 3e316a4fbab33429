//! `slipline udev`: what lets the user open a board on Linux.

use super::failure::Failure;
use super::output;
use serde_json::json;
use slipline_link::udev;

/// Prints the rules, whose comment has the two lines that install them.
pub(super) fn run(as_json: bool) -> Result<(), Failure> {
    let lines: Vec<_> = udev::install_lines().collect();
    // JSON `install_lines`, text: Lines of a shell that install the rules
    // JSON `rules`, text: Rules of udev, as they are installed
    let value = json!({ "rules": udev::RULES, "install_lines": lines });
    output::print(as_json, &value, |out| write!(out, "{}", udev::RULES))
}
