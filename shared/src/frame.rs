//! Frames: how a message becomes bytes on a link, and how it is found again among damaged ones.
//!
//! ```text
//! raw  = direction 1 | session 4 | sequence 2 | id 1 | body 0..=238 | crc 4      (little-endian)
//! wire = COBS(raw) 00                                                            (00 occurs nowhere else)
//! ```
//! The CRC-32 covers all bytes before it. If the frame on the wire is a multiple of 64 bytes long, a second 00 follows:
//! a USB transfer that ends with a full packet would need an empty packet after it. A receiver skips empty frames.

use crate::limits::{MAX_BODY, MAX_ENCODED, MAX_RAW};
use heapless::Vec;

/// CRC-32/ISO-HDLC, the one of zip and Ethernet: polynomial 0x04c11db7, reflected, start and final XOR all ones.
pub const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

const HEADER: usize = 8;
const TRAILER: usize = 4;

/// Which way a frame travels. Each side ignores frames of its own direction: a terminal may echo what the side sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Direction {
    /// Host to device.
    ToDevice = 0xa5,
    /// Device to host.
    ToHost = 0x5a,
}

impl Direction {
    const fn from_byte(byte: u8) -> Option<Self> {
        match byte {
            0xa5 => Some(Self::ToDevice),
            0x5a => Some(Self::ToHost),
            _ => None,
        }
    }
}

/// The fields before the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Which way the frame travels.
    pub direction: Direction,
    /// The session that the frame belongs to; 0 in a hello.
    pub session: u32,
    /// The number of the command; a reply repeats the number of its command.
    pub sequence: u16,
    /// The message's id.
    pub id: u8,
}

/// A complete frame whose CRC is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// The fields before the body.
    pub header: Header,
    /// The message's body as postcard encodes it, 0..=[`MAX_BODY`] bytes.
    pub body: &'a [u8],
}

/// Why a message cannot be sent as a frame. It is never sent itself: bytes that are no frame are counted by the decoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// More bytes than a frame may have.
    TooLong,
    /// The message is newer than the minor version that the other side speaks.
    TooNew,
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::TooLong => "a frame is too long",
            Self::TooNew => "the other side does not know this message yet",
        })
    }
}

impl core::error::Error for FrameError {}

/// The bytes of one frame on the link.
pub type Encoded = Vec<u8, MAX_ENCODED>;

/// Encodes a frame. `body` gets a buffer of [`MAX_BODY`] bytes, writes the message's body into it and returns the
/// body's length in bytes.
///
/// # Errors
/// The error of `body`; [`FrameError::TooLong`] if `body` returns a length above [`MAX_BODY`].
pub fn encode(
    header: Header,
    body: impl FnOnce(&mut [u8]) -> Result<usize, FrameError>,
) -> Result<Encoded, FrameError> {
    let mut raw = [0u8; MAX_RAW];
    let [d, s0, s1, s2, s3, q0, q1, id, rest @ ..] = &mut raw;
    *d = header.direction as u8;
    [*s0, *s1, *s2, *s3] = header.session.to_le_bytes();
    [*q0, *q1] = header.sequence.to_le_bytes();
    *id = header.id;
    let length = body(rest.get_mut(..MAX_BODY).ok_or(FrameError::TooLong)?)?;
    let end = HEADER + length;
    let crc = CRC.checksum(raw.get(..end).ok_or(FrameError::TooLong)?);
    raw.get_mut(end..end + TRAILER).ok_or(FrameError::TooLong)?.copy_from_slice(&crc.to_le_bytes());
    let whole = raw.get(..end + TRAILER).ok_or(FrameError::TooLong)?;

    let mut wire = [0u8; MAX_ENCODED];
    let used = cobs::try_encode(whole, &mut wire).map_err(|_| FrameError::TooLong)?;
    let mut encoded =
        Encoded::from_slice(wire.get(..used).ok_or(FrameError::TooLong)?).map_err(|_| FrameError::TooLong)?;
    encoded.push(0).map_err(|_| FrameError::TooLong)?;
    if encoded.len() % 64 == 0 {
        encoded.push(0).map_err(|_| FrameError::TooLong)?;
    }
    Ok(encoded)
}

