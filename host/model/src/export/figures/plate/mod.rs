//! The plate on the screen as a figure for print: its outline with the wave, under it the envelope, through both the
//! boundaries, over one x axis; 170 mm wide.

mod field;
mod layout;

use super::PRINT_DOTS_PER_INCH;
use super::axes::Axes;
use super::drawing::{DrawError, Drawing, Format};
use super::font;
use super::legend::{Sample, legend, row_height};
use super::page::{Anchor, BLACK, HUES, Ink, Page, Pen, Place};
use super::plot::{TEXT, TITLE};
use crate::field::rings::Rings;
use crate::field::sheet::Frame;
use crate::field::steady_field::{POINTS, SteadyField, displacement_unit, envelope_top_m, full_colour_m};
use crate::jobs::Task;
use crate::setup::{BoundaryMode, Setup};
use layout::Layout;
use slipline_plate::order;
use slipline_plate::quantity::{show_frequency, show_length, show_place};

const WEAK: Ink = HUES[5];
/// The fill under the predicted envelope.
const AREA: Ink = [214, 229, 240];
const PREDICTED: Pen = Pen::solid(HUES[0], 1.2);
const NOT_DRIVEN: Pen = Pen::dashed(HUES[0], 1.2, (4.0, 3.0));
const BOUND: Pen = Pen::dashed(WEAK, 0.8, (2.0, 2.0));
const FELT: Pen = Pen::dashed(HUES[3], 0.8, (4.0, 3.0));
const SIMULATED: Pen = Pen::solid(HUES[1], 0.6);
const BOUNDARY: Pen = Pen::solid(BLACK, 0.9);
/// Radius of a ring of the simulated plate.
const RING: f64 = 1.4;

/// The state of the screen that a figure shows.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The plate and its tones.
    pub setup: Setup,
    /// The plate under the tones of the setup, predicted.
    pub predicted: SteadyField,
    /// The plate under the tones that sound; `None` at rest.
    pub sounding: Option<SteadyField>,
    /// The sheet, if the wave is taken from it.
    pub sheet: Option<Frame>,
    /// The envelope of the simulated plate.
    pub measured: Option<Rings<'static>>,
    /// The table's peak at level 1, in metres.
    pub full_peak_m: f64,
    /// The factor by which the screen shows displacements larger than to the table's full scale; 1 where it does not.
    pub magnification: f64,
    /// Whether the plate is coloured by its largest displacement, not by the present one.
    pub is_largest: bool,
    /// Seconds of slow motion so far.
    pub wave_time_s: f64,
}

/// A figure to draw.
#[derive(Clone, Debug)]
pub struct FigureJob {
    /// The state of the screen.
    pub subject: Subject,
    /// The format of the file.
    pub format: Format,
}

/// A figure's file.
#[derive(Clone, Debug)]
pub struct File {
    /// Its format.
    pub format: Format,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// The work of the figure thread: the file, or the reason why there is none. `None` if the task was cancelled
/// before.
#[must_use]
pub fn work(job: &FigureJob, task: &Task) -> Option<Result<File, DrawError>> {
    if task.is_over() {
        return None;
    }
    let bytes = plate_figure(&job.subject).and_then(|drawing| drawing.file(job.format));
    Some(bytes.map(|bytes| File { format: job.format, bytes }))
}

/// Draws the state of the screen.
///
/// # Errors
/// [`DrawError`] when the plate's colours cannot be encoded.
pub fn plate_figure(subject: &Subject) -> Result<Drawing, DrawError> {
    let layout = &Layout::new(subject);
    let mut page = Page::new(layout.size(), subject.setup.plate.name());
    let mut figure = Figure { subject, layout, page: &mut page };
    figure.heading()?;
    figure.plate()?;
    figure.envelope();
    figure.boundaries();
    figure.legend();
    figure.caption();
    Ok(page.finish(PRINT_DOTS_PER_INCH))
}

impl Subject {
    fn full_colour_m(&self) -> f64 {
        full_colour_m(self.sounding.as_ref(), self.full_peak_m) / self.magnification
    }

