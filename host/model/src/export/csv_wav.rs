//! Envelope and waveform as CSV and WAV files.

use crate::field::rings::Rings;
use crate::field::steady_field::{POINTS, SteadyField};
use crate::field::tone_places::TonePlaces;
use crate::setup::Setup;
use crate::waveform::Waveform;
use slipline_plate::order;
use std::fmt::Write as _;

/// Largest number of codes of a waveform in a CSV file: 0.16 s at 400 kS/s.
const CSV_CODES: usize = 1 << 16;

/// The envelope over x as CSV in SI units, after a header that describes plate and tones. Theory and simulated
/// plate have different grids: a cell is empty where its column has no value. `full_peak_m` is the table's peak at
/// level 1.
#[must_use]
pub fn envelope_csv(
    setup: &Setup,
    steady: &SteadyField,
    measured: Option<&Rings<'_>>,
    full_peak_m: f64,
) -> String {
    let mut rows: Vec<(f64, String)> = Vec::new();
    for (i, (bound_m, rms_m)) in steady.bound_m.iter().zip(&steady.rms_m).enumerate() {
        let x_m = i as f64 / (POINTS - 1) as f64 * steady.length_m;
        rows.push((x_m, format!("{x_m:.6},{bound_m:e},{rms_m:e},,")));
    }
    if let Some(Rings { field: measured, .. }) = measured {
        let places = measured.position_m.iter().zip(&measured.maximum_m).zip(&measured.rms_m);
        rows.extend(
            places.map(|((&x_m, maximum_m), rms_m)| (x_m, format!("{x_m:.6},,,{maximum_m:e},{rms_m:e}"))),
        );
    }
    order::sort_by(&mut rows, |a, b| a.0.total_cmp(&b.0));
    let mut text = envelope_head(setup, steady, measured, full_peak_m);
    text.push_str("position_m,predicted_maximum_m,predicted_rms_m,simulated_maximum_m,simulated_rms_m\n");
    for (_, row) in rows {
        text.push_str(&row);
        text.push('\n');
    }
    text
}

/// The header of an envelope: plate and tones, line by line.
fn envelope_head(
    setup: &Setup,
    steady: &SteadyField,
    measured: Option<&Rings<'_>>,
    full_peak_m: f64,
) -> String {
    let simulated = match measured {
        Some(measured) => format!(
            "the {} while it was watched, at its own {} places; maximum and root mean square{}",
            measured.name(),
            measured.field.position_m.len(),
            measured.fitted.map_or(String::new(), |factor| format!(", all multiplied by {factor:.4}"))
        ),
        None => "not run for what is on the screen".to_owned(),
    };
    let mut head = vec![
        "Envelope along the plate, by Slipline".to_owned(),
        format!("plate: {}", setup.plate.name()),
        "felt edge: of the tone alone, at its level; illustrative".to_owned(),
        format!("master level: {:.2} dB", setup.master_db + 0.0),
        format!("peak at level 1: {full_peak_m:e} m"),
    ];
    for tone in &setup.tones {
        let frequency_hz = setup.plate.frequency_for_boundary_hz(tone.position_m);
        let places = TonePlaces::of_wave(setup, tone, frequency_hz, steady.tone(tone.slot));
        let felt = match places.felt_edge.place_m() {
            Some(place_m) => format!("felt edge {place_m:.6} m"),
            None => places.edge_words(),
        };
        head.push(format!(
            "tone {}: frequency {frequency_hz:.4} Hz, turning point {:.6} m, {felt}, level {:.4}, phase {:.4} turns",
            tone.slot + 1,
            tone.position_m,
            tone.level,
            tone.phase_turns
        ));
    }
    head.push(format!("predicted: steady state by theory, at {POINTS} places; maximum and root mean square"));
    head.push(format!("simulated: {simulated}"));
    head.push(
        "units: metres from the driven end, metres of displacement; an empty cell has no value".to_owned(),
    );
    head.iter().map(|line| format!("# {line}\n")).collect()
}

/// The latest codes as CSV: sample index, time and DAC code. `None` while there are no codes.
#[must_use]
pub fn waveform_csv(waveform: &Waveform) -> Option<String> {
    let window = waveform.window()?;
    let mut text = String::from("sample_index,time_s,dac_code\n");
    let skipped = window.codes.len().saturating_sub(CSV_CODES);
    for (i, code) in window.codes.iter().enumerate().skip(skipped) {
        let index = window.first + i as u64;
        let _ = writeln!(text, "{index},{:.9},{code}", index as f64 / window.sample_rate_hz);
    }
    Some(text)
}

/// The latest codes as a 16-bit WAV file at the device's rate. `None` while there are no codes.
///
/// # Errors
/// The error of the encoder.
pub fn wav(waveform: &Waveform) -> Result<Option<Vec<u8>>, hound::Error> {
    let Some(window) = waveform.window() else { return Ok(None) };
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: window.sample_rate_hz as u32,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut file, spec)?;
    for &code in window.codes.iter() {
        // From 12 bits around mid-scale to 16 bits around zero.
        writer.write_sample(((i32::from(code) - 2048) * 16) as i16)?;
    }
    writer.finalize()?;
    Ok(Some(file.into_inner()))
}

#[cfg(test)]
mod tests;
