//! The fonts of the window and of the figures. They are part of the program, so that both look the same on every machine, even
//! one without fonts.

/// The font of words.
#[cfg(not(target_arch = "wasm32"))]
pub const UBUNTU_LIGHT: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;
/// The font of columns of figures and of code. It has letters that the other one lacks.
#[cfg(not(target_arch = "wasm32"))]
pub const HACK: &[u8] = epaint_default_fonts::HACK_REGULAR;

// A browser loads each byte before the first picture: there they have the letters of western Europe, Greek ones and the signs of
// formulas alone (`fonts/README.md`). What they lack is drawn with the fonts of the browser.

/// The font of words.
#[cfg(target_arch = "wasm32")]
pub const UBUNTU_LIGHT: &[u8] = include_bytes!("../fonts/Ubuntu-Light.ttf");
/// The font of columns of figures and of code. It has letters that the other one lacks.
#[cfg(target_arch = "wasm32")]
pub const HACK: &[u8] = include_bytes!("../fonts/Hack-Regular.ttf");
