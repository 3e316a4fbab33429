//! Writes a drawing as DXF of AutoCAD release 12 (AC1009), which the software of all cutters reads; millimetres.

use super::drawing::{Drawing, Layer, Shape, TEXT_HEIGHT_MM, strokes, text_place};
use std::fmt::{Display, Write};

/// AutoCAD colour numbers of the layers: 1 is red, 5 is blue.
const LAYERS: [(Layer, i32); 2] = [(Layer::Cut, 1), (Layer::Dimension, 5)];

impl Drawing {
    /// The drawing as a DXF R12 file in millimetres.
    pub fn to_dxf(&self) -> String {
        let mut file = Groups::default();
        // Group 999 is a comment for people who open the file as text.
        file.put(999, format_args!("{}; units: millimetres", ascii(&self.title)));
        let [left, bottom, right, top] = self.extents_mm();
        file.section("HEADER");
        file.put(9, "$ACADVER").put(1, "AC1009");
        // R12 has no header variable for the unit. Programs read these two from later releases; without them they may
        // interpret the numbers as inches.
        file.put(9, "$INSUNITS").put(70, 4);
        file.put(9, "$MEASUREMENT").put(70, 1);
        file.put(9, "$EXTMIN").point(10, [left, bottom]);
        file.put(9, "$EXTMAX").point(10, [right, top]);
        file.put(0, "ENDSEC");

        file.section("TABLES");
        file.put(0, "TABLE").put(2, "LTYPE").put(70, 1);
        file.put(0, "LTYPE").put(2, "CONTINUOUS").put(70, 0).put(3, "Solid line").put(72, 65).put(73, 0);
        file.put(40, "0.0").put(0, "ENDTAB");
        file.put(0, "TABLE").put(2, "LAYER").put(70, LAYERS.len());
        for (layer, colour) in LAYERS {
            file.put(0, "LAYER").put(2, layer.name()).put(70, 0).put(62, colour).put(6, "CONTINUOUS");
        }
        file.put(0, "ENDTAB").put(0, "ENDSEC");

        file.section("ENTITIES");
        for shape in &self.shapes {
            draw(&mut file, shape);
        }
        file.put(0, "ENDSEC").put(0, "EOF");
        file.text
    }
}

/// The text of the file: pairs of a group code and a value, each on its own line.
#[derive(Default)]
struct Groups {
    text: String,
}

impl Groups {
    fn put(&mut self, code: i32, value: impl Display) -> &mut Self {
        // Writing to a String cannot fail.
        let _ = writeln!(self.text, "{code:>3}\n{value}");
        self
    }

    fn section(&mut self, name: &str) {
        self.put(0, "SECTION").put(2, name);
    }

    /// A point: `code` is the group of DXF's x, `code` + 10 that of DXF's y, which is z here.
    fn point(&mut self, code: i32, [x, z]: [f64; 2]) -> &mut Self {
        self.put(code, format_args!("{x:.5}")).put(code + 10, format_args!("{z:.5}"))
    }

    fn entity(&mut self, kind: &str, layer: Layer) -> &mut Self {
        self.put(0, kind).put(8, layer.name())
    }
}

fn draw(file: &mut Groups, shape: &Shape) {
    let layer = shape.layer();
    match shape {
        Shape::Outline { points } => {
            // 66 = 1: vertices follow; 70 = 1: closed.
            file.entity("POLYLINE", layer).put(66, 1).put(70, 1).point(10, [0.0, 0.0]).put(30, "0.0");
            for &point in points {
                file.entity("VERTEX", layer).point(10, point).put(30, "0.0");
            }
            file.entity("SEQEND", layer);
        }
        Shape::Hole { centre, diameter } => {
            file.entity("CIRCLE", layer)
                .point(10, *centre)
                .put(30, "0.0")
                .put(40, format_args!("{:.5}", 0.5 * diameter));
        }
        Shape::Dimension { from, to, text } => {
            for [start, end] in strokes(*from, *to) {
                file.entity("LINE", layer).point(10, start).put(30, "0.0").point(11, end).put(31, "0.0");
            }
            let (place, upward) = text_place(*from, *to);
            // 72 = 1: centred on the second point.
            file.entity("TEXT", layer)
                .point(10, place)
                .put(30, "0.0")
                .put(40, TEXT_HEIGHT_MM)
                .put(1, ascii(text))
                .put(50, if upward { "90.0" } else { "0.0" })
                .put(72, 1)
                .point(11, place)
                .put(31, "0.0");
        }
        Shape::Note { at, text } => {
            file.entity("TEXT", layer)
                .point(10, *at)
                .put(30, "0.0")
                .put(40, TEXT_HEIGHT_MM)
                .put(1, ascii(text));
        }
    }
}

/// Replaces every character that is not printable ASCII by a question mark: R12 has no other characters.
fn ascii(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect()
}