    /// The amplitude from which the first tone is felt, if the lines hold felt edges.
    fn just_felt_m(&self) -> Option<f64> {
        let tone = self.setup.tones.first().filter(|_| self.setup.boundary == BoundaryMode::FeltEdge)?;
        let frequency_hz = self.setup.plate.frequency_for_boundary_hz(tone.position_m);
        Some(self.setup.feeling.just_felt_m(frequency_hz))
    }
}

/// A figure being drawn.
struct Figure<'a> {
    subject: &'a Subject,
    layout: &'a Layout,
    page: &'a mut Page,
}

impl Figure<'_> {
    fn text(&mut self, text: &str, place: Place, anchor: Anchor, ink: Ink) {
        self.page.text(text, place, anchor, TEXT, ink);
    }

    /// The plate's name, the meaning of its colours, and their scale.
    fn heading(&mut self) -> Result<(), DrawError> {
        let (subject, layout) = (self.subject, self.layout);
        let (left, y) = (layout.left, layout.colours);
        self.page.text(subject.setup.plate.name(), (left, layout.title), Anchor::Left, TITLE, BLACK);
        if subject.sounding.is_none() {
            self.text("at rest", (left, y), Anchor::Left, WEAK);
            return Ok(());
        }
        let what = if subject.is_largest { "largest displacement" } else { "displacement at one moment" };
        self.text(what, (left, y), Anchor::Left, BLACK);
        let full = show_length(subject.full_colour_m());
        let (low, high) = if subject.is_largest {
            ("0".to_owned(), full)
        } else {
            (format!("−{full}"), format!("+{full}"))
        };
        let right = layout.right - font::width(&high, TEXT) - 4.0;
        let bar = (right - 90.0, right);
        field::draw_scale(self.page, subject, (bar.0, y - 3.0), (bar.1, y + 3.0))?;
        self.text(&low, (bar.0 - 4.0, y), Anchor::Right, BLACK);
        self.text(&high, (layout.right, y), Anchor::Right, BLACK);
        Ok(())
    }

    /// The plate from above with its wave.
    fn plate(&mut self) -> Result<(), DrawError> {
        let (plate, layout) = (&self.subject.setup.plate, self.layout);
        field::draw_field(self.page, self.subject, layout)?;
        // Both edges and the narrow end between them.
        let edges = layout.edge(plate, -1.0).chain(layout.edge(plate, 1.0).rev());
        self.page.line(edges, Pen::solid(BLACK, 0.9));
        // The driven end is a thick bar: this is where the actuator holds the plate.
        let start = layout.half_width(plate.half_width_m(0.0));
        let bar = (layout.left - 4.0, layout.left - 0.5);
        self.page.fill((bar.0, layout.centre - start), (bar.1, layout.centre + start), WEAK);
        self.text("drive", (layout.left - 8.0, layout.centre), Anchor::Right, BLACK);
        let scale = if layout.is_to_scale { "to scale" } else { "width not to scale" };
        self.text(scale, (layout.right, layout.plate.1 - 4.0), Anchor::Right, WEAK);
        Ok(())
    }

    /// The envelope: the largest displacement at each x.
    fn envelope(&mut self) {
        let (subject, layout) = (self.subject, self.layout);
        let predicted = &subject.predicted;
        let top_m = envelope_top_m(predicted, subject.full_peak_m) / subject.magnification;
        let (unit, unit_m) = displacement_unit(top_m);
        let axes = Axes {
            across: (layout.left, layout.right),
            down: layout.envelope,
            x: (0.0, layout.length_m * 1e3),
            y: (0.0, top_m / unit_m),
            text: TEXT,
        };
        let at = |(x_m, metres): Place| axes.at((x_m * 1e3, metres / unit_m));
        let x_m = |i: usize| predicted.length_m * i as f64 / (POINTS - 1) as f64;
        let curve = |values: &[f64]| -> Vec<Place> {
            values.iter().enumerate().map(|(i, &metres)| at((x_m(i), metres))).collect()
        };
        let drawn = curve(&predicted.drawn_m());
        let below = [at((predicted.length_m, 0.0)), at((0.0, 0.0))];
        axes.inside(self.page, |page| page.area(drawn.iter().copied().chain(below), AREA));
        axes.grid(self.page);
        axes.inside(self.page, |page| {
            page.line(drawn, if subject.sounding.is_some() { PREDICTED } else { NOT_DRIVEN });
            if predicted.is_mean() {
                page.line(curve(&predicted.bound_m), BOUND);
            }
            if let Some(just_felt_m) = subject.just_felt_m().filter(|&just_felt_m| just_felt_m < top_m) {
                page.line([at((0.0, just_felt_m)), at((layout.length_m, just_felt_m))], FELT);
            }
            for point in subject.measured.iter().flat_map(|rings| rings.field.points()) {
                page.ring(at(point), RING, SIMULATED);
            }
        });
        axes.frame(self.page, "x from the driven end (mm)", &format!("displacement ({unit})"));
    }

    /// A line through plate and envelope for every tone, labelled with its number, or with its values if there is
    /// only one tone.
    fn boundaries(&mut self) {
        let (subject, layout) = (self.subject, self.layout);
        let setup = &subject.setup;
        let mut marks: Vec<(f64, String)> = Vec::new();
        for (tone, line) in setup.tones.iter().zip(&layout.lines) {
            let shown_m = line.place_m;
            let x = layout.x(shown_m);
            self.page.line([(x, layout.plate.0), (x, layout.envelope.1)], BOUNDARY);
            let text = if setup.tones.len() > 1 {
                (tone.slot + 1).to_string()
            } else {
                let hertz = setup.plate.frequency_for_boundary_hz(tone.position_m);
                format!("{}, {}", show_place(shown_m), show_frequency(hertz))
            };
            marks.push((x, text));
        }
        order::sort_by(&mut marks, |a, b| a.0.total_cmp(&b.0));
        // A number that would overlap the one before is moved above it.
        let mut taken = [f64::NEG_INFINITY; 2];
        for (x, text) in marks {
            let half = 0.5 * font::width(&text, TEXT);
            let middle = x.clamp(layout.left + half, (layout.right - half).max(layout.left + half));
            let level = usize::from(taken[0] > middle - half);
            taken[level] = middle + half + 2.0;
            let y = layout.plate.0 - 6.0 - 8.0 * level as f64;
            self.text(&text, (middle, y), Anchor::Centre, BLACK);
        }
    }

    /// The legend.
    fn legend(&mut self) {
        let (subject, layout) = (self.subject, self.layout);
        let is_mean = subject.predicted.is_mean();
        let what = if is_mean { "mean of all tones, predicted" } else { "predicted" };
        let mut entries = vec![match subject.sounding {
            Some(_) => (what.to_owned(), Sample::Line(PREDICTED)),
            None => (format!("{what}, not driven"), Sample::Line(NOT_DRIVEN)),
        }];
        let mut entry = |name: &str, sample| entries.push((name.to_owned(), sample));
        if is_mean {
            entry("bound of the largest", Sample::Line(BOUND));
        }
        if let Some(rings) = &subject.measured {
            entry(rings.name(), Sample::Ring(SIMULATED, RING));
        }
        if subject.just_felt_m().is_some() {
            entry("just felt", Sample::Line(FELT));
        }
        entry("boundary", Sample::Upright(BOUNDARY));
        legend(self.page, &entries, (layout.left, layout.legend), layout.right - layout.left, TEXT);
    }

    /// The caption with the values of the tones.
    fn caption(&mut self) {
        let layout = self.layout;
        for (i, line) in layout.caption.iter().enumerate() {
            let y = layout.legend + (i as f64 + 1.0) * row_height(TEXT) + 2.0;
            self.text(line, (layout.left, y), Anchor::Left, BLACK);
        }
    }
}

#[cfg(all(test, feature = "painted"))]
mod tests;
