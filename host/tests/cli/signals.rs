//! A signal while a device is driven: the device is stopped and disarmed first.

use super::{file, piped, signal};
use slipline_link::native::system_clock;
use slipline_link::protocol::version::Minor;
use slipline_link::protocol::{Command as Message, Decoder, Event};
use slipline_link::simulator::realtime::{RealtimeDevice, RealtimeLine};
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::transport::{Transport, Waker};
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixListener;
use std::os::unix::process::ExitStatusExt as _;
use std::path::PathBuf;
use std::process::{Child, Command};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Time limit that only a hang reaches. No test asserts how long anything took.
pub(crate) const HANG: Duration = Duration::from_secs(120);

/// A simulated device behind a socket, for one host, and what has gone past.
pub(crate) struct Socket {
    pub(crate) path: PathBuf,
    line: Arc<Mutex<Line>>,
}

#[derive(Default)]
struct Line {
    /// The commands that the device has received.
    sent: Vec<Message>,
    /// The number of the last drive, and whether the device has answered it.
    drive: Option<u16>,
    is_answered: bool,
}

impl Line {
    fn take_command(&mut self, command: Message, sequence: u16) {
        if matches!(command, Message::Drive(_)) {
            self.is_answered &= self.drive == Some(sequence);
            self.drive = Some(sequence);
        }
        self.sent.push(command);
    }

    fn take_event(&mut self, event: &Event, sequence: u16) {
        self.is_answered |= event.accepted_at().is_some() && self.drive == Some(sequence);
    }
}

impl Socket {
    pub(crate) fn serve(name: &str) -> Self {
        Self::serve_altered(name, |_| ())
    }

    /// With the device's answers changed on their way to the host.
    pub(crate) fn serve_altered(name: &str, alter: fn(&mut Event)) -> Self {
        let path = file(name);
        let listener = UnixListener::bind(&path).unwrap();
        let line = Arc::<Mutex<Line>>::default();
        let seen = Arc::clone(&line);
        std::thread::spawn(move || {
            let device = RealtimeDevice::new(SimulatedDevice::new(Options::default()), system_clock());
            let mut device = RealtimeLine::new(Arc::new(Mutex::new(device)), Waker::new(|| ()));
            let (mut host, _) = listener.accept().unwrap();
            host.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
            let (mut from_host, mut from_device) = (Decoder::new(), Decoder::new());
            let mut bytes = [0; 512];
            loop {
                match host.read(&mut bytes) {
                    Ok(0) => return,
                    Ok(count) => {
                        for &byte in &bytes[..count] {
                            from_host.push(byte, |frame| {
                                if let Ok(command) = Message::decode(frame.header.id, frame.body) {
                                    seen.lock().unwrap().take_command(command, frame.header.sequence);
                                }
                            });
                        }
                        let mut rest = &bytes[..count];
                        while !rest.is_empty() {
                            rest = &rest[device.write(rest).unwrap_or(0)..];
                        }
                    }
                    Err(_) => {}
                }
                while let Ok(count @ 1..) = device.read(&mut bytes) {
                    let mut answers = Vec::new();
                    for &byte in &bytes[..count] {
                        from_device.push(byte, |frame| {
                            let (session, sequence) = (frame.header.session, frame.header.sequence);
                            let mut event = Event::decode(frame.header.id, frame.body).unwrap();
                            seen.lock().unwrap().take_event(&event, sequence);
                            alter(&mut event);
                            answers.extend(event.frame_for(Minor::OURS, session, sequence).unwrap());
                        });
                    }
                    if host.write_all(&answers).is_err() {
                        return;
                    }
                }
            }
        });
        Self { path, line }
    }

    /// The commands that the device has received.
    pub(crate) fn sent(&self) -> Vec<Message> {
        self.line.lock().unwrap().sent.clone()
    }

    /// Runs a command on it until its first drive is answered, and until it has `said` something if it says anything
    /// while it drives.
    fn driven_by(&self, arguments: &str, said: Option<&'static str>) -> Child {
        let mut child = piped(format!("{arguments} --port unix:{}", self.path.display()).split(' '));
        let begun = Instant::now();
        while !self.line.lock().unwrap().is_answered {
            assert!(begun.elapsed() < HANG, "nothing is driven");
            assert!(child.try_wait().unwrap().is_none(), "it has ended");
            std::thread::sleep(Duration::from_millis(5));
        }
        if let Some(said) = said {
            let (heard, hears) = channel();
            let output = BufReader::new(child.stdout.take().unwrap());
            std::thread::spawn(move || {
                let lines = output.lines().map_while(Result::ok);
                lines.filter(|line| line.contains(said)).for_each(|_| {
                    let _ = heard.send(());
                });
            });
            hears.recv_timeout(HANG).unwrap_or_else(|_| panic!("it never says '{said}'"));
        }
        child
    }
}

/// The signals, by the options of `kill` and by their names. Tests started with nohup cannot make their children
/// receive SIGHUP again.
fn kinds() -> Vec<(&'static str, i32, &'static str)> {
    let all = [("-INT", 2, "SIGINT"), ("-TERM", 15, "SIGTERM"), ("-HUP", 1, "SIGHUP")];
    let is_heard = |option: &str| option != "-HUP" || !super::files::ignores_hangup("self");
    all.into_iter().filter(|(option, ..)| is_heard(option)).collect()
}

