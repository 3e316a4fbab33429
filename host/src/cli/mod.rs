//! The command line: every use of Slipline except the window.
//!
//! JSON numbers are SI and their names end in the unit. Exit codes: 0 done; 1 failed; 2 bad usage or a bad
//! file (the message names it and the allowed range); 3 `check` or `selftest` is done and found red lights. A signal ends the
//! program by itself. Existing files are replaced with `--force` only.

mod argument;
mod board;
mod calibrate;
mod calibrated;
mod call;
mod check;
mod command;
mod completions;
mod defaults;
mod design;
mod design_argument;
mod destination;
mod device;
mod differs;
mod drive;
mod drive_wait;
mod envelope_file;
mod examples;
mod failure;
mod feeling;
mod figure_file;
mod figures;
mod followed_drive;
mod harmonics;
mod hold;
mod images;
mod info;
mod input_lines;
mod known_drive;
mod likely_unit;
mod manual;
mod measure;
mod measured_file;
mod measuring;
mod merit;
mod output;
mod page;
mod presets;
mod profile;
mod progress;
mod record;
mod refusal;
mod renamed;
mod respond;
mod rig;
mod schema;
mod selftest;
mod sensor_places;
mod serve;
mod setup_source;
mod simulate;
mod source;
mod study;
mod sweep;
mod table;
mod texture;
mod tones;
mod touch;
mod trim;
mod udev;
mod verify;
mod version;
mod watch;

pub use call::asks_for_json;
pub use command::{Cli, Command};
pub use examples::EXAMPLES;
pub use failure::Failure;
pub use output::{note, trace_to_file, trace_to_standard_output};
pub use schema::SCHEMA;
