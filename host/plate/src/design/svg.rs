//! Writes a drawing as SVG: one user unit is 1 mm, and z points up on the page.

use super::drawing::{Drawing, Layer, Shape, TEXT_HEIGHT_MM, strokes, text_place};
use std::fmt::Write;

/// Empty margin around the drawing, mm.
const MARGIN_MM: f64 = 5.0;

impl Drawing {
    /// The drawing as an SVG file at true size: `width`, `height` and the view box are in millimetres.
    pub fn to_svg(&self) -> String {
        let [left, bottom, right, top] = self.extents_mm();
        let (width, height) = (right - left + 2.0 * MARGIN_MM, top - bottom + 2.0 * MARGIN_MM);
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.3}mm\" height=\"{height:.3}mm\" viewBox=\"{:.3} {:.3} {width:.3} {height:.3}\">",
            left - MARGIN_MM,
            -top - MARGIN_MM
        );
        let _ = writeln!(text, "  <title>{}</title>", escaped(&self.title));
        for (layer, style) in [
            (Layer::Cut, "fill=\"none\" stroke=\"#ff0000\" stroke-width=\"0.1\""),
            (Layer::Dimension, "fill=\"none\" stroke=\"#0000ff\" stroke-width=\"0.15\""),
        ] {
            let _ = writeln!(text, "  <g id=\"{}\" {style}>", layer.name().to_lowercase());
            for shape in self.shapes.iter().filter(|shape| shape.layer() == layer) {
                draw(&mut text, shape);
            }
            text.push_str("  </g>\n");
        }
        text.push_str("</svg>\n");
        text
    }
}

fn draw(text: &mut String, shape: &Shape) {
    match shape {
        Shape::Outline { points } => {
            text.push_str("    <path d=\"");
            for (i, [x, z]) in points.iter().enumerate() {
                let _ = write!(text, "{}{x:.4} {:.4} ", if i == 0 { 'M' } else { 'L' }, -z);
            }
            text.push_str("Z\"/>\n");
        }
        Shape::Hole { centre: [x, z], diameter } => {
            let _ =
                writeln!(text, "    <circle cx=\"{x:.4}\" cy=\"{:.4}\" r=\"{:.4}\"/>", -z, 0.5 * diameter);
        }
        Shape::Dimension { from, to, text: label } => {
            for [[x1, z1], [x2, z2]] in strokes(*from, *to) {
                let _ = writeln!(
                    text,
                    "    <line x1=\"{x1:.4}\" y1=\"{:.4}\" x2=\"{x2:.4}\" y2=\"{:.4}\"/>",
                    -z1, -z2
                );
            }
            let ([x, z], upward) = text_place(*from, *to);
            let turn =
                if upward { format!(" transform=\"rotate(-90 {x:.3} {:.3})\"", -z) } else { String::new() };
            let _ = writeln!(
                text,
                "    <text x=\"{x:.3}\" y=\"{:.3}\"{turn} font-family=\"sans-serif\" font-size=\"{TEXT_HEIGHT_MM}\" text-anchor=\"middle\" fill=\"#0000ff\" stroke=\"none\">{}</text>",
                -z,
                escaped(label)
            );
        }
        Shape::Note { at: [x, z], text: line } => {
            let _ = writeln!(
                text,
                "    <text x=\"{x:.3}\" y=\"{:.3}\" font-family=\"sans-serif\" font-size=\"{TEXT_HEIGHT_MM}\" fill=\"#0000ff\" stroke=\"none\">{}</text>",
                -z,
                escaped(line)
            );
        }
    }
}

/// Text as XML character data.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
