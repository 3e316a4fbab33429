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
        let mut image = ColorImage::filled(size, Color32::BLACK);
        let textures = self.0.borrow();
        for primitive in ctx.tessellate(output.shapes.clone(), output.pixels_per_point) {
            let epaint::Primitive::Mesh(mesh) = primitive.primitive else { continue };
            let Some(texture) = textures.get(&mesh.texture_id) else { continue };
            let scale = output.pixels_per_point;
            let clip = primitive.clip_rect * scale;
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
    for y in from(bounds.top(), size[1])..last(bounds.bottom(), size[1]) {
        for x in from(bounds.left(), size[0])..last(bounds.right(), size[0]) {
            let at = Pos2::new(x as f32 + 0.5, y as f32 + 0.5);
            if !clip.contains(at) {
                continue;
            }
            let edges = [(b.at, c.at), (c.at, a.at), (a.at, b.at)];
            let weights = edges.map(|(from, to)| area(from, to, at));
            // The top-left rule: a pixel on a shared edge belongs to one triangle only.
            let is_inside = edges.iter().zip(weights).all(|((from, to), weight)| {
                let owns_edge = to.y < from.y || (to.y == from.y && to.x > from.x);
                weight > 0.0 || (weight == 0.0 && owns_edge)
            });
            if !is_inside {
                continue;
            }
            let share = weights.map(|weight| weight / whole.abs());
            let mix =
                |pick: fn(&Corner) -> f32| share[0] * pick(&a) + share[1] * pick(&b) + share[2] * pick(&c);
            let texel = sample(texture, mix(|corner| corner.uv.x), mix(|corner| corner.uv.y));
            let channel = [
                mix(|corner| f32::from(corner.colour.r())) * texel[0],
                mix(|corner| f32::from(corner.colour.g())) * texel[1],
                mix(|corner| f32::from(corner.colour.b())) * texel[2],
                mix(|corner| f32::from(corner.colour.a())) * texel[3],
            ];
            let under = image.pixels[y * size[0] + x];
            let keep = 1.0 - channel[3] / 255.0;
            let blend = |over: f32, under: u8| (over + keep * f32::from(under)).round().min(255.0) as u8;
            image.pixels[y * size[0] + x] = Color32::from_rgb(
                blend(channel[0], under.r()),
                blend(channel[1], under.g()),
                blend(channel[2], under.b()),
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
    let corners =
        [texel(left, top), texel(left + 1.0, top), texel(left, top + 1.0), texel(left + 1.0, top + 1.0)];
    let (right, down) = (x - left, y - top);
    let weights = [(1.0 - right) * (1.0 - down), right * (1.0 - down), (1.0 - right) * down, right * down];
    let mut mixed = [0.0; 4];
    for (corner, weight) in corners.iter().zip(weights) {
        for (sum, channel) in mixed.iter_mut().zip(corner) {
            *sum += weight * f32::from(*channel) / 255.0;
        }
    }
    mixed
}
