//! Tests that need a process of their own: one replaces the process's panic hook, one measures the process's memory, one
//! draws the first figure.

mod first_figure;
mod panics;
mod soak;
