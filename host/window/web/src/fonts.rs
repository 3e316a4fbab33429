//! The window's fonts on a page. What they lack is drawn with the browser's.

use eframe::egui::{FontData, FontDefinitions, FontFamily};
use slipline_model::fonts::{HACK, UBUNTU_LIGHT};
use std::sync::Arc;

/// The fonts, in the order in which egui searches its own.
pub(crate) fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    for (name, font) in [("Ubuntu-Light", UBUNTU_LIGHT), ("Hack", HACK)] {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(font)));
    }
    for (family, names) in [
        (FontFamily::Proportional, &["Ubuntu-Light"][..]),
        (FontFamily::Monospace, &["Hack", "Ubuntu-Light"]),
    ] {
        fonts.families.insert(family, names.iter().map(|&name| name.to_owned()).collect());
    }
    fonts
}
