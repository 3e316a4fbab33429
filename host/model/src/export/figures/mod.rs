//! Figures: drawn as SVG, for papers, and painted from it as PNG.
//!
//! ```text
//! numbers -> Page (points) -> Drawing (SVG text) -> file of either format
//!             ^ axes, legend, plot                   ^ resvg, with the built-in font
//! ```
//! The numbers come from [`slipline_plate::paper`], the simulation, the frequency domain and the screen; this
//! module only draws them. It reads and writes no file.

mod axes;
mod drawing;
mod envelope;
mod font;
mod legend;
mod page;
#[cfg(feature = "painted")]
mod painting;
mod paper;
pub mod plate;
mod plot;
mod response;

pub use drawing::{DrawError, Drawing, Format, encode};
pub use envelope::envelope_figure;
#[cfg(feature = "painted")]
pub use painting::PaintError;
pub use paper::paper_figure;
pub use response::response_figure;

/// Width of a figure for print, in points: 170 mm, the text width of a page of A4.
const PRINT_WIDTH: f64 = 170.0 / 25.4 * 72.0;
/// Dots per inch of a figure as PNG: the resolution that journals require at print size.
const PRINT_DOTS_PER_INCH: f64 = 300.0;

#[cfg(all(test, feature = "painted"))]
mod tests;
