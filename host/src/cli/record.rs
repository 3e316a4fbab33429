//! `slipline record`.

use super::argument;
use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::setup_source::SetupArgument;
use super::{output, progress, tones};
use clap::Args;
use serde_json::json;
use slipline_link::Sounding;
use slipline_link::simulator::loopback::Loopback;
use slipline_model::answer::ToneAnswer;
use slipline_model::atomic_file::{STANDARD_STREAM, is_stream};
use slipline_model::field::simulation::{MAX_SECONDS, SAMPLE_RATE_HZ};
use slipline_model::field::tone_places::TonePlaces;
use slipline_plate::quantity::number_format::rounded;
use std::path::{Path, PathBuf};

/// `record`.
#[derive(Debug, Args)]
pub struct RecordArguments {
    #[command(flatten)]
    sounds: SetupArgument,
    /// Duration of the recording, 1ms to 600s.
    #[arg(long = "for", alias = "seconds", value_name = "TIME", value_parser = argument::seconds(0.001, MAX_SECONDS), allow_hyphen_values = true, default_value = "1s")]
    duration: f64,
    /// The WAV file (.wav; -): one channel, 16 bits, at the device's sample rate.
    #[arg(long, value_name = "FILE", value_parser = wav_file, required_unless_present = "wav", help_heading = "Output")]
    out: Option<PathBuf>,
    #[arg(long, hide = true, value_name = "F", conflicts_with = "out")]
    wav: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
}

/// A file whose name ends in .wav, or a stream.
fn wav_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_wav = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("wav"));
    let is_allowed = is_wav || is_stream(&path) || path == Path::new(STANDARD_STREAM);
    is_allowed.then_some(path).ok_or_else(|| "must end in .wav".to_owned())
}

pub(super) fn run(arguments: &RecordArguments, as_json: bool) -> Result<(), Failure> {
    let wanted = arguments.sounds.read()?;
    let seconds = arguments.duration;
    let path = arguments.out.as_deref().or(arguments.wav.as_deref()).unwrap_or(Path::new(""));
    let wav = Destination::new(path, arguments.force)?;
    let samples = (seconds * f64::from(SAMPLE_RATE_HZ)).round() as u64;
    let (table, device_table) = progress::table_for(&wanted.plate, SAMPLE_RATE_HZ)?;
    let setup = wanted.setup(&table)?;
    let mut chain = Loopback::connect(SAMPLE_RATE_HZ).map_err(Failure::failed)?;
    let sounding = wanted.sounding(&setup, &device_table, chain.view())?;
    let (places, gain_db) = TonePlaces::as_played(setup, Some(&sounding), &table);
    chain.use_table(device_table).map_err(Failure::failed)?;
    write(&wav, chain, sounding, samples)?;
    let value = json!({
        "plate": wanted.plate.name(),
        "sample_rate_hz": SAMPLE_RATE_HZ,
        "samples": samples,
        // JSON: Time of the recording
        "recorded_s": seconds,
        "files": Destination::names([&wav]),
        "feeling": wanted.feeling.answer(),
        "tones": places.iter().map(|tone| ToneAnswer::of(tone, tone.frequency_hz)).collect::<Vec<_>>(),
        "chord_gain_db": gain_db,
    });
    output::print(as_json, &value, |out| {
        for tone in &places {
            writeln!(out, "{}", tones::words(tone, tone.frequency_hz))?;
        }
        writeln!(out, "{}", wanted.feeling.words())?;
        if let Some(gain_db) = gain_db {
            writeln!(out, "As a chord, {gain_db:.1} dB above the setup's levels.")?;
        }
        let (name, kilohertz) = (path.display(), f64::from(SAMPLE_RATE_HZ) / 1e3);
        let seconds = rounded(seconds, 6);
        writeln!(out, "{samples} codes ({seconds} s at {kilohertz} kS/s) written to {name}.")
    })
}

/// Records this many codes, from the block in which the drive begins.
fn write(wav: &Destination, mut chain: Loopback, sounding: Sounding, samples: u64) -> Result<(), Failure> {
    let begin = chain.samples();
    let mut codes = Vec::new();
    let at = chain.play(sounding, |block| codes.extend_from_slice(block)).map_err(Failure::failed)?;

    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: SAMPLE_RATE_HZ,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    wav.write(|file| {
        let mut wav = hound::WavWriter::new(file, spec)?;
        let mut left = samples;
        let mut result = Ok(());
        let mut take = |codes: &[u16]| {
            for &code in codes.iter().take(left as usize) {
                // 12 bits around mid-scale, shifted to the upper bits of 16.
                let sample = (i32::from(code) - 2048) * 16;
                result = std::mem::replace(&mut result, Ok(())).and_then(|()| wav.write_sample(sample));
                left -= 1;
            }
        };
        take(codes.get((at.saturating_sub(begin)) as usize..).unwrap_or_default());
        // Rounded up to whole blocks, so there are always enough codes.
        chain.pass(samples, &mut take);
        result?;
        Ok(wav.finalize()?)
    })
}
