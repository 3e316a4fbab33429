//! The pages of the side panel, one file each: what the user sets up, beside the stage.
//!
//! A page is text, choices and fields; what is drawn along the plate is the stage's, what several pages ask for is a field.

pub(crate) mod boundary_panel;
pub(crate) mod designer;
pub(crate) mod device_panel;
pub(crate) mod measure_panel;
pub(crate) mod plane_check;
pub(crate) mod plate_panel;
pub(crate) mod play_panel;
pub(crate) mod side_panel;
pub(crate) mod texture_panel;
pub(crate) mod texture_plot;
mod time_line;
pub(crate) mod tones_panel;
pub(crate) mod validity;
