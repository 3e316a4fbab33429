//! The shortest time in which a plate's fields at many frequencies are solved, in seconds:
//! `respond_many PLATE POINTS FREQUENCIES RUNS`. Beside it `tests/python/speed.py` has that of Python.

use slipline_plate::{Responder, preset};
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, points, count, runs] = &arguments[..] else {
        return Err("respond_many PLATE POINTS FREQUENCIES RUNS".into());
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
