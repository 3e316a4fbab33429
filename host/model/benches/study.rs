//! What a plate of a study costs against the solver alone, and two threads against one.
//!
//! `cargo bench -p slipline-model --bench study` prints it: the median of several rounds, in each of which all are run in
//! turn, because a processor's clock changes from second to second.

use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_model::study::{Draft, Study, run_in_order};
use slipline_plate::{Plate, Progress, boundaries, preset};
use std::time::{Duration, Instant};

const PLATES: u64 = 256;

fn took(run: impl FnOnce()) -> Duration {
    let begin = Instant::now();
    run();
    begin.elapsed()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn main() {
    // Without `--bench` (as `cargo test --benches` calls it) one round shows that everything works.
    let rounds = if std::env::args().any(|argument| argument == "--bench") { 41 } else { 1 };
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
        let study = Study::new(spec, &mut Progress::unwatched()).expect("a table");
        let plates: Vec<Plate> = (0..PLATES).filter_map(|plate| study.plate(plate).ok()).collect();
        let rate_hz = f64::from(SAMPLE_RATE_HZ);
        let alone = || {
            let solved = plates.iter().map(|plate| boundaries(plate, study.frequencies_hz(), rate_hz).len());
            assert_eq!(solved.sum::<usize>(), 3 * plates.len());
        };
        let by_threads = |threads| run_in_order(&study, threads, 32, |_| true).map(drop).expect("threads");
        let rounds: Vec<[f64; 3]> = std::iter::repeat_with(|| {
            [took(alone), took(|| by_threads(1)), took(|| by_threads(2))].map(|time| time.as_secs_f64())
        })
        .take(rounds)
        .collect();
        let ratio = |of: fn(&[f64; 3]) -> f64| median(rounds.iter().map(of).collect());
        println!(
            "{name:<12} {:>8.1} us a plate, {:.2} x the solver alone; two threads {:.2} x one",
            1e6 * ratio(|[_, one, _]| *one) / PLATES as f64,
            ratio(|[alone, one, _]| one / alone) * plates.len() as f64 / PLATES as f64,
            ratio(|[_, one, two]| one / two)
        );
    }
}
