//! Options that have another name now; the old ones are taken for a release.

use super::command::Command;
use std::ffi::OsString;

/// Each command's old options and the ones in their place.
const RENAMED: [(&str, &str, &str); 9] = [
    ("simulate", "--seconds", "--for"),
    ("simulate", "--csv", "--out"),
    ("simulate", "--figure", "--out"),
    ("simulate", "--png", "--out"),
    ("record", "--seconds", "--for"),
    ("record", "--wav", "--out"),
    ("respond", "--figure", "--out"),
    ("sweep", "--time", "--for"),
    ("trim", "--watch", "--for"),
];

impl Command {
    /// One sentence for each old option among these arguments.
    #[must_use]
    #[expect(clippy::wildcard_enum_match_arm, reason = "most commands have no old options")]
    pub fn renamed(&self, arguments: &[OsString]) -> Vec<String> {
        let command = match self {
            Self::Simulate(_) => "simulate",
            Self::Record(_) => "record",
            Self::Respond(_) => "respond",
            Self::Sweep(_) => "sweep",
            Self::Trim(_) => "trim",
            _ => return Vec::new(),
        };
        let is_given = |old: &str| {
            let mut texts = arguments.iter().filter_map(|argument| argument.to_str());
            texts.any(|text| {
                text.strip_prefix(old).is_some_and(|rest| rest.is_empty() || rest.starts_with('='))
            })
        };
        let of_command = RENAMED.iter().filter(|(of, old, _)| *of == command && is_given(old));
        of_command
            .map(|(_, old, new)| format!("{old} of {command} is {new} now; the old name will go"))
            .collect()
    }
}
