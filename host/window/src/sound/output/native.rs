//! Sound by the system's own interface.

use crate::sound::system::SampleSource;
use anyhow::Context as _;
use cpal::traits::{DeviceTrait as _, HostTrait as _, StreamTrait as _};
use std::sync::mpsc::channel;

/// Plays what `source` gives until it ends. Calls `playing` once it plays.
pub(in crate::sound) fn run(playing: &dyn Fn(), mut source: SampleSource) -> anyhow::Result<()> {
    let device = cpal::default_host().default_output_device().context("this computer has no sound output")?;
    let supported = device.default_output_config()?;
    if supported.sample_format() != cpal::SampleFormat::F32 {
        anyhow::bail!("the sound output takes {}, not floats", supported.sample_format());
    }
    let config = supported.config();
    let (channels, rate_hz) = (usize::from(config.channels), f64::from(config.sample_rate));
    let (ended, end) = channel();
    let failed = ended.clone();
    let mut samples = Vec::new();
    let fill = move |output: &mut [f32], _: &cpal::OutputCallbackInfo| {
        samples.resize(output.len() / channels, 0.0);
        if !source.fill(rate_hz, &mut samples) {
            // The receiver is gone when it has ended before.
            let _ = ended.send(Ok(()));
        }
        for (frame, sample) in output.chunks_exact_mut(channels).zip(&samples) {
            frame.fill(*sample);
        }
    };
    let fail = move |error: cpal::Error| {
        let _ = failed.send(Err(error.into()));
    };
    let stream = device.build_output_stream(config, fill, fail, None)?;
    stream.play()?;
    playing();
    end.recv().unwrap_or(Ok(()))
}
