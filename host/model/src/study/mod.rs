//! Studies: many plates drawn around a nominal one, each driven by the nominal plate's table.
//!
//! ```text
//! text -> Draft -> Spec -> Study: the nominal plate's table -> Drives: the tones of the places, their lines on the nominal plate
//!                              \-> run_range(first..end) -> Chunk (arrays) -> CSV, statistics, a store
//!                                    plate i <- factors of its fields <- draw(seed, i, field)
//! ```
//! Plate i depends on the seed, on i and on its varied fields alone: not on the range, the thread or the order in which it is
//! computed. So any range can be computed by itself, anywhere, with the same bits on the same kind of processor.

mod chunk;
pub mod csv;
mod draw;
mod drives;
mod error;
mod law;
mod plates;
mod results;
mod spec;
mod statistics;
#[cfg(feature = "native")]
mod threads;

pub use chunk::{Chunk, Status};
pub use error::StudyError;
pub use law::Law;
pub use plates::Study;
pub use results::{Kind, StudyResult};
pub use spec::{Draft, SPEC_BYTES_MAX, Spec, SpecError, Varied};
pub use statistics::{Statistics, Summary};
#[cfg(feature = "native")]
pub use threads::run_in_order;
