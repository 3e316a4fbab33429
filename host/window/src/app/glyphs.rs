//! Names in scripts that the window's own fonts lack, such as CJK: eframe looks for a font of the system. Characters that no
//! font has are reported to the user, because they are drawn as empty boxes.

use super::App;
use eframe::egui::{self, FontId};

/// The names that were checked, and the missing characters that were reported.
#[derive(Default)]
pub(super) struct Glyphs {
    looked_at: String,
    reported: Vec<char>,
}

impl App {
    /// Reports once each character of the names on the screen that no font has.
    pub(super) fn look_for_glyphs(&mut self, ctx: &egui::Context) {
        // What these fonts lack is drawn with the browser's.
        if cfg!(target_arch = "wasm32") {
            return;
        }
        let ports = self.ports.iter().map(|port| port.label.as_str());
        let names = ports.chain([
            self.instrument.desk.setup().plate.name(),
            &self.instrument.screen.background().draft.name,
        ]);
        if names.clone().flat_map(str::chars).eq(self.glyphs.looked_at.chars()) {
            return;
        }
        let names: String = names.collect();
        let font = FontId::proportional(14.0);
        let is_new = |c: &char| !c.is_ascii() && !self.glyphs.reported.contains(c);
        let mut missing: Vec<char> = ctx.fonts_mut(|fonts| {
            names.chars().filter(is_new).filter(|&c| !fonts.has_glyph(&font, c)).collect()
        });
        missing.sort_unstable();
        missing.dedup();
        self.glyphs.looked_at = names;
        if missing.is_empty() {
            return;
        }
        let codes: Vec<String> = missing.iter().take(4).map(|&c| format!("U+{:04X}", u32::from(c))).collect();
        let more = if missing.len() > codes.len() { " and others" } else { "" };
        self.glyphs.reported.extend(missing);
        self.instrument.out.fail(format!(
            "No font of this system has the characters {}{more}: they are shown as boxes. Install a font of their \
             script, such as Noto Sans CJK, and start Slipline again.",
            codes.join(", ")
        ));
    }
}
