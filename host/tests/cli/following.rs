//! `slipline drive --stdin`: a drive that follows lines; without the option standard input is not touched.

use super::piped;
use super::signals::{HANG, Socket};
use serde_json::Value;
use slipline_link::protocol::Command as Message;
use slipline_link::protocol::command::Drive;
use std::io::{BufRead, BufReader, Read as _, Write as _};
use std::process::{Child, ChildStdin, Command};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// A drive that follows lines, on a device that keeps what it was sent.
struct Following {
    child: Child,
    socket: Socket,
    lines: Option<ChildStdin>,
    answers: Receiver<Value>,
}

impl Following {
    fn begun(name: &str, arguments: &str) -> Self {
        let socket = Socket::serve(&format!("following-{name}"));
        let drive = "drive --json --stdin --plate membrane --port unix:";
        let mut child = piped(format!("{drive}{} {arguments}", socket.path.display()).split(' '));
        let (heard, answers) = channel();
        let output = BufReader::new(child.stdout.take().unwrap());
        std::thread::spawn(move || {
            for line in output.lines().map_while(Result::ok) {
                let _ = heard.send(serde_json::from_str(&line).unwrap());
            }
        });
        let lines = child.stdin.take();
        let following = Self { child, socket, lines, answers };
        following.drives(1);
        following
    }

