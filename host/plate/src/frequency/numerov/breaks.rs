//! Numerov's method where W'' jumps: at the points of a sampled taper or thickness.
//!
//! The scheme replaces the integral of g'' = -Q g over a hat of two steps by (1, 10, 1)/12 of its values. At a jump of Q
//! between two grid points that is wrong in the second order. Let Q jump by D(x) = (what follows, continued) - (what
//! precedes, continued) at the place x_i + theta h, 0 < theta <= 1. The hats around the points i and i + 1 then miss
//!
//! ```text
//! h^2 D(x_i) g_i ((1 - theta)^2/2 - 1/12)   and   h^2 D(x_i+1) g_i+1 (1/12 - theta^2/2)
//! ```
//! for all D g that are straight lines. So Q is changed at these two points by D times the two brackets; what remains is
//! of the scheme's own fourth order.

use crate::definition::plate::Plate;
use crate::definition::taper::Taper;
use crate::definition::thickness::Thickness;

/// The tangent at the end of one piece of the barrier, which continues it over the step that holds the end.
struct Tangent {
    place: f64,
    value: f64,
    slope: f64,
}

impl Tangent {
    /// To the piece that begins at `place` and goes on for `room_m`, to the left if that is negative.
    fn of(barrier_at: impl Fn(f64) -> f64, place: f64, room_m: f64) -> Self {
        // Inside the piece, yet so near that the tangent is the same there.
        let place = place + 1e-6 * room_m;
        let part = 0.25 * room_m;
        let [value, next, far] = [0.0, part, 2.0 * part].map(|apart| barrier_at(place + apart));
        Self { place, value, slope: (4.0 * next - 3.0 * value - far) / (2.0 * part) }
    }

    fn at(&self, x: f64) -> f64 {
        self.value + self.slope * (x - self.place)
    }
}

/// Changes the barrier at the points beside each jump of what it has at a place, `barrier_at`, of which it may lack a smooth
/// part; the barrier's index 0 is the place -`step_m`.
pub(super) fn mend(barrier: &mut [f64], step_m: f64, plate: &Plate, barrier_at: impl Fn(f64) -> f64 + Copy) {
    let places = places(plate);
    for (number, &place) in places.iter().enumerate() {
        let after = places.get(number + 1).map_or(step_m, |next| (next - place).min(step_m));
        let right = Tangent::of(barrier_at, place, after);
        let Some(before) = number.checked_sub(1).map(|before| places[before]) else {
            // Before the driven end there is no plate: the first piece is continued there.
            barrier[0] += right.at(-step_m) - barrier_at(-step_m);
            continue;
        };
        let left = Tangent::of(barrier_at, place, -(place - before).min(step_m));
        // The last point before the jump, by the comparison that the laws make: a point at the jump belongs to what follows.
        let nearest = (place / step_m).round();
        let index = nearest as usize + usize::from(nearest * step_m < place);
        let Some([here, next]) = barrier.get_mut(index..index + 2) else { return };
        let x = (index as f64 - 1.0) * step_m;
        let theta = (place - x) / step_m;
        let jump = |x: f64| right.at(x) - left.at(x);
        *here += jump(x) * (0.5 * (1.0 - theta).powi(2) - 1.0 / 12.0);
        *next += jump(x + step_m) * (1.0 / 12.0 - 0.5 * theta * theta);
    }
}

/// Where W'' or the thickness's second derivative jumps, rising, metres; the first is the driven end.
fn places(plate: &Plate) -> Vec<f64> {
    let spec = plate.spec();
    let mut places: Vec<f64> = Vec::new();
    if let Taper::Sampled { points } = &spec.taper {
        places.extend(points.iter().map(|point| point[0]));
    }
    if let Some(Thickness::Sampled { points }) = &spec.thickness {
        places.extend(points.iter().map(|point| point[0]));
    }
    places.sort_by(f64::total_cmp);
    // Between two laws, pieces shorter than this are below rounding.
    places.dedup_by(|place, before| *place - *before < 1e-9);
    places
}
