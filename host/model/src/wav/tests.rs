//! WAV files of all formats, and damaged ones.

mod heads;
#[cfg(feature = "native")]
mod lossless;

use super::*;
use hound::{SampleFormat, WavSpec, WavWriter};
use slipline_plate::truth::Random;
use std::io::Cursor;

/// A file whose channels have different values.
fn file(rate: u32, channels: u16, bits: u16, format: SampleFormat) -> Vec<u8> {
    let spec = WavSpec { channels, sample_rate: rate, bits_per_sample: bits, sample_format: format };
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = WavWriter::new(&mut bytes, spec).unwrap();
    for frame in 0..50 {
        for channel in 0..channels {
            let value = value(frame, channel);
            match format {
                SampleFormat::Float => writer.write_sample(value as f32).unwrap(),
                SampleFormat::Int => {
                    let full = 2_f64.powi(i32::from(bits) - 1);
                    writer.write_sample((value * full).clamp(-full, full - 1.0) as i32).unwrap();
                }
            }
        }
    }
    writer.finalize().unwrap();
    bytes.into_inner()
}

fn value(frame: u32, channel: u16) -> f64 {
    (0.2 * f64::from(frame)).sin() / f64::from(channel + 1)
}

#[test]
fn integers_of_8_16_24_and_32_bits_and_floats_are_read_channel_by_channel() {
    for (bits, format) in [
        (8, SampleFormat::Int),
        (16, SampleFormat::Int),
        (24, SampleFormat::Int),
        (32, SampleFormat::Int),
        (32, SampleFormat::Float),
    ] {
        for (rate, channels) in [(8_000, 1), (48_000, 2), (384_000, 5)] {
            let wav = Wav::read(file(rate, channels, bits, format)).unwrap();
            assert_eq!((wav.channels(), wav.rate_hz()), (usize::from(channels), f64::from(rate)));
            assert!((wav.seconds() - 50.0 / f64::from(rate)).abs() < 1e-12);
            for channel in 0..channels {
                let sound = wav.channel(usize::from(channel) + 1).unwrap();
                assert_eq!((sound.values.len(), sound.end.is_none()), (50, format == SampleFormat::Float));
                for (frame, found) in (0..).zip(&sound.values) {
                    let error = (found - value(frame, channel)).abs();
                    assert!(error <= sound.step.max(1e-7), "{bits} {channel} {frame}: {error}");
                }
            }
        }
    }
}

#[test]
fn a_file_that_is_not_read_names_its_field_and_range() {
    let refused = |bytes: Vec<u8>| Wav::read(bytes).unwrap_err().to_string();
    let refusal = refused(file(4_000, 1, 16, SampleFormat::Int));
    assert!(refusal.starts_with("rate = 4000 Hz: must be 8000 to 384000 Hz"), "{refusal}");
    let mut bytes = file(48_000, 1, 16, SampleFormat::Int);
    bytes[34] = 12;
    let refusal = refused(bytes.clone());
    assert!(
        refusal.starts_with("integers of 12 bits in 2 bytes: must be integers of 8, 16, 24 or 32"),
        "{refusal}"
    );
    bytes[20] = 7;
    let refusal = refused(bytes);
    assert_eq!(
        refusal,
        "values compressed with loss (mu-law): record as WAV of plain values, FLAC or lossless"
    );
    let wav = Wav::read(file(48_000, 2, 16, SampleFormat::Int)).unwrap();
    for number in [0, 3] {
        let refusal = wav.channel(number).unwrap_err().to_string();
        assert_eq!(refusal, format!("channel {number}: must be 1 to 2, the channels of the file"));
    }
    // A file that a copy has cut short has the values that are left.
    let mut short = file(48_000, 2, 16, SampleFormat::Int);
    short.truncate(short.len() - 21);
    assert_eq!(Wav::read(short).unwrap().channel(2).unwrap().values.len(), 44);
    let mut bytes = file(48_000, 1, 32, SampleFormat::Float);
    let end = bytes.len();
    bytes[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
    let refusal = Wav::read(bytes).unwrap().channel(1).unwrap_err().to_string();
    assert!(refusal.contains("value 50: must be a finite number"), "{refusal}");
    for bytes in [&b"RF64\xff\xff\xff\xffWAVE"[..], b"RIFF", b"RIFF\0\0\0\0AVI ", b"RIFX\0\0\0\0WAVE"] {
        assert!(refused(bytes.to_vec()).starts_with("the WAV file cannot be read: "));
    }
}

#[test]
fn no_bytes_make_the_reader_panic() {
    let files = [
        file(48_000, 2, 16, SampleFormat::Int),
        file(96_000, 3, 24, SampleFormat::Int),
        file(44_100, 1, 32, SampleFormat::Float),
    ];
    let mut random = Random::new(7);
    let mut below = |most: usize| (random.bits() % most as u64) as usize;
    let mut read = 0;
    for round in 0..6000 {
        let mut bytes = files[round % files.len()].clone();
        // The header is damaged more often than the values, and sometimes the file is truncated.
        for _ in 0..1 + below(4) {
            let place = if below(4) > 0 { below(72) } else { below(bytes.len()) };
            bytes[place] = [0, 1, 0xff, 0x80, below(256) as u8][below(5)];
        }
        if below(5) == 0 {
            bytes.truncate(below(bytes.len()));
        }
        if let Ok(wav) = Wav::read(bytes) {
            let sound = wav.channel(1 + below(wav.channels() + 1));
            read += usize::from(sound.is_ok());
        }
    }
    // Some of the damage has no effect.
    assert!(read > 500, "{read}");
}
