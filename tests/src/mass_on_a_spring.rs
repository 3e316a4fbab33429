//! The actuator that a travel limit describes, moved by codes.

use slipline_protocol::command::TravelLimit;
use std::f64::consts::TAU;

use crate::rig::{MID, RATE_HZ};

/// Codes from mid-scale to full scale.
pub const FULL: f64 = 2047.0;

/// The largest deflection, 1 = the peak travel, of a mass on a spring that a voltage of these codes, held from each to the next,
/// drives: `x'' + w/Q x' + w^2 (x - static_travel u) = 0`, in closed form for each sample. The quality must be above 1/2.
#[must_use]
pub fn travel(codes: &[u16], limit: &TravelLimit) -> f64 {
    let resonance = TAU * limit.resonance_uhz as f64 * 1e-6;
    let decay = resonance / (2.0 * f64::from(limit.quality_per_mille) / 1e3);
    let static_travel = f64::from(limit.static_ppm) / 1e6;
    let ringing = (resonance * resonance - decay * decay).sqrt();
    let step = 1.0 / f64::from(RATE_HZ);
    let (sine, cosine, left) = ((ringing * step).sin(), (ringing * step).cos(), (-decay * step).exp());
    let (mut place, mut speed, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
    for &code in codes {
        let rest = static_travel * (f64::from(code) - f64::from(MID)) / FULL;
        let away = place - rest;
        place = rest + left * (away * cosine + (speed + decay * away) / ringing * sine);
        speed = left * (speed * cosine - (decay * speed + resonance * resonance * away) / ringing * sine);
        most = most.max(place.abs());
    }
    most
}
