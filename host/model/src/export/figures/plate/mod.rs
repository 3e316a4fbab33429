//! The plate on the screen as a figure for print: its outline with the wave, under it the envelope, through both the
//! boundaries, over one x axis; 170 mm wide.

mod page;
mod paper;

use super::draw::{DrawError, HUES};
use crate::colour_map;
use crate::field::displacement_map::{Row, Surface, Wave};
use crate::field::sheet::Frame;
use crate::field::steady_field::{
    POINTS, Picture, displacement_unit, drawn_boundary_m, envelope_top_m, full_colour_m,
};
use crate::field::time_domain::Measured;
use crate::jobs::Task;
use crate::numbers::quantity::{show_frequency, show_length, show_place};
use crate::numbers::ticks::Ticks;
use crate::setup::{BoundaryMode, Setup};
use page::Page;
use paper::{Anchor, CELL, LINE, Paper, Place, TEXT, TITLE};
use plotters::style::{BLACK, RGBColor};

const PREDICTED: RGBColor = HUES[0];
const SIMULATED: RGBColor = HUES[1];
const FELT: RGBColor = HUES[3];
const WEAK: RGBColor = HUES[5];
const GRID: RGBColor = RGBColor(225, 225, 225);
/// Under the predicted envelope.
const AREA: RGBColor = RGBColor(214, 229, 240);

/// What is seen, to be drawn.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The plate and its tones.
    pub setup: Setup,
    /// What the setup would do.
    pub predicted: Picture,
    /// What sounds; `None` at rest.
    pub sounding: Option<Picture>,
    /// The sheet, if the wave is taken from it.
    pub sheet: Option<Frame>,
    /// What the simulated plate did.
    pub measured: Option<Measured>,
    /// The table's peak at level 1, in metres.
    pub full_peak_m: f64,
    /// Whether the plate is coloured by its largest displacement, not by the present one.
    pub is_largest: bool,
    /// Seconds of slow motion so far.
    pub wave_time_s: f64,
}

/// The work of the thread that draws: the PNG file, or a sentence that says why there is none. `None` when the task
/// was over before.
#[must_use]
pub fn work(subject: &Subject, task: &Task) -> Option<Result<Vec<u8>, String>> {
    if task.is_over() { None } else { Some(png(subject).map_err(|error| error.to_string())) }
}

/// The figure as a PNG file of 300 dots per inch.
///
/// # Errors
/// [`DrawError`] when the font, the canvas or the encoder refuses.
pub fn png(subject: &Subject) -> Result<Vec<u8>, DrawError> {
    let page = Page::new(subject)?;
    paper::print(page.size(), |paper| {
        let figure = Figure { subject, page: &page, paper };
        figure.heading()?;
        figure.plate()?;
        figure.envelope()?;
        figure.boundaries()?;
        figure.legend()?;
        figure.caption()
    })
}

impl Subject {
    fn full_colour_m(&self) -> f64 {
        full_colour_m(self.sounding.as_ref(), self.full_peak_m)
    }
}

/// A figure being drawn.
struct Figure<'a, 'b> {
    subject: &'a Subject,
    page: &'a Page,
    paper: &'a Paper<'b>,
}

impl Figure<'_, '_> {
    /// The plate's name, what its colours are, and their scale.
    fn heading(&self) -> Result<(), DrawError> {
        let (page, paper) = (self.page, self.paper);
        paper.text(self.subject.setup.plate.name(), (page.left, page.title), Anchor::Left, TITLE, BLACK)?;
        let Some(_) = &self.subject.sounding else {
            return paper.text("at rest", (page.left, page.colours), Anchor::Left, TEXT, WEAK);
        };
        let what =
            if self.subject.is_largest { "largest displacement" } else { "displacement at one moment" };
        paper.text(what, (page.left, page.colours), Anchor::Left, TEXT, BLACK)?;
        let full = show_length(self.subject.full_colour_m());
        let (low, high) = if self.subject.is_largest {
            ("0".to_owned(), full)
        } else {
            (format!("−{full}"), format!("+{full}"))
        };
        let right = page.right - paper::text_width(&high, TEXT)? - 4.0;
        let bar = (right - 90.0, right);
        let cells = ((bar.1 - bar.0) / CELL) as usize;
        for i in 0..cells {
            let x = bar.0 + i as f64 * CELL;
            let share = (i as f64 + 0.5) / cells as f64;
            let value = if self.subject.is_largest { share } else { 2.0 * share - 1.0 };
            paper.fill((x, page.colours - 3.0), (x + CELL, page.colours + 3.0), self.colour(value))?;
        }
        paper.text(&low, (bar.0 - 4.0, page.colours), Anchor::Right, TEXT, BLACK)?;
        paper.text(&high, (page.right, page.colours), Anchor::Right, TEXT, BLACK)
    }

