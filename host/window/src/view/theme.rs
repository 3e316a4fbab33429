//! Colours, type and spacing of the window, in light and dark.

use eframe::egui::{self, Color32, CornerRadius, FontId, Margin, Rect, Stroke, TextStyle, Theme, vec2};
use slipline_model::colour_map::{self, Rgb};
use std::sync::LazyLock;

/// Space between related controls, in points.
pub const GAP: f32 = 8.0;
/// Space between a scroll bar and the content, in points.
const BESIDE_BAR: f32 = 3.0;
/// The least width of a handle that can be touched, in points.
pub const HANDLE: f32 = 24.0;

/// The colours of one theme.
#[derive(Clone, Copy, Debug)]
pub struct Palette {
    /// Whether it is the dark theme.
    pub dark: bool,
    /// Background of the window.
    pub page: Color32,
    /// Background of the panels.
    pub panel: Color32,
    /// Background of views and plots.
    pub well: Color32,
    /// Separator lines.
    pub line: Color32,
    /// Grid lines in views and plots.
    pub grid: Color32,
    /// Text.
    pub text: Color32,
    /// Text of less importance.
    pub weak: Color32,
    /// The boundary line and its handle.
    pub boundary: Color32,
    /// The accent colour.
    pub accent: Color32,
    /// A good state.
    pub good: Color32,
    /// A warning.
    pub warn: Color32,
    /// Background of STOP, and frames of errors.
    pub bad: Color32,
    /// Text of an error.
    pub wrong: Color32,
    /// Text on `bad`, `good` and `accent`.
    pub on_colour: Color32,
}

pub(super) const LIGHT: Palette = Palette {
    dark: false,
    page: Color32::from_rgb(0xee, 0xf0, 0xf3),
    panel: Color32::from_rgb(0xfa, 0xfb, 0xfc),
    well: Color32::from_rgb(0xff, 0xff, 0xff),
    line: Color32::from_rgb(0xd5, 0xda, 0xe1),
    grid: Color32::from_rgb(0xe6, 0xe9, 0xee),
    text: Color32::from_rgb(0x1b, 0x23, 0x2e),
    weak: Color32::from_rgb(0x55, 0x61, 0x71),
    boundary: Color32::from_rgb(0x11, 0x18, 0x27),
    accent: Color32::from_rgb(0x1f, 0x5f, 0xb4),
    good: Color32::from_rgb(0x1a, 0x74, 0x4a),
    warn: Color32::from_rgb(0x96, 0x5a, 0x00),
    bad: Color32::from_rgb(0xc4, 0x1e, 0x30),
    wrong: Color32::from_rgb(0xb5, 0x17, 0x2a),
    on_colour: Color32::WHITE,
};

pub(super) const DARK: Palette = Palette {
    dark: true,
    page: Color32::from_rgb(0x10, 0x13, 0x18),
    panel: Color32::from_rgb(0x19, 0x1d, 0x24),
    well: Color32::from_rgb(0x13, 0x17, 0x1d),
    line: Color32::from_rgb(0x2d, 0x34, 0x3f),
    grid: Color32::from_rgb(0x23, 0x29, 0x32),
    text: Color32::from_rgb(0xe6, 0xea, 0xf0),
    weak: Color32::from_rgb(0x9c, 0xa8, 0xb8),
    boundary: Color32::from_rgb(0xf5, 0xf7, 0xfa),
    accent: Color32::from_rgb(0x6c, 0xa8, 0xf2),
    good: Color32::from_rgb(0x4f, 0xc0, 0x8a),
    warn: Color32::from_rgb(0xe0, 0xab, 0x4a),
    bad: Color32::from_rgb(0xd8, 0x36, 0x46),
    wrong: Color32::from_rgb(0xff, 0x7a, 0x85),
    on_colour: Color32::WHITE,
};

impl Palette {
    /// Shade over the part of a view that a boundary cannot reach.
    #[must_use]
    pub fn beyond(&self) -> Color32 {
        self.line.gamma_multiply(0.45)
    }
}

/// The palette in use.
#[must_use]
pub fn palette(ui: &egui::Ui) -> &'static Palette {
    if ui.visuals().dark_mode { &DARK } else { &LIGHT }
}

/// Gives both themes of a context their colours, type and spacing.
pub fn install(ctx: &egui::Context) {
    for (theme, palette) in [(Theme::Light, &LIGHT), (Theme::Dark, &DARK)] {
        ctx.style_mut_of(theme, |style| dress(style, palette));
    }
}

