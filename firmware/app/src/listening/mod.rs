//! Measurement of the inputs: from the ADC's blocks to an answer per tone, captured samples and held levels.
//!
//! `listener` takes the blocks and counts lost ones, [`lock_in`](slipline_dds::lock_in) measures each tone, `capture` keeps
//! samples, `hold` steers the levels by the answers. What the hold's new levels may be is planned as any other program (`planning`).

pub mod capture;
pub mod hold;
pub mod listener;
