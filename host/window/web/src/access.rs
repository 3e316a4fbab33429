//! The accessible nodes of the window as data, because eframe drops egui's tree in a browser: `static/mirror.js` shows them to
//! screen readers, and tests press by them what a user would press.
//!
//! A tree takes a part of a picture's time, so not every picture makes one, but in a build with the feature `tests`.

use eframe::egui::{self, Plugin, Rect, accesskit};
use js_sys::{Array, Object, Reflect};
use std::collections::HashMap;
use wasm_bindgen::JsValue;

/// The time from one tree to the next, in seconds.
const EACH_S: f64 = if cfg!(feature = "tests") { 0.0 } else { 0.5 };

/// Keeps the latest tree.
#[derive(Default)]
struct Access {
    tree: Option<accesskit::TreeUpdate>,
    /// Whether the tree was not taken yet.
    is_new: bool,
    /// When it was made, in seconds of egui's clock.
    made_s: f64,
}

impl Plugin for Access {
    fn debug_name(&self) -> &'static str {
        "access"
    }

    fn output_hook(&mut self, _ctx: &egui::Context, output: &mut egui::FullOutput) {
        if let Some(tree) = output.platform_output.accesskit_update.take() {
            self.tree = Some(tree);
            self.is_new = true;
        }
    }
}

/// Keeps trees from now on.
pub(crate) fn keep(ctx: &egui::Context) {
    ctx.add_plugin(Access::default());
}

/// Decides before a picture whether it makes a tree.
pub(crate) fn begin(ctx: &egui::Context, now_s: f64) {
    let is_due = ctx.with_plugin(|access: &mut Access| {
        let is_due = access.tree.is_none() || now_s - access.made_s >= EACH_S;
        if is_due {
            access.made_s = now_s;
        }
        is_due
    });
    if is_due == Some(true) {
        ctx.enable_accesskit();
    } else {
        ctx.disable_accesskit();
    }
}

/// Within a picture: asks for one more if this one makes no tree, so that the last tree shows what is on the screen.
pub(crate) fn follow_up(ctx: &egui::Context) {
    let now_s = ctx.input(|input| input.time);
    let made_s = ctx.with_plugin(|access: &mut Access| access.made_s).unwrap_or(now_s);
    if made_s < now_s {
        ctx.request_repaint_after_secs((made_s + EACH_S - now_s).max(0.0) as f32);
    }
}

/// Whether there is a new tree since the last call.
pub(crate) fn take_news(ctx: &egui::Context) -> bool {
    ctx.with_plugin(|access: &mut Access| std::mem::take(&mut access.is_new)) == Some(true)
}

/// What a screen reader asks of a node: a press.
pub(crate) fn press(id: &str) -> Option<egui::Event> {
    Some(egui::Event::AccessKitActionRequest(accesskit::ActionRequest {
        action: accesskit::Action::Click,
        target_tree: accesskit::TreeId::ROOT,
        target_node: accesskit::NodeId(id.parse().ok()?),
        data: None,
    }))
}

/// The nodes that have a place in reading order, each an object of `id`, `role`, `label`, `value`, `number`, `is_disabled`,
/// `is_toggled`, `is_focused`, `rect` and `seen_rect`, in CSS pixels of the canvas: left, top, right, bottom. The latter is
/// null where all of a node is scrolled out of sight.
pub(crate) fn nodes(ctx: &egui::Context) -> Array {
    // The visible part of each widget in its scroll area.
    let seen: HashMap<_, _> = ctx.viewport(|viewport| {
        let widgets = viewport.prev_pass.widgets.layers().flat_map(|(_, widgets)| widgets);
        widgets.map(|widget| (widget.id.accesskit_id(), widget.interact_rect)).collect()
    });
    let scale = ctx.zoom_factor();
    let listed =
        ctx.with_plugin(|access: &mut Access| access.tree.as_ref().map(|tree| listed(tree, &seen, scale)));
    listed.flatten().unwrap_or_default()
}

fn listed(tree: &accesskit::TreeUpdate, seen: &HashMap<accesskit::NodeId, Rect>, scale: f32) -> Array {
    let all: HashMap<_, _> = tree.nodes.iter().map(|(id, node)| (id, node)).collect();
    let listed = Array::new();
    let mut ahead = vec![tree.tree.as_ref().map_or(tree.focus, |tree| tree.root)];
    while let Some(id) = ahead.pop() {
        let Some(node) = all.get(&id) else { continue };
        ahead.extend(node.children().iter().rev());
        let Some(bounds) = node.bounds() else { continue };
        let bounds = [bounds.x0, bounds.y0, bounds.x1, bounds.y1].map(|place| place as f32);
        let seen = seen.get(&id).filter(|rect| rect.is_positive());
        let seen = seen.map(|rect| [rect.left(), rect.top(), rect.right(), rect.bottom()]);
        // A field is named by itself or by the text beside it.
        let beside = || {
            let mut texts = node.labelled_by().iter().filter_map(|id| all.get(id));
            texts.find_map(|text| text.value().or_else(|| text.label()))
        };
        let object = Object::new();
        for (name, value) in [
            ("id", JsValue::from(id.0.to_string())),
            ("number", node.numeric_value().into()),
            ("is_focused", (tree.focus == id).into()),
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
