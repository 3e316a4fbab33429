//! Solvers of the crate, for other programs to compare with: `oracle least_squares`, `oracle calibrate` (`tests/oracle`
//! has scipy's beside them) and `oracle respond_many PLATE POINTS FREQUENCIES RUNS` (`tests/python/speed.py` has Python's).

use slipline_plate::calibrate::{MeasuredPoint, Measurement, Priors, SensorKind, from_ratio};
use slipline_plate::texture::least_largest_error;
use slipline_plate::texture::nnls::{Columns, non_negative_least_squares};
use slipline_plate::{Complex64, Responder, preset};
use std::error::Error;
use std::hint::black_box;
use std::io::{self, Write};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let input = || io::read_to_string(io::stdin());
    match arguments.first().map(String::as_str) {
        Some("least_squares") => least_squares(&input()?),
        Some("calibrate") => calibrate(&input()?),
        Some("respond_many") => respond_many(&arguments[1..]),
        _ => Err("oracle least_squares | calibrate | respond_many".into()),
    }
}

/// Non-negative least squares and the least largest error of problems: numbers separated by white space, rows, columns,
/// A column by column, b. Prints one line for each problem: x of the least squares, then the least largest error.
fn least_squares(text: &str) -> Result<(), Box<dyn Error>> {
    let mut words = text.split_whitespace();
    let mut out = io::BufWriter::new(io::stdout().lock());
    while let Some(rows) = words.next() {
        let rows: usize = rows.parse()?;
        let count: usize = words.next().ok_or("the number of columns is missing")?.parse()?;
        let mut numbers = |count: usize| {
            let found: Result<Vec<f64>, _> = words.by_ref().take(count).map(str::parse).collect();
            found.ok().filter(|found| found.len() == count).ok_or("numbers are missing")
        };
        let mut a = Columns::new(rows);
        for _ in 0..count {
            a.push(numbers(rows)?);
        }
        let b = numbers(rows)?;
        for x in non_negative_least_squares(&a, &b) {
            write!(out, "{x:e} ")?;
        }
        let (error, _) = least_largest_error(&a, &b).ok_or("the linear program has no solution")?;
        writeln!(out, "{error:e}")?;
    }
    Ok(())
}

/// A calibration by the ratio of two places, from words separated by white space: the name of a preset, both places in
/// metres, the standard deviation of each, the number of frequencies, and for each frequency its value in hertz and, for
/// both sensors, the real and the imaginary part of the response and the standard deviation of its noise. Prints one line
/// for each parameter: its name, value, and the ends of its interval; then chi^2 over the number of residuals.
fn calibrate(text: &str) -> Result<(), Box<dyn Error>> {
    let mut words = text.split_whitespace();
    let plate = preset(words.next().ok_or("the preset is missing")?).ok_or("no such preset")?;
    let mut number =
        || -> Result<f64, Box<dyn Error>> { Ok(words.next().ok_or("a number is missing")?.parse()?) };
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

/// Prints the shortest time in which a plate's fields at many frequencies are solved, in seconds.
fn respond_many(arguments: &[String]) -> Result<(), Box<dyn Error>> {
    let [name, points, count, runs] = arguments else {
        return Err("oracle respond_many PLATE POINTS FREQUENCIES RUNS".into());
    };
    let plate = preset(name).ok_or("no such preset")?;
    let (points, count, runs): (usize, usize, usize) = (points.parse()?, count.parse()?, runs.parse()?);
    let (low_hz, high_hz) = plate.band_hz();
    let mut best_s = f64::INFINITY;
    for _ in 0..=runs {
        let begin = Instant::now();
        let mut responder = Responder::new(&plate, points);
        let mut fields = Vec::with_capacity(points * count);
        for i in 0..count {
            let hz = (high_hz - low_hz).mul_add(i as f64 / (count - 1) as f64, low_hz).min(high_hz);
            fields.extend(responder.respond(None, hz)?.amplitude);
        }
        black_box(&fields);
        best_s = best_s.min(begin.elapsed().as_secs_f64());
    }
    println!("{best_s}");
    Ok(())
}
