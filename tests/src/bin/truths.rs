//! All truths of a calibration from two places, through the protocol, for a nightly run:
//! `cargo run --release -p slipline-tests --bin truths [count] [first seed]`.
//!
//! Twenty true plates of each of two presets unless another number is given. Prints a line for each plate; with these twenty, ends
//! with an error where the errors of the calibrated tables are not those of PHYSICS.md.

use slipline_tests::truths::{Judged, Noise, calibrate, middle_and_worst};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |usual: u64| {
        arguments.next().map_or(usual, |text| text.parse().unwrap_or_else(|_| panic!("{text} is no number")))
    };
    let (count, first) = (number(20), number(0));
    let mut is_held = true;
    for (name, noise, limits) in [
        ("membrane", Noise::Input, [0.125, 0.75, 0.26, 0.6]),
        ("al-bending", Noise::Input, [0.07, 0.36, 0.075, 0.1]),
        ("membrane", Noise::Responses, [0.155, 0.9, 0.28, 0.61]),
        ("al-bending", Noise::Responses, [0.075, 0.36, 0.115, 0.21]),
    ] {
        println!("{name}, noise 40 dB below the signal: {noise:?}");
        let judged = all(name, first, count, noise);
        judged.iter().for_each(|it| println!("{}", it.line()));
        let figures = |of: &dyn Fn(&Judged) -> f64| middle_and_worst(judged.iter().map(of));
        let before = (figures(&|it| 1e3 * it.before.boundary_m), figures(&|it| it.before.level_db));
        let (mm, db) = (figures(&|it| 1e3 * it.after.boundary_m), figures(&|it| it.after.level_db));
        println!("{name}: mm and dB, median and worst: {before:.2?} -> {mm:.3?} {db:.3?}");
        is_held &= [mm.0, mm.1, db.0, db.1].iter().zip(limits).all(|(found, most)| *found <= most);
    }
    // PHYSICS.md states nothing about other plates.
    assert!(is_held || (count, first) != (20, 0), "not the errors of PHYSICS.md");
}

/// Each seed's plate, by as many threads as the machine has.
fn all(name: &str, first: u64, count: u64, noise: Noise) -> Vec<Judged> {
    let next = AtomicU64::new(first);
    let judged = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + count {
                        break;
                    }
                    let it =
                        calibrate(name, seed, noise).unwrap_or_else(|error| panic!("{name} {seed}: {error}"));
                    judged.lock().expect("no thread panicked").push(it);
                }
            });
        }
    });
    let mut judged = judged.into_inner().expect("no thread panicked");
    judged.sort_by_key(|it| it.seed);
    judged
}