fn dress(style: &mut egui::Style, palette: &Palette) {
    style.text_styles = [
        (TextStyle::Small, FontId::proportional(12.5)),
        (TextStyle::Body, FontId::proportional(13.0)),
        (TextStyle::Button, FontId::proportional(13.0)),
        (TextStyle::Heading, FontId::proportional(16.0)),
        (TextStyle::Monospace, FontId::monospace(12.0)),
    ]
    .into();
    style.spacing.item_spacing = vec2(GAP, 6.0);
    style.spacing.button_padding = vec2(10.0, 4.0);
    style.spacing.interact_size = vec2(40.0, 26.0);
    style.spacing.slider_width = 150.0;
    style.spacing.combo_width = 120.0;
    style.spacing.tooltip_width = 340.0;
    style.animation_time = 0.08;
    let visuals = &mut style.visuals;
    visuals.dark_mode = palette.dark;
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.extreme_bg_color = palette.well;
    visuals.faint_bg_color = palette.page;
    visuals.override_text_color = None;
    visuals.weak_text_color = Some(palette.weak);
    visuals.hyperlink_color = palette.accent;
    visuals.warn_fg_color = palette.warn;
    visuals.error_fg_color = palette.wrong;
    visuals.selection.bg_fill = palette.accent.gamma_multiply(if palette.dark { 0.45 } else { 0.22 });
    visuals.selection.stroke = Stroke::new(1.0, palette.text);
    visuals.slider_trailing_fill = true;
    visuals.menu_corner_radius = CornerRadius::same(8);
    visuals.window_corner_radius = CornerRadius::same(10);
    let widgets = &mut visuals.widgets;
    let fills = if palette.dark {
        [
            Color32::from_rgb(0x26, 0x2c, 0x36),
            Color32::from_rgb(0x30, 0x38, 0x45),
            Color32::from_rgb(0x3a, 0x44, 0x53),
        ]
    } else {
        [
            Color32::from_rgb(0xe7, 0xea, 0xef),
            Color32::from_rgb(0xdc, 0xe1, 0xe8),
            Color32::from_rgb(0xcf, 0xd6, 0xe0),
        ]
    };
    for (widget, fill) in
        [(&mut widgets.inactive, fills[0]), (&mut widgets.hovered, fills[1]), (&mut widgets.active, fills[2])]
    {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::new(1.0, palette.line);
        widget.fg_stroke = Stroke::new(1.0, palette.text);
        widget.corner_radius = CornerRadius::same(6);
        widget.expansion = 0.0;
    }
    widgets.hovered.bg_stroke = Stroke::new(1.0, palette.weak.gamma_multiply(0.6));
    widgets.active.bg_stroke = Stroke::new(1.5, palette.accent);
    widgets.open.bg_fill = fills[1];
    widgets.open.weak_bg_fill = fills[1];
    widgets.open.fg_stroke = Stroke::new(1.0, palette.text);
    widgets.open.corner_radius = CornerRadius::same(6);
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, palette.text);
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.line);
    widgets.noninteractive.corner_radius = CornerRadius::same(6);
}

/// Space between the edge of a panel or of the page and its content, in points.
pub(super) const MARGIN: Margin = Margin::symmetric(14, 10);

/// The colour that the graphics fill the window with before anything is drawn: that of the panels, which therefore draw none.
/// Without a graphics card the processor shades and blends each pixel that is drawn, but not those that are cleared.
#[must_use]
pub fn ground(visuals: &egui::Visuals) -> [f32; 4] {
    visuals.panel_fill.to_normalized_gamma_f32()
}

/// Fills the page around a part of it that has a colour of its own, which would be drawn twice.
pub(super) fn fill_page_around(ui: &egui::Ui, page: Rect, part: Rect) {
    let fill = palette(ui).page;
    let mut mesh = egui::Mesh::default();
    for rect in [page, part] {
        for corner in [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom()] {
            mesh.colored_vertex(corner, fill);
        }
    }
    for side in 0..4_u32 {
        let next = (side + 1) % 4;
        mesh.add_triangle(side, next, side + 4);
        mesh.add_triangle(next, next + 4, side + 4);
    }
    ui.painter().add(egui::Shape::mesh(mesh));
}

/// Text size of a small heading, in points.
pub const HEADING: f32 = 13.5;

/// A small heading over a group of controls.
pub fn heading(ui: &mut egui::Ui, text: &str) {
    ui.label(egui::RichText::new(text).strong().size(HEADING));
}