/// What a decoder has counted. Counters stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct DecoderCounters {
    /// Complete frames whose CRC is right.
    pub frames: u32,
    /// Frames with impossible COBS, too few bytes, a wrong CRC or an unknown direction.
    pub damaged: u32,
    /// Frames of more than [`MAX_ENCODED`] bytes.
    pub overlong: u32,
}

/// Finds frames in a stream of bytes, which may begin anywhere in a frame. Its buffer has a fixed size.
///
/// After damaged bytes the next frame is found behind the next zero byte. So at most one undamaged frame is lost.
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    buffer: Vec<u8, MAX_ENCODED>,
    overflowed: bool,
    counters: DecoderCounters,
}

impl Decoder {
    /// A decoder that has received nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            buffer: Vec::new(),
            overflowed: false,
            counters: DecoderCounters { frames: 0, damaged: 0, overlong: 0 },
        }
    }

    /// Takes one byte. If it ends a complete frame whose CRC is right, calls `found` with the frame and returns the
    /// result; else returns `None`.
    pub fn push<R>(&mut self, byte: u8, found: impl FnOnce(Frame<'_>) -> R) -> Option<R> {
        if byte != 0 {
            if self.buffer.push(byte).is_err() {
                self.overflowed = true;
            }
            return None;
        }
        let overflowed = core::mem::take(&mut self.overflowed);
        let result = if overflowed {
            self.counters.overlong = self.counters.overlong.saturating_add(1);
            None
        } else if self.buffer.is_empty() {
            None
        } else if let Some(frame) = open(&mut self.buffer) {
            self.counters.frames = self.counters.frames.saturating_add(1);
            Some(found(frame))
        } else {
            self.counters.damaged = self.counters.damaged.saturating_add(1);
            None
        };
        self.buffer.clear();
        result
    }

    /// The counters so far.
    #[must_use]
    pub const fn counters(&self) -> DecoderCounters {
        self.counters
    }
}

/// Undoes COBS in place and checks length, CRC and direction.
fn open(wire: &mut [u8]) -> Option<Frame<'_>> {
    let raw = uncover(wire)?;
    let (covered, crc) = raw.split_last_chunk::<TRAILER>()?;
    if CRC.checksum(covered) != u32::from_le_bytes(*crc) {
        return None;
    }
    let (&[direction, s0, s1, s2, s3, q0, q1, id], body) = covered.split_first_chunk::<HEADER>()?;
    let header = Header {
        direction: Direction::from_byte(direction)?,
        session: u32::from_le_bytes([s0, s1, s2, s3]),
        sequence: u16::from_le_bytes([q0, q1]),
        id,
    };
    Some(Frame { header, body })
}

// No frame has room for a run of 254 bytes, the only one that no zero follows: its code, 255, leads beyond the end.
const _: () = assert!(MAX_ENCODED < 255);

