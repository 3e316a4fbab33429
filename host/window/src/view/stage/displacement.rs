//! The wave on the plate: a picture of one texel a column and row, stretched over the plate's outline.
//!
//! The graphics interpolate between its texels. As a mesh of coloured triangles the same picture costs a computer without
//! a graphics card twenty times the triangles.

use crate::scene::Scene;
use crate::view::theme;
use eframe::egui::{
    self, Color32, ColorImage, Id, Mesh, Pos2, Shape, TextureHandle, TextureOptions, epaint::Vertex, pos2,
};
use slipline_model::field::displacement_map::{DisplacementMap, Row, Wave};

/// Rows of the picture across the plate.
pub(crate) const ROWS: usize = 19;
/// The share of the glow's colour where the plate moves most.
const GLOW: f32 = 0.45;

/// Shows the wave between the plate's upper and lower edge: `ends` are points of both, over each other and evenly spaced
/// from the driven end to the far one. `columns` is the resolution along the plate.
pub(crate) fn show(
    ui: &egui::Ui,
    scene: &Scene<'_>,
    ends: impl ExactSizeIterator<Item = [Pos2; 2]>,
    columns: usize,
) {
    let picture = picture(scene, columns, theme::palette(ui));
    let id = Id::unique("the wave on the plate");
    let kept = ui.data(|data| data.get_temp::<TextureHandle>(id));
    let texture = match kept {
        Some(mut texture) => {
            texture.set(picture, TextureOptions::LINEAR);
            texture
        }
        None => {
            let texture = ui.ctx().load_texture("wave", picture, TextureOptions::LINEAR);
            ui.data_mut(|data| data.insert_temp(id, texture.clone()));
            texture
        }
    };
    let strips = ends.len().saturating_sub(1);
    let mut mesh = Mesh::with_texture(texture.id());
    for (i, [upper, lower]) in ends.enumerate() {
        let u = texel(i as f32 / strips as f32, columns + 1);
        for (pos, across) in [(upper, 0.0), (lower, 1.0)] {
            mesh.vertices.push(Vertex { pos, uv: pos2(u, texel(across, ROWS)), color: Color32::WHITE });
        }
    }
    for i in 0..strips as u32 {
        mesh.add_triangle(2 * i, 2 * i + 1, 2 * i + 2);
        mesh.add_triangle(2 * i + 1, 2 * i + 2, 2 * i + 3);
    }
    ui.painter().add(Shape::mesh(mesh));
}

/// The texture's coordinate at which a share of the way from the first to the last of `count` texels is shown. A texel
/// shows its own colour at its centre.
fn texel(share: f32, count: usize) -> f32 {
    (share * (count - 1) as f32 + 0.5) / count as f32
}

/// The present displacement of the plate, or the largest, as `is_largest` says.
pub(crate) fn map<'a>(scene: &Scene<'a>, is_largest: bool) -> DisplacementMap<'a> {
    DisplacementMap::new(Wave {
        plate: &scene.setup.plate,
        sounding: scene.sounding,
        sheet: scene.sheet,
        is_largest,
        time_s: scene.wave_time_s,
    })
}

/// [`ROWS`] lines along the plate, from edge to edge.
pub(crate) fn rows(map: &DisplacementMap<'_>) -> Vec<Row> {
    (0..ROWS).map(|row| map.row(2.0 * row as f64 / (ROWS - 1) as f64 - 1.0)).collect()
}

/// The colour of a displacement over that of full colour: of the largest by its size, of the present one by its sign, too.
pub(crate) fn colour(value: f32, is_largest: bool, palette: &theme::Palette) -> Color32 {
    if is_largest {
        theme::sequential(value.abs(), palette.dark)
    } else {
        theme::diverging(value, palette.dark)
    }
}

/// The colours of the plate, `columns` + 1 by [`ROWS`] texels.
fn picture(scene: &Scene<'_>, columns: usize, palette: &theme::Palette) -> ColorImage {
    let show_amplitude = scene.settings.show_amplitude;
    let plate = &scene.setup.plate;
    let now = map(scene, show_amplitude);
    // Under the present displacement lies a glow of the largest, so that no moment of the wave looks like a plate at rest.
    let reach = map(scene, true);
    let across = rows(&now);
    let full_m = scene.full_colour_m();
    let mut picture = ColorImage::filled([columns + 1, ROWS], Color32::TRANSPARENT);
    for column in 0..=columns {
        let x_m = column as f64 / columns as f64 * plate.length_m();
        let (across_here, reach_here) = (now.column(x_m), reach.column(x_m));
        for (i, row) in across.iter().enumerate() {
            let value = (now.at(&across_here, row) / full_m) as f32;
            let colour = colour(value, show_amplitude, palette);
            picture[(column, i)] = if show_amplitude {
                colour
            } else {
                let largest = (reach.at(&reach_here, row) / full_m) as f32;
                glowing(colour, value, largest, palette.weak)
            };
        }
    }
    picture
}

/// The colour of a displacement over the glow of the largest there: full between two crests, gone on a crest.
fn glowing(colour: Color32, value: f32, largest: f32, glow: Color32) -> Color32 {
    let rest = 1.0 - (value / largest.max(1e-6)).abs().min(1.0);
    colour.lerp_to_gamma(glow, GLOW * largest.clamp(0.0, 1.0).sqrt() * rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_plate_show_the_first_and_the_last_texel() {
        assert_eq!(texel(0.0, 4), 0.125);
        assert_eq!(texel(1.0, 4), 0.875);
        assert_eq!(texel(0.5, 19), 0.5);
    }

    #[test]
    fn the_wave_glows_between_its_crests_and_the_plate_at_rest_does_not() {
        for palette in [&theme::LIGHT, &theme::DARK] {
            let at = |value: f32, largest: f32| {
                glowing(theme::diverging(value, palette.dark), value, largest, palette.weak)
            };
            let rest = theme::diverging(0.0, palette.dark);
            assert_eq!(at(0.0, 0.0), rest);
            assert_eq!(at(0.8, 0.8), theme::diverging(0.8, palette.dark), "a crest keeps its colour");
            let off = |colour: Color32| u32::from(colour.g().abs_diff(rest.g()));
            assert!(off(at(0.0, 1.0)) > off(at(0.0, 0.3)) && off(at(0.0, 0.3)) > 8, "{}", palette.dark);
        }
    }
}
