//! Ends the program after a signal: Ctrl-C, on Unix also SIGTERM, and SIGHUP unless it is ignored (nohup).
//! All endings pass through one place, so that no driven device and no incomplete file remains. The program then ends
//! by the signal itself, so that a shell's loop around it ends, too.
//!
//! ```text
//! signal --> does the command have its own orderly end (drive, serve, the window)?
//!              yes: it is asked to end, stops its device, reports, and returns by itself --> by the signal
//!                                                        (serve, page, watch, whose only end it is: --> exit code 0)
//!              no, it takes too long, or a second signal comes:
//!                   devices stopped and disarmed --> temporary files removed -------------> by the signal
//! ```

use slipline_link::native::Handle;
use slipline_link::{LinkState, Request};
use slipline_model::atomic_file;
use std::io;
use std::process;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Time limit for a command with its own orderly end.
const CLOSING: Duration = Duration::from_secs(5);
/// Time limit for a device to acknowledge stop and disarm. Without a host it stops by itself.
const STOPPING: Duration = Duration::from_secs(1);

/// A signal that ends the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Signal {
    /// Ctrl-C.
    Interrupt,
    /// As `kill` sends it.
    #[cfg_attr(not(unix), expect(dead_code, reason = "there is Ctrl-C only"))]
    Terminate,
    /// The terminal is closed.
    #[cfg_attr(not(unix), expect(dead_code, reason = "there is Ctrl-C only"))]
    HangUp,
}

impl Signal {
    /// Its name, in text and JSON.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Interrupt => "SIGINT",
            Self::Terminate => "SIGTERM",
            Self::HangUp => "SIGHUP",
        }
    }

    const fn number(self) -> i32 {
        match self {
            Self::Interrupt => 2,
            Self::Terminate => 15,
            Self::HangUp => 1,
        }
    }

    /// Ends the program as the signal does by default; with 128 + its number where signals do not exist.
    fn end_program(self) -> ! {
        #[cfg(unix)]
        let _ = signal_hook::low_level::emulate_default_handler(self.number());
        process::exit(128 + self.number())
    }
}

/// How a command with its own orderly end leaves the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Leaving {
    BySignal,
    /// With its own exit code, because a signal is its only end.
    ByItself,
}

/// A command's own orderly end.
struct Closing {
    number: u64,
    leaving: Leaving,
    close: Box<dyn FnMut() + Send>,
}

/// The actions before the program ends.
struct Endings {
    /// Devices to stop, by number.
    devices: Vec<(u64, Handle)>,
    close: Option<Closing>,
    /// The last action.
    last: Option<fn()>,
    /// The last number given.
    count: u64,
    is_ending: bool,
    /// The signal by which the program ends.
    by: Option<Signal>,
}

static ENDINGS: Mutex<Endings> = Mutex::new(Endings {
    devices: Vec::new(),
    close: None,
    last: None,
    count: 0,
    is_ending: false,
    by: None,
});

fn endings() -> MutexGuard<'static, Endings> {
    ENDINGS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Registers an action before the program ends; dropping it removes the action.
#[must_use]
pub(crate) struct Ending(u64);

impl Drop for Ending {
    fn drop(&mut self) {
        let mut endings = endings();
        endings.devices.retain(|(number, _)| *number != self.0);
        endings.close.take_if(|close| close.number == self.0);
    }
}

/// Registers a device to be stopped and disarmed before the program ends.
pub(crate) fn stop_before_end(device: Handle) -> Ending {
    hold_while_ending();
    let mut endings = endings();
    endings.count += 1;
    let number = endings.count;
    endings.devices.push((number, device));
    Ending(number)
}

/// Registers `close`, which is called on a signal. It must stop the device and let the program return from its
/// main function, which ends by the signal ([`end_by_signal`]).
pub(crate) fn end_by(close: impl FnMut() + Send + 'static) -> Ending {
    register(Leaving::BySignal, Box::new(close))
}

/// As [`end_by`], for a command whose only end is a signal: the program ends with its exit code.
pub(crate) fn end_normally_by(close: impl FnMut() + Send + 'static) -> Ending {
    register(Leaving::ByItself, Box::new(close))
}

fn register(leaving: Leaving, close: Box<dyn FnMut() + Send>) -> Ending {
    hold_while_ending();
    let mut endings = endings();
    endings.count += 1;
    let number = endings.count;
    endings.close = Some(Closing { number, leaving, close });
    Ending(number)
}

/// The signal by which the program ends, if one has come.
pub(crate) fn ended_by() -> Option<Signal> {
    endings().by
}

/// Ends the program by the signal that has ended its command, if one has. The main function calls it last.
pub fn end_by_signal() {
    if let Some(signal) = ended_by() {
        signal.end_program();
    }
}

