//! A signal while a device is driven: the device is stopped and disarmed first.

use super::file;
use slipline_link::native::system_clock;
use slipline_link::protocol::{Command as Message, Decoder};
use slipline_link::simulator::realtime::{RealtimeDevice, RealtimeLine};
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::transport::{Transport, Waker};
use std::io::{Read, Write};
use std::os::unix::net::UnixListener;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// A simulated device behind a socket, for one host, and the commands it has received.
struct Socket {
    path: PathBuf,
    sent: Arc<Mutex<Vec<Message>>>,
}

impl Socket {
    fn serve(name: &str) -> Self {
        let path = file(name);
        let listener = UnixListener::bind(&path).unwrap();
        let sent = Arc::<Mutex<Vec<Message>>>::default();
        let seen = Arc::clone(&sent);
        std::thread::spawn(move || {
            let device = RealtimeDevice::new(SimulatedDevice::new(Options::default()), system_clock());
            let mut device = RealtimeLine::new(Arc::new(Mutex::new(device)), Waker::new(|| ()));
            let (mut host, _) = listener.accept().unwrap();
            host.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
            let mut decoder = Decoder::new();
            let mut bytes = [0; 512];
            loop {
                match host.read(&mut bytes) {
                    Ok(0) => return,
                    Ok(count) => {
                        for &byte in &bytes[..count] {
                            let command =
                                decoder.push(byte, |frame| Message::decode(frame.header.id, frame.body).ok());
                            seen.lock().unwrap().extend(command.flatten());
                        }
                        let mut rest = &bytes[..count];
                        while !rest.is_empty() {
                            rest = &rest[device.write(rest).unwrap_or(0)..];
                        }
                    }
                    Err(_) => {}
                }
                while let Ok(count @ 1..) = device.read(&mut bytes) {
                    if host.write_all(&bytes[..count]).is_err() {
                        return;
                    }
                }
            }
        });
        Self { path, sent }
    }

    /// Runs a command on it, up to the answer to its first drive.
    fn driven_by(&self, arguments: &str) -> Child {
        let mut child = Command::new(env!("CARGO_BIN_EXE_slipline"))
            .args(arguments.split(' '))
            .args(["--port", &format!("unix:{}", self.path.display())])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while self.last(|command| matches!(command, Message::Drive(_))).is_none() {
            assert!(begun.elapsed() < Duration::from_secs(60), "nothing is driven");
            assert!(child.try_wait().unwrap().is_none(), "it has ended");
            std::thread::sleep(Duration::from_millis(5));
        }
        // The device's answer has to reach the command: until then a signal interrupts it, with another exit code.
        let driven = self.last(|command| matches!(command, Message::Drive(_)));
        while self.last(|command| matches!(command, Message::Status)) < driven {
            assert!(begun.elapsed() < Duration::from_secs(60), "the drive is not answered");
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(200));
        child
    }

    /// The index of the last such command among those received.
    fn last(&self, is_it: impl Fn(&Message) -> bool) -> Option<usize> {
        self.sent.lock().unwrap().iter().rposition(is_it)
    }
}

fn signal(child: &Child, signal: &str) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

#[test]
fn a_signal_stops_and_disarms_the_device() {
    // The exit codes: a drive ends normally with Ctrl-C; verify has no result.
    for (arguments, code) in [("drive --plate membrane --boundary 120mm", 0), ("verify --window 250ms", 130)]
    {
        for told in ["-INT", "-TERM"] {
            let command = arguments.split(' ').next().unwrap();
            let socket = Socket::serve(&format!("{command}{told}"));
            let child = socket.driven_by(arguments);
            let begun = Instant::now();
            signal(&child, told);
            let output = child.wait_with_output().unwrap();
            let error = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(code), "{command} {told}: {error}");
            assert_eq!(error, "", "{command} {told}");
            assert!(
                begun.elapsed() < Duration::from_secs(4),
                "{command} {told}: it was not waited for in vain"
            );
            let driven = socket.last(|sent| matches!(sent, Message::Drive(_))).unwrap();
            let sent = socket.sent.lock().unwrap();
            let afterwards = &sent[driven + 1..];
            let stopped = afterwards.iter().rposition(|sent| matches!(sent, Message::Stop));
            let disarmed = afterwards.iter().rposition(|sent| matches!(sent, Message::Disarm));
            assert!(stopped.is_some() && stopped < disarmed, "{command} {told}: {afterwards:?}");
            drop(sent);
            std::fs::remove_file(&socket.path).unwrap();
        }
    }
}