    /// The colour of a displacement, of full colour.
    fn colour(&self, value: f64) -> RGBColor {
        let [red, green, blue] = if self.subject.is_largest {
            colour_map::sequential(value.abs() as f32, false)
        } else {
            colour_map::diverging(value as f32, false)
        };
        RGBColor(red, green, blue)
    }

    /// The plate from above with its wave.
    fn plate(&self) -> Result<(), DrawError> {
        let (subject, page, paper) = (self.subject, self.page, self.paper);
        let plate = &subject.setup.plate;
        let surface = Surface::new(Wave {
            plate,
            sounding: subject.sounding.as_ref(),
            sheet: subject.sheet.as_ref(),
            is_largest: subject.is_largest,
            time_s: subject.wave_time_s,
        });
        let full_m = subject.full_colour_m();
        let half_rows = (page.half_width(plate.half_width_m(0.0)) / CELL).ceil().max(1.0) as i32;
        let rows: Vec<Row> =
            (-half_rows..=half_rows).map(|row| surface.row(f64::from(row) / f64::from(half_rows))).collect();
        let columns = ((page.right - page.left) / CELL).ceil() as usize;
        let place_m = |column: usize| plate.length_m() * column as f64 / columns as f64;
        for column in 0..columns {
            let x_m = place_m(column);
            let across = surface.column(x_m);
            let (x, half) = (page.x(x_m), page.half_width(across.half_width_m));
            for row in &rows {
                let y = page.centre + row.beta * half;
                let colour = self.colour(surface.at(&across, row) / full_m);
                paper.fill((x, y - 0.5 * CELL), (x + CELL, y + 0.5 * CELL), colour)?;
            }
        }
        for side in [-1.0, 1.0] {
            let edge = (0..=columns).map(|column| {
                let x_m = place_m(column);
                (page.x(x_m), page.centre + side * page.half_width(plate.half_width_m(x_m)))
            });
            paper.line(edge, 0.9, BLACK)?;
        }
        let end = page.half_width(plate.half_width_m(plate.length_m()));
        paper.line([(page.right, page.centre - end), (page.right, page.centre + end)], 0.9, BLACK)?;
        // The driven end is a thick bar: this is where the actuator holds the plate.
        let start = page.half_width(plate.half_width_m(0.0));
        paper.fill((page.left - 4.0, page.centre - start), (page.left - 0.5, page.centre + start), WEAK)?;
        paper.text("drive", (page.left - 8.0, page.centre), Anchor::Right, TEXT, BLACK)?;
        let scale = if page.is_to_scale { "to scale" } else { "width not to scale" };
        paper.text(scale, (page.right, page.plate.1 - 4.0), Anchor::Right, TEXT, WEAK)
    }

    /// How far the plate moves at each x.
    fn envelope(&self) -> Result<(), DrawError> {
        let (subject, page, paper) = (self.subject, self.page, self.paper);
        let predicted = &subject.predicted;
        let top_m = envelope_top_m(predicted, subject.full_peak_m);
        let (low, high) = (page.envelope.1, page.envelope.0);
        let y = |metres: f64| low - (metres / top_m).clamp(0.0, 1.0) * (low - high);
        let x = |i: usize| page.x(predicted.length_m * i as f64 / (POINTS - 1) as f64);
        let line = |values: &[f64]| -> Vec<Place> {
            values.iter().enumerate().map(|(i, &metres)| (x(i), y(metres))).collect()
        };
        let bound = line(&predicted.bound_m);
        for pair in bound.windows(2) {
            if let [from, to] = pair {
                paper.fill((from.0, 0.5 * (from.1 + to.1)), (to.0, low), AREA)?;
            }
        }
        self.scales(top_m, y)?;
        if subject.sounding.is_some() {
            paper.line(bound, 1.2, PREDICTED)?;
        } else {
            paper.dashed(bound, (4.0, 3.0), 1.2, PREDICTED)?;
        }
        if predicted.tones.len() > 1 {
            let rms: Vec<f64> = predicted.rms_m.iter().map(|rms| rms * std::f64::consts::SQRT_2).collect();
            paper.dashed(line(&rms), (2.0, 2.0), 0.8, WEAK)?;
        }
        if let BoundaryMode::FeltEdge { threshold_m } = subject.setup.boundary
            && threshold_m < top_m
        {
            let ends = [(page.left, y(threshold_m)), (page.right, y(threshold_m))];
            paper.dashed(ends, (4.0, 3.0), 0.8, FELT)?;
        }
        for (x_m, metres) in subject.measured.iter().flat_map(Measured::points) {
            paper.ring((page.x(x_m), y(metres)), 1.4, SIMULATED)?;
        }
        Ok(())
    }

