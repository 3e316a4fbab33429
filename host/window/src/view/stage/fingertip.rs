//! The drawing of a fingertip that comes over the plate from its near edge, and of its print on the track.

use crate::view::theme;
use eframe::egui::{self, Color32, Mesh, Pos2, Rect, Shape, Stroke, pos2, vec2};
use std::f32::consts::PI;

/// Least width of the finger, in points.
const LEAST: f32 = 18.0;
/// Rows and columns of its shading.
const ROWS: usize = 24;
const COLUMNS: usize = 8;
/// The share of the finger's length from its near end over which it fades.
const FADES: f32 = 0.45;
/// Half of the width over which the tip is round, over half the width of the finger.
const ROUND: f32 = 1.15;
/// The nail: half its width and height, and how far its middle is from the tip, over half the width of the finger.
const NAIL: egui::Vec2 = vec2(0.56, 0.66);
const NAIL_AT: f32 = 1.02;
/// Radius of the print on the track, in points.
const PRINT: f32 = 11.0;

/// How the finger is drawn.
#[derive(Clone, Copy)]
pub(super) struct Look {
    /// The colour of what it feels.
    pub(super) feels: Color32,
    pub(super) is_hot: bool,
    pub(super) has_focus: bool,
}

impl Look {
    fn outline(self, palette: &theme::Palette) -> Stroke {
        let ink = if self.has_focus { palette.accent } else { palette.text };
        Stroke::new(if self.is_hot || self.has_focus { 2.2 } else { 1.4 }, ink)
    }
}

/// Draws a finger whose contact of `contact` points is at `centre`; it ends at the lower edge of `rect`.
pub(super) fn finger(
    painter: &egui::Painter,
    palette: &theme::Palette,
    rect: Rect,
    at: (Pos2, f32),
    look: Look,
) {
    let (centre, contact) = at;
    let half = 0.5 * contact.max(LEAST);
    let top = centre.y - half;
    let length = (rect.bottom() - top).max(2.0 * half);
    // A glow round the contact shows what it feels.
    for (grown, share) in [(7.0, 0.16), (4.0, 0.28), (1.5, 0.5)] {
        painter.circle_filled(centre, half + grown, look.feels.gamma_multiply(share));
    }
    let half_at = |below: f32| {
        let round = ROUND * half;
        if below >= round { half } else { half * (1.0 - ((round - below) / round).powi(2)).max(0.0).sqrt() }
    };
    let opacity = |below: f32| {
        let left = 1.0 - below / length;
        0.94 * (left / FADES).clamp(0.0, 1.0)
    };
    let skin = palette.panel.lerp_to_gamma(palette.text, if palette.dark { 0.62 } else { 0.16 });
    let shade = palette.panel.lerp_to_gamma(palette.text, if palette.dark { 0.28 } else { 0.42 });
    let mut mesh = Mesh::default();
    for row in 0..=ROWS {
        // Closer together where the tip is round.
        let below = length * (row as f32 / ROWS as f32).powi(2);
        for column in 0..=COLUMNS {
            let across = 2.0 * column as f32 / COLUMNS as f32 - 1.0;
            let colour = skin.lerp_to_gamma(shade, across * across * 0.9);
            let place = pos2(centre.x + across * half_at(below), top + below);
            mesh.colored_vertex(place, colour.gamma_multiply(opacity(below)));
        }
    }
    let stride = COLUMNS as u32 + 1;
    for row in 0..ROWS as u32 {
        for column in 0..COLUMNS as u32 {
            let a = row * stride + column;
            mesh.add_triangle(a, a + 1, a + stride);
            mesh.add_triangle(a + 1, a + stride + 1, a + stride);
        }
    }
    painter.add(Shape::mesh(mesh));
    let stroke = look.outline(palette);
    let end = length * (1.0 - 0.6 * FADES);
    let side = |sign: f32| {
        let steps = (0..=ROWS).map(move |i| end * (i as f32 / ROWS as f32).powi(2));
        steps.map(move |below| pos2(centre.x + sign * half_at(below), top + below)).collect::<Vec<Pos2>>()
    };
    for sign in [-1.0, 1.0] {
        painter.add(Shape::line(side(sign), stroke));
    }
    nail(painter, palette, pos2(centre.x, top + NAIL_AT * half), half, stroke.color);
}

fn nail(painter: &egui::Painter, palette: &theme::Palette, at: Pos2, half: f32, ink: Color32) {
    let turn = |i: usize| 2.0 * PI * i as f32 / 28.0;
    // Rounder at the tip than at its root.
    let point = |angle: f32| {
        let (sin, cos) = angle.sin_cos();
        let flat = sin.signum() * sin.abs().powf(if sin > 0.0 { 0.62 } else { 0.9 });
        at + half * vec2(NAIL.x * cos.signum() * cos.abs().powf(0.8), NAIL.y * flat)
    };
    let outline: Vec<Pos2> = (0..28).map(|i| point(turn(i))).collect();
    let fill = palette.panel.lerp_to_gamma(palette.text, if palette.dark { 0.78 } else { 0.05 });
    painter.add(Shape::convex_polygon(outline, fill, Stroke::new(1.0, ink.gamma_multiply(0.55))));
}

/// Draws the print of the finger on its track.
pub(super) fn print(painter: &egui::Painter, palette: &theme::Palette, centre: Pos2, look: Look) {
    let stroke = look.outline(palette);
    painter.circle(centre, PRINT, palette.panel, stroke);
    for (radius, from, to) in [(8.0, -0.95, 0.95), (5.4, -0.85, 0.85), (2.8, -0.8, 0.8)] {
        let arc = |i: usize| {
            let angle = PI * (from + (to - from) * i as f32 / 12.0) - 0.5 * PI;
            centre + radius * vec2(angle.cos(), angle.sin())
        };
        painter.add(Shape::line((0..=12).map(arc).collect(), Stroke::new(1.3, palette.weak)));
    }
}
