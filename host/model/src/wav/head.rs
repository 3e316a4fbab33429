//! The head of a WAV file: the format of its values, and where they are.
//!
//! ```text
//! RIFF or RF64 -> chunks: ds64 (sizes beyond 32 bits), fmt (format), others, data -> Format, range of bytes
//! ```
//! Writers disagree on two points, and both ways are read. A chunk of an odd size should be followed by a pad byte, and often is
//! not. The size of `data` is written last, so a recorder that was switched off leaves 0, or a size beyond the end of the file:
//! then the values go on to the end.

use super::WavError;
use slipline_plate::quantity::must_be;
use std::collections::BTreeSet;
use std::ops::Range;

/// Most chunks that are looked at.
const CHUNKS_MAX: usize = 10_000;
/// The rest of the identifier of a sub-format of `WAVE_FORMAT_EXTENSIBLE`, after its tag.
const SUB_FORMAT: [u8; 14] = [0, 0, 0, 0, 16, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71];
const PCM: u16 = 1;
const FLOAT: u16 = 3;
const EXTENSIBLE: u16 = 0xfffe;
const FORMATS: &str = "integers of 8, 16, 24 or 32 bits, or floating point of 32 or 64";

/// How a value is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// As its magnitude above -1: integers of 8 bits.
    Unsigned,
    /// In two's complement, at the upper end of its bytes.
    Signed,
    /// In two's complement, as the lower three of four bytes.
    Signed24,
    /// As floating point.
    Float,
}

impl Encoding {
    /// The value of its bytes; 1 is full scale.
    pub(super) fn value(self, bytes: &[u8]) -> f64 {
        // The highest bit of the value is that of the number.
        let upper = || (little_endian(bytes) as u32) << (32 - 8 * bytes.len());
        let signed = |upper: u32| f64::from(upper as i32) * 0.5_f64.powi(31);
        match self {
            Self::Unsigned => signed(upper() ^ 1 << 31),
            Self::Signed => signed(upper()),
            Self::Signed24 => signed(upper() << 8),
            Self::Float if bytes.len() == 8 => f64::from_bits(little_endian(bytes)),
            Self::Float => f32::from_bits(little_endian(bytes) as u32).into(),
        }
    }
}

/// The format of the values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Format {
    pub(super) encoding: Encoding,
    /// Bytes of a value.
    pub(super) bytes: usize,
    /// Bits that a value has, of those of its bytes; `None` where it has no smallest step.
    pub(super) bits: Option<u32>,
    pub(super) channels: usize,
    pub(super) rate_hz: u32,
}

impl Format {
    /// Bytes of one value of each channel.
    pub(super) const fn frame(&self) -> usize {
        self.bytes * self.channels
    }
}

/// A position at which a chunk may begin, and what the chunks before it said.
#[derive(Clone, Copy)]
struct Place {
    at: usize,
    format: Option<Format>,
    /// The size of `data` by `ds64`.
    long_size: Option<u64>,
}

/// Reads the head of a file: the format, and the bytes of whole frames of values.
///
/// # Errors
/// [`WavError`]: a format that is not read, and a head that is damaged.
pub(super) fn read(bytes: &[u8]) -> Result<(Format, Range<usize>), WavError> {
    let form = |why: &str| WavError::Form(why.to_owned());
    match (bytes.get(..4), bytes.get(8..12)) {
        (Some(b"RIFX"), _) => {
            return Err(form("its numbers begin with the high byte (RIFX): save it as RIFF"));
        }
        (_, Some(b"WAVE")) => {}
        (_, Some(_)) => return Err(form("it is a RIFF file of another kind than WAVE")),
        (_, None) => return Err(form("it ends within its head")),
    }
    let mut places = vec![Place { at: 12, format: None, long_size: None }];
    let mut seen = BTreeSet::new();
    let (mut has_format, mut has_values) = (false, false);
    while let Some(Place { at, mut format, mut long_size }) = places.pop() {
        if !seen.insert(at) {
            continue;
        }
        if seen.len() > CHUNKS_MAX {
            return Err(form("its head has too many parts"));
        }
        let Some((name, size)) = chunk(bytes, at) else { continue };
        let begin = at + 8;
        if name == *b"data" {
            has_values = true;
            let Some(format) = format else { continue };
            let size = if size == u64::from(u32::MAX) { long_size.unwrap_or(size) } else { size };
            let end = end_of_values(bytes, begin, size);
            let frames = (end - begin) / format.frame();
            return Ok((format, begin..begin + frames * format.frame()));
        }
        let Some(end) = usize::try_from(size).ok().and_then(|size| begin.checked_add(size)) else { continue };
        let Some(content) = bytes.get(begin..end) else { continue };
        match &name {
            b"fmt " => {
                format = Some(format_of(content)?);
                has_format = true;
            }
            b"ds64" => long_size = content.get(8..16).map(little_endian),
            _ => {}
        }
        let next = |at| Place { at, format, long_size };
        if size % 2 == 1 {
            places.push(next(end));
            places.push(next(end + 1));
            // The last one is looked at first. Without the pad byte a known name stands one byte earlier.
            let is_known = |at: usize| chunk(bytes, at).is_some_and(|(name, _)| KNOWN.contains(&&name));
            if is_known(end) && !is_known(end + 1) {
                places.push(next(end));
            }
        } else {
            places.push(next(end));
        }
    }
    Err(form(match (has_format, has_values) {
        (false, true) => "its values begin before their format is stated",
        (false, false) => "its head is damaged: it states no format",
        (true, _) => "its head is damaged: it has no values",
    }))
}

