//! Bytes of a file as text: UTF-8 or UTF-16, else Windows' code page 1252; one kind of line end.

use std::borrow::Cow;

/// The letters of code page 1252 from 0x80 to 0x9f; the others are those of Unicode.
const CP1252: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}',
    '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// The text of a file, without a byte order mark and DOS's mark of its end, its lines ended by a line feed alone. UTF-16 needs its mark, or a zero in
/// every other of its first bytes.
#[must_use]
pub fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => utf_16(rest, u16::from_le_bytes).into(),
        [0xfe, 0xff, rest @ ..] => utf_16(rest, u16::from_be_bytes).into(),
        &[a, 0, b, 0, ..] if a != 0 && b != 0 => utf_16(bytes, u16::from_le_bytes).into(),
        &[0, a, 0, b, ..] if a != 0 && b != 0 => utf_16(bytes, u16::from_be_bytes).into(),
        _ => match str::from_utf8(bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes)) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => bytes.iter().map(|&byte| cp1252(byte)).collect::<String>().into(),
        },
    };
    let text = match text.strip_suffix('\u{1a}') {
        Some(text) => Cow::Owned(text.to_owned()),
        None => text,
    };
    if text.contains('\r') { text.replace("\r\n", "\n").replace('\r', "\n").into() } else { text }
}

fn cp1252(byte: u8) -> char {
    let special = byte.checked_sub(0x80).and_then(|at| CP1252.get(usize::from(at)));
    special.copied().unwrap_or(char::from(byte))
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}
