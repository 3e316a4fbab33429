//! Exports of the window's content as files.

pub mod csv_wav;
pub mod figures;
pub mod report;
