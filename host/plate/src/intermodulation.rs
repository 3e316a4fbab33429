//! What the drive adds to several tones at once: their harmonics and the sums of their frequencies.
//!
//! The terms b u^2 and c u^3 of a drive that give one tone its harmonics give several tones products, too: of two tones the sum of
//! their frequencies with 2 sqrt(h_i h_j), where h_i is the second harmonic of the one and h_j that of the other; of three tones 6
//! times the cube root of their third harmonics' product, or 3 times where two of them are the same. Several tones as loud as one
//! therefore disturb the still side as much as that one, although the harmonics of each are much weaker. Differences of frequencies are
//! left out: they turn before the tones or do not enter.

use crate::definition::{Harmonics, Plate};
use crate::frequency::{Equation, RespondError, respond};
use crate::second_boundary::DrivenTone;

/// Number of products up to which each is solved at its own frequency.
const EXACT: usize = 64;
/// Relative distance of frequencies that are solved together where there are more.
const APART: f64 = 0.02;

/// A product of the drive: its frequency, and the mean square of its drive.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Product {
    frequency_hz: f64,
    square_m2: f64,
}

/// Frequency in Hz and mean square displacement, in metres squared at `points` (8 to 200 001) places uniform from 0 to the plate's end,
/// of all that the drive adds to these tones together; none where the plate file states no harmonics. The products add in power; of more
/// than 64 those within 2 % of frequency are solved as one.
///
/// # Errors
/// As [`respond`], for a sum of the tones' frequencies.
pub fn products(
    plate: &Plate,
    tones: &[DrivenTone],
    points: usize,
) -> Result<Vec<(f64, Vec<f64>)>, RespondError> {
    let Some(harmonics) = &plate.spec().harmonics else { return Ok(Vec::new()) };
    let solve = |Product { frequency_hz, square_m2 }: Product| {
        let response = respond(plate, frequency_hz, points, Equation::Corrected)?;
        let squares = response.amplitude.iter().map(|f| f.norm_sqr() * square_m2).collect();
        Ok((frequency_hz, squares))
    };
    grouped(of_drive(harmonics, tones)).into_iter().map(solve).collect()
}

/// The products of a drive, in rising frequency.
fn of_drive(harmonics: &Harmonics, tones: &[DrivenTone]) -> Vec<Product> {
    let amplitudes_m = |order: u8| -> Vec<f64> {
        let of_tone = |tone: &DrivenTone| harmonics.drive(order, tone.frequency_hz, tone.level, tone.drive_m);
        tones.iter().map(|tone| of_tone(tone).map_or(0.0, |drive_m| drive_m.norm())).collect()
    };
    let (second, third) = (amplitudes_m(2), amplitudes_m(3));
    let mut found = Vec::new();
    let mut add = |frequency_hz: f64, amplitude_m: f64| {
        if amplitude_m > 0.0 {
            found.push(Product { frequency_hz, square_m2: 0.5 * amplitude_m * amplitude_m });
        }
    };
    for i in 0..tones.len() {
        for j in i..tones.len() {
            let two_hz = tones[i].frequency_hz + tones[j].frequency_hz;
            add(two_hz, if i == j { 1.0 } else { 2.0 } * (second[i] * second[j]).sqrt());
            for k in j..tones.len() {
                let ways = match (i == j, j == k) {
                    (true, true) => 1.0,
                    (false, false) => 6.0,
                    (true, false) | (false, true) => 3.0,
                };
                add(two_hz + tones[k].frequency_hz, ways * (third[i] * third[j] * third[k]).cbrt());
            }
        }
    }
    found.sort_by(|one, other| one.frequency_hz.total_cmp(&other.frequency_hz));
    found
}

/// The products to be solved: as they are, or, of many, those near each other as one of their mean frequency.
fn grouped(products: Vec<Product>) -> Vec<Product> {
    if products.len() <= EXACT {
        return products;
    }
    let mut groups: Vec<(f64, Product)> = Vec::new();
    for product in products {
        match groups.last_mut() {
            Some((first_hz, group)) if product.frequency_hz < *first_hz * (1.0 + APART) => {
                let sum = group.square_m2 + product.square_m2;
                let weighted =
                    group.frequency_hz * group.square_m2 + product.frequency_hz * product.square_m2;
                *group = Product { frequency_hz: weighted / sum, square_m2: sum };
            }
            _ => groups.push((product.frequency_hz, product)),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::ResponseCurve;
    use std::f64::consts::TAU;

    /// b u^2 + c u^3 at full scale, as harmonics at the level 1.
    const B: f64 = 0.02;
    const C: f64 = 0.03;

    fn harmonics() -> Harmonics {
        let flat = |ratio: f64| {
            let db = 20.0 * ratio.log10();
            Some(ResponseCurve { points: vec![[1.0, db, 0.0], [1000.0, db, 0.0]] })
        };
        Harmonics { level: 1.0, second: flat(0.5 * B), third: flat(0.25 * C) }
    }

    fn tones(levels: &[(f64, f64)]) -> Vec<DrivenTone> {
        let tone = |&(frequency_hz, level)| DrivenTone { frequency_hz, level, drive_m: level.into() };
        levels.iter().map(tone).collect()
    }

    #[test]
    fn the_products_are_those_of_the_sum_of_the_tones_in_time() {
        // Whole numbers of periods of three tones, no two of whose sums are alike.
        let levels = [(100.0, 0.3), (131.0, 0.25), (157.0, 0.4)];
        let found = of_drive(&harmonics(), &tones(&levels));
        assert_eq!(found.len(), 6 + 10);
        let u = |t: f64| levels.iter().map(|(hz, level)| level * (TAU * hz * t).cos()).sum::<f64>();
        for Product { frequency_hz, square_m2 } in found {
            let times = (0..4096).map(|n| f64::from(n) / 4096.0);
            let part = |t: f64| (B * u(t).powi(2) + C * u(t).powi(3)) * (TAU * frequency_hz * t).cos();
            let amplitude = times.map(part).sum::<f64>() / 2048.0;
            assert!(
                (0.5 * amplitude * amplitude / square_m2 - 1.0).abs() < 1e-9,
                "{frequency_hz} Hz: {amplitude}"
            );
        }
    }

    #[test]
    fn many_products_keep_their_power_in_groups() {
        let levels: Vec<(f64, f64)> = (0..9).map(|i| (90.0 + 11.3 * f64::from(i), 0.1)).collect();
        let all = of_drive(&harmonics(), &tones(&levels));
        let groups = grouped(all.clone());
        assert!(groups.len() < all.len() / 2 && groups.len() > 20, "{} of {}", groups.len(), all.len());
        let power = |products: &[Product]| products.iter().map(|it| it.square_m2).sum::<f64>();
        assert!((power(&groups) / power(&all) - 1.0).abs() < 1e-12);
        assert!(groups.windows(2).all(|pair| pair[0].frequency_hz < pair[1].frequency_hz));
    }
}
