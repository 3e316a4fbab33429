//! What a plate of a study costs against the solver alone, and two threads against one.
//!
//! `cargo bench -p slipline-model --bench study` prints it. The fastest of several runs counts.

use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_model::study::{Draft, Study, run_in_order};
use slipline_plate::{Plate, Progress, boundaries, preset};
use std::time::{Duration, Instant};

const PLATES: u64 = 256;

fn fastest(repeats: usize, mut run: impl FnMut()) -> Duration {
    let once = |()| {
        let begin = Instant::now();
        run();
        begin.elapsed()
    };
    std::iter::repeat_n((), repeats).map(once).min().unwrap_or_default()
}

fn main() {
    // Without `--bench` (as `cargo test --benches` calls it) one run shows that everything works.
    let repeats = if std::env::args().any(|argument| argument == "--bench") { 15 } else { 1 };
    for name in ["membrane", "al-bending", "al-sh"] {
        let nominal = preset(name).expect("a preset");
        let (start_m, end_m) = nominal.span_m();
        let place = |share: f64| start_m + share * (end_m - start_m);
        let places = [place(0.2), place(0.5), place(0.8)];
        let text = format!(
            "plate = {name:?}\nseed = 7\ncount = {PLATES}\nturning_point_m = {places:?}\n[vary]\n\
             \"taper.rate_per_m\" = {{ uniform = 0.02 }}\n\"taper.half_width_m\" = {{ normal = 0.002 }}"
        );
        let spec = Draft::parse(&text).expect("valid").finish(Some(nominal)).expect("valid");
        let study = Study::new(spec, &mut Progress::new(&mut |_| true)).expect("a table");
        let plates: Vec<Plate> = (0..PLATES).filter_map(|plate| study.plate(plate).ok()).collect();
        let rate_hz = f64::from(SAMPLE_RATE_HZ);
        let alone = fastest(repeats, || {
            let solved = plates.iter().map(|plate| boundaries(plate, study.frequencies_hz(), rate_hz).len());
            assert_eq!(solved.sum::<usize>(), 3 * plates.len());
        });
        let by_threads =
            |threads| fastest(repeats, || run_in_order(&study, threads, 32, |_| true).expect("threads"));
        let (one, two) = (by_threads(1), by_threads(2));
        println!(
            "{name:<12} {:>8.1} us a plate, {:.2} x the solver alone; two threads {:.2} x one",
            1e6 * one.as_secs_f64() / PLATES as f64,
            one.as_secs_f64() / alone.as_secs_f64() * plates.len() as f64 / PLATES as f64,
            one.as_secs_f64() / two.as_secs_f64()
        );
    }
}