/// Registers the window: on a signal its device is stopped at once, then the window stores its state and
/// returns. For the window's `run`.
#[cfg(feature = "gui")]
pub fn end_window(device: Handle, mut close: Box<dyn FnMut() + Send>) {
    let stop = device.clone();
    let closing = end_by(move || {
        stop.send(Request::Stop);
        close();
    });
    // Registered until the program ends.
    std::mem::forget((stop_before_end(device), closing));
}

/// Registers `last`, which is called after everything else when a signal ends the program, to leave a clean
/// terminal.
pub(crate) fn before_exit(last: fn()) {
    endings().last = Some(last);
}

/// Does not return while the program is being ended, so that a thread that would start or report something
/// waits here for the end.
pub fn hold_while_ending() {
    while endings().is_ending {
        thread::park_timeout(STOPPING);
    }
}

/// Starts a thread that handles signals. The main function calls it once.
///
/// # Errors
/// When the system refuses the signal handler or the thread.
pub fn watch() -> io::Result<()> {
    let (sender, signals) = channel();
    listen(move |signal| {
        // The receiver is gone when the program is at its end.
        let _ = sender.send(signal);
    })?;
    let wait = move || {
        if let Ok(signal) = signals.recv() {
            end(signal, &signals);
        }
    };
    thread::Builder::new().name("slipline-ending".to_owned()).spawn(wait).map(drop)
}

/// Ends the program; `signals` reports further signals meanwhile.
fn end(signal: Signal, signals: &Receiver<Signal>) {
    let is_closing = {
        let mut endings = endings();
        let is_its_end = endings.close.as_ref().is_some_and(|close| close.leaving == Leaving::ByItself);
        // Stated before the command is asked to end: what it then reports has this signal.
        endings.by = (!is_its_end).then_some(signal);
        endings.close.as_mut().map(|close| (close.close)()).is_some()
    };
    let mut last_signal = signal;
    if is_closing {
        // The main function ends the program meanwhile. A second signal requests an immediate end.
        last_signal = signals.recv_timeout(CLOSING).unwrap_or(signal);
    }
    let devices: Vec<Handle> = {
        let mut endings = endings();
        endings.is_ending = true;
        endings.devices.iter().map(|(_, device)| device.clone()).collect()
    };
    for device in &devices {
        // The worker stops and disarms the device before it closes the port, and ignores later requests.
        device.send(Request::Disconnect);
    }
    for device in &devices {
        // A device that does not answer stops by itself after its dead-man time.
        let _ = device
            .wait_for(STOPPING, |seen| matches!(seen.link.state, LinkState::Disconnected).then_some(()));
    }
    atomic_file::remove_unfinished();
    let last = endings().last;
    last.into_iter().for_each(|last| last());
    last_signal.end_program();
}

/// Calls `notify` for every signal.
#[cfg(unix)]
fn listen(mut notify: impl FnMut(Signal) + Send + 'static) -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    // A user who started the program with nohup wants it to continue when the terminal closes.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let hangup = (!is_ignored(SIGHUP, &status)).then_some(SIGHUP);
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM].into_iter().chain(hangup))?;
    let wait = move || {
        signals.forever().for_each(|number| {
            notify(match number {
                SIGTERM => Signal::Terminate,
                SIGHUP => Signal::HangUp,
                _ => Signal::Interrupt,
            });
        });
    };
    thread::Builder::new().name("slipline-signals".to_owned()).spawn(wait).map(drop)
}

/// Whether a process ignores a signal, according to `/proc` of Linux. Other systems do not report it.
#[cfg(unix)]
fn is_ignored(signal: i32, status: &str) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Calls `notify` for every Ctrl-C.
#[cfg(not(unix))]
fn listen(mut notify: impl FnMut(Signal) + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(move || notify(Signal::Interrupt)).map_err(io::Error::other)
}
#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

    #[test]
    fn an_ignored_signal_is_distinguished_from_the_others() {
        let nohup = "SigBlk:\t0000000000000003\nSigIgn:\t0000000000001001\nSigCgt:\t0000000000000002\n";
        assert!(is_ignored(SIGHUP, nohup) && !is_ignored(SIGINT, nohup));
        for status in ["", "SigIgn:\n", "SigIgn:\tnonsense\n", "SigIgn:\t0000000000001000\n"] {
            assert!(!is_ignored(SIGHUP, status), "{status}");
        }
    }

    #[test]
    fn the_numbers_match_the_system() {
        let numbers = [Signal::Interrupt, Signal::Terminate, Signal::HangUp].map(Signal::number);
        assert_eq!(numbers, [SIGINT, SIGTERM, SIGHUP]);
    }
}
