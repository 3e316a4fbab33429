//! `slipline record`.

use super::destination::Destination;
use super::{Failure, RecordArguments, argument, output, progress, tones};
use serde_json::{Value, json};
use slipline_link::DriveRequest;
use slipline_link::simulator::loopback::Loopback;
use slipline_link::table::DeviceTable;
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_model::field::tone_places::TonePlaces;
use std::sync::Arc;

pub(super) fn run(arguments: &RecordArguments, as_json: bool) -> Result<(), Failure> {
    let plate = Arc::new(argument::plate(&arguments.plate.plate)?);
    let asked = arguments.tones.on(&plate)?;
    let seconds = arguments.seconds;
    let wav = Destination::new(&arguments.wav, arguments.force)?;
    let samples = (seconds * f64::from(SAMPLE_RATE_HZ)).round() as u64;
    let (table, device_table) = progress::table_for(&plate, SAMPLE_RATE_HZ)?;
    let setup = asked.setup(&plate, &table)?;
    write(&wav, device_table, &tones::turning_points(&setup), samples)?;
    let places = TonePlaces::of_setup(&setup, &table);
    let value = json!({
        "wav": arguments.wav.display().to_string(),
        "plate": plate.name(),
        "sample_rate_hz": SAMPLE_RATE_HZ,
        "samples": samples,
        "seconds": seconds,
        "feeling": asked.feeling.value(),
        "tones": places.iter().map(|tone| tones::value(tone, tone.frequency_hz)).collect::<Vec<Value>>(),
    });
    output::print(as_json, &value, |out| {
        for tone in &places {
            writeln!(out, "{}", tones::words(tone, tone.frequency_hz))?;
        }
        writeln!(out, "{}", asked.feeling.words())?;
        let (name, kilohertz) = (arguments.wav.display(), f64::from(SAMPLE_RATE_HZ) / 1e3);
        writeln!(out, "{samples} codes ({seconds} s at {kilohertz} kS/s) written to {name}.")
    })
}

/// Records this many codes, from the block in which the drive begins. The tones are given by (turning point in metres,
/// level).
fn write(
    wav: &Destination,
    table: Arc<DeviceTable>,
    tones: &[(f64, f64)],
    samples: u64,
) -> Result<(), Failure> {
    table.check_sum(tones).map_err(Failure::usage)?;
    let mut chain = Loopback::connect(SAMPLE_RATE_HZ).map_err(Failure::failed)?;
    chain.use_table(table).map_err(Failure::failed)?;
    let begin = chain.samples();
    let mut codes = Vec::new();
    let drive = DriveRequest::at(tones);
    let at = chain.play(drive, |block| codes.extend_from_slice(block)).map_err(Failure::failed)?;

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
