//! Existing files, and a signal while a file is being written.

use super::{design, failure, file, piped, refused, slipline};
#[cfg(unix)]
use std::os::unix::process::ExitStatusExt as _;
#[cfg(unix)]
use std::path::PathBuf;
use std::process::Command;

#[test]
fn an_existing_file_is_replaced_only_when_asked() {
    let folder = file("kept");
    std::fs::create_dir_all(&folder).unwrap();
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (json, csv, png, wav, own) = (path("t.json"), path("e.csv"), path("e.png"), path("d.wav"), path(""));
    let simulate = ["simulate", "--plate", "membrane", "--turning-point", "120mm"];
    let record =
        ["record", "--plate", "membrane", "--turning-point", "120mm", "--seconds", "1ms", "--wav", &wav];
    let commands: [(Vec<&str>, &str); 4] = [
        (vec!["table", "--plate", "membrane", "--knots", "5", "--out", &json], "t.json"),
        ([&simulate[..], &["--csv", &csv]].concat(), "e.csv"),
        ([&simulate[..], &["--png", &png]].concat(), "e.png"),
        (record.to_vec(), "d.wav"),
    ];
    for (arguments, name) in &commands {
        std::fs::write(folder.join(name), "mine").unwrap();
        refused(arguments, 2, &[name, "--force"]);
        assert_eq!(std::fs::read(folder.join(name)).unwrap(), b"mine", "{name}");
        let output = slipline(&[&arguments[..], &["--force"]].concat());
        assert_eq!(output.status.code(), Some(0), "{name}");
        assert_ne!(std::fs::read(folder.join(name)).unwrap(), b"mine", "{name}");
    }
    // Files in a folder are kept in the same way: all or none are replaced.
    std::fs::write(folder.join("plate.toml"), "mine").unwrap();
    let output = design(&["--out", &own]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("holds plate.toml already") && message.contains("--force"), "{message}");
    assert!(!folder.join("frame.dxf").exists());
    assert_eq!(design(&["--out", &own, "--force"]).status.code(), Some(0));
    assert!(std::fs::read_to_string(folder.join("plate.toml")).unwrap().starts_with("name"));
    std::fs::write(folder.join("fig03.csv"), "mine").unwrap();
    assert!(failure(&["figures", "--out", &own], 2).contains("holds fig03.csv already"));
    let left: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().ends_with(".part")), "{left:?}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn of_commands_that_create_a_file_at_once_one_succeeds() {
    let path = file("at-once.json");
    let table = || {
        let out = ["table", "--plate", "membrane", "--out", path.to_str().unwrap()];
        piped(out)
    };
    let running: Vec<_> = (0..4).map(|_| table()).collect();
    let ended: Vec<_> = running.into_iter().map(|child| child.wait_with_output().unwrap()).collect();
    let wrote = ended.iter().filter(|output| String::from_utf8_lossy(&output.stdout).contains("Written to"));
    assert_eq!(wrote.count(), 1);
    for output in ended.iter().filter(|output| !output.status.success()) {
        let message = String::from_utf8_lossy(&output.stderr);
        // The last to begin may find it already.
        assert!(
            message.contains("at-once.json exists:") || message.contains("created by another"),
            "{message}"
        );
    }
    assert_eq!(ended.iter().filter(|output| output.status.success()).count(), 1);
    std::fs::remove_file(path).unwrap();
}

#[test]
#[cfg(unix)]
fn a_link_to_nothing_counts_as_an_existing_file() {
    let folder = file("links");
    std::fs::create_dir_all(&folder).unwrap();
    let (link, nothing) = (folder.join("fig03.csv"), folder.join("nothing"));
    std::os::unix::fs::symlink(&nothing, &link).unwrap();
    let table = ["table", "--plate", "membrane", "--knots", "5", "--out", link.to_str().unwrap()];
    assert!(failure(&table, 2).contains("is a link to a file that is missing: write --force"));
    assert!(failure(&["figures", "--out", folder.to_str().unwrap()], 2).contains("holds fig03.csv already"));
    assert!(link.is_symlink() && !nothing.exists());
    assert_eq!(slipline(&[&table[..], &["--force"]].concat()).status.code(), Some(0));
    std::fs::remove_dir_all(folder).unwrap();
}

/// A long recording over an existing file, ended by a signal while it is being written.
#[cfg(unix)]
struct Recording {
    folder: PathBuf,
    child: std::process::Child,
}

#[cfg(unix)]
impl Recording {
    /// Starts it through a shell, with these words before the command itself.
    fn begun(name: &str, shell: &str) -> Self {
        let folder = file(name);
        std::fs::create_dir_all(&folder).unwrap();
        let wav = folder.join("long.wav");
        std::fs::write(&wav, "mine").unwrap();
        let arguments = "record --plate membrane --turning-point 120mm --seconds 600s --force --wav";
        let mut command = Command::new("sh");
        command.args(["-c", &format!("{shell} exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_slipline")]);
        let child = command.args(arguments.split(' ')).arg(wav).spawn().unwrap();
        let recording = Self { folder, child };
        let begun = std::time::Instant::now();
        while recording.files() < 2 && begun.elapsed().as_secs() < 60 {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        assert_eq!(recording.files(), 2, "it is being written beside the old one");
        recording
    }

    fn files(&self) -> usize {
        std::fs::read_dir(&self.folder).unwrap().count()
    }

    fn signal(&self, signal: &str) {
        super::signal(self.child.id(), signal);
    }

    /// It ends by this signal, and only the old file exists.
    fn ends(mut self, signal: i32) {
        assert_eq!(self.child.wait().unwrap().signal(), Some(signal));
        assert_eq!(self.files(), 1);
        assert_eq!(std::fs::read(self.folder.join("long.wav")).unwrap(), b"mine");
        std::fs::remove_dir_all(self.folder).unwrap();
    }
}

/// Whether Linux says that a process ignores SIGHUP.
#[cfg(unix)]
pub(crate) fn ignores_hangup(process: &str) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() & 1 == 1)
}

#[cfg(unix)]
#[test]
fn a_signal_leaves_no_half_written_file_and_keeps_the_old_one() {
    for (signal, number) in [("-INT", 2), ("-TERM", 15), ("-HUP", 1)] {
        // Tests started with nohup cannot make their children receive SIGHUP again.
        if signal != "-HUP" || !ignores_hangup("self") {
            let recording = Recording::begun("interrupted", "");
            recording.signal(signal);
            recording.ends(number);
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_hangup_that_is_ignored_from_the_start_stays_ignored() {
    let recording = Recording::begun("outliving", "trap '' HUP;");
    assert!(ignores_hangup(&recording.child.id().to_string()));
    recording.signal("-HUP");
    recording.signal("-TERM");
    recording.ends(15);
}
