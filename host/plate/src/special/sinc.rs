//! sin(pi x)/(pi x): the factor by which a mean over one length or time reduces a sine with x periods in it.

use std::f64::consts::PI;

/// sin(pi x)/(pi x), 1 at 0.
pub(crate) fn sinc(turns: f64) -> f64 {
    let x = PI * turns;
    if x.abs() < 1e-9 { 1.0 } else { x.sin() / x }
}
