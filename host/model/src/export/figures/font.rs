//! The font of the figures, and what fits into a line of it.

use crate::fonts::{HACK, UBUNTU_LIGHT};
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider as _};
use std::sync::OnceLock;

/// The font families that a figure refers to, in order of preference: a viewer without Ubuntu uses the next
/// one.
pub(super) const FAMILIES: &str = "Ubuntu, Ubuntu Light, sans-serif";
/// The font weight that a figure refers to.
pub(super) const WEIGHT: u16 = 300;

/// The assumed width of a letter that is in no font, as a multiple of the text size.
const UNKNOWN: f32 = 1.0;

/// The fonts in the order in which they are searched: the second has letters that the first lacks.
pub(super) const FONTS: [&[u8]; 2] = [UBUNTU_LIGHT, HACK];

/// Width of a text of this size, in the unit of the size.
pub(super) fn width(text: &str, size: f64) -> f64 {
    static FACES: OnceLock<Vec<FontRef<'static>>> = OnceLock::new();
    let faces = FACES.get_or_init(|| FONTS.iter().filter_map(|font| FontRef::new(font).ok()).collect());
    let advance = |letter: char| {
        let of_face = |face: &FontRef<'static>| {
            let glyph = face.charmap().map(letter)?;
            // The units of the font, scaled to text size 1.
            face.glyph_metrics(Size::new(1.0), LocationRef::default()).advance_width(glyph)
        };
        f64::from(faces.iter().find_map(of_face).unwrap_or(UNKNOWN))
    };
    size * text.chars().map(advance).sum::<f64>()
}

/// Breaks text into lines no wider than `room`; a word that is wider gets its own line.
pub(super) fn wrapped(text: &str, size: f64, room: f64) -> Vec<String> {
    joined(text.split_whitespace(), " ", size, room)
}

/// Fills lines of width `room` with phrases, `gap` between them; no phrase is broken.
pub(super) fn joined<'a>(
    phrases: impl IntoIterator<Item = &'a str>,
    gap: &str,
    size: f64,
    room: f64,
) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for phrase in phrases {
        match lines.last_mut() {
            Some(line) if width(&format!("{line}{gap}{phrase}"), size) <= room => {
                line.push_str(gap);
                line.push_str(phrase);
            }
            _ => lines.push(phrase.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_broken_between_words_and_loses_none() {
        let text = "a plate that narrows carries a wave";
        let room = width("a plate that", 8.0);
        let lines = wrapped(text, 8.0, room);
        assert!(lines.len() > 2 && lines.iter().all(|line| width(line, 8.0) <= room), "{lines:?}");
        assert_eq!(lines.join(" "), text);
        assert_eq!(wrapped("unbreakable", 8.0, 3.0), ["unbreakable"]);
        assert!(wrapped("", 8.0, 3.0).is_empty());
    }

    #[test]
    fn widths_are_the_fonts_own() {
        assert!(width("W", 10.0) > 2.0 * width("i", 10.0) && width("i", 10.0) > 1.0);
        assert!((width("wave", 20.0) - 2.0 * width("wave", 10.0)).abs() < 1e-9);
        // A letter that is in no font still needs a width.
        assert_eq!(width("\u{10ffff}", 8.0), 8.0);
    }
}
