//! The wave on the plate as hills and valleys: a mesh of its own, seen from the side and lit by its slope. It is made only
//! while it is shown.

use crate::scene::Scene;
use crate::view::stage::displacement::{self, ROWS};
use crate::view::theme;
use eframe::egui::{self, Color32, Mesh, Pos2, Rect, Shape, pos2};

/// Half the plate's width at the driven end, and the height of full colour, as shares of the height of its view.
const DEPTH: f32 = 0.2;
const LIFT: f32 = 0.42;
/// How strongly a slope of one full colour for each column is lit, and how strongly at most.
const LIGHT: f32 = 6.0;
const BRIGHTEST: f32 = 0.5;

/// Half the width of the plate on the screen at its driven end, in points.
pub(crate) fn depth(rect: Rect) -> f32 {
    DEPTH * rect.height()
}

/// Shows the wave in `rect` over the plate's far edge on the screen, whose points are evenly spaced along the plate.
pub(crate) fn show(ui: &egui::Ui, scene: &Scene<'_>, rect: Rect, far_edge: &[Pos2]) {
    let palette = theme::palette(ui);
    let (plate, is_largest) = (&scene.setup.plate, scene.settings.show_amplitude);
    let map = displacement::map(scene, is_largest);
    let across = displacement::rows(&map);
    let full_m = scene.full_colour_m();
    let columns = far_edge.len().saturating_sub(1).max(1);
    let middle = rect.center().y;
    let mut mesh = Mesh::default();
    let mut before = [0.0; ROWS];
    for (column, far) in far_edge.iter().enumerate() {
        let here = map.column(column as f64 / columns as f64 * plate.length_m());
        for (row, before) in across.iter().zip(&mut before) {
            let value = (map.at(&here, row) / full_m) as f32;
            let rise = if column == 0 { 0.0 } else { value - *before };
            *before = value;
            let colour = displacement::colour(value, is_largest, palette);
            let level = middle + row.beta as f32 * (middle - far.y);
            mesh.colored_vertex(pos2(far.x, level - value * LIFT * rect.height()), lit(colour, rise));
        }
    }
    // From the far edge to the near one, so that a hill hides what is behind it.
    for row in 0..ROWS as u32 - 1 {
        for column in 0..columns as u32 {
            let a = column * ROWS as u32 + row;
            let b = a + ROWS as u32;
            mesh.add_triangle(a, a + 1, b);
            mesh.add_triangle(a + 1, b + 1, b);
        }
    }
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    // Hills stand before the far edge.
    painter.add(Shape::line(far_edge.to_vec(), egui::Stroke::new(1.5, palette.weak)));
    painter.add(Shape::mesh(mesh));
}

/// The colour of a slope, lit from the far end of the plate: lighter where it falls towards there.
fn lit(colour: Color32, rise: f32) -> Color32 {
    let towards = if rise < 0.0 { Color32::WHITE } else { Color32::BLACK };
    colour.lerp_to_gamma(towards, (LIGHT * rise.abs()).min(BRIGHTEST))
}
