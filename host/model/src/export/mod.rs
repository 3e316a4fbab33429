//! What is seen, as files for others.

pub mod csv_wav;
pub mod figures;
pub mod report;
