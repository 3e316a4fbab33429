//! The least error that any calibration by felt edges can have on a membrane of unknown drive.
//!
//! Truths are random as in the tests: plate, source, actuator, threshold and gain. A finger marks the felt edges of
//! some tones, each within 3 mm. Many plates and drives are sampled from the same distribution. Those with all edges
//! within 3 mm of the marks are equally likely to be the truth, all others are excluded. The mean of their edges has
//! the least expected square error of any method; its rms error over the band is printed. It contains no fit and no
//! model of an estimator: the average error of `from_touches` cannot be smaller.
//!
//! `cargo run --release -p slipline-plate --example felt_edges`

use slipline_plate::feeling::{Feeling, FeltTone};
use slipline_plate::truth::{Random, near};
use slipline_plate::{DriveTable, Equation, Plate, preset, respond_batch};

const RATE_HZ: f64 = 400e3;
/// Sampled plates, and fingers for each.
const PLATES: u64 = 12_000;
const FINGERS: usize = 64;
/// Truths; the first of them are those of the tests.
const TRUTHS: u64 = 100;
/// Largest distance of a mark from its edge, metres.
const MARK_M: f64 = 3e-3;
/// Tones over the band.
const TONES: usize = 21;
/// Least number of matching plates for a mean.
const LEAST: usize = 20;

/// The edges of all tones, metres; 0 or the plate's length where no edge lies on the plate.
type Edges = [f32; TONES];

/// The drive of the tones, and the weight of each place in the sensation.
struct Played {
    frequencies_hz: Vec<f64>,
    amplitudes: Vec<f64>,
}

impl Played {
    fn by(nominal: &Plate) -> Self {
        let table = DriveTable::build(nominal, RATE_HZ, 129).expect("a table");
        let (low, high) = nominal.band_hz();
        let share = |i: usize| 0.1 + 0.8 * i as f64 / (TONES - 1) as f64;
        let frequencies_hz: Vec<f64> = (0..TONES).map(|i| low * (high / low).powf(share(i))).collect();
        // The level of a touch: vibration is felt from less than a micrometre.
        let amplitude = |&hz: &f64| 0.03 * table.gain(nominal.turning_point_m(hz).expect("enters"));
        let amplitudes = frequencies_hz.iter().map(amplitude).collect();
        Self { frequencies_hz, amplitudes }
    }

    /// The edges that `fingers` feel on a plate.
    fn edges(&self, plate: &Plate, fingers: usize, random: &mut Random) -> Vec<Edges> {
        let fields =
            respond_batch(plate, &self.frequencies_hz, 401, Equation::Corrected).expect("in the band");
        let feeling = Feeling::default();
        let strength = |i: usize| {
            let frequency_hz = self.frequencies_hz[i];
            let drive = plate.drive_response(frequency_hz).norm() * plate.spec().full_scale_m;
            let amplitude = drive * self.amplitudes[i];
            let squares: Vec<f64> =
                fields[i].iter().map(|f| 0.5 * f.norm_sqr() * amplitude.powi(2)).collect();
            feeling.strength(plate, &[FeltTone { frequency_hz, squares: &squares }])
        };
        let strengths: Vec<Vec<f64>> = (0..TONES).map(strength).collect();
        let finger = |_| {
            // The gain over the threshold.
            let factor = random.factor(0.7, 1.4) / random.factor(0.5, 2.0);
            std::array::from_fn(|i| {
                let felt: Vec<f64> = strengths[i].iter().map(|strength| strength * factor).collect();
                let none_m =
                    if felt.last().is_some_and(|last| *last >= 1.0) { plate.length_m() } else { 0.0 };
                Feeling::edge(plate, &felt).place_m().unwrap_or(none_m) as f32
            })
        };
        (0..fingers).map(finger).collect()
    }
}

fn main() {
    let nominal = preset("membrane").expect("a preset");
    let played = Played::by(&nominal);
    let drawn = |seed: u64, fingers: usize| {
        let mut random = Random::new(seed);
        let plate = near(&nominal, &mut random).expect("a plate");
        played.edges(&plate, fingers, &mut random)
    };
    let candidates: Vec<Edges> = (0..PLATES).flat_map(|seed| drawn(1_000_000 + seed, FINGERS)).collect();
    println!("{PLATES} plates with {FINGERS} fingers each; felt edge off at best, mm:");
    for count in 2..=6 {
        let mut off_mm = Vec::new();
        let mut few = 0;
        for seed in 0..TRUTHS {
            let truth = drawn(seed, 1)[0];
            let is_on = |i: &usize| truth[*i] > 0.0 && f64::from(truth[*i]) < nominal.length_m();
            let on: Vec<usize> = (0..TONES).filter(is_on).collect();
            let mut random = Random::new(seed + 7);
            let touches: Vec<(usize, f32)> = (0..count)
                .map(|i| {
                    let tone = on[i * (on.len() - 1) / (count - 1)];
                    (tone, truth[tone] + random.within(-MARK_M, MARK_M) as f32)
                })
                .collect();
            let fits = |edges: &&Edges| {
                touches.iter().all(|&(tone, mark_m)| (edges[tone] - mark_m).abs() < MARK_M as f32)
            };
            let fitting: Vec<&Edges> = candidates.iter().filter(fits).collect();
            if fitting.len() < LEAST {
                few += 1;
                continue;
            }
            let off = |&i: &usize| {
                let mean =
                    fitting.iter().map(|edges| f64::from(edges[i])).sum::<f64>() / fitting.len() as f64;
                (1e3 * (mean - f64::from(truth[i]))).powi(2)
            };
            off_mm.push((on.iter().map(off).sum::<f64>() / on.len() as f64).sqrt());
        }
        off_mm.sort_by(f64::total_cmp);
        let root = (off_mm.iter().map(|off| off * off).sum::<f64>() / off_mm.len() as f64).sqrt();
        println!(
            "{count} touches: median {:.1}, root of the mean square {root:.1}, worst {:.1} of {} truths ({few} without {LEAST} plates that fit)",
            off_mm[off_mm.len() / 2],
            off_mm[off_mm.len() - 1],
            off_mm.len(),
        );
    }
}
