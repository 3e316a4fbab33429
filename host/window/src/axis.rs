//! The one x axis that plate, envelope and strip share.

use eframe::egui::{Rangef, Rect};
use slipline_plate::quantity::ticks::Ticks;

/// The transform between places on the plate and points on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    left: f32,
    points_per_m: f32,
    length_m: f64,
    pixels_per_point: f32,
}

impl Axis {
    /// The axis of a plate of this length over this range of screen points, its ends on whole pixels.
    #[must_use]
    pub fn new(length_m: f64, screen: Rangef, pixels_per_point: f32) -> Self {
        let left = (screen.min * pixels_per_point).round() / pixels_per_point;
        let right = (screen.max * pixels_per_point).round() / pixels_per_point;
        Self { left, points_per_m: (right - left).max(1.0) / length_m as f32, length_m, pixels_per_point }
    }

    /// The screen position of a place.
    #[must_use]
    pub fn screen_from_place(&self, x_m: f64) -> f32 {
        self.left + x_m as f32 * self.points_per_m
    }

    /// The screen position of a place, rounded to the middle of a pixel: for lines that must meet across views.
    #[must_use]
    pub fn line_from_place(&self, x_m: f64) -> f32 {
        ((self.screen_from_place(x_m) * self.pixels_per_point).floor() + 0.5) / self.pixels_per_point
    }

    /// The place under a screen position, in metres; it may lie off the plate.
    #[must_use]
    pub fn place_from_screen(&self, x: f32) -> f64 {
        f64::from((x - self.left) / self.points_per_m)
    }

    /// Size of a pixel in points.
    #[must_use]
    pub fn pixel(&self) -> f32 {
        self.pixels_per_point.recip()
    }

    /// Screen points per metre.
    #[must_use]
    pub fn points_per_m(&self) -> f32 {
        self.points_per_m
    }

    /// The plate's length in metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// The plate's extent on the screen.
    #[must_use]
    pub fn screen(&self) -> Rangef {
        Rangef::new(self.left, self.screen_from_place(self.length_m))
    }

    /// The parts of the plate's extent on the screen that lie before and after a span in metres.
    #[must_use]
    pub fn beyond(&self, (start, end): (f64, f64)) -> [Rangef; 2] {
        let screen = self.screen();
        [
            Rangef::new(screen.min, self.screen_from_place(start)),
            Rangef::new(self.screen_from_place(end), screen.max),
        ]
    }

    /// The part of `rect` over the plate.
    #[must_use]
    pub fn over_plate(&self, rect: Rect) -> Rect {
        Rect::from_x_y_ranges(self.screen(), rect.y_range())
    }

    /// Round places to label, about `spacing` points apart, in millimetres.
    #[must_use]
    pub fn ticks_mm(&self, spacing: f32) -> Ticks {
        Ticks::between(0.0, self.length_m * 1e3, f64::from(spacing / self.points_per_m) * 1e3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_goes_to_the_screen_and_back() {
        for scale in [1.0, 1.5, 2.0] {
            let axis = Axis::new(0.32, Rangef::new(60.3, 901.7), scale);
            for x in [0.0, 0.05, 0.16, 0.32] {
                assert!((axis.place_from_screen(axis.screen_from_place(x)) - x).abs() < 1e-6);
                let pixel = axis.line_from_place(x) * scale - 0.5;
                assert!((pixel - pixel.round()).abs() < 1e-3, "{pixel}");
            }
        }
    }

    #[test]
    fn ticks_are_round_numbers() {
        let ticks = Axis::new(0.32, Rangef::new(0.0, 800.0), 1.0).ticks_mm(90.0);
        assert_eq!(ticks.places, [0.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0]);
    }
}