/// A button that is filled while it is the one to be pressed next: there is only one of them on a page then.
pub(super) fn primary(ui: &egui::Ui, word: &str, is_due: bool) -> egui::Button<'static> {
    let palette = palette(ui);
    let text = egui::RichText::new(word).strong();
    if is_due {
        let ink = if palette.dark { palette.page } else { palette.on_colour };
        egui::Button::new(text.color(ink)).fill(palette.accent)
    } else {
        egui::Button::new(text)
    }
}

/// Keeps the content of a scrolled area clear of its bar, which floats over it and is widest under the pointer.
pub(super) fn clear_of_bar(ui: &mut egui::Ui) {
    let bar = ui.spacing().scroll.bar_width + BESIDE_BAR;
    ui.set_max_width((ui.available_width() - bar).max(0.0));
}

/// Names a picture and says what it shows, for a screen reader; it has a read-out at the pointer, over which a tooltip
/// would lie.
pub(super) fn describe(response: &egui::Response, name: &str, help: &str) {
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
    response.ctx.accesskit_node_builder(response.id, |node| node.set_description(help));
}

/// Width of a text on one line, in points.
pub(super) fn text_width(ui: &egui::Ui, text: &str, font: FontId) -> f32 {
    ui.painter().layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER).size().x
}

/// Names a text field for a screen reader, with its value before, what is typed, and its hint.
pub(super) fn name_field(field: &egui::Response, name: &str, value: &str, typed: &str, hint: &str) {
    field.widget_info(|| {
        let mut info = egui::WidgetInfo::text_edit(true, value, typed, hint);
        info.label = Some(name.to_owned());
        info
    });
}

/// The arrow keys, left and right, move what has the focus, not the focus.
pub(super) fn keep_arrows(ui: &egui::Ui, focused: egui::Id) {
    let filter = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(focused, filter));
}

/// Colours of each sign: a displacement's own colour differs from the nearest by 1 of 255 in a channel at most.
const SHADES: usize = 1024;

fn colour([red, green, blue]: Rgb) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// Signed displacement, -1..=1, in the colours of [`colour_map::diverging`]: the nearest of 1024 for each sign, as
/// the plate has thousands of texels a frame.
#[must_use]
pub fn diverging(value: f32, dark: bool) -> Color32 {
    static DIVERGING: LazyLock<[Vec<Color32>; 2]> = LazyLock::new(|| {
        let shade = |i: usize| (i as f32 - SHADES as f32) / SHADES as f32;
        [false, true]
            .map(|dark| (0..=2 * SHADES).map(|i| colour(colour_map::diverging(shade(i), dark))).collect())
    });
    // A NaN is at rest, as in the map itself.
    let step = (value.clamp(-1.0, 1.0) * SHADES as f32).round() as i32;
    DIVERGING[usize::from(dark)][(step + SHADES as i32) as usize]
}

/// Amplitude, 0..=1, in the colours of [`colour_map::sequential`].
#[must_use]
pub fn sequential(value: f32, dark: bool) -> Color32 {
    colour(colour_map::sequential(value, dark))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG relative luminance.
    fn luminance(colour: Color32) -> f32 {
        let linear = |channel: u8| {
            let value = f32::from(channel) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
    }

    fn contrast(a: Color32, b: Color32) -> f32 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn a_displacement_has_the_colour_of_the_map() {
        for dark in [false, true] {
            let values = (-10_500..=10_500).map(|i| i as f32 / 1e4).chain([f32::NAN, f32::INFINITY.recip()]);
            for value in values {
                let exact = colour(colour_map::diverging(value, dark)).to_array();
                let shown = diverging(value, dark).to_array();
                let is_near = exact.iter().zip(shown).all(|(&exact, shown)| exact.abs_diff(shown) <= 1);
                assert!(is_near, "{value}: {shown:?} for {exact:?}");
            }
        }
    }

    #[test]
    fn words_contrast_with_what_is_behind_them() {
        for palette in [LIGHT, DARK] {
            for ink in [palette.text, palette.weak, palette.warn, palette.good, palette.accent, palette.wrong]
            {
                for ground in [palette.panel, palette.page, palette.well] {
                    assert!(contrast(ink, ground) >= 4.5, "{ink:?} on {ground:?}: {}", contrast(ink, ground));
                }
            }
            assert!(contrast(palette.on_colour, palette.bad) >= 4.4);
        }
    }
}
