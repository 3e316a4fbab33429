//! The plate's physics against closed solutions, independent solvers and its own documents, in one test program.
//!
//! `cargo test -p slipline-plate --test physics merit` runs the tests of one file.

mod air;
mod air_truth;
mod bending_end;
mod bending_truth;
mod bessel;
mod calibration;
mod clamped_end;
mod clamped_law;
mod clamped_sheet;
mod clamped_time;
mod digests;
mod drive_curve;
mod drive_end;
mod edges;
mod even_level;
mod exact;
mod film;
mod finger;
mod harmonics;
mod lights_truth;
mod loss_exponent;
mod merit;
mod ode;
mod on_a_table;
mod paper;
mod physics_page;
mod plate_files;
mod stopped;
mod texture;
mod thickness;
mod time_line;
mod turning_width;
