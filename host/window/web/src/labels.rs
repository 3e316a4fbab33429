//! The accessible nodes of the latest picture as data, for tests that press what a user would press. Only a build with
//! the feature `tests` has this: what is shipped makes no such tree.

use eframe::egui::{self, Plugin, Rect, accesskit};
use js_sys::{Array, Object, Reflect};
use std::collections::HashMap;
use wasm_bindgen::JsValue;

/// Keeps the tree that egui makes for each picture; eframe drops it in a browser.
#[derive(Default)]
struct Labels(Option<accesskit::TreeUpdate>);

impl Plugin for Labels {
    fn debug_name(&self) -> &'static str {
        "labels"
    }

    fn output_hook(&mut self, _ctx: &egui::Context, output: &mut egui::FullOutput) {
        if let Some(tree) = output.platform_output.accesskit_update.take() {
            self.0 = Some(tree);
        }
    }
}

/// Has each picture's tree made and kept from now on.
pub(crate) fn keep(ctx: &egui::Context) {
    ctx.enable_accesskit();
    ctx.add_plugin(Labels::default());
}

/// The nodes that have a place, each an object of `role`, `label`, `value`, `is_disabled`, `is_toggled`, `rect` and
/// `seen_rect`, in CSS pixels of the canvas: left, top, right, bottom. The latter is null where all of a node is scrolled out
/// of sight.
pub(crate) fn nodes(ctx: &egui::Context) -> Array {
    // What is left of each widget by the area that it is scrolled in.
    let seen: HashMap<_, _> = ctx.viewport(|viewport| {
        let widgets = viewport.prev_pass.widgets.layers().flat_map(|(_, widgets)| widgets);
        widgets.map(|widget| (widget.id.accesskit_id(), widget.interact_rect)).collect()
    });
    let scale = ctx.zoom_factor();
    let listed =
        ctx.with_plugin(|labels: &mut Labels| labels.0.as_ref().map(|tree| listed(tree, &seen, scale)));
    listed.flatten().unwrap_or_default()
}

fn listed(tree: &accesskit::TreeUpdate, seen: &HashMap<accesskit::NodeId, Rect>, scale: f32) -> Array {
    let all: HashMap<_, _> = tree.nodes.iter().map(|(id, node)| (id, node)).collect();
    let listed = Array::new();
    for (id, node) in &tree.nodes {
        let Some(bounds) = node.bounds() else { continue };
        let bounds = [bounds.x0, bounds.y0, bounds.x1, bounds.y1].map(|place| place as f32);
        let seen = seen.get(id).filter(|rect| rect.is_positive());
        let seen = seen.map(|rect| [rect.left(), rect.top(), rect.right(), rect.bottom()]);
        // A field is named by itself or by the text beside it.
        let beside = || {
            let mut texts = node.labelled_by().iter().filter_map(|id| all.get(id));
            texts.find_map(|text| text.value().or_else(|| text.label()))
        };
        let object = Object::new();
        for (name, value) in [
            ("role", JsValue::from(format!("{:?}", node.role()))),
            ("label", node.label().or_else(beside).into()),
            ("value", node.value().into()),
            ("is_disabled", node.is_disabled().into()),
            ("is_toggled", node.toggled().map(|toggled| toggled == accesskit::Toggled::True).into()),
            ("rect", in_pixels(bounds, scale).into()),
            ("seen_rect", seen.map(|rect| in_pixels(rect, scale)).into()),
        ] {
            // A plain object takes every property.
            let _ = Reflect::set(&object, &name.into(), &value);
        }
        listed.push(&object);
    }
    listed
}

fn in_pixels(rect: [f32; 4], scale: f32) -> Array {
    rect.into_iter().map(|place| JsValue::from(place * scale)).collect()
}
