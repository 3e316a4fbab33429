//! The plate in the frequency domain: the steady amplitude over x at one frequency, and its peak.

pub(crate) mod axial;
pub(crate) mod driven_end;
pub(crate) mod equation;
pub(crate) mod error;
mod far_air;
pub(crate) mod finger;
mod impedance;
pub(crate) mod medium;
pub(crate) mod numerov;
pub(crate) mod peak;
mod prediction;
pub(crate) mod respond;
mod strip_grid;
mod sweep;

pub use driven_end::{reflection, resistance_reflection};
pub use equation::Equation;
pub use error::RespondError;
pub(crate) use finger::CONTACT_M;
pub use finger::Finger;
pub use peak::Peak;
pub use prediction::{PredictedEnvelope, ToneDrive, predict_envelope};
pub use respond::{
    POINTS_MAX, POINTS_MIN, Responder, Response, respond, respond_batch, respond_range, respond_touched,
};
