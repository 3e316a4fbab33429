//! The colours of the measurements: one keeps its colour while others come and go. The chosen one is also drawn thick, for
//! those who cannot distinguish the colours.

use crate::view::theme::Palette;
use eframe::egui::Color32;

const LIGHT: [Color32; 5] = [
    Color32::from_rgb(0xa3, 0x47, 0x00),
    Color32::from_rgb(0x00, 0x74, 0x58),
    Color32::from_rgb(0x87, 0x3a, 0x8d),
    Color32::from_rgb(0x5a, 0x66, 0x00),
    Color32::from_rgb(0xae, 0x2d, 0x58),
];
const DARK: [Color32; 5] = [
    Color32::from_rgb(0xf0, 0xa3, 0x5e),
    Color32::from_rgb(0x4c, 0xc9, 0xa6),
    Color32::from_rgb(0xd4, 0x9a, 0xe0),
    Color32::from_rgb(0xc5, 0xcf, 0x5a),
    Color32::from_rgb(0xf5, 0x8a, 0xa8),
];

/// The colour of the measurement of this number, which counts from 1.
pub(in crate::view) fn ink(number: u64, palette: &Palette) -> Color32 {
    let others = if palette.dark { &DARK } else { &LIGHT };
    let place = (number.saturating_sub(1) % (others.len() as u64 + 1)) as usize;
    place.checked_sub(1).and_then(|place| others.get(place)).copied().unwrap_or(palette.accent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::theme;

    #[test]
    fn the_first_measurements_have_colours_of_their_own_and_the_seventh_that_of_the_first() {
        for palette in [theme::LIGHT, theme::DARK] {
            let mut inks: Vec<[u8; 4]> = (1..=6).map(|number| ink(number, &palette).to_array()).collect();
            assert_eq!(ink(7, &palette).to_array(), inks[0]);
            inks.sort_unstable();
            inks.dedup();
            assert_eq!(inks.len(), 6);
        }
    }
}
