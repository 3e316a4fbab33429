//! Heads of WAV files as recorders write them, at random: what is in the file is read, or the file is refused.

use super::*;

/// How the values of a file are written.
#[derive(Clone, Copy, Debug)]
enum Layout {
    /// Integers of these bits, at the upper end of these bytes.
    Upper(u32, usize),
    /// 24 bits at the lower end of 4 bytes.
    Lower24,
    Float32,
    Float64,
}

struct Written {
    bytes: Vec<u8>,
    /// The values by channels.
    truth: Vec<Vec<f64>>,
    /// Whether the file must be read.
    is_sound: bool,
}

fn below(random: &mut Random, most: usize) -> usize {
    (random.bits() % most as u64) as usize
}

fn chunk(name: &[u8; 4], size: u32, content: &[u8], has_pad: bool) -> Vec<u8> {
    let pad: &[u8] = if content.len() % 2 == 1 && has_pad { &[0] } else { &[] };
    [&name[..], &size.to_le_bytes(), content, pad].concat()
}

/// A value, as it is stored, and its bytes.
fn stored(layout: Layout, value: f64) -> (f64, Vec<u8>) {
    match layout {
        Layout::Float64 => (value, value.to_le_bytes().to_vec()),
        Layout::Float32 => (f64::from(value as f32), (value as f32).to_le_bytes().to_vec()),
        Layout::Lower24 => {
            let number = (value * 8_388_608.0) as i32;
            (f64::from(number) / 8_388_608.0, number.to_le_bytes().to_vec())
        }
        Layout::Upper(bits, bytes) => {
            let full = 2_f64.powi(bits as i32 - 1);
            let number = (value * full) as i64;
            let upper = number << (8 * bytes as u32 - bits);
            let upper = if bytes == 1 { upper + 128 } else { upper };
            (number as f64 / full, upper.to_le_bytes()[..bytes].to_vec())
        }
    }
}

fn written(random: &mut Random) -> Written {
    let layouts = [
        Layout::Upper(8, 1),
        Layout::Upper(16, 2),
        Layout::Upper(24, 3),
        Layout::Upper(32, 4),
        Layout::Upper(24, 4),
        Layout::Upper(20, 3),
        Layout::Lower24,
        Layout::Float32,
        Layout::Float64,
    ];
    let layout = layouts[below(random, layouts.len())];
    let (bytes, valid, tag) = match layout {
        Layout::Upper(bits, bytes) => (bytes, bits, 1),
        Layout::Lower24 => (4, 24, 1),
        Layout::Float32 => (4, 32, 3),
        Layout::Float64 => (8, 64, 3_u16),
    };
    let needs_extension = valid as usize != 8 * bytes && !matches!(layout, Layout::Lower24);
    let is_extensible = !matches!(layout, Layout::Lower24) && (needs_extension || below(random, 2) == 0);
    let (channels, frames) = (1 + below(random, 4), 20 + below(random, 40));
    let rate = [8_000_u32, 44_100, 48_000, 384_000][below(random, 4)];
    let mut truth = vec![Vec::new(); channels];
    let mut values = Vec::new();
    for _ in 0..frames {
        for channel in &mut truth {
            let (value, bytes) = stored(layout, random.within(-0.99, 0.99));
            channel.push(value);
            values.extend(bytes);
        }
    }
    let frame = (bytes * channels) as u16;
    let container = if matches!(layout, Layout::Lower24) { 24 } else { 8 * bytes as u16 };
    let mut format = [if is_extensible { 0xfffe } else { tag }, channels as u16]
        .iter()
        .flat_map(|number: &u16| number.to_le_bytes())
        .collect::<Vec<_>>();
    format.extend(rate.to_le_bytes());
    format.extend((rate * u32::from(frame)).to_le_bytes());
    format.extend(frame.to_le_bytes());
    format.extend(container.to_le_bytes());
    if is_extensible {
        format.extend(22_u16.to_le_bytes());
        format.extend((valid as u16).to_le_bytes());
        format.extend(3_u32.to_le_bytes());
        format.extend(tag.to_le_bytes());
        format.extend([0, 0, 0, 0, 16, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71]);
    } else if below(random, 3) == 0 {
        format.extend(0_u16.to_le_bytes());
    }
    let is_long = below(random, 4) == 0;
    let size = values.len() as u32;
    let is_to_the_end = below(random, 2) == 0;
    let stated = match (is_to_the_end, is_long) {
        (true, false) => [0, u32::MAX, 0x7fff_f000, size + 2 + below(random, 1000) as u32][below(random, 4)],
        (true, true) => [0, u32::MAX][below(random, 2)],
        (false, true) => u32::MAX,
        (false, false) => size,
    };
    let mut file = if is_long { b"RF64".to_vec() } else { b"RIFF".to_vec() };
    file.extend(if is_long { u32::MAX } else { below(random, 1 << 30) as u32 }.to_le_bytes());
    file.extend(b"WAVE");
    if is_long {
        let long = if is_to_the_end { [0, u64::MAX][below(random, 2)] } else { u64::from(size) };
        let sizes = [0_u64, long, frames as u64].map(u64::to_le_bytes).concat();
        file.extend(chunk(b"ds64", 28, &[&sizes[..], &[0; 4]].concat(), true));
    }
    let mut is_sound = true;
    // Any names, the content of any bytes, pad bytes or none.
    let others = |random: &mut Random, file: &mut Vec<u8>, is_sound: &mut bool| {
        for _ in 0..below(random, 4) {
            let known = [*b"LIST", *b"fact", *b"bext", *b"JUNK", *b"cue ", *b"iXML", *b"xyz1", *b"Junk"];
            let name = known[below(random, known.len())];
            let content: Vec<u8> = (0..below(random, 60)).map(|_| random.bits() as u8).collect();
            let has_pad = below(random, 2) == 0;
            // Two readings of a name that no recorder writes are two truths.
            *is_sound &= has_pad || content.len().is_multiple_of(2);
            file.extend(chunk(&name, content.len() as u32, &content, has_pad));
        }
    };
    others(random, &mut file, &mut is_sound);
    file.extend(chunk(b"fmt ", format.len() as u32, &format, true));
    others(random, &mut file, &mut is_sound);
    let has_more = !is_to_the_end && values.len() % 2 == 0 && below(random, 2) == 0;
    file.extend(chunk(b"data", stated, &values, has_more));
    if has_more {
        others(random, &mut file, &mut true.clone());
    } else if is_to_the_end {
        // A frame that is not whole.
        file.extend(vec![1; below(random, bytes * channels)]);
    }
    Written { bytes: file, truth, is_sound }
}

