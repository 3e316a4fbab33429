//! What a file is, by its first bytes: a name may lie.

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// A WAV file, or a damaged one.
    Wav,
    /// A recording in another lossless format, by its name.
    Lossless(&'static str),
    /// What is never read: what it is, and what to do.
    Foreign(&'static str),
    /// None of these: perhaps a text.
    Other,
}

/// What is said of a file whose bytes are no text, where a text is wanted.
pub const NOT_TEXT: &str = "the file is not UTF-8 text";

const LOSSY: &str = "it is a recording that is compressed with loss: record as WAV, FLAC or lossless";
const RECORDING: &str = "it is a recording in a format that is not read: save it as WAV";
const SPREADSHEET: &str = "it is a spreadsheet: save it as CSV";
const ARCHIVE: &str = "it is an archive: unpack it, and name a file in it";
const PICTURE: &str = "it is a picture: export the numbers as CSV";
const DOCUMENT: &str = "it is a document: export the numbers as CSV";
const NUMBERS: &str = "it is a file of another program's own format: export the numbers as CSV";

/// Offset, bytes there, and the content that they mean. The first row that fits counts.
const MARKS: &[(usize, &[u8], Content)] = &[
    (0, b"RIFF", Content::Wav),
    (0, b"RF64", Content::Wav),
    (0, b"BW64", Content::Wav),
    (0, b"RIFX", Content::Wav),
    (0, b"fLaC", Content::Lossless("FLAC")),
    (8, b"AIFF", Content::Lossless("AIFF")),
    (8, b"AIFC", Content::Lossless("AIFF")),
    (4, b"ftypheic", Content::Foreign(PICTURE)),
    (4, b"ftypmif1", Content::Foreign(PICTURE)),
    (4, b"ftypavif", Content::Foreign(PICTURE)),
    // QuickTime.
    (4, b"ftypqt  ", Content::Foreign(RECORDING)),
    (4, b"moov", Content::Foreign(RECORDING)),
    (4, b"wide", Content::Foreign(RECORDING)),
    (4, b"ftyp", Content::Lossless("M4A")),
    (0, b"ID3\x02", Content::Foreign(LOSSY)),
    (0, b"ID3\x03", Content::Foreign(LOSSY)),
    (0, b"ID3\x04", Content::Foreign(LOSSY)),
    // FLAC in Ogg.
    (28, b"\x7fFLAC", Content::Foreign(RECORDING)),
    (0, b"OggS\0", Content::Foreign(LOSSY)),
    (0, b"#!AMR", Content::Foreign(LOSSY)),
    (0, b"0&\xb2u\x8ef\xcf\x11", Content::Foreign(LOSSY)),
    (0, b"\x1aE\xdf\xa3", Content::Foreign(RECORDING)),
    (0, b"caff\0\x01", Content::Foreign(RECORDING)),
    (0, b"wvpk", Content::Foreign(RECORDING)),
    (0, b".snd", Content::Foreign(RECORDING)),
    (0, b"TTA1", Content::Foreign(RECORDING)),
    (0, b"Creative Voice File", Content::Foreign(RECORDING)),
    (0, b"DSD \x1c\0", Content::Foreign(RECORDING)),
    (0, b"\x0bw", Content::Foreign(LOSSY)),
    (0, b"riff.\x91\xcf\x11", Content::Foreign(RECORDING)),
    (0, b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", Content::Foreign(SPREADSHEET)),
    (0, b"\x1f\x8b", Content::Foreign(ARCHIVE)),
    (4, b"1AY&SY", Content::Foreign(ARCHIVE)),
    (0, b"\xfd7zXZ\0", Content::Foreign(ARCHIVE)),
    (0, b"7z\xbc\xaf\x27\x1c", Content::Foreign(ARCHIVE)),
    (0, b"Rar!", Content::Foreign(ARCHIVE)),
    (0, b"\x28\xb5\x2f\xfd", Content::Foreign(ARCHIVE)),
    (257, b"ustar", Content::Foreign(ARCHIVE)),
    (0, b"\x89PNG", Content::Foreign(PICTURE)),
    (0, b"\xff\xd8\xff", Content::Foreign(PICTURE)),
    (0, b"GIF8", Content::Foreign(PICTURE)),
    (0, b"II*\0", Content::Foreign(PICTURE)),
    (0, b"%PDF", Content::Foreign(DOCUMENT)),
    (0, b"{\\rtf", Content::Foreign(DOCUMENT)),
    (0, b"MATLAB 5.0 MAT-file", Content::Foreign(NUMBERS)),
    (0, b"MATLAB 7.3 MAT-file", Content::Foreign(NUMBERS)),
    (0, b"\x93NUMPY", Content::Foreign(NUMBERS)),
    (0, b"PAR1", Content::Foreign(NUMBERS)),
    (0, b"\x89HDF\r\n\x1a\n", Content::Foreign(NUMBERS)),
    (0, b"TDSm", Content::Foreign(NUMBERS)),
    (0, b"SQLite format 3\0", Content::Foreign(NUMBERS)),
    (0, b"<!DOCTYPE ", Content::Foreign(DOCUMENT)),
    (0, b"<html", Content::Foreign(DOCUMENT)),
    (0, b"<?xml ", Content::Foreign(DOCUMENT)),
];

impl Content {
    /// Recognizes a file by its bytes.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        let has = |at: usize, mark: &[u8]| bytes.get(at..).is_some_and(|rest| rest.starts_with(mark));
        if has(tag_length(bytes), b"fLaC") {
            return Self::Lossless("FLAC");
        }
        if bytes.is_empty() {
            return Self::Foreign("the file is empty");
        }
        if has(0, b"PK\x03\x04") || has(0, b"PK\x05\x06") {
            return Self::Foreign(if is_spreadsheet(bytes) { SPREADSHEET } else { ARCHIVE });
        }
        // A frame of MPEG audio, layer 2 or 3, or of AAC. FE FF and FF FE, which begin a text of UTF-16, are none.
        if let [0xff, second, third, ..] = bytes
            && second & 0xe0 == 0xe0
            && second & 0x18 != 0x08
            && (matches!(second & 0x06, 0x02 | 0x04) || second & 0xf6 == 0xf0)
            && third & 0xf0 != 0xf0
        {
            return Self::Foreign(LOSSY);
        }
        let found = MARKS.iter().find(|(at, mark, _)| has(*at, mark));
        found.map_or(Self::Other, |(.., content)| *content)
    }
}

/// Length of a tag of MP3's (ID3v2) at a file's beginning, which some programs put before other formats, too.
pub(crate) fn tag_length(bytes: &[u8]) -> usize {
    match *bytes {
        [b'I', b'D', b'3', 2..=4, _, _, a, b, c, d, ..] if (a | b | c | d) < 0x80 => {
            10 + [a, b, c, d].iter().fold(0, |length, byte| length << 7 | usize::from(*byte))
        }
        _ => 0,
    }
}

/// Whether an archive is a spreadsheet: the name of a file in it, or its first file, says so.
fn is_spreadsheet(bytes: &[u8]) -> bool {
    let has = |name: &[u8]| bytes.windows(name.len()).take(1 << 16).any(|window| window == name);
    has(b"opendocument.spreadsheet")
        || has(b"Index/Tables/")
        || has(b"[Content_Types].xml") && !has(b"word/") && !has(b"ppt/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_recognized_by_its_bytes_and_a_text_is_none_of_these() {
        let zip = |names: &str| [b"PK\x03\x04..........................", names.as_bytes()].concat();
        for (bytes, content) in [
            (b"RIFF....AVI ".to_vec(), Content::Wav),
            (b"RF64".to_vec(), Content::Wav),
            (b"fLaC\0\0".to_vec(), Content::Lossless("FLAC")),
            (b"FORM\0\0\0\0AIFF".to_vec(), Content::Lossless("AIFF")),
            (b"\0\0\0 ftypM4A ".to_vec(), Content::Lossless("M4A")),
            (b"\0\0\0\x14ftypqt  ".to_vec(), Content::Foreign(RECORDING)),
            (b"\0\0\0\x08wide".to_vec(), Content::Foreign(RECORDING)),
            (b"\0\0\0\x18ftypheic".to_vec(), Content::Foreign(PICTURE)),
            ([b"OggS\0", &[0; 23][..], b"\x7fFLAC"].concat(), Content::Foreign(RECORDING)),
            (b"\xff\xfb\x90\x64".to_vec(), Content::Foreign(LOSSY)),
            (b"\xff\xf1\x50\x80".to_vec(), Content::Foreign(LOSSY)),
            (b"ID3\x04".to_vec(), Content::Foreign(LOSSY)),
            (b"ID3\x04\0\0\0\0\0\x02..\xff\xfb\x90\x64".to_vec(), Content::Foreign(LOSSY)),
            (b"ID3\x04\0\0\0\0\0\x02..fLaC".to_vec(), Content::Lossless("FLAC")),
            (b"Creative Voice File\x1a".to_vec(), Content::Foreign(RECORDING)),
            (zip("[Content_Types].xml..xl/workbook.xml"), Content::Foreign(SPREADSHEET)),
            (zip("mimetypeapplication/vnd.oasis.opendocument.spreadsheet"), Content::Foreign(SPREADSHEET)),
            (zip("[Content_Types].xml..word/document.xml"), Content::Foreign(ARCHIVE)),
            (zip("near.txt"), Content::Foreign(ARCHIVE)),
            (Vec::new(), Content::Foreign("the file is empty")),
            (b"Hz\tdB\n100\t-3\n".to_vec(), Content::Other),
            (b"    -1\n    58\n".to_vec(), Content::Other),
            ("\u{feff}100 -3 0".as_bytes().to_vec(), Content::Other),
            (b"\xff\xfe1\x000\x00".to_vec(), Content::Other),
            (b"\xfe\xff\x001\x000".to_vec(), Content::Other),
            (b"MAC 7\n".to_vec(), Content::Other),
            (b"30&40\n".to_vec(), Content::Other),
        ] {
            assert_eq!(Content::of(&bytes), content, "{}", bytes.escape_ascii());
        }
    }
}
