//! Lossless recordings of other formats than WAV: FLAC, ALAC in M4A, and AIFF.

use super::head::{Encoding, Format};
use super::{Wav, WavError};
use crate::content::tag_length;
use slipline_plate::quantity::must_be;
use std::io::Cursor;
use symphonia::core::audio::GenericAudioBufferRef;
use symphonia::core::codecs::audio::AudioDecoderOptions;
use symphonia::core::codecs::audio::well_known::{CODEC_ID_ALAC, CODEC_ID_PCM_ALAW, CODEC_ID_PCM_MULAW};
use symphonia::core::errors::Error;
use symphonia::core::formats::probe::Hint;
use symphonia::core::formats::{FormatOptions, TrackType};
use symphonia::core::io::MediaSourceStream;
use symphonia::core::meta::MetadataOptions;

/// Most values of all channels, so that a small file of silence fills no memory.
const VALUES_MAX: usize = 1 << 25;

/// Decodes a file; `name` is that of its format. The values are kept as floating point, which is exact for up to 53 bits.
pub(super) fn read(name: &'static str, mut bytes: Vec<u8>) -> Result<Wav, WavError> {
    let damaged = || WavError::Lossless(name, "it is empty or damaged".to_owned());
    let lossy = || {
        let what = "it is compressed with loss, or in a way that is not read";
        WavError::Lossless(name, format!("{what}: record as WAV, FLAC or lossless"))
    };
    let failed = |error: Error| if matches!(error, Error::Unsupported(_)) { lossy() } else { damaged() };
    if name == "AIFF" && !has_whole_frames(&bytes) {
        return Err(damaged());
    }
    bytes.drain(..tag_length(&bytes).min(bytes.len()));
    let stream = MediaSourceStream::new(Box::new(Cursor::new(bytes)), Default::default());
    let (options, tags) = (FormatOptions::default(), MetadataOptions::default());
    let mut reader =
        symphonia::default::get_probe().probe(&Hint::new(), stream, options, tags).map_err(|_| damaged())?;
    let track = reader.default_track(TrackType::Audio).ok_or_else(damaged)?;
    let number = track.id;
    let parameters =
        track.codec_params.as_ref().and_then(|parameters| parameters.audio()).ok_or_else(damaged)?;
    if matches!(parameters.codec, CODEC_ID_PCM_ALAW | CODEC_ID_PCM_MULAW) {
        return Err(lossy());
    }
    let stated = parameters.bits_per_sample.or(parameters.bits_per_coded_sample);
    // ALAC states its bits in a record of its own: after the length of a frame and a version.
    let own = parameters.extra_data.as_deref().filter(|_| parameters.codec == CODEC_ID_ALAC);
    let bits = stated.or_else(|| own?.get(5).copied().map(u32::from));
    let mut decoder = symphonia::default::get_codecs()
        .make_audio_decoder(parameters, &AudioDecoderOptions::default())
        .map_err(failed)?;
    let mut found: Option<Format> = None;
    let (mut values, mut packet_values) = (Vec::new(), Vec::<f64>::new());
    while let Some(packet) = reader.next_packet().map_err(failed)? {
        if packet.track_id != number {
            continue;
        }
        let decoded = decoder.decode(&packet).map_err(failed)?;
        let is_float = matches!(decoded, GenericAudioBufferRef::F32(_) | GenericAudioBufferRef::F64(_));
        let format = Format {
            encoding: Encoding::Float,
            bytes: size_of::<f64>(),
            bits: bits.filter(|bits| !is_float && (1..=32).contains(bits)),
            channels: decoded.spec().channels().count(),
            rate_hz: decoded.spec().rate(),
        };
        if format.channels == 0 || *found.get_or_insert(format) != format {
            return Err(damaged());
        }
        decoded.copy_to_vec_interleaved(&mut packet_values);
        if values.len() / size_of::<f64>() + packet_values.len() > VALUES_MAX {
            let allowed = format_args!("at most {VALUES_MAX}: record for a shorter time");
            return Err(WavError::Values(must_be("values of all channels", allowed)));
        }
        values.extend(packet_values.iter().flat_map(|value| value.to_le_bytes()));
    }
    let format = found.ok_or_else(damaged)?;
    Ok(Wav { values: 0..values.len(), bytes: values, format })
}

/// Whether the size of a frame of an AIFF file fits 16 bits: `symphonia` multiplies it in these (0.6.1), and panics otherwise.
fn has_whole_frames(bytes: &[u8]) -> bool {
    let mut at = 12;
    while let Some((head, content)) = bytes.get(at..).and_then(<[u8]>::split_first_chunk::<8>) {
        let [.., a, b, c, d] = *head;
        if head.starts_with(b"COMM") {
            let number = |at| content.get(at..at + 2).map_or(0, |it| u16::from_be_bytes([it[0], it[1]]));
            return (number(6) / 8).checked_mul(number(0)).is_some();
        }
        let size = u32::from_be_bytes([a, b, c, d]) as usize;
        at += 8 + size + size % 2;
    }
    true
}
