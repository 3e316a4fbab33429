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
    let is_largest = scene.settings.show_amplitude;
    let maps = [map(scene, is_largest), map(scene, true)];
    let picture = picture(&maps, is_largest, scene.full_colour_m(), columns, theme::palette(ui));
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

/// The colours of the plate, `columns` + 1 by [`ROWS`] texels: of the first map, and under the present displacement a glow of
/// the second, the largest one, so that no moment of the wave looks like a plate at rest.
fn picture(
    [now, reach]: &[DisplacementMap<'_>; 2],
    is_largest: bool,
    full_m: f64,
    columns: usize,
    palette: &theme::Palette,
) -> ColorImage {
    let across = rows(now);
    let mut picture = ColorImage::filled([columns + 1, ROWS], Color32::TRANSPARENT);
    for column in 0..=columns {
        let share = column as f64 / columns as f64;
        let (across_here, reach_here) = (now.column_at(share), reach.column_at(share));
        for (i, row) in across.iter().enumerate() {
            let value = (now.at(&across_here, row) / full_m) as f32;
            let colour = colour(value, is_largest, palette);
            picture[(column, i)] = if is_largest {
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
    use slipline_model::field::displacement_map::slow_factor;
    use slipline_model::field::steady_field::{SteadyField, full_colour_m, magnification, steady_tones};
    use slipline_model::scenes::SCENES;
    use slipline_model::setup::Setup;
    use slipline_plate::{DriveTable, presets};

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

    /// The difference of a channel that is seen.
    const SEEN: u8 = 8;

    #[test]
    fn no_phase_of_the_wave_on_a_preset_or_scene_looks_like_a_plate_at_rest() {
        let plates = presets().iter().map(|preset| Setup::new(preset.plate().unwrap().into()));
        let scenes = SCENES.iter().map(|scene| scene.setup().unwrap());
        for setup in plates.chain(scenes) {
            let plate = &setup.plate;
            let table = DriveTable::build(plate, 400e3, 17).unwrap();
            let field = SteadyField::solve(plate, &steady_tones(&setup, Some(&table)));
            let full_peak_m = table.peak_at_full_scale_m();
            let full_m =
                full_colour_m(Some(&field), full_peak_m) / magnification(field.highest_m() / full_peak_m);
            let slowest_hz =
                field.tones.iter().map(|tone| tone.tone.frequency_hz).fold(f64::INFINITY, f64::min);
            let period_s = slow_factor(&field) / slowest_hz;
            for palette in [&theme::LIGHT, &theme::DARK] {
                let at = |phase: u32| {
                    let map = |is_largest| {
                        let time_s = period_s * f64::from(phase) / 20.0;
                        DisplacementMap::new(Wave {
                            plate,
                            sounding: Some(&field),
                            sheet: None,
                            is_largest,
                            time_s,
                        })
                    };
                    picture(&[map(false), map(true)], false, full_m, 80, palette)
                };
                let rest = theme::diverging(0.0, palette.dark);
                for phase in 0..20 {
                    let seen = at(phase);
                    // Texels stand for the width of the plate at their column.
                    let share = |is_counted: &dyn Fn(Color32) -> bool| -> f64 {
                        let weight = |i: usize| plate.half_width_m(plate.length_m() * (i % 81) as f64 / 80.0);
                        let texels = seen.pixels.iter().enumerate();
                        texels.filter(|(_, colour)| is_counted(**colour)).map(|(i, _)| weight(i)).sum()
                    };
                    let is_off = |colour: Color32| {
                        let [a, b] = [colour, rest].map(|colour| colour.to_array());
                        a.iter().zip(b).any(|(a, b)| a.abs_diff(b) >= SEEN)
                    };
                    let off = share(&is_off) / share(&|_| true);
                    assert!(off >= 0.02, "{}, phase {phase}, dark {}: {off}", plate.name(), palette.dark);
                }
            }
        }
    }
}
