//! Exports of the window's content as files.

pub mod csv_wav;
#[cfg(feature = "figures")]
pub mod figures;
pub mod report;
