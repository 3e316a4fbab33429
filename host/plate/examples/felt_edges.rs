//! What any method can make of felt edges on a membrane of unknown drive, at best.
//!
//! Truths are drawn as the tests draw them: plate, source, actuator, threshold and gain. A finger shows where the edges of
//! some tones are, each mark within 3 mm of its edge. Of many plates and drives drawn alike, those whose edges all lie within
//! 3 mm of the marks are as likely as each other to be the truth, and the others are impossible. The mean of their edges has
//! the least expected square error that any method can have; here its error is printed, as the root of the mean square over
//! the band. No fit and no model of an estimator is in it: `from_touches` can be no better on average.
//!
//! `cargo run --release -p slipline-plate --example felt_edges`

use slipline_plate::feeling::{Feeling, FeltTone};
use slipline_plate::truth::{Random, near};
use slipline_plate::{DriveTable, Equation, Plate, preset, respond_batch};

const RATE_HZ: f64 = 400e3;
/// Plates that are drawn, and fingers with each.
const PLATES: u64 = 12_000;
const FINGERS: usize = 64;
/// Truths, the first of them those of the tests.
const TRUTHS: u64 = 100;
/// How far a mark may be from its edge, metres.
const MARK_M: f64 = 3e-3;
/// Tones over the band.
const TONES: usize = 21;
/// Least number of plates that must fit for a mean of theirs.
const LEAST: usize = 20;

/// The edges of all tones; 0 or the plate's length where there is none on it.
type Edges = [f32; TONES];

/// What plays the tones, and how strongly each place of a plate is felt.
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
        // The level of a touch: a vibration is felt from less than a micrometre on.
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
