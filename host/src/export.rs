//! What is seen, as files: PNG, CSV, WAV and a text for bug reports.

use crate::link::Snapshot;
use crate::live::Live;
use crate::model::Setup;
use crate::picture::{POINTS, Picture};
use crate::setup_file;
use crate::table_making::TableState;
use crate::trial::Measured;
use eframe::egui::ColorImage;
use std::fmt::Write as _;

/// Codes of a waveform as CSV, at most: 0.16 s at 400 kS/s.
const CSV_CODES: usize = 1 << 16;

/// A picture as PNG.
///
/// # Errors
/// What the encoder says; a picture of no size is one such case.
pub fn png(image: &ColorImage) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.size[0] as u32, image.size[1] as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    let pixels: Vec<u8> = image.pixels.iter().flat_map(|pixel| pixel.to_srgba_unmultiplied()).collect();
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// The envelope over x as CSV, SI units; the simulated plate's column is empty where nothing was measured.
#[must_use]
pub fn envelope_csv(picture: &Picture, measured: Option<&Measured>) -> String {
    let mut text = String::from("position_m,predicted_maximum_m,predicted_rms_m,simulated_maximum_m\n");
    for i in 0..POINTS {
        let x_m = i as f64 / (POINTS - 1) as f64 * picture.length_m;
        let value = |values: &[f64]| values.get(i).copied().unwrap_or(0.0);
        let simulated = measured
            .and_then(|measured| measured.at(x_m))
            .map_or_else(String::new, |metres| format!("{metres:e}"));
        // Writing to a string cannot fail.
        let _ =
            writeln!(text, "{x_m:.6},{:e},{:e},{simulated}", value(&picture.bound_m), value(&picture.rms_m));
    }
    text
}

/// The latest codes as CSV: the sample index, the time and the DAC code. `None` while there is none.
#[must_use]
pub fn waveform_csv(live: &Live) -> Option<String> {
    let window = live.window()?;
    let mut text = String::from("sample_index,time_s,dac_code\n");
    let skipped = window.codes.len().saturating_sub(CSV_CODES);
    for (i, code) in window.codes.iter().enumerate().skip(skipped) {
        let index = window.first + i as u64;
        let _ = writeln!(text, "{index},{:.9},{code}", index as f64 / window.sample_rate_hz);
    }
    Some(text)
}

/// The window of the drive as a 16-bit WAV at the device's rate. `None` while there is none.
///
/// # Errors
/// What the encoder says.
pub fn wav(live: &Live) -> Result<Option<Vec<u8>>, hound::Error> {
    let Some(window) = live.window() else { return Ok(None) };
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: window.sample_rate_hz as u32,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut file, spec)?;
    for &code in window.codes.iter() {
        // Twelve bits about mid-scale to sixteen about zero.
        writer.write_sample(((i32::from(code) - 2048) * 16) as i16)?;
    }
    writer.finalize()?;
    Ok(Some(file.into_inner()))
}

/// All that helps to find a fault: versions, counters, setup, log. It holds no name of the user or the machine.
#[must_use]
pub fn diagnostics(snapshot: &Snapshot, setup: &Setup, table: &TableState) -> String {
    let mut text = format!(
        "Slipline {} on {} {}\n",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    let mut part = |title: &str, body: String| {
        let _ = write!(text, "\n== {title}\n{body}\n");
    };
    part(
        "link",
        format!(
            "{:?}\n{:?}\n{:?}\n{:?}",
            snapshot.link, snapshot.round_trip, snapshot.counters, snapshot.decoder
        ),
    );
    part("device", format!("{:#?}", snapshot.identity));
    part("status", format!("{:#?}", snapshot.status));
    part("device table", format!("{:?}, verified {:?}", snapshot.table, snapshot.upload_verified));
    let made = match table {
        TableState::Ready(made) => format!("{:?}", made.device_table.header()),
        TableState::Failed(reason) => reason.clone(),
        TableState::Waiting => "waiting for a device".to_owned(),
        TableState::Making => "being made".to_owned(),
        TableState::Cancelled => "given up".to_owned(),
    };
    part("screen table", made);
    part("setup", setup_file::write(setup));
    let log: Vec<String> = snapshot.log.iter().map(crate::view::log_line).collect();
    part("log", log.join("\n"));
    text
}
