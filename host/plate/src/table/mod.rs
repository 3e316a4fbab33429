//! The turning-point table, and its error on a plate that differs from the one it was made for.

mod boundary;
mod drive_table;
pub(crate) mod error;
mod knots;
pub(crate) mod level;
mod sensitivity;
pub(crate) mod travel;

pub use boundary::{Boundary, NoBoundary, boundaries};
pub use drive_table::{DriveTable, Knot};
pub use error::{KNOTS_MAX, TableError};
pub use level::Level;
pub use sensitivity::{Sensitivity, sensitivity_per_percent, table_sensitivity};
pub use travel::TableTravel;
