//! Being told to end: by Ctrl-C, on Unix as well by SIGTERM, and by SIGHUP unless the program is to outlive its
//! terminal.

use slipline_model::disk;
use std::io;

/// Has the program do `first` and leave no half-written file when it is told to end. Without a handler it still ends,
/// and only the part is left.
pub fn remove_parts_on_ending(mut first: impl FnMut() + Send + 'static) {
    let _ = on_ending(move || {
        first();
        disk::remove_unfinished();
        // What a shell gives a program that Ctrl-C ended.
        std::process::exit(130);
    });
}

/// Has `act` done whenever the program is told to end, on a thread of its own; it no longer ends by itself then.
///
/// # Errors
/// When the system takes no handler or gives no thread.
#[cfg(unix)]
pub(crate) fn on_ending(mut act: impl FnMut() + Send + 'static) -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    // Whoever began the program with nohup wants it to go on when the terminal closes.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let hangup = (!is_ignored(SIGHUP, &status)).then_some(SIGHUP);
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM].into_iter().chain(hangup))?;
    let wait = move || signals.forever().for_each(|_| act());
    std::thread::Builder::new().name("slipline-ending".to_owned()).spawn(wait).map(drop)
}

/// Whether a process ignores a signal, by what Linux says of it in `/proc`. Other systems do not say.
#[cfg(unix)]
fn is_ignored(signal: i32, status: &str) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Has `act` done whenever the program is told to end, on a thread of its own; it no longer ends by itself then.
///
/// # Errors
/// When the system takes no handler or gives no thread.
#[cfg(not(unix))]
pub(crate) fn on_ending(act: impl FnMut() + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(act).map_err(io::Error::other)
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
