//! Lossless recordings as Debian's `ffmpeg` and `flac` write them, and lossy ones.

use super::*;
use crate::content::Content;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Two channels of noise and a tone, as integers of these bits.
fn recorded(bits: u16) -> Vec<u8> {
    let mut random = Random::new(u64::from(bits));
    let spec =
        WavSpec { channels: 2, sample_rate: 48_000, bits_per_sample: bits, sample_format: SampleFormat::Int };
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = WavWriter::new(&mut bytes, spec).unwrap();
    let full = 2_f64.powi(i32::from(bits) - 1);
    for frame in 0..20_000 {
        let tone = 0.5 * (0.03 * f64::from(frame)).sin();
        writer.write_sample((full * (tone + random.within(-0.2, 0.2))) as i32).unwrap();
        writer.write_sample((full * random.within(-0.9, 0.9)) as i32).unwrap();
    }
    writer.finalize().unwrap();
    bytes.into_inner()
}

fn run(program: &str, arguments: &[&str], folder: &Path) {
    let output = Command::new(program).args(arguments).current_dir(folder).output();
    let output =
        output.unwrap_or_else(|error| panic!("{program} is needed, as .ci/run tools installs it: {error}"));
    assert!(output.status.success(), "{program} {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// A folder with `in.wav`.
fn folder(name: &str, wav: &[u8]) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("slipline-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("in.wav"), wav).unwrap();
    folder
}

fn converted(folder: &Path, more: &[&str], name: &str) -> Vec<u8> {
    let convert = [&["-loglevel", "error", "-y", "-i", "in.wav"][..], more, &[name]].concat();
    run("ffmpeg", &convert, folder);
    std::fs::read(folder.join(name)).unwrap()
}

#[test]
#[ignore = "needs ffmpeg and flac: .ci/run recordings"]
fn lossless_files_have_the_values_of_the_wav_that_they_were_made_of() {
    for bits in [16, 24] {
        let wav = recorded(bits);
        let folder = folder(&format!("lossless-{bits}"), &wav);
        let wav = Wav::read(wav).unwrap();
        run("flac", &["--silent", "--force", "-o", "flac.flac", "in.wav"], &folder);
        run("flac", &["--silent", "--force", "-0", "--no-padding", "-o", "fast.flac", "in.wav"], &folder);
        let big = format!("pcm_s{bits}be");
        let mut files = vec![
            ("FLAC", std::fs::read(folder.join("flac.flac")).unwrap()),
            ("FLAC", std::fs::read(folder.join("fast.flac")).unwrap()),
            ("FLAC", converted(&folder, &[], "ffmpeg.flac")),
            ("M4A", converted(&folder, &["-c:a", "alac"], "alac.m4a")),
            ("M4A", converted(&folder, &["-c:a", "alac", "-movflags", "+faststart"], "fast.m4a")),
            ("AIFF", converted(&folder, &["-c:a", &big], "big.aiff")),
        ];
        let tagged = [b"ID3\x04\0\0\0\0\0\x0a..........", &files[0].1[..]].concat();
        assert_eq!(Content::of(&tagged), Content::Lossless("FLAC"));
        files.push(("FLAC", tagged));
        if bits == 16 {
            // The low byte first, which no AIFF has with 24 bits.
            files.push(("AIFF", converted(&folder, &["-c:a", "pcm_s16le", "-f", "aiff"], "sowt.aifc")));
        }
        for (name, bytes) in files {
            let read =
                Wav::read_lossless(name, bytes).unwrap_or_else(|error| panic!("{name} {bits}: {error}"));
            assert_eq!((read.channels(), read.rate_hz()), (2, 48e3), "{name} {bits}");
            for channel in [1, 2] {
                let (found, truth) = (read.channel(channel).unwrap(), wav.channel(channel).unwrap());
                assert_eq!((found.end, found.step), (truth.end, truth.step), "{name} {bits}");
                assert!(found.values == truth.values, "{name} {bits}: {} values", found.values.len());
            }
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}

#[test]
#[ignore = "needs ffmpeg and flac: .ci/run recordings"]
fn lossy_files_are_refused_in_words() {
    let folder = folder("lossy", &recorded(16));
    for (codec, name) in
        [("libmp3lame", "a.mp3"), ("libvorbis", "a.ogg"), ("libopus", "a.opus"), ("aac", "a.aac")]
    {
        let bytes = converted(&folder, &["-c:a", codec], name);
        let Content::Foreign(words) = Content::of(&bytes) else { panic!("{name}") };
        assert!(words.ends_with("compressed with loss: record as WAV, FLAC or lossless"), "{words}");
    }
    let bytes = converted(&folder, &["-c:a", "aac"], "aac.m4a");
    assert_eq!(Content::of(&bytes), Content::Lossless("M4A"));
    let refused = Wav::read_lossless("M4A", bytes).unwrap_err().to_string();
    assert!(refused.contains("compressed with loss") && refused.ends_with("FLAC or lossless"), "{refused}");
    for codec in ["pcm_mulaw", "pcm_alaw"] {
        let bytes = converted(&folder, &["-c:a", codec, "-f", "aiff"], "lossy.aifc");
        let refused = Wav::read_lossless("AIFF", bytes).unwrap_err().to_string();
        assert!(refused.contains("compressed with loss"), "{refused}");
    }
    for codec in ["adpcm_ms", "pcm_mulaw", "pcm_alaw"] {
        let refused = Wav::read(converted(&folder, &["-c:a", codec], "lossy.wav")).unwrap_err().to_string();
        assert!(refused.starts_with("values compressed with loss ("), "{refused}");
    }
    for codec in ["pcm_u8", "pcm_s24le", "pcm_s32le", "pcm_f32le", "pcm_f64le"] {
        for form in [&["-rf64", "always"][..], &[]] {
            let bytes = converted(&folder, &[&["-c:a", codec], form].concat(), "plain.wav");
            assert_eq!(
                Wav::read(bytes).unwrap().channel(2).unwrap().values.len(),
                20_000,
                "{codec} {form:?}"
            );
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
#[ignore = "needs ffmpeg and flac: .ci/run recordings"]
fn no_damage_makes_the_reader_panic() {
    let folder = folder("damaged", &file(48_000, 2, 16, SampleFormat::Int));
    let files = [
        ("FLAC", converted(&folder, &[], "a.flac")),
        ("M4A", converted(&folder, &["-c:a", "alac"], "a.m4a")),
        ("AIFF", converted(&folder, &[], "a.aiff")),
    ];
    std::fs::remove_dir_all(folder).unwrap();
    let mut random = Random::new(11);
    let mut below = |most: usize| (random.bits() % most as u64) as usize;
    for round in 0..6000 {
        let (name, whole) = &files[round % files.len()];
        let mut bytes = whole.clone();
        for _ in 0..1 + below(4) {
            let place = if below(3) > 0 { below(bytes.len().min(700)) } else { below(bytes.len()) };
            bytes[place] = [0, 1, 0xff, 0x80, below(256) as u8][below(5)];
        }
        if below(5) == 0 {
            bytes.truncate(below(bytes.len()));
        }
        let _ = Wav::read_lossless(name, bytes);
    }
}

#[test]
fn damaged_lossless_files_are_refused_by_their_format() {
    for name in ["FLAC", "M4A", "AIFF"] {
        for bytes in
            [&b""[..], b"fLaC", &[b"fLaC\0\0\0\x22", &[0; 400][..]].concat(), b"\0\0\0 ftypM4A ", &[0; 400]]
        {
            let refused = Wav::read_lossless(name, bytes.to_vec()).unwrap_err().to_string();
            assert!(refused.starts_with(&format!("the {name} file cannot be read: ")), "{refused}");
        }
    }
}
