//! Tests that need a process of their own: one replaces the process's panic hook, one measures the process's memory.

mod panics;
mod soak;