    /// Both axes of the envelope: round numbers, units, a frame.
    fn scales(&self, top_m: f64, y: impl Fn(f64) -> f64) -> Result<(), DrawError> {
        let (page, paper) = (self.page, self.paper);
        let (low, high) = (page.envelope.1, page.envelope.0);
        let (unit, unit_m) = displacement_unit(top_m);
        let ticks = Ticks::between(0.0, top_m / unit_m, top_m / unit_m / 6.0);
        for &tick in &ticks.places {
            let y = y(tick * unit_m);
            if tick > 0.0 {
                paper.line([(page.left, y), (page.right, y)], 0.4, GRID)?;
            }
            paper.line([(page.left - 3.0, y), (page.left, y)], 0.6, BLACK)?;
            paper.text(&ticks.label(tick), (page.left - 5.0, y), Anchor::Right, TEXT, BLACK)?;
        }
        paper.upward(&format!("displacement ({unit})"), (14.0, 0.5 * (low + high)))?;
        let length_mm = page.length_m * 1e3;
        let ticks = Ticks::between(0.0, length_mm, length_mm / 9.0);
        for &tick in &ticks.places {
            let x = page.x(tick * 1e-3);
            paper.line([(x, low), (x, low + 3.0)], 0.6, BLACK)?;
            paper.text(&ticks.label(tick), (x, low + 8.0), Anchor::Centre, TEXT, BLACK)?;
        }
        let middle = 0.5 * (page.left + page.right);
        paper.text("x from the driven end (mm)", (middle, low + 19.0), Anchor::Centre, TEXT, BLACK)?;
        let corners = [(page.left, high), (page.right, high), (page.right, low), (page.left, low)];
        paper.line(corners.into_iter().chain([corners[0]]), 0.6, BLACK)
    }

    /// A line through plate and envelope for every tone, with its number; with its figures where there is one tone.
    fn boundaries(&self) -> Result<(), DrawError> {
        let (subject, page, paper) = (self.subject, self.page, self.paper);
        let setup = &subject.setup;
        let mut marks: Vec<(f64, String)> = Vec::new();
        for tone in &setup.tones {
            let shown_m = drawn_boundary_m(setup, tone, Some(subject.full_peak_m));
            let x = page.x(shown_m);
            paper.line([(x, page.plate.0), (x, page.envelope.1)], 0.9, BLACK)?;
            let text = if setup.tones.len() > 1 {
                (tone.slot + 1).to_string()
            } else {
                let hertz = setup.plate.frequency_for_boundary_hz(tone.position_m);
                format!("{}, {}", show_place(shown_m), show_frequency(hertz))
            };
            marks.push((x, text));
        }
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        // A number that would lie on the one before stands over it.
        let mut taken = [f64::NEG_INFINITY; 2];
        for (x, text) in marks {
            let half = 0.5 * paper::text_width(&text, TEXT)?;
            let middle = x.clamp(page.left + half, (page.right - half).max(page.left + half));
            let level = usize::from(taken[0] > middle - half);
            taken[level] = middle + half + 2.0;
            let y = page.plate.0 - 6.0 - 8.0 * level as f64;
            paper.text(&text, (middle, y), Anchor::Centre, TEXT, BLACK)?;
        }
        Ok(())
    }

    /// What the lines are.
    fn legend(&self) -> Result<(), DrawError> {
        let (subject, page, paper) = (self.subject, self.page, self.paper);
        let y = page.legend;
        let mut x = page.left;
        let mut entry = |text: &str, draw: &dyn Fn(f64) -> Result<(), DrawError>| -> Result<(), DrawError> {
            draw(x)?;
            paper.text(text, (x + 20.0, y), Anchor::Left, TEXT, BLACK)?;
            x += 20.0 + paper::text_width(text, TEXT)? + 16.0;
            Ok(())
        };
        let sample = |x: f64| [(x, y), (x + 16.0, y)];
        let is_chord = subject.predicted.tones.len() > 1;
        let what = if is_chord { "largest, predicted" } else { "predicted" };
        if subject.sounding.is_some() {
            entry(what, &|x| paper.line(sample(x), 1.2, PREDICTED))?;
        } else {
            entry(&format!("{what}, not driven"), &|x| paper.dashed(sample(x), (4.0, 3.0), 1.2, PREDICTED))?;
        }
        if is_chord {
            entry("mean of all tones", &|x| paper.dashed(sample(x), (2.0, 2.0), 0.8, WEAK))?;
        }
        if subject.measured.is_some() {
            entry("simulated plate", &|x| paper.ring((x + 8.0, y), 1.4, SIMULATED))?;
        }
        if let BoundaryMode::FeltEdge { .. } = subject.setup.boundary {
            entry("just felt", &|x| paper.dashed(sample(x), (4.0, 3.0), 0.8, FELT))?;
        }
        entry("boundary", &|x| paper.line([(x + 8.0, y - 4.0), (x + 8.0, y + 4.0)], 0.9, BLACK))
    }

    /// The tones in figures.
    fn caption(&self) -> Result<(), DrawError> {
        for (i, line) in self.page.caption.iter().enumerate() {
            let place = (self.page.left, self.page.legend + (i as f64 + 1.0) * LINE + 2.0);
            self.paper.text(line, place, Anchor::Left, TEXT, BLACK)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
