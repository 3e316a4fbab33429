//! The crate in four steps: a plate of your own, turning points, a drive table, and a tone in the time domain.
//!
//! `cargo run -p slipline-plate --example tour`

use slipline_plate::{DriveTable, Equation, Plate, TimeDomainLine, preset, respond};
use std::error::Error;
use std::f64::consts::TAU;

fn main() -> Result<(), Box<dyn Error>> {
    own_plate()?;
    turning_points()?;
    drive_table()?;
    envelope()
}

const TEXT: &str = r#"
name = "my membrane"
length_m = 0.3
loss_factor = 0.01
band_start_hz = 90.0
band_end_hz = 200.0

[taper]
kind = "exponential"
half_width_m = 0.05
rate_per_m = 4.62

[model]
kind = "membrane"
wave_speed_m_per_s = 12.0

[drive]
end = "displacement"
"#;

/// A plate of your own, from the text of a plate file; every error names the line, the field and its range.
fn own_plate() -> Result<(), Box<dyn Error>> {
    let plate = Plate::from_toml(TEXT)?;
    let (start_m, end_m) = plate.span_m();
    println!("{}: boundaries from {:.1} to {:.1} mm", plate.name(), start_m * 1e3, end_m * 1e3);

    let too_long = TEXT.replace("length_m = 0.3", "length_m = 30");
    if let Err(error) = Plate::from_toml(&too_long) {
        println!("refused: {error}");
    }
    Ok(())
}

/// Turning point of a frequency on a plate, and the width of its edge.
fn turning_points() -> Result<(), Box<dyn Error>> {
    let plate = preset("membrane").ok_or("no such preset")?;
    let (low, high) = plate.band_hz();
    println!("{}: {low:.1} to {high:.1} Hz", plate.name());
    for i in 0..=4 {
        let frequency_hz = low * (high / low).powf(f64::from(i) / 4.0);
        let turning_point = plate.turning_point_m(frequency_hz).zip(plate.edge_width_m(frequency_hz));
        if let Some((place_m, width_m)) = turning_point {
            println!(
                "{frequency_hz:8.1} Hz turns at {:6.1} mm, edge {:5.1} mm",
                place_m * 1e3,
                width_m * 1e3
            );
        }
    }
    Ok(())
}

/// The drive table of a plate: for each place of the boundary a frequency and a gain.
fn drive_table() -> Result<(), Box<dyn Error>> {
    let plate = preset("al-bending").ok_or("no such preset")?;
    let table = DriveTable::build(&plate, 400e3, 257)?;
    println!("place/mm  frequency/Hz  gain");
    for knot in table.knots().iter().step_by(32) {
        println!("{:8.1}  {:12.1}  {:.4}", knot.position_m * 1e3, knot.frequency_hz, knot.gain);
    }
    println!("the peak keeps its level within {:.2} dB", table.worst_error_db());
    Ok(())
}

/// A tone in the time domain: DAC codes in, the envelope's peak out, beside the frequency-domain solution.
fn envelope() -> Result<(), Box<dyn Error>> {
    let plate = preset("membrane").ok_or("no such preset")?;
    let (rate_hz, frequency_hz) = (400e3, 150.0);
    let mut line = TimeDomainLine::new(&plate, rate_hz, 257)?;
    let settle = (line.settle_time_s() * rate_hz) as u64;
    let measure = (0.1 * rate_hz) as u64;
    let code = |n: u64| (TAU * frequency_hz * n as f64 / rate_hz).cos() as f32;
    line.push(&(0..settle).map(code).collect::<Vec<_>>());
    line.reset_envelope();
    line.push(&(settle..settle + measure).map(code).collect::<Vec<_>>());

    let steady = respond(&plate, frequency_hz, 257, Equation::Corrected)?;
    for (domain, peak) in [("time", line.envelope().peak(&plate, frequency_hz)), ("frequency", steady.peak)] {
        match peak {
            Some(peak) => println!("{domain} domain: peak at {:.2} mm", peak.position_m * 1e3),
            None => println!("{domain} domain: no peak"),
        }
    }
    Ok(())
}
