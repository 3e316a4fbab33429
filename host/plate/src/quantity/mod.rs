//! Numbers and names as a person types and reads them.

pub mod notation;
pub mod number_format;
pub mod range;
pub(crate) mod suggestion;

pub use notation::Notation;
pub use range::{Count, Counted, Range};
pub use suggestion::nearest;
