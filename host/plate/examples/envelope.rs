//! A tone in the time domain: DAC codes in, the envelope's peak out, beside the frequency-domain solution.
//!
//! `cargo run --release -p slipline-plate --example envelope`

use slipline_plate::{Equation, TimeDomainLine, preset, respond};
use std::error::Error;
use std::f64::consts::TAU;

fn main() -> Result<(), Box<dyn Error>> {
    let plate = preset("membrane").ok_or("no such preset")?;
    let (rate_hz, frequency_hz) = (400e3, 150.0);
    let mut line = TimeDomainLine::new(&plate, rate_hz, 257, 1)?;
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
