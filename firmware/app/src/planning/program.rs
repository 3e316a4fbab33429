//! A change of the drive, checked and complete.
//!
//! ```text
//! Drive + table + motion at the index --plan--> Program --Motion::follow--> Motion --mailbox--> samples
//! ```

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::table::Setting;
use slipline_protocol::units::{FinePosition, Gain, SampleIndex};

use crate::slots::TableRef;

/// Where a tone goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// Its place.
    pub position: FinePosition,
    /// Its level, master included.
    pub level: Gain,
    /// Its phase at the start, if it starts from silence; 2^64 = one turn.
    pub phase: u64,
    /// Its step and gain if it starts from silence; `None`: the table's values at its place.
    pub setting: Option<Setting>,
}

/// A change of the drive, complete and immutable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Program {
    /// The block boundary it begins at.
    pub at: SampleIndex,
    /// Its duration in samples.
    pub glide: u32,
    /// Its table.
    pub table: TableRef,
    /// Where each slot goes; a slot with no target fades out.
    pub targets: [Option<Target>; MAX_TONES],
}