#[test]
fn a_signal_stops_and_disarms_the_device() {
    // Both end by the signal itself: a drive after its own report, verify without a result.
    for (arguments, said) in [
        ("drive --plate membrane --turning-point 120mm", Some("until Ctrl-C")),
        ("verify --window 250ms", None),
    ] {
        for (option, number, _) in kinds() {
            let command = arguments.split(' ').next().unwrap();
            let socket = Socket::serve(&format!("{command}{option}"));
            let child = socket.driven_by(arguments, said);
            signal(child.id(), option);
            let output = child.wait_with_output().unwrap();
            let error = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.signal(), Some(number), "{command} {option}: {error}");
            assert_eq!(error, "", "{command} {option}");
            let line = socket.line.lock().unwrap();
            let driven = line.sent.iter().rposition(|sent| matches!(sent, Message::Drive(_))).unwrap();
            let afterwards = &line.sent[driven + 1..];
            let stopped = afterwards.iter().position(|sent| matches!(sent, Message::Stop));
            let disarmed = afterwards.iter().rposition(|sent| matches!(sent, Message::Disarm));
            assert!(stopped.is_some() && stopped < disarmed, "{command} {option}: {afterwards:?}");
            // verify notices the stop by itself and sends its own, before the disarming or after it; nothing arms again.
            assert!(
                !afterwards.iter().any(|sent| matches!(sent, Message::Arm | Message::ArmFor(_))),
                "{command} {option}"
            );
            // It ends then without waiting; a wait would show as further keep-alives.
            let kept =
                afterwards[disarmed.unwrap()..].iter().filter(|sent| matches!(sent, Message::KeepAlive(_)));
            assert!(kept.count() < 5, "{command} {option}: {afterwards:?}");
            drop(line);
            std::fs::remove_file(&socket.path).unwrap();
        }
    }
}

#[test]
fn a_drive_that_is_cut_short_writes_what_json_promises_and_what_ended_it() {
    for (option, number, name) in kinds() {
        let socket = Socket::serve(&format!("json{option}"));
        let arguments = "drive --json --plate membrane --turning-point 120mm --for 60s";
        let child = socket.driven_by(arguments, None);
        // The link drops a program that has given no sign of life for a second: after seven it has begun to wait.
        let begun = Instant::now();
        let kept = || socket.sent().iter().filter(|sent| matches!(sent, Message::KeepAlive(_))).count();
        let before = kept();
        while kept() < before + 7 {
            assert!(begun.elapsed() < HANG, "no signs of life");
            std::thread::sleep(Duration::from_millis(5));
        }
        signal(child.id(), option);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.signal(), Some(number), "{option}");
        let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(value["ended_by"], name);
        assert!(value["driven_s"].as_f64() < Some(60.0), "{value}");
        assert!(value["stopped_at_samples"].as_u64() > value["at_samples"].as_u64(), "{value}");
        std::fs::remove_file(&socket.path).unwrap();
    }
}

/// The terminal's Ctrl-C.
#[cfg(target_os = "linux")]
const CTRL_C: u8 = 3;

#[test]
#[cfg(target_os = "linux")]
fn a_shell_loop_of_drives_ends_at_the_first_ctrl_c() {
    let socket = Socket::serve("loop");
    let (mut ours, theirs) = super::terminal::terminal();
    let program = env!("CARGO_BIN_EXE_slipline");
    let drive = "drive --plate membrane --turning-point 120mm --for 60s --port";
    let script = format!("while :; do {program} {drive} unix:{}; echo again; done", socket.path.display());
    // The shell gets the terminal as its own, whose Ctrl-C goes to all that run in it. It does not ignore Ctrl-C, even if
    // the tests do: a script has started them in the background.
    let mut command = Command::new("setsid");
    let shell = ["--ctty", "env", "--default-signal=INT", "bash", "-c", &script];
    command.args(shell).stdin(theirs.try_clone().unwrap());
    let mut child = command.stdout(theirs.try_clone().unwrap()).stderr(theirs).spawn().unwrap();
    drop(command);
    let (sends, shown) = channel();
    let mut reads = ours.try_clone().unwrap();
    std::thread::spawn(move || {
        let mut bytes = [0; 512];
        while let Ok(count @ 1..) = reads.read(&mut bytes) {
            let _ = sends.send(String::from_utf8_lossy(&bytes[..count]).into_owned());
        }
    });
    let mut text = String::new();
    while !text.contains("Driving for 60 s.") {
        text.push_str(&shown.recv_timeout(HANG).unwrap_or_else(|_| panic!("it drives: {text}")));
    }
    ours.write_all(&[CTRL_C]).unwrap();
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        text.extend(shown.recv_timeout(Duration::from_millis(5)));
        if text.contains("again") || begun.elapsed() > HANG {
            child.kill().unwrap();
            panic!("the loop goes on: {text}");
        }
    };
    assert_eq!(status.signal(), Some(2), "{text}");
    // Nobody else has the terminal: reading ends.
    while let Ok(more) = shown.recv_timeout(HANG) {
        text.push_str(&more);
    }
    assert!(text.contains("Stopped by SIGINT after ") && !text.contains("again"), "{text}");
    let sent = socket.sent();
    let last = |is_it: fn(&Message) -> bool| sent.iter().rposition(is_it);
    let [driven, stopped, disarmed] = [
        last(|sent| matches!(sent, Message::Drive(_))),
        last(|sent| matches!(sent, Message::Stop)),
        last(|sent| matches!(sent, Message::Disarm)),
    ];
    assert!(driven.is_some() && driven < stopped && stopped < disarmed, "{sent:?}");
    std::fs::remove_file(&socket.path).unwrap();
}
