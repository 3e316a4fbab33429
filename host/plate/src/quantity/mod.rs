//! Numbers and names as a person types and reads them.

pub mod numeral;
pub(crate) mod suggestion;

pub use suggestion::nearest;
