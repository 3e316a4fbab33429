//! Real-time factor of the time-domain line: prints ratios, asserts nothing.

use slipline_plate::{TimeLine, preset};
use std::time::Instant;

fn main() {
    println!("{:<26}{:>8}{:>14}{:>16}", "plate at 400 kS/s", "points", "x real time", "prepared in");
    for name in ["al-sh", "al-bending", "al-bending-displacement", "membrane"] {
        let Some(plate) = preset(name) else { continue };
        for points in [128, 512] {
            let start = Instant::now();
            let Ok(mut line) = TimeLine::new(&plate, 400e3, points, 1) else { continue };
            let prepared = start.elapsed();
            let frequency = plate.band_hz().1;
            let codes: Vec<f32> = (0..40_000)
                .map(|n| (std::f64::consts::TAU * frequency * f64::from(n) / 400e3).sin() as f32)
                .collect();
            line.push(&codes);
            // The best of many short runs: other work on the machine only ever makes one slower.
            let best = codes
                .chunks(2000)
                .cycle()
                .take(400)
                .map(|chunk| {
                    let start = Instant::now();
                    line.push(chunk);
                    start.elapsed().as_secs_f64()
                })
                .fold(f64::INFINITY, f64::min);
            println!("{name:<26}{points:>8}{:>14.1}{:>16.1?}", 0.005 / best, prepared);
        }
    }
}
