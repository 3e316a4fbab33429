//! The part of the plate where a condition fails.

use serde::Serialize;

/// Steps from the seed to a limit in the search for the first place that holds.
const PLACES: usize = 200;
/// Bisections of the end of a stretch: to less than a micrometre on a plate of 10 m.
const HALVINGS: usize = 16;

/// A part of the plate, metres from the driven end; where both ends are equal it is one place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, serde::Deserialize)]
pub struct Stretch {
    /// Its end nearer the drive.
    // JSON: End of the stretch nearer the drive
    pub from_m: f64,
    /// Its end farther from the drive.
    // JSON: End of the stretch farther from the drive
    pub to_m: f64,
}

impl Stretch {
    /// One place.
    #[must_use]
    pub const fn at(place_m: f64) -> Self {
        Self { from_m: place_m, to_m: place_m }
    }

    /// The place in its middle.
    #[must_use]
    pub const fn middle_m(self) -> f64 {
        0.5 * (self.from_m + self.to_m)
    }

    /// The stretch of failing places around `seed_m`, which fails itself, within 0 to `to_m`.
    pub(super) fn about(seed_m: f64, to_m: f64, fails: impl Fn(f64) -> bool) -> Self {
        let seed_m = seed_m.clamp(0.0, to_m);
        let end = |limit_m: f64| {
            let at = |i: usize| seed_m + (limit_m - seed_m) * i as f64 / PLACES as f64;
            let Some(holds) = (1..=PLACES).find(|&i| !fails(at(i))) else { return limit_m };
            let (mut inside_m, mut outside_m) = (at(holds - 1), at(holds));
            for _ in 0..HALVINGS {
                let middle_m = 0.5 * (inside_m + outside_m);
                *if fails(middle_m) { &mut inside_m } else { &mut outside_m } = middle_m;
            }
            inside_m
        };
        Self { from_m: end(0.0), to_m: end(to_m) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_reaches_as_far_as_the_condition_fails_without_a_gap() {
        let fails = |x: f64| (0.1234..=0.25).contains(&x) || x > 0.28;
        let near = |stretch: Stretch, from_m: f64, to_m: f64| {
            assert!(
                (stretch.from_m - from_m).abs() < 1e-7 && (stretch.to_m - to_m).abs() < 1e-7,
                "{stretch:?}"
            );
        };
        near(Stretch::about(0.2, 0.3, fails), 0.1234, 0.25);
        near(Stretch::about(0.2, 0.22, fails), 0.1234, 0.22);
        near(Stretch::about(0.3, 0.3, fails), 0.28, 0.3);
        near(Stretch::about(0.15, 0.3, |_| true), 0.0, 0.3);
        near(Stretch::about(0.15, 0.3, |x| x == 0.15), 0.15, 0.15);
    }
}
