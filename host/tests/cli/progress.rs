//! The progress of a long command: a bar on a terminal, nothing on a pipe.
#![cfg(target_os = "linux")]

use super::terminal::terminal;
use super::{file, signal, slipline};
use std::io::Read as _;
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// A plate of two metres, on which a table takes seconds: a preset's may end before a bar is due.
fn long_plate(name: &str) -> String {
    let mut plate = slipline_plate::preset("al-bending").unwrap().to_toml();
    for (field, value) in
        [("length_m", 2.0), ("rate_per_m", 0.77), ("span_start_m", 1.2), ("span_end_m", 1.65)]
    {
        let line = plate.lines().find(|line| line.starts_with(&format!("{field} = "))).unwrap().to_owned();
        plate = plate.replace(&line, &format!("{field} = {value:?}"));
    }
    let path = file(name);
    std::fs::write(&path, plate).unwrap();
    path.into_os_string().into_string().unwrap()
}
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
        let (ours, theirs) = terminal();
        let mut command = Command::new(env!("CARGO_BIN_EXE_slipline"));
        command.args(arguments).env("TERM", "xterm").stdout(Stdio::null()).stderr(theirs);
        let child = command.spawn().unwrap();
        // Only the command keeps the terminal's other side open: when it ends, reading ends.
        drop(command);
        let shown = Arc::new(Mutex::new(Vec::new()));
        let reader = std::thread::spawn({
            let (shown, mut ours) = (Arc::clone(&shown), ours);
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

    /// Its complete output and the signal that ended it.
    fn ended(mut self) -> (String, Option<i32>) {
        let signal = self.child.wait().unwrap().signal();
        self.reader.join().unwrap();
        let shown = String::from_utf8_lossy(&self.shown.lock().unwrap()).into_owned();
        (shown, signal)
    }
}

#[test]
fn a_terminal_shows_a_bar_that_is_gone_in_the_end() {
    let command = OnTerminal::begun(&["table", "--plate", &long_plate("bar.toml")]);
    assert!(command.is_shown(" %"), "{:?}", command.shown());
    let (shown, _) = command.ended();
    let (bar, last) = shown.rsplit_once(CLEARED).unwrap();
    assert!(bar.contains("table"), "{shown:?}");
    // The result, on the other stream, begins on the empty line.
    assert_eq!(last, "", "{shown:?}");
    assert!(!shown.contains("\u{1b}[?25l"), "the cursor is left alone");
}

#[test]
fn a_pipe_shows_no_progress_bar() {
    let output = slipline(&["table", "--plate", &long_plate("pipe.toml")]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(!error.contains('%') && !error.contains('\u{1b}'), "{error:?}");
}

#[test]
fn a_signal_removes_the_progress_bar_from_the_terminal() {
    // A command that a signal ends at once, and a drive that has not begun yet.
    let plate = long_plate("signal.toml");
    let table = ["table", "--plate", &plate];
    let drive = ["drive", "--port", "sim", "--plate", &plate, "--turning-point", "1.4m"];
    // A million plates.
    let folder = file("signal-study");
    std::fs::create_dir_all(&folder).unwrap();
    let spec = folder.join("study.toml").into_os_string().into_string().unwrap();
    let million = include_str!("../../assets/study.toml").replace("count = 1000", "count = 1000000");
    std::fs::write(&spec, million).unwrap();
    let out = folder.join("study.csv").into_os_string().into_string().unwrap();
    let study = ["study", &spec, "--out", &out];
    for arguments in [&table[..], &drive, &study] {
        let command = OnTerminal::begun(arguments);
        assert!(command.is_shown(" %"), "{:?}", command.shown());
        signal(command.child.id(), "-INT");
        let (shown, number) = command.ended();
        assert_eq!(number, Some(2), "{arguments:?}");
        assert!(shown.ends_with(CLEARED), "{arguments:?}: {shown:?}");
    }
    let left: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["study.toml"], "no part of a file is left");
    std::fs::remove_dir_all(folder).unwrap();
}
