//! `slipline record`.

use super::destination::Destination;
use super::{Failure, RecordArguments, argument, output, progress};
use serde_json::json;
use slipline_link::DriveRequest;
use slipline_link::simulator::loopback::Loopback;
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_plate::Plate;

pub(super) fn run(arguments: &RecordArguments, as_json: bool) -> Result<(), Failure> {
    let plate = argument::plate(&arguments.plate.plate)?;
    let tones = arguments.tones.on(&plate)?;
    let seconds = arguments.seconds;
    let wav = Destination::new(&arguments.wav, arguments.force)?;
    let samples = (seconds * f64::from(SAMPLE_RATE_HZ)).round() as u64;
    write(&wav, &plate, &tones, samples)?;
    let value = json!({
        "wav": arguments.wav.display().to_string(),
        "sample_rate_hz": SAMPLE_RATE_HZ,
        "samples": samples,
        "seconds": seconds,
    });
    output::print(as_json, &value, |out| {
        let (name, kilohertz) = (arguments.wav.display(), f64::from(SAMPLE_RATE_HZ) / 1e3);
        writeln!(out, "{samples} codes ({seconds} s at {kilohertz} kS/s) written to {name}.")
    })
}

/// Records this many codes, from the block in which the drive begins.
fn write(wav: &Destination, plate: &Plate, tones: &[(f64, f64)], samples: u64) -> Result<(), Failure> {
    let (_, table) = progress::table_for(plate, SAMPLE_RATE_HZ)?;
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
