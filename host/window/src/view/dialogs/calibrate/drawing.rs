//! The plate from above, to scale along its length, with the places of the sensor.

use crate::view::theme;
use eframe::egui::{self, Align2, FontId, Pos2, Shape, Stroke, pos2, vec2};
use slipline_instrument::calibration::CalibrationWizard;
use slipline_plate::quantity::show_place;

/// Height of the drawing in points, and the room beside the plate.
const HEIGHT: f32 = 120.0;
const MARGIN: f32 = 16.0;
/// Least distance of two places whose words are centred, and the space between other words and their line, in points.
const WORDS: f32 = 64.0;
const ASIDE: f32 = 2.0;
/// Points along an edge.
const POINTS: usize = 64;

const HELP: &str =
    "The plate from above, the driven end at the left, with the place where the sensor is to be put";

pub(super) fn show(ui: &mut egui::Ui, calibration: &CalibrationWizard, sensor: usize) {
    let palette = theme::palette(ui);
    let plate = calibration.plate();
    let (area, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), egui::Sense::hover());
    let drawn = area.shrink2(vec2(MARGIN, 22.0));
    let length_m = plate.length_m();
    // The width is not drawn to scale: a plate 20 times as long as wide would look like a line.
    let widest =
        (0..=POINTS).map(|i| plate.half_width_m(length_m * i as f64 / POINTS as f64)).fold(0.0, f64::max);
    let at = |share: f64, side: f32| {
        let half = (plate.half_width_m(length_m * share) / widest) as f32 * 0.5 * drawn.height();
        pos2(drawn.left() + share as f32 * drawn.width(), drawn.center().y + side * half)
    };
    let along = |i: usize| i as f64 / POINTS as f64;
    let edge = |side: f32| (0..=POINTS).map(move |i| at(along(i), side));
    let painter = ui.painter();
    let fill = palette.accent.gamma_multiply(0.14);
    for i in 0..POINTS {
        let [a, b] = [along(i), along(i + 1)];
        painter.add(Shape::convex_polygon(
            vec![at(a, -1.0), at(b, -1.0), at(b, 1.0), at(a, 1.0)],
            fill,
            Stroke::NONE,
        ));
    }
    let outline: Vec<Pos2> = edge(-1.0).chain(edge(1.0).collect::<Vec<_>>().into_iter().rev()).collect();
    painter.add(Shape::closed_line(outline, Stroke::new(1.2, palette.weak)));
    let centre = Stroke::new(1.0, palette.weak.gamma_multiply(0.6));
    painter.extend(Shape::dashed_line(&[drawn.left_center(), drawn.right_center()], centre, 5.0, 4.0));
    painter.line_segment([at(0.0, -1.0), at(0.0, 1.0)], Stroke::new(4.0, palette.text));
    let font = FontId::proportional(11.5);
    let under = pos2(drawn.left(), area.bottom() - 2.0);
    painter.text(under, Align2::LEFT_BOTTOM, "driven end", font.clone(), palette.weak);
    // Its actual place may differ from the proposed one.
    let place_m = |i: usize| {
        let stood = calibration.answer(i).filter(|_| i < sensor);
        stood.map_or(calibration.places_m()[i], |answer| answer.measurement.place_m)
    };
    let across = |i: usize| drawn.left() + (place_m(i) / length_m) as f32 * drawn.width();
    for i in 0..=sensor {
        let ink = if i == sensor { palette.accent } else { palette.weak };
        let (place_m, x) = (place_m(i), across(i));
        // Of places close to each other, the words stand at the outer sides.
        let others = (0..=sensor).filter(|other| *other != i).map(|other| x - across(other));
        let apart = others.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f32::INFINITY);
        let (aligned, aside) = match apart {
            _ if apart.abs() > WORDS => (Align2::CENTER_TOP, 0.0),
            _ if apart > 0.0 => (Align2::LEFT_TOP, ASIDE),
            _ => (Align2::RIGHT_TOP, -ASIDE),
        };
        painter.vline(x, area.top() + 16.0..=area.bottom() - 16.0, Stroke::new(1.2, ink));
        painter.circle(pos2(x, drawn.center().y), 5.0, palette.panel, Stroke::new(2.0, ink));
        painter.text(pos2(x + aside, area.top()), aligned, show_place(place_m), font.clone(), ink);
    }
    let stood: String = (0..sensor).map(|i| format!("; it stood at {}", show_place(place_m(i)))).collect();
    let place = show_place(place_m(sensor));
    let name = format!("The sensor's place: {place} from the driven end, on the centre line{stood}");
    theme::describe(&response, &name, HELP);
}
