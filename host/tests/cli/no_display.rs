//! Without a display the program ends with a message that says so.
#![cfg(all(feature = "gui", target_os = "linux"))]

use super::program;

/// The message and exit code of the program, with these variables and no other that names a display.
pub(crate) fn start(arguments: &[&str], variables: &[(&str, &str)]) -> (String, Option<i32>) {
    let mut command = program(arguments);
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let output = command.envs(variables.iter().copied()).output().unwrap();
    (String::from_utf8(output.stderr).unwrap(), output.status.code())
}

#[test]
fn without_a_display_the_error_says_what_to_do_and_names_no_folder_of_the_build() {
    for (variables, what) in [
        (&[][..], "there is no display to open a window on: neither WAYLAND_DISPLAY nor DISPLAY is set."),
        (&[("DISPLAY", ""), ("WAYLAND_DISPLAY", "")], "neither WAYLAND_DISPLAY nor DISPLAY is set."),
        (&[("DISPLAY", ":4711")], "the display DISPLAY=:4711 does not answer: "),
        (&[("WAYLAND_DISPLAY", "nowhere-7")], "the display WAYLAND_DISPLAY=nowhere-7 does not answer: "),
    ] {
        let (error, code) = start(&[], variables);
        assert_eq!(code, Some(1), "{error}");
        assert!(error.starts_with("slipline: ") && error.contains(what), "{error}");
        assert!(error.contains("set WAYLAND_DISPLAY or DISPLAY"), "{error}");
        assert!(error.contains("The command line needs no display: see slipline --help."), "{error}");
        assert!(!error.contains(".rs") && !error.contains("registry"), "{error}");
    }
}