/// Names of chunks that recorders write.
const KNOWN: [&[u8; 4]; 22] = [
    b"data", b"fmt ", b"LIST", b"fact", b"bext", b"ds64", b"JUNK", b"junk", b"PAD ", b"FLLR", b"cue ",
    b"smpl", b"inst", b"id3 ", b"ID3 ", b"iXML", b"PEAK", b"_PMX", b"cart", b"axml", b"chna", b"levl",
];

/// Name and size of the chunk that begins here; `None` where none does.
fn chunk(bytes: &[u8], at: usize) -> Option<([u8; 4], u64)> {
    let head = bytes.get(at..at.checked_add(8)?)?;
    let (name, size) = head.split_at(4);
    let name: [u8; 4] = name.try_into().ok()?;
    name.iter().all(|letter| (b' '..=b'~').contains(letter)).then(|| (name, little_endian(size)))
}

/// Where the values end that begin here.
fn end_of_values(bytes: &[u8], begin: usize, size: u64) -> usize {
    let left = bytes.len() - begin;
    let stated = usize::try_from(size).ok().filter(|size| *size <= left);
    match stated {
        // Nothing was recorded, if only chunks follow; or the recorder did not end.
        Some(0) if !ends_in_chunks(bytes, begin) => bytes.len(),
        Some(size) => begin + size,
        None => bytes.len(),
    }
}

/// Whether chunks follow to the end of the file, with a pad byte after odd ones.
fn ends_in_chunks(bytes: &[u8], mut at: usize) -> bool {
    for _ in 0..CHUNKS_MAX {
        if at >= bytes.len() {
            return true;
        }
        let size = chunk(bytes, at).and_then(|(_, size)| usize::try_from(size).ok());
        let Some(end) = size.and_then(|size| (at + 8).checked_add(size)) else { return false };
        if end > bytes.len() {
            return false;
        }
        at = end + end % 2;
    }
    false
}

fn little_endian(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte))
}

/// The format that a chunk states.
fn format_of(content: &[u8]) -> Result<Format, WavError> {
    let number = |at: usize, bytes: usize| content.get(at..at + bytes).map(little_endian);
    let damaged =
        || WavError::Form("its head is damaged: the statement of the format is too short".to_owned());
    let short = |at| number(at, 2).and_then(|it| u16::try_from(it).ok()).ok_or_else(damaged);
    let (stated, channels, frame, bits) = (short(0)?, short(2)?, short(12)?, short(14)?);
    let rate_hz = number(4, 4).and_then(|it| u32::try_from(it).ok()).ok_or_else(damaged)?;
    let is_extensible = stated == EXTENSIBLE;
    let (tag, valid) = if is_extensible {
        if content.get(26..40) != Some(&SUB_FORMAT) {
            return Err(WavError::Values(must_be("values of an unknown kind", FORMATS)));
        }
        // Some writers state none.
        (short(24)?, Some(short(18)?).filter(|valid| *valid > 0).unwrap_or(bits))
    } else {
        (stated, bits)
    };
    if !matches!(tag, PCM | FLOAT) {
        return Err(WavError::Values(format!(
            "{}: record as WAV of plain values, FLAC or lossless",
            coding(tag)
        )));
    }
    let (channels, frame) = (usize::from(channels), usize::from(frame));
    if channels == 0 || frame == 0 || frame % channels > 0 {
        return Err(WavError::Form(format!("its head is damaged: {channels} channels in {frame} bytes")));
    }
    let bytes = frame / channels;
    let kind = if tag == PCM { "integers" } else { "floating point" };
    let encoding = match (tag, bytes, valid) {
        (FLOAT, 4, 32) | (FLOAT, 8, 64) => Encoding::Float,
        (PCM, 1, 8) => Encoding::Unsigned,
        (PCM, 2, 16) | (PCM, 3, 24) | (PCM, 4, 24 | 32) => Encoding::Signed,
        (PCM, 2..=4, 9..) if is_extensible && usize::from(valid) <= 8 * bytes => Encoding::Signed,
        _ => {
            let given = format_args!("{kind} of {valid} bits in {bytes} bytes");
            return Err(WavError::Values(must_be(given, FORMATS)));
        }
    };
    let bits = (tag == PCM).then_some(u32::from(valid));
    Ok(Format { encoding, bytes, bits, channels, rate_hz })
}

/// A way of storing sound that loses a part of it, in words.
fn coding(tag: u16) -> String {
    let name = match tag {
        2 | 0x11 => "ADPCM",
        6 => "A-law",
        7 => "mu-law",
        0x31 => "GSM",
        0x50 => "MPEG audio",
        0x55 => "MP3",
        0x160..=0x163 => "WMA",
        0xff | 0x1600 | 0x1602 | 0x1610 => "AAC",
        _ => return format!("values of the unknown kind {tag:#x}"),
    };
    format!("values compressed with loss ({name})")
}
