//! What is seen, as files for others.

pub mod csv_wav;
#[cfg(feature = "native")]
pub mod envelope;
#[cfg(feature = "native")]
pub mod figures;
pub mod report;
