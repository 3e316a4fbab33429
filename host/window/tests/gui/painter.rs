//! Images of the window without a display or a GPU: a software renderer for egui's triangles.
//!
//! It follows the rules of egui's own painters: gamma-space blending of premultiplied colours, linear sampling of
//! textures. So an image depends only on the program, not on the machine.

use eframe::egui::{self, Color32, ColorImage, ImageData, Pos2, Rect, TextureId, TexturesDelta, epaint};
use egui_kittest::TestRenderer;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// The textures of a window.
#[derive(Clone, Default)]
pub(crate) struct Painter(Rc<RefCell<HashMap<TextureId, ColorImage>>>);

impl TestRenderer for Painter {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let mut textures = self.0.borrow_mut();
        let changes =
            delta.set.drain().flat_map(|(id, changes)| changes.into_iter().map(move |change| (id, change)));
        for (id, change) in changes {
            let ImageData::Color(image) = change.image;
            let Some(at) = change.pos else {
                textures.insert(id, (*image).clone());
                continue;
            };
            let Some(texture) = textures.get_mut(&id) else { continue };
            let width = texture.size[0];
            for y in 0..image.size[1] {
                let from = y * image.size[0];
                let to = (at[1] + y) * width + at[0];
                texture.pixels[to..to + image.size[0]]
                    .copy_from_slice(&image.pixels[from..from + image.size[0]]);
            }
        }
        delta.free.clear();
    }
}

impl Painter {
    /// The window as it looks now.
    pub(crate) fn paint(
        &self,
        ctx: &egui::Context,
        output: &egui::FullOutput,
        size: [usize; 2],
    ) -> ColorImage {
        self.paint_within(ctx, output, size, Rect::EVERYTHING)
    }

    /// The part of the window in `within`, in points; the rest is black.
    pub(crate) fn paint_within(
        &self,
        ctx: &egui::Context,
        output: &egui::FullOutput,
        size: [usize; 2],
        within: Rect,
    ) -> ColorImage {
        let mut image = ColorImage::filled(size, Color32::BLACK);
        let textures = self.0.borrow();
        for primitive in ctx.tessellate(output.shapes.clone(), output.pixels_per_point) {
            let epaint::Primitive::Mesh(mesh) = primitive.primitive else { continue };
            let Some(texture) = textures.get(&mesh.texture_id) else { continue };
            let scale = output.pixels_per_point;
            let clip = primitive.clip_rect.intersect(within) * scale;
            for corners in mesh.indices.chunks_exact(3) {
                let corner = |i: usize| {
                    let vertex = mesh.vertices[corners[i] as usize];
                    Corner { at: vertex.pos * scale, uv: vertex.uv, colour: vertex.color }
                };
                triangle(&mut image, texture, clip, [corner(0), corner(1), corner(2)]);
            }
        }
        image
    }
}

#[derive(Clone, Copy)]
struct Corner {
    at: Pos2,
    uv: Pos2,
    colour: Color32,
}

/// Twice the signed area of a triangle.
fn area(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

fn triangle(image: &mut ColorImage, texture: &ColorImage, clip: Rect, mut corners: [Corner; 3]) {
    let whole = area(corners[0].at, corners[1].at, corners[2].at);
    if whole == 0.0 || !whole.is_finite() {
        return;
    }
    if whole < 0.0 {
        corners.swap(1, 2);
    }
    let [a, b, c] = corners;
    let bounds = Rect::from_points(&[a.at, b.at, c.at]).intersect(clip);
    let size = image.size;
    let from = |edge: f32, limit: usize| (edge.max(0.0) as usize).min(limit);
    let last = |edge: f32, limit: usize| (edge.max(0.0).ceil() as usize).min(limit);
    // Plain loops: these lines are run for each pixel of each picture, and tests are not optimised.
    let edges = [(b.at, c.at), (c.at, a.at), (a.at, b.at)];
    // The top-left rule: a pixel on a shared edge belongs to one triangle only.
    let mut owns_edge = [false; 3];
    for i in 0..3 {
        let (from, to) = edges[i];
        owns_edge[i] = to.y < from.y || (to.y == from.y && to.x > from.x);
    }
    // A plain area has one place of the texture.
    let plain = (a.uv == b.uv && b.uv == c.uv).then(|| sample(texture, a.uv.x, a.uv.y));
    let tint = [a, b, c].map(|corner| corner.colour.to_array().map(f32::from));
    let whole = whole.abs();
    for y in from(bounds.top(), size[1])..last(bounds.bottom(), size[1]) {
        for x in from(bounds.left(), size[0])..last(bounds.right(), size[0]) {
            let at = Pos2::new(x as f32 + 0.5, y as f32 + 0.5);
            if !clip.contains(at) {
                continue;
            }
            let mut share = [0.0; 3];
            let mut is_inside = true;
            for i in 0..3 {
                let weight = area(edges[i].0, edges[i].1, at);
                is_inside &= weight > 0.0 || (weight == 0.0 && owns_edge[i]);
                share[i] = weight / whole;
            }
            if !is_inside {
                continue;
            }
            let texel = plain.unwrap_or_else(|| {
                let u = share[0] * a.uv.x + share[1] * b.uv.x + share[2] * c.uv.x;
                let v = share[0] * a.uv.y + share[1] * b.uv.y + share[2] * c.uv.y;
                sample(texture, u, v)
            });
            let mix =
                |i: usize| (share[0] * tint[0][i] + share[1] * tint[1][i] + share[2] * tint[2][i]) * texel[i];
            let under = image.pixels[y * size[0] + x];
            let keep = 1.0 - mix(3) / 255.0;
            let blend = |over: f32, under: u8| (over + keep * f32::from(under)).round().min(255.0) as u8;
            image.pixels[y * size[0] + x] = Color32::from_rgb(
                blend(mix(0), under.r()),
                blend(mix(1), under.g()),
                blend(mix(2), under.b()),
            );
        }
    }
}

/// The texture at (u, v), linearly, as shares of 1.
fn sample(texture: &ColorImage, u: f32, v: f32) -> [f32; 4] {
    let [width, height] = texture.size;
    let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let texel = |x: f32, y: f32| {
        let x = (x.max(0.0) as usize).min(width - 1);
        let y = (y.max(0.0) as usize).min(height - 1);
        texture.pixels[y * width + x].to_array()
    };
    let (right, down) = (x - left, y - top);
    let mut mixed = [0.0; 4];
    let mut add = |corner: [u8; 4], weight: f32| {
        mixed[0] += weight * f32::from(corner[0]) / 255.0;
        mixed[1] += weight * f32::from(corner[1]) / 255.0;
        mixed[2] += weight * f32::from(corner[2]) / 255.0;
        mixed[3] += weight * f32::from(corner[3]) / 255.0;
    };
    add(texel(left, top), (1.0 - right) * (1.0 - down));
    add(texel(left + 1.0, top), right * (1.0 - down));
    add(texel(left, top + 1.0), (1.0 - right) * down);
    add(texel(left + 1.0, top + 1.0), right * down);
    mixed
}