    /// Its drives, once there are this many.
    fn drives(&self, count: usize) -> Vec<Drive> {
        let begun = Instant::now();
        loop {
            let sent = self.socket.sent();
            let mut drives: Vec<Drive> = sent
                .iter()
                .filter_map(|sent| if let Message::Drive(drive) = sent { Some(drive.clone()) } else { None })
                .collect();
            // The link asks a slow device again.
            drives.dedup();
            if drives.len() >= count {
                return drives;
            }
            assert!(begun.elapsed() < HANG, "{} drives", drives.len());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn write(&mut self, text: &str) {
        self.lines.as_mut().unwrap().write_all(text.as_bytes()).unwrap();
    }

    /// The next line of its output.
    fn answer(&self) -> Value {
        self.answers.recv_timeout(HANG).unwrap()
    }

    /// Its last line and its error stream, after the end of its input; it must end with 0.
    fn end(mut self) -> (Value, String, Vec<Message>) {
        drop(self.lines.take());
        let status = self.child.wait().unwrap();
        let mut error = String::new();
        self.child.stderr.take().unwrap().read_to_string(&mut error).unwrap();
        assert_eq!(status.code(), Some(0), "{error}");
        let last = self.answers.iter().last().unwrap();
        std::fs::remove_file(&self.socket.path).unwrap();
        (last, error, self.socket.sent())
    }
}

fn place_m(answer: &Value, field: &str) -> f64 {
    answer["tones"][0][field].as_f64().unwrap_or_else(|| panic!("{answer}"))
}

#[test]
fn a_drive_follows_lines_without_silence_and_their_end_stops_it() {
    let mut following = Following::begun("all", "--turning-point 120mm --level 0.8");
    following.write("turning-point 160mm\n\n");
    let moved = following.answer();
    assert!((place_m(&moved, "turning_point_m") - 0.16).abs() < 1e-9 && moved["line"] == 1, "{moved}");
    // What comes in pieces, with the ends of another system.
    following.write("glide 50ms\r\nfelt-e");
    following.write("dge 250mm:0.7\r\n");
    let felt = following.answer();
    assert!((place_m(&felt, "felt_edge_m") - 0.25).abs() < 1e-5 && felt["line"] == 4, "{felt}");
    assert_eq!((place_m(&felt, "level"), &felt["glide_s"]), (0.7, &0.05.into()));
    // The felt edge stays where the level changes.
    following.write("level 0.5\n");
    let quieter = following.answer();
    assert!((place_m(&quieter, "felt_edge_m") - 0.25).abs() < 1e-5, "{quieter}");
    assert!(place_m(&quieter, "turning_point_m") > place_m(&felt, "turning_point_m") + 1e-3, "{quieter}");
    let drives = following.drives(4);
    let glides: Vec<u32> = drives.iter().map(|drive| drive.glide).collect();
    assert_eq!(glides, [8_000, 8_000, 20_000, 20_000]);
    assert!(drives.iter().all(|drive| drive.tones.len() == 1 && drive.tones[0].slot == 0), "{drives:?}");
    let (last, error, sent) = following.end();
    assert_eq!((error.as_str(), &last["ended_by"]), ("", &"input".into()));
    assert_eq!(last["tones"], quieter["tones"]);
    assert!(last["stopped_at_samples"].as_u64() > quieter["at_samples"].as_u64(), "{last}");
    // Nothing between the drives, and the device is disarmed behind its stop.
    let mut acts: Vec<&Message> = sent
        .iter()
        .filter(|sent| matches!(sent, Message::Drive(_) | Message::Stop | Message::Disarm))
        .collect();
    acts.dedup();
    let [Message::Drive(_), Message::Drive(_), Message::Drive(_), Message::Drive(_), stops @ ..] = &acts[..]
    else {
        panic!("{acts:?}")
    };
    assert!(
        matches!(stops, [Message::Stop, .., Message::Disarm] | [Message::Stop, Message::Disarm, ..]),
        "{acts:?}"
    );
}

#[test]
fn a_bad_line_is_refused_and_changes_nothing() {
    let mut following = Following::begun("bad", "--felt-edge 250mm --level 0.8");
    let bad = [
        ("felt-egde 210mm", "must be felt-edge PLACE, turning-point PLACE, level LEVEL, glide TIME or stop"),
        ("felt-edge 9m", "invalid value '9m' for 'felt-edge': must be "),
        ("turning-point 9m", "invalid value '9m' for 'turning-point': must be 80 to 280 mm"),
        ("felt-edge 250mm 260mm", "2 places: must be 1 to 1"),
        ("level 1.5", "0 to 1"),
        ("glide 1h", "'1h' for 'glide'"),
        ("stop it", "or stop"),
        ("\u{1b}[2J\0", "'\u{fffd}[2J\u{fffd}'"),
    ];
    for (line, _) in bad {
        following.write(&format!("{line}\n"));
    }
    following.write("level 0.7\n");
    let answer = following.answer();
    assert!((place_m(&answer, "felt_edge_m") - 0.25).abs() < 1e-5, "{answer}");
    assert_eq!((place_m(&answer, "level"), &answer["line"]), (0.7, &9.into()));
    assert_eq!(following.drives(2).len(), 2, "the first drive and the good line");
    let (_, error, _) = following.end();
    assert_eq!(error.lines().count(), bad.len(), "{error}");
    for ((number, line), (_, words)) in (1..).zip(error.lines()).zip(bad) {
        let refusal: Value = serde_json::from_str(line).unwrap();
        assert_eq!(refusal["line"], number, "{line}");
        assert!(refusal["error"].as_str().unwrap().contains(words), "{words}: {line}");
    }
}

#[test]
fn a_line_ends_the_drive_and_what_follows_it_stays() {
    let mut following = Following::begun("stop", "--turning-point 120mm:0.4 --turning-point 200mm:0.3");
    // One place moves the first tone only, two move both.
    following.write("turning-point 130mm\nturning-point 140mm 210mm:0.1\nlevel 0.2\nstop\nlevel 2\n");
    let first = following.answer();
    let places = |answer: &Value| {
        let of = |tone: &Value| (1e3 * tone["turning_point_m"].as_f64().unwrap()).round();
        answer["tones"].as_array().unwrap().iter().map(of).collect::<Vec<_>>()
    };
    assert_eq!(places(&first), [130.0, 200.0]);
    let second = following.answer();
    assert_eq!((places(&second), &second["tones"][1]["level"]), (vec![140.0, 210.0], &0.1.into()));
    let third = following.answer();
    assert_eq!((&third["tones"][0]["level"], &third["tones"][1]["level"]), (&0.2.into(), &0.1.into()));
    let (last, error, _) = following.end();
    assert_eq!((error.as_str(), &last["ended_by"]), ("", &"stop".into()));
    assert_eq!(last["tones"], third["tones"]);
}

#[test]
fn a_loop_around_drives_keeps_its_lines() {
    let script = "printf 'a\\nb\\nc\\n' | while read line; do \
                  \"$0\" drive --port sim --plate membrane --turning-point 120mm --for 1ms > /dev/null; echo $line; done";
    let output = Command::new("sh").args(["-c", script, env!("CARGO_BIN_EXE_slipline")]).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout), "a\nb\nc\n");
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn lines_and_a_file_cannot_both_be_standard_input() {
    let message = super::failure(
        &["drive", "--port", "sim", "--plate", "membrane", "--turning-point", "120mm", "--stdin", "--hold"],
        2,
    );
    assert!(message.contains("cannot be used with"), "{message}");
    let plate = slipline_plate::preset("membrane").unwrap().to_toml();
    let (code, message) = super::streams::fed(
        &["drive", "--port", "sim", "--plate", "-", "--turning-point", "120mm", "--stdin"],
        plate.as_bytes(),
    );
    assert!(code == Some(2) && message.1.contains("--stdin follows standard input"), "{message:?}");
}
