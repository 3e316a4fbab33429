//! Ends the program after a signal: Ctrl-C, on Unix also SIGTERM, and SIGHUP unless it is ignored (nohup).
//! All endings pass through one place, so that no driven device and no incomplete file remains.
//!
//! ```text
//! signal --> does the command have its own orderly end (drive, the window)?
//!              yes: it is asked to end, and returns by itself -----------------------> its own exit code
//!              no, it takes too long, or a second signal comes:
//!                   devices stopped and disarmed --> temporary files removed --> exit code 130
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

/// The exit code after a signal: the one that a shell reports for a program ended by Ctrl-C.
const EXIT_CODE: i32 = 130;
/// Time limit for a command with its own orderly end.
const CLOSING: Duration = Duration::from_secs(5);
/// Time limit for a device to acknowledge stop and disarm. Without a host it stops by itself.
const STOPPING: Duration = Duration::from_secs(1);

/// The actions before the program ends.
struct Endings {
    /// Devices to stop, by number.
    devices: Vec<(u64, Handle)>,
    /// The command's own orderly end, with its number.
    close: Option<(u64, Box<dyn FnMut() + Send>)>,
    /// The last action.
    last: Option<fn()>,
    /// The last number given.
    count: u64,
    is_ending: bool,
}

static ENDINGS: Mutex<Endings> =
    Mutex::new(Endings { devices: Vec::new(), close: None, last: None, count: 0, is_ending: false });

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
        endings.close.take_if(|(number, _)| *number == self.0);
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
/// main function.
pub(crate) fn end_by(close: impl FnMut() + Send + 'static) -> Ending {
    hold_while_ending();
    let mut endings = endings();
    endings.count += 1;
    let number = endings.count;
    endings.close = Some((number, Box::new(close)));
    Ending(number)
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
    listen(move || {
        // The receiver is gone when the program is at its end.
        let _ = sender.send(());
    })?;
    let wait = move || {
        if signals.recv().is_ok() {
            end(&signals);
        }
    };
    thread::Builder::new().name("slipline-ending".to_owned()).spawn(wait).map(drop)
}

/// Ends the program; `signals` reports further signals meanwhile.
fn end(signals: &Receiver<()>) {
    let is_closing = match &mut endings().close {
        Some((_, close)) => {
            close();
            true
        }
        None => false,
    };
    if is_closing {
        // The main function ends the program meanwhile. A second signal requests an immediate end.
        let _ = signals.recv_timeout(CLOSING);
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
        let _ = device.wait_for(STOPPING, |seen| matches!(seen.link, LinkState::Disconnected).then_some(()));
    }
    atomic_file::remove_unfinished();
    let last = endings().last;
    last.into_iter().for_each(|last| last());
    process::exit(EXIT_CODE);
}

/// Calls `notify` for every signal.
#[cfg(unix)]
fn listen(mut notify: impl FnMut() + Send + 'static) -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    // A user who started the program with nohup wants it to continue when the terminal closes.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let hangup = (!is_ignored(SIGHUP, &status)).then_some(SIGHUP);
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM].into_iter().chain(hangup))?;
    let wait = move || signals.forever().for_each(|_| notify());
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
fn listen(notify: impl FnMut() + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(notify).map_err(io::Error::other)
}
#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use signal_hook::consts::{SIGHUP, SIGINT};

    #[test]
    fn an_ignored_signal_is_told_from_the_others() {
        let nohup = "SigBlk:\t0000000000000003\nSigIgn:\t0000000000001001\nSigCgt:\t0000000000000002\n";
        assert!(is_ignored(SIGHUP, nohup) && !is_ignored(SIGINT, nohup));
        for status in ["", "SigIgn:\n", "SigIgn:\tnonsense\n", "SigIgn:\t0000000000001000\n"] {
            assert!(!is_ignored(SIGHUP, status), "{status}");
        }
    }
}
