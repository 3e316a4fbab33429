//! Calibration by the ratio of two places, for other programs: `tests/oracle` compares it with scipy's least squares.
//!
//! Standard input, separated by white space: the name of a preset, both places in metres, the standard deviation of
//! each, the number of frequencies, and for each frequency its value in hertz and, for both sensors, the real and the
//! imaginary part of the response and the standard deviation of its noise. Standard output, one line for each
//! parameter: its name, value, and the ends of its interval; then chi^2 over the number of residuals.

use slipline_plate::calibrate::{MeasuredPoint, Measurement, Priors, SensorKind, from_ratio};
use slipline_plate::{Complex64, preset};
use std::io::{self, Read};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut text = String::new();
    io::stdin().read_to_string(&mut text)?;
    let mut words = text.split_whitespace();
    let plate = preset(words.next().ok_or("the preset is missing")?).ok_or("no such preset")?;
    let mut number = || -> Result<f64, Box<dyn std::error::Error>> {
        Ok(words.next().ok_or("a number is missing")?.parse()?)
    };
    let places_m = [number()?, number()?];
    let tolerances_m = [number()?, number()?];
    let mut points = [Vec::new(), Vec::new()];
    for _ in 0..number()? as usize {
        let frequency_hz = number()?;
        for points in &mut points {
            let response = Complex64::new(number()?, number()?);
            points.push(MeasuredPoint { frequency_hz, response, noise: number()?, headroom_db: None });
        }
    }
    let [near, far] = points;
    let sensor = |i: usize, points| Measurement {
        place_tolerance_m: tolerances_m[i],
        ..Measurement::at(places_m[i], SensorKind::Displacement, points)
    };
    let found = from_ratio(&plate, [&sensor(0, near), &sensor(1, far)], &Priors::default())?;
    for parameter in &found.parameters {
        println!("{} {:e} {:e} {:e}", parameter.name, parameter.value, parameter.low, parameter.high);
    }
    println!("{:e}", found.chi2_per_n);
    Ok(())
}
