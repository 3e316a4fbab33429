//! A setup as the fragment of a page's address, so that a link shows it.
//!
//! ```text
//! setup -> text of its file -> raw DEFLATE (RFC 1951) -> base64url without padding (RFC 4648) -> setup=1.TEXT
//! ```
//! The number before the dot is the version of this form; the text has its own (`slipline_setup`).

use crate::setup::Setup;
use crate::setup::file::{self, FILE_BYTES_MAX, Opened, SetupFileError};
use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;

/// How a fragment with a setup begins, without its `#` and its version.
const KEY: &str = "setup=";
/// The version this program writes.
const VERSION: &str = "1";
/// The longest fragment that is read, in characters.
pub(crate) const FRAGMENT_MAX: usize = 16_000;
/// The slowest and smallest compression.
const SMALLEST: u8 = 10;

/// Why the setup of an address was refused.
#[derive(Debug, thiserror::Error)]
pub enum FragmentError {
    /// It is too long.
    #[error("the setup in the address has {0} characters, more than the {FRAGMENT_MAX} that are read")]
    TooLong(usize),
    /// A version that this program does not know.
    #[error("the setup in the address is of version {0:?}: this page reads version {VERSION}; load it again")]
    Version(String),
    /// It is not base64url of DEFLATE of text: a character was lost or changed.
    #[error("the setup in the address is damaged: copy the whole address once more")]
    Damaged,
    /// The text is no setup.
    #[error("the setup in the address: {0}")]
    File(#[from] SetupFileError),
}

/// The setup as a fragment, without its `#`.
#[must_use]
pub fn write(setup: &Setup) -> String {
    let packed = compress_to_vec(file::write(setup).as_bytes(), SMALLEST);
    format!("{KEY}{VERSION}.{}", URL_SAFE_NO_PAD.encode(packed))
}

/// The setup or plate of a fragment, with or without its `#`; `None` if the fragment holds none. Programs that pass addresses on
/// may have written its characters as `%3D`, added parts behind `&`, and padded the base64.
///
/// # Errors
/// [`FragmentError`]. No text makes this function panic.
#[must_use]
pub fn read(fragment: &str) -> Option<Result<Opened, FragmentError>> {
    let fragment = unescaped(fragment.strip_prefix('#').unwrap_or(fragment));
    let text = fragment.split('&').find_map(|part| part.strip_prefix(KEY))?;
    Some(unpacked(fragment.chars().count(), text.trim_end_matches('=')))
}

/// The fragment with each escaped ASCII character (RFC 3986, 2.1) as itself; what is no such escape stays.
fn unescaped(fragment: &str) -> String {
    let mut parts = fragment.split('%');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let digits = part.get(..2).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
        let code = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        match (code.filter(u8::is_ascii), part.get(2..)) {
            (Some(code), Some(rest)) => {
                text.push(char::from(code));
                text.push_str(rest);
            }
            _ => {
                text.push('%');
                text.push_str(part);
            }
        }
    }
    text
}

fn unpacked(length: usize, text: &str) -> Result<Opened, FragmentError> {
    if length > FRAGMENT_MAX {
        return Err(FragmentError::TooLong(length));
    }
    let (version, packed) = text.split_once('.').ok_or(FragmentError::Damaged)?;
    if version != VERSION {
        return Err(FragmentError::Version(version.chars().take(20).collect()));
    }
    let packed = URL_SAFE_NO_PAD.decode(packed).map_err(|_| FragmentError::Damaged)?;
    let text = decompress_to_vec_with_limit(&packed, FILE_BYTES_MAX).map_err(|_| FragmentError::Damaged)?;
    let text = String::from_utf8(text).map_err(|_| FragmentError::Damaged)?;
    Ok(file::read(&text)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::SCENES;
    use proptest::prelude::*;

    fn setup_of(fragment: &str) -> Result<Setup, FragmentError> {
        match read(fragment).expect("a fragment with a setup")? {
            Opened::Setup(setup) => Ok(*setup),
            Opened::Plate(_) => panic!("a plate alone"),
        }
    }

    #[test]
    fn every_scene_fits_an_address_and_comes_back_as_it_was() {
        for scene in SCENES {
            let setup = scene.setup().unwrap();
            let fragment = write(&setup);
            println!("{}: {} characters", scene.name, fragment.len());
            assert!(fragment.len() < 2000, "{}: {}", scene.name, fragment.len());
            assert!(fragment.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"=.-_".contains(&byte)));
            let read = setup_of(&format!("#{fragment}")).unwrap();
            assert_eq!(file::write(&read), file::write(&setup));
            assert_eq!(read.plate.spec(), setup.plate.spec());
        }
    }

    #[test]
    fn a_fragment_is_read_as_programs_pass_it_on() {
        let setup = SCENES[0].setup().unwrap();
        let fragment = write(&setup);
        for passed in [
            fragment.replacen('=', "%3D", 1),
            fragment.replacen('=', "%3d", 1).replacen('.', "%2E", 1).replace('_', "%5F"),
            format!("{fragment}&utm_source=letter&utm_medium=%E2%82%AC"),
            format!("fbclid=1&{fragment}"),
            format!("{fragment}=="),
            format!("{fragment}%3D%3D"),
        ] {
            let read = setup_of(&format!("#{passed}")).unwrap_or_else(|error| panic!("{passed}: {error}"));
            assert_eq!(file::write(&read), file::write(&setup));
        }
        for broken in ["setup%3", "setup%+D1", "%", "%%3D"] {
            assert!(read(broken).is_none(), "{broken}");
        }
    }

    #[test]
    fn a_fragment_that_is_no_setup_is_left_alone_and_a_bad_one_is_refused_by_a_sentence() {
        assert!(read("").is_none() && read("#section").is_none());
        let fragment = write(&SCENES[0].setup().unwrap());
        let refused = |fragment: &str| setup_of(fragment).unwrap_err().to_string();
        assert!(refused(&fragment.replacen("=1.", "=2.", 1)).contains("version \"2\""));
        for damaged in [&fragment[..fragment.len() - 9], "setup=1.", "setup=1", "setup=", "setup=1.??"] {
            let reason = refused(damaged);
            assert!(reason.contains("damaged"), "{damaged}: {reason}");
        }
        let long = format!("{fragment}{}", "A".repeat(FRAGMENT_MAX));
        assert!(refused(&long).contains("more than the 16000"));
        // What unpacks to more than a file may have is refused before it has filled the memory.
        let bomb = URL_SAFE_NO_PAD.encode(compress_to_vec(&vec![b'#'; 8 << 20], SMALLEST));
        assert!(bomb.len() < FRAGMENT_MAX && refused(&format!("setup=1.{bomb}")).contains("damaged"));
        let wrong = URL_SAFE_NO_PAD.encode(compress_to_vec(b"slipline_setup = 9", SMALLEST));
        assert!(refused(&format!("setup=1.{wrong}")).contains("slipline_setup = 9"));
    }

    proptest! {
        #[test]
        fn no_text_makes_the_reader_of_a_fragment_panic(text in "\\PC*", at in 0usize..1000, byte in 0u8..128) {
            let _ = read(&format!("setup=1.{text}"));
            let mut fragment = write(&SCENES[0].setup().unwrap()).into_bytes();
            let at = at % fragment.len();
            fragment[at] = byte;
            let _ = read(&String::from_utf8(fragment).unwrap());
        }
    }
}