/// Undoes COBS: a code says where the next one stands, and all but the first stand in the place of a zero. To write these zeros
/// takes the device a tenth of the time of moving every byte, and no stop is looked for meanwhile.
fn uncover(wire: &mut [u8]) -> Option<&[u8]> {
    let mut at = 0;
    while let Some(code) = wire.get_mut(at) {
        // No byte on the wire is 0, so this ends.
        at += usize::from(core::mem::take(code));
    }
    if at == wire.len() { wire.get(1..) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    extern crate std;

    fn header(sequence: u16) -> Header {
        Header { direction: Direction::ToDevice, session: 0x0403_0201, sequence, id: 0x12 }
    }

    fn frame(sequence: u16, body: &[u8]) -> Encoded {
        encode(header(sequence), |b| {
            b.get_mut(..body.len()).ok_or(FrameError::TooLong)?.copy_from_slice(body);
            Ok(body.len())
        })
        .unwrap()
    }

    fn decode(bytes: &[u8]) -> std::vec::Vec<(u16, std::vec::Vec<u8>)> {
        let mut decoder = Decoder::new();
        bytes.iter().filter_map(|&b| decoder.push(b, |f| (f.header.sequence, f.body.to_vec()))).collect()
    }

    #[test]
    fn no_frame_of_any_length_fills_its_last_usb_packet() {
        for length in 0..=MAX_BODY {
            let encoded = frame(1, &std::vec![7u8; length]);
            assert_ne!(encoded.len() % 64, 0, "body of {length} bytes");
            assert_eq!(decode(&encoded).len(), 1);
        }
    }

    #[test]
    fn a_body_beyond_the_limit_is_an_error() {
        assert_eq!(encode(header(0), |_| Ok(MAX_BODY + 1)), Err(FrameError::TooLong));
    }

    #[test]
    fn bytes_without_end_fill_no_more_than_the_buffer_and_the_next_frame_is_found() {
        let mut decoder = Decoder::new();
        for _ in 0..100_000 {
            assert_eq!(decoder.push(0x55, |_| ()), None);
        }
        assert_eq!(decoder.push(0, |_| ()), None);
        assert_eq!(decoder.counters().overlong, 1);
        let found = frame(9, b"hello").iter().filter_map(|&b| decoder.push(b, |f| f.header.sequence)).count();
        assert_eq!(found, 1);
    }

    proptest! {
        #[test]
        fn a_frame_comes_out_as_it_went_in(sequence: u16, body in prop::collection::vec(any::<u8>(), 0..=MAX_BODY)) {
            prop_assert_eq!(decode(&frame(sequence, &body)), std::vec![(sequence, body)]);
        }

        #[test]
        fn any_flipped_bits_lose_the_frame_and_invent_none(
            body in prop::collection::vec(any::<u8>(), 0..40),
            flips in prop::collection::vec((any::<prop::sample::Index>(), 0..8u8), 1..4),
        ) {
            let good = frame(5, &body);
            let mut bad = good.clone();
            for (at, bit) in flips {
                let at = at.index(bad.len());
                bad[at] ^= 1 << bit;
            }
            prop_assume!(bad != good);
            for (sequence, found) in decode(&bad) {
                // Flips of trailing delimiters may leave the frame itself whole.
                prop_assert_eq!((sequence, &found), (5, &body));
            }
            let mut stream = bad.to_vec();
            stream.push(0);
            stream.extend_from_slice(&frame(6, b"next"));
            prop_assert!(decode(&stream).contains(&(6, b"next".to_vec())));
        }

        #[test]
        fn decoding_from_any_offset_loses_at_most_one_frame(offset in 0usize..60, bodies in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..30), 1..8)) {
            let mut stream = std::vec::Vec::new();
            for (i, body) in bodies.iter().enumerate() {
                stream.extend_from_slice(&frame(i as u16, body));
            }
            let offset = offset.min(frame(0, &bodies[0]).len());
            prop_assert!(decode(&stream[offset..]).len() + 1 >= bodies.len());
        }

        #[test]
        fn cobs_is_undone_as_its_own_crate_does_it(
            raw in prop::collection::vec(prop::sample::select(std::vec![0_u8, 0, 1, 2, 3, 7, 0xFE, 0xFF]), 1..MAX_RAW),
            damage in prop::option::of((any::<prop::sample::Index>(), 1..=0xFF_u8)),
        ) {
            let mut wire = std::vec![0; MAX_ENCODED];
            let length = cobs::try_encode(&raw, &mut wire).unwrap();
            wire.truncate(length);
            if let Some((at, byte)) = damage {
                let at = at.index(wire.len());
                wire[at] = byte;
            }
            let mut theirs = wire.clone();
            let theirs = cobs::decode_in_place(&mut theirs).ok().map(|length| theirs[..length].to_vec());
            prop_assert_eq!(uncover(&mut wire).map(<[u8]>::to_vec), theirs);
        }

        #[test]
        fn random_bytes_are_no_frames(noise in prop::collection::vec(any::<u8>(), 0..2000)) {
            prop_assert!(decode(&noise).is_empty());
        }
    }
}
