//! How the program ends when it is told to: by Ctrl-C, on Unix as well by SIGTERM, and by SIGHUP unless the program is
//! to outlive its terminal. It ends in one place, so that no way out leaves a device driven or half a file behind.
//!
//! ```text
//! signal --> has the command an end of its own (drive, the window)?
//!              yes: it is asked to end, and returns by itself -----------------------> its own exit code
//!              no, it takes too long, or a second signal comes:
//!                   devices stopped and disarmed --> temporary files removed --> exit code 130
//! ```

use slipline_link::native::Handle;
use slipline_link::{LinkState, Request};
use slipline_model::disk;
use std::io;
use std::process;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// The exit code of what was cut short by a signal: what a shell reports of a program that Ctrl-C ended.
const EXIT_CODE: i32 = 130;
/// A command with an end of its own has so long for it.
const CLOSING: Duration = Duration::from_secs(5);
/// A device has so long to agree to stop and disarm. It does so by itself when its host is silent.
const STOPPING: Duration = Duration::from_secs(1);

/// What is done before the program ends.
struct Endings {
    /// Devices to stop, by number.
    devices: Vec<(u64, Handle)>,
    /// The command's own end, by number.
    close: Option<(u64, Box<dyn FnMut() + Send>)>,
    /// What is done last.
    last: Option<fn()>,
    /// The latest number.
    count: u64,
    is_ending: bool,
}

static ENDINGS: Mutex<Endings> =
    Mutex::new(Endings { devices: Vec::new(), close: None, last: None, count: 0, is_ending: false });

fn endings() -> MutexGuard<'static, Endings> {
    ENDINGS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Something to be done before the program ends; dropped, it no longer is.
#[must_use]
pub(crate) struct Ending(u64);

impl Drop for Ending {
    fn drop(&mut self) {
        let mut endings = endings();
        endings.devices.retain(|(number, _)| *number != self.0);
        endings.close.take_if(|(number, _)| *number == self.0);
    }
}

/// Has this device stopped and disarmed before the program ends.
pub(crate) fn stop_before_end(device: Handle) -> Ending {
    hold_while_ending();
    let mut endings = endings();
    endings.count += 1;
    let number = endings.count;
    endings.devices.push((number, device));
    Ending(number)
}

/// Has `close` called when the program is told to end. It stops the device and lets the program return from its main
/// function.
pub(crate) fn end_by(close: impl FnMut() + Send + 'static) -> Ending {
    hold_while_ending();
    let mut endings = endings();
    endings.count += 1;
    let number = endings.count;
    endings.close = Some((number, Box::new(close)));
    Ending(number)
}

/// Has the window closed when the program is told to end: its device is stopped at once, then it keeps what it keeps
/// and returns. For the window's `run`.
#[cfg(feature = "gui")]
pub fn end_window(device: Handle, mut close: Box<dyn FnMut() + Send>) {
    let stop = device.clone();
    let closing = end_by(move || {
        stop.send(Request::Stop);
        close();
    });
    // To the end of the program.
    std::mem::forget((stop_before_end(device), closing));
}

/// Has `last` called when a signal cuts the program short, after everything else: so that the terminal is left clean.
pub(crate) fn before_exit(last: fn()) {
    endings().last = Some(last);
}

/// Never returns once the program is being ended: whoever would begin or report something waits for the end here.
pub fn hold_while_ending() {
    while endings().is_ending {
        thread::park_timeout(STOPPING);
    }
}

/// Watches for signals from now on, on a thread of its own. For the main function, once.
///
/// # Errors
/// When the system takes no handler or gives no thread.
pub fn watch() -> io::Result<()> {
    let (told, signals) = channel();
    listen(move || {
        // Nobody listens any more when the program is at its end.
        let _ = told.send(());
    })?;
    let wait = move || {
        if signals.recv().is_ok() {
            end(&signals);
        }
    };
    thread::Builder::new().name("slipline-ending".to_owned()).spawn(wait).map(drop)
}

/// Ends the program; on the way out, more signals come.
fn end(signals: &Receiver<()>) {
    let is_closing = match &mut endings().close {
        Some((_, close)) => {
            close();
            true
        }
        None => false,
    };
    if is_closing {
        // The program ends meanwhile. A second signal means that nobody will wait for it.
        let _ = signals.recv_timeout(CLOSING);
    }
    let devices: Vec<Handle> = {
        let mut endings = endings();
        endings.is_ending = true;
        endings.devices.iter().map(|(_, device)| device.clone()).collect()
    };
    for device in &devices {
        // It stops and disarms before it closes the port; what is asked afterwards is not done.
        device.send(Request::Disconnect);
    }
    for device in &devices {
        // One that does not answer stops by its dead-man's time.
        let _ = device.wait_for(STOPPING, |seen| matches!(seen.link, LinkState::Disconnected).then_some(()));
    }
    disk::remove_unfinished();
    let last = endings().last;
    last.into_iter().for_each(|last| last());
    process::exit(EXIT_CODE);
}

/// Has `told` called for every signal.
#[cfg(unix)]
fn listen(mut told: impl FnMut() + Send + 'static) -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    // Whoever began the program with nohup wants it to go on when the terminal closes.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let hangup = (!is_ignored(SIGHUP, &status)).then_some(SIGHUP);
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM].into_iter().chain(hangup))?;
    let wait = move || signals.forever().for_each(|_| told());
    thread::Builder::new().name("slipline-signals".to_owned()).spawn(wait).map(drop)
}

/// Whether a process ignores a signal, by what Linux says of it in `/proc`. Other systems do not say.
#[cfg(unix)]
fn is_ignored(signal: i32, status: &str) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Has `told` called for every Ctrl-C.
#[cfg(not(unix))]
fn listen(told: impl FnMut() + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(told).map_err(io::Error::other)
}
#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use signal_hook::consts::{SIGHUP, SIGINT};

    #[test]
    fn an_ignored_signal_is_told_from_the_others() {
        let nohup = "SigBlk:\t0000000000000003\nSigIgn:\t0000000000001001\nSigCgt:\t0000000000000002\n";
        assert!(is_ignored(SIGHUP, nohup) && !is_ignored(SIGINT, nohup));
        for told in ["", "SigIgn:\n", "SigIgn:\tnonsense\n", "SigIgn:\t0000000000001000\n"] {
            assert!(!is_ignored(SIGHUP, told), "{told}");
        }
    }
}