#[test]
fn of_2000_random_heads_none_is_read_to_something_else() {
    let mut random = Random::new(49);
    let mut read = 0;
    for number in 0..2000 {
        let Written { bytes, truth, is_sound } = written(&mut random);
        match Wav::read(bytes) {
            Ok(wav) => {
                assert_eq!(wav.channels(), truth.len(), "{number}");
                for (channel, values) in (1..).zip(&truth) {
                    assert_eq!(&wav.channel(channel).unwrap().values, values, "{number}: channel {channel}");
                }
                read += 1;
            }
            Err(error) => assert!(!is_sound, "{number}: {error}"),
        }
    }
    assert!(read > 1950, "{read}");
}

#[test]
fn the_bits_of_a_value_are_those_that_the_head_states() {
    let one = |valid: u16, is_extensible: bool, value: i32| {
        let mut format =
            vec![if is_extensible { 0xfe } else { 1 }, if is_extensible { 0xff } else { 0 }, 1, 0];
        format.extend(48_000_u32.to_le_bytes());
        format.extend([0; 4]);
        format.extend([4, 0, if is_extensible { 32 } else { valid as u8 }, 0]);
        if is_extensible {
            format.extend([22, 0, valid as u8, 0, 1, 0, 0, 0, 1, 0]);
            format.extend([0, 0, 0, 0, 16, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71]);
        }
        let data = chunk(b"data", 4, &value.to_le_bytes(), true);
        let bytes = [&b"RIFF\0\0\0\0WAVE"[..], &chunk(b"fmt ", format.len() as u32, &format, true), &data];
        let sound = Wav::read(bytes.concat()).unwrap().channel(1).unwrap();
        (sound.values[0], sound.step)
    };
    let step = 0.5_f64.powi(23);
    assert_eq!(one(24, true, -0x4000_0000), (-0.5, step));
    assert_eq!(one(24, false, 0x4000_0000), (0.5, step));
    // At the lower end, as the writers do that state it by the bits alone.
    assert_eq!(one(24, false, -0x0040_0001), (-0.5 - step, step));
    assert_eq!(one(32, true, -0x4000_0000), (-0.5, 0.5_f64.powi(31)));
}

#[test]
fn a_recording_of_nothing_is_not_the_chunks_that_follow_it() {
    let bytes = file(48_000, 1, 16, SampleFormat::Int);
    let head = [&bytes[..40], &[0; 4]].concat();
    let more = chunk(b"LIST", 5, b"INFO1", true);
    let refused = Wav::read([&head[..], &more].concat()).unwrap_err().to_string();
    assert!(refused.starts_with("values of a channel = 0"), "{refused}");
    assert!(Wav::read(head).is_err());
}
