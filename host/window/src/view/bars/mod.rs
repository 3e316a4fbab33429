//! The rows above and below the stage: menu, device and STOP at the top; meters, log and plots at the bottom.

pub(crate) mod bottom_row;
pub(crate) mod log;
pub(crate) mod menu;
pub(crate) mod meters;
pub(crate) mod offers;
pub(crate) mod status_line;
pub(crate) mod top_bar;
pub(crate) mod tour;
