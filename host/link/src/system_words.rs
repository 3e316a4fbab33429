//! The words of the operating system, in those of Slipline.

use std::fmt::Display;

/// Texts of systems and of the standard library that a user cannot act on, and what they mean.
const MEANINGS: [(&str, &str); 22] = [
    ("Not a typewriter", NO_TERMINAL),
    ("Not a tty", NO_TERMINAL),
    ("Inappropriate ioctl for device", NO_TERMINAL),
    (SUN_LEN, "the path is too long for a socket: name a shorter one"),
    ("Resource temporarily unavailable", NO_THREAD),
    ("Cannot allocate memory", "the system has no memory left for this program"),
    ("Address already in use", "another program uses this address"),
    ("Cannot assign requested address", "this computer has no such address"),
    ("Bad file descriptor", "it is closed"),
    ("Broken pipe", "its reader has gone"),
    ("Input/output error", "the device, or the disk, failed"),
    ("Device or resource busy", "another program uses it"),
    ("Text file busy", "it is a program that runs now"),
    ("Too many open files", "this program has too many files open"),
    ("Too many levels of symbolic links", "its links lead in a circle"),
    ("Is a directory", "it is a folder: name a file in it"),
    ("Not a directory", "a part of its path is no folder"),
    ("Protocol wrong type for socket", "it is a socket of another kind"),
    ("Socket operation on non-socket", "it is no socket"),
    ("Connection refused", "no program listens there"),
    ("failed to fill whole buffer", "it ends too early"),
    ("stream did not contain valid UTF-8", "it is not UTF-8 text"),
];
/// The end of the standard library's text for a socket's path that is too long.
const SUN_LEN: &str = "shorter than SUN_LEN";
/// A file, or a device, that is no serial port.
const NO_TERMINAL: &str = "it is no serial port";
/// A thread or a process that the system does not start.
const NO_THREAD: &str =
    "the system starts no more threads for this user: end other programs, or raise the limit (ulimit -u)";

/// The text of a system's error, without its number, so that it can end a sentence.
#[must_use]
pub fn system_words(error: &(impl Display + ?Sized)) -> String {
    let text = error.to_string();
    let text = text.split(" (os error").next().unwrap_or_default();
    if let Some((_, meaning)) =
        MEANINGS.iter().find(|(theirs, _)| *theirs == text || *theirs == SUN_LEN && text.ends_with(SUN_LEN))
    {
        return (*meaning).to_owned();
    }
    let mut text = text.to_owned();
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_lowercase();
    }
    text
}

/// A reason as the beginning of a sentence. A first word that is a name, of a port or a file, or a number, stays as it is.
#[must_use]
pub fn capitalized(reason: &str) -> String {
    let first = reason.split([' ', ',', ':']).next().unwrap_or_default();
    let is_word =
        !first.is_empty() && first.chars().all(char::is_lowercase) && !["sim", "unix"].contains(&first);
    let mut letters = reason.chars();
    match letters.next() {
        Some(letter) if is_word => letter.to_uppercase().chain(letters).collect(),
        _ => reason.to_owned(),
    }
}

/// Whether an error says that a file, or a device, is no serial port.
#[must_use]
#[cfg(feature = "native")]
pub(crate) fn is_no_terminal(error: &impl Display) -> bool {
    system_words(error) == NO_TERMINAL
}

#[cfg(test)]
mod tests {
    use super::{capitalized, system_words};
    use std::io;

    #[test]
    fn a_sentence_begins_with_a_capital_unless_with_a_name() {
        for (reason, sentence) in [
            ("the device went away", "The device went away"),
            ("line 3: no number", "Line 3: no number"),
            ("unix:r.sock is in use", "unix:r.sock is in use"),
            ("sim is in use", "sim is in use"),
            ("near.txt is empty", "near.txt is empty"),
            ("/dev/ttyACM0 is no serial port", "/dev/ttyACM0 is no serial port"),
            ("", ""),
        ] {
            assert_eq!(capitalized(reason), sentence);
        }
    }

    #[test]
    fn a_systems_error_ends_a_sentence_in_words_that_say_what_to_do() {
        for (error, words) in [
            (io::Error::other("Not a typewriter"), "it is no serial port"),
            (io::Error::other("made of air"), "made of air"),
            (io::Error::other("The disk is gone (os error 7)"), "the disk is gone"),
        ] {
            assert_eq!(system_words(&error), words);
        }
        #[cfg(target_os = "linux")]
        for (number, words) in [
            (
                11,
                "the system starts no more threads for this user: end other programs, or raise the limit (ulimit -u)",
            ),
            (13, "permission denied"),
            (20, "a part of its path is no folder"),
            (25, "it is no serial port"),
            (28, "no space left on device"),
            (98, "another program uses this address"),
        ] {
            assert_eq!(system_words(&io::Error::from_raw_os_error(number)), words);
        }
    }
}
