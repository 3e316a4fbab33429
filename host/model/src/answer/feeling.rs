//! The feeling of a finger by which felt edges are computed.

use serde::Serialize;
use slipline_plate::feeling::Feeling;

/// The fields of a feeling, with the names of its file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "host/JSON.md has the meaning of each field")]
pub struct FeelingAnswer<'a> {
    pub from: &'a str,
    pub threshold: f64,
    pub friction_scale_m: f64,
    pub friction_residual: f64,
    pub friction_exponent: f64,
    pub least_friction_change: f64,
    pub contact_m: f64,
}

impl<'a> FeelingAnswer<'a> {
    /// The fields of a feeling from this file; `None` for that of a usual finger.
    #[must_use]
    pub fn of(feeling: &Feeling, from: Option<&'a str>) -> Self {
        let Feeling { threshold, friction, least_friction_change, contact_m } = *feeling;
        Self {
            from: from.unwrap_or("default"),
            threshold,
            friction_scale_m: friction.scale_m,
            friction_residual: friction.residual,
            friction_exponent: friction.exponent,
            least_friction_change,
            contact_m,
        }
    }
}
