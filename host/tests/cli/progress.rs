//! The progress of a long command: a bar on a terminal, nothing on a pipe.
#![cfg(target_os = "linux")]

use super::slipline;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use std::fs::{File, OpenOptions};
use std::io::Read as _;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Takes more than a second on the fastest machine.
const LONG: [&str; 3] = ["check", "--plate", "al-bending"];
/// Moves to the line's beginning and clears the line.
const CLEARED: &str = "\r\u{1b}[2K";

/// A command whose error stream is a terminal.
struct OnTerminal {
    child: Child,
    shown: Arc<Mutex<Vec<u8>>>,
    reader: std::thread::JoinHandle<()>,
}

impl OnTerminal {
    fn begun(arguments: &[&str]) -> Self {
        let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&ours).unwrap();
        unlockpt(&ours).unwrap();
        let name = ptsname(&ours, Vec::new()).unwrap().into_string().unwrap();
        let theirs = OpenOptions::new().read(true).write(true).open(name).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_slipline"));
        command.args(arguments).env("TERM", "xterm").stdout(Stdio::null()).stderr(theirs);
        let child = command.spawn().unwrap();
        // Only the command keeps the terminal's other side open: when it ends, reading ends.
        drop(command);
        let shown = Arc::new(Mutex::new(Vec::new()));
        let reader = std::thread::spawn({
            let (shown, mut ours) = (Arc::clone(&shown), File::from(ours));
            move || {
                let mut bytes = [0; 1024];
                while let Ok(count @ 1..) = ours.read(&mut bytes) {
                    shown.lock().unwrap().extend_from_slice(&bytes[..count]);
                }
            }
        });
        Self { child, shown, reader }
    }

    fn shown(&self) -> String {
        String::from_utf8_lossy(&self.shown.lock().unwrap()).into_owned()
    }

    fn is_shown(&self, part: &str) -> bool {
        let begun = Instant::now();
        while begun.elapsed().as_secs() < 60 {
            if self.shown().contains(part) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        false
    }

    /// Its complete output and its exit code.
    fn ended(mut self) -> (String, Option<i32>) {
        let code = self.child.wait().unwrap().code();
        self.reader.join().unwrap();
        let shown = String::from_utf8_lossy(&self.shown.lock().unwrap()).into_owned();
        (shown, code)
    }
}

#[test]
fn a_terminal_shows_a_bar_that_is_gone_in_the_end() {
    let command = OnTerminal::begun(&LONG);
    assert!(command.is_shown(" %"), "{:?}", command.shown());
    let (shown, _) = command.ended();
    let (bar, last) = shown.rsplit_once(CLEARED).unwrap();
    assert!(bar.contains("check") && !last.contains('%'), "{shown:?}");
    // The result begins on the empty line.
    assert!(last.starts_with("slipline: ") && last.ends_with(" red\r\n"), "{shown:?}");
    assert!(!shown.contains("\u{1b}[?25l"), "the cursor is left alone");
}

#[test]
fn a_pipe_shows_no_progress_bar() {
    let output = slipline(&LONG);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(!told.contains('%') && !told.contains('\u{1b}'), "{told:?}");
}

#[test]
fn a_signal_removes_the_progress_bar_from_the_terminal() {
    // A command that a signal ends at once, and a drive that has not begun yet.
    let drive = ["drive", "--port", "sim", "--plate", "al-bending", "--boundary", "250mm"];
    for arguments in [&LONG[..], &drive] {
        let command = OnTerminal::begun(arguments);
        assert!(command.is_shown(" %"), "{:?}", command.shown());
        let told = Command::new("kill").args(["-INT", &command.child.id().to_string()]).status().unwrap();
        assert!(told.success());
        let (shown, code) = command.ended();
        assert_eq!(code, Some(130), "{arguments:?}");
        assert!(shown.ends_with(CLEARED), "{arguments:?}: {shown:?}");
    }
}
