//! Sound by the protocol of PulseAudio.

use crate::sound::system::SampleSource;
use anyhow::anyhow;
use futures::executor::block_on;
use pulseaudio::protocol::stream::{BufferAttr, StreamFlags};
use pulseaudio::protocol::{ChannelMap, PlaybackStreamParams, SampleFormat, SampleSpec};
use pulseaudio::{AsPlaybackSource as _, Client};

const RATE_HZ: u32 = 48_000;
/// Bytes of a sample.
const SAMPLE: usize = size_of::<f32>();
/// What the server keeps ahead, in samples: 40 ms. Less would break on a busy computer; more would be heard late.
const AHEAD: u32 = RATE_HZ / 25;

/// Plays what `source` gives until it ends. Calls `playing` once it plays.
pub(in crate::sound) fn run(playing: &dyn Fn(), mut source: SampleSource) -> anyhow::Result<()> {
    let client = Client::from_env(c"Slipline").map_err(|error| explain(&error))?;
    let params = PlaybackStreamParams {
        sample_spec: SampleSpec { format: SampleFormat::Float32Le, channels: 1, sample_rate: RATE_HZ },
        channel_map: ChannelMap::mono(),
        buffer_attr: BufferAttr {
            max_length: u32::MAX,
            target_length: AHEAD * SAMPLE as u32,
            pre_buffering: u32::MAX,
            minimum_request_length: AHEAD / 4 * SAMPLE as u32,
            fragment_size: u32::MAX,
        },
        flags: StreamFlags { adjust_latency: true, ..StreamFlags::default() },
        ..PlaybackStreamParams::default()
    };
    let mut samples = Vec::new();
    let fill = move |bytes: &mut [u8]| {
        samples.resize(bytes.len() / SAMPLE, 0.0);
        if !source.fill(f64::from(RATE_HZ), &mut samples) {
            return 0;
        }
        for (bytes, sample) in bytes.chunks_exact_mut(SAMPLE).zip(&samples) {
            bytes.copy_from_slice(&sample.to_le_bytes());
        }
        samples.len() * SAMPLE
    };
    let stream = block_on(client.create_playback_stream(params, fill.as_playback_source()))
        .map_err(|error| explain(&error))?;
    playing();
    // Ends when there is nothing more to play; fails when the server is gone.
    block_on(stream.source_eof()).map_err(|error| explain(&error))
}

fn explain(error: &pulseaudio::ClientError) -> anyhow::Error {
    use pulseaudio::ClientError;
    match error {
        ClientError::ServerUnavailable => anyhow!("neither PulseAudio nor PipeWire is running here"),
        ClientError::Io(error) => anyhow!("the sound server cannot be reached: {error}"),
        ClientError::Disconnected => anyhow!("the sound server has ended the connection"),
        ClientError::ServerError(error) => anyhow!("the sound server refuses: {error}"),
        ClientError::UnexpectedSequenceNumber | ClientError::Protocol(_) => {
            anyhow!("the sound server gives an answer that is not understood")
        }
    }
}
