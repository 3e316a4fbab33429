//! A page measured in points (1/72 inch) that takes lines, text and images and becomes a [`Drawing`].

use super::drawing::Drawing;
use super::font;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write as _;
use svg::Document;
use svg::node::element::{ClipPath, Element, Group, Image, Path, Rectangle, Title};
use svg::node::{Node, Text};

/// Red, green and blue in sRGB, 0 to 255 each.
pub(super) type Ink = [u8; 3];

pub(super) const BLACK: Ink = [0, 0, 0];
pub(super) const WHITE: Ink = [255, 255, 255];
/// The grid lines.
pub(super) const GRID: Ink = [225, 225, 225];
/// Colours that colour-blind readers can distinguish (Okabe and Ito), then violet and grey.
pub(super) const HUES: [Ink; 6] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 60, 160], [90, 90, 90]];

/// From the middle of a line of text down to its base line, as a multiple of the text size: half the height of a
/// capital letter.
const BASE: f64 = 0.346;

/// A place on the page: points from the left and from the top.
pub(super) type Place = (f64, f64);

/// The point of a text that lies at the given place.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    /// The middle of its left end.
    Left,
    /// The middle of its right end.
    Right,
    /// Its middle.
    Centre,
}

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pen {
    ink: Ink,
    width: f64,
    /// Lengths of a dash and of the gap after it, in points; `None` for a solid line.
    dash: Option<(f64, f64)>,
}

impl Pen {
    /// A solid pen of this width in points.
    pub(super) const fn solid(ink: Ink, width: f64) -> Self {
        Self { ink, width, dash: None }
    }

    /// A dashed pen of this width in points; `dash` is the length of a dash and of the gap after it, in points.
    pub(super) const fn dashed(ink: Ink, width: f64, dash: (f64, f64)) -> Self {
        Self { ink, width, dash: Some(dash) }
    }

    /// Whether it draws dashes.
    pub(super) const fn is_dashed(self) -> bool {
        self.dash.is_some()
    }
}

/// A page that is being drawn on.
pub(super) struct Page {
    size: Place,
    title: String,
    elements: Vec<Box<dyn Node>>,
    /// Number of clip paths so far: each needs its own name.
    clips: usize,
}

impl Page {
    /// A white page of this width and height in points; a viewer shows the title.
    pub(super) fn new(size: Place, title: &str) -> Self {
        let mut page = Self { size, title: printable(title), elements: Vec::new(), clips: 0 };
        page.fill((0.0, 0.0), size, WHITE);
        page
    }

    /// Draws one line of text.
    pub(super) fn text(&mut self, text: &str, (x, y): Place, anchor: Anchor, size: f64, ink: Ink) {
        let mut element = words(text, anchor, size, ink);
        element.assign("x", number(x));
        element.assign("y", number(y + BASE * size));
        self.elements.push(element.into());
    }

    /// Draws a text that reads upwards, centred on the place.
    pub(super) fn upward(&mut self, text: &str, (x, y): Place, size: f64) {
        let place = format!("translate({} {}) rotate(-90)", number(x + BASE * size), number(y));
        let mut element = words(text, Anchor::Centre, size, BLACK);
        element.assign("transform", place);
        self.elements.push(element.into());
    }

    /// Draws a line through these places.
    pub(super) fn line(&mut self, places: impl IntoIterator<Item = Place>, pen: Pen) {
        let path = Path::new().set("d", outline(places)).set("fill", "none");
        self.elements.push(stroked(path, pen).into());
    }

    /// Fills the polygon with these corners.
    pub(super) fn area(&mut self, corners: impl IntoIterator<Item = Place>, ink: Ink) {
        let outline = outline(corners) + "Z";
        self.elements.push(Path::new().set("d", outline).set("fill", hex(ink)).into());
    }

    /// Fills a rectangle.
    pub(super) fn fill(&mut self, from: Place, to: Place, ink: Ink) {
        self.elements.push(framed(Rectangle::new(), from, to).set("fill", hex(ink)).into());
    }

    /// Draws a small ring.
    pub(super) fn ring(&mut self, (x, y): Place, radius: f64, pen: Pen) {
        let ring = Path::new().set("d", circle(x, y, radius)).set("fill", "none");
        self.elements.push(stroked(ring, pen).into());
    }

    /// Draws a dot.
    pub(super) fn dot(&mut self, (x, y): Place, radius: f64, ink: Ink) {
        self.elements.push(Path::new().set("d", circle(x, y, radius)).set("fill", hex(ink)).into());
    }

    /// Draws a PNG image, stretched to fill the rectangle.
    pub(super) fn picture(&mut self, png: &[u8], from: Place, to: Place) {
        let link = format!("data:image/png;base64,{}", STANDARD.encode(png));
        let image = framed(Image::new(), from, to).set("preserveAspectRatio", "none").set("href", link);
        self.elements.push(image.into());
    }

    /// Draws, clipped to the polygon with these corners.
    pub(super) fn clipped(&mut self, corners: impl IntoIterator<Item = Place>, draw: impl FnOnce(&mut Self)) {
        self.clips += 1;
        let name = format!("clip{}", self.clips);
        let path = Path::new().set("d", outline(corners) + "Z");
        self.elements.push(ClipPath::new().set("id", name.as_str()).add(path).into());
        let around = std::mem::take(&mut self.elements);
        draw(self);
        let inside = std::mem::replace(&mut self.elements, around);
        let group = Group::new().set("clip-path", format!("url(#{name})"));
        self.elements.push(inside.into_iter().fold(group, Group::add).into());
    }

    /// The finished drawing, to be rendered at this many dots per inch.
    pub(super) fn finish(self, dots_per_inch: f64) -> Drawing {
        let (width, height) = (number(self.size.0), number(self.size.1));
        let document = Document::new()
            .set("width", format!("{width}pt"))
            .set("height", format!("{height}pt"))
            .set("viewBox", format!("0 0 {width} {height}"))
            .set("font-family", font::FAMILIES)
            .set("font-weight", font::WEIGHT)
            .add(Title::new(self.title));
        let document = self.elements.into_iter().fold(document, Document::add);
        Drawing::new(format!("{document}\n"), dots_per_inch)
    }
}

/// The parts of a text element that do not depend on its place.
fn words(text: &str, anchor: Anchor, size: f64, ink: Ink) -> Element {
    let text = printable(text);
    let side = match anchor {
        Anchor::Left => "start",
        Anchor::Right => "end",
        Anchor::Centre => "middle",
    };
    // A viewer with another font stretches the text to this width, so that no text runs over its neighbour.
    let length = number(font::width(&text, size));
    let mut element = Element::new("text");
    let mut set = |name: &str, value: &str| element.assign(name, value);
    set("xml:space", "preserve");
    set("text-anchor", side);
    set("font-size", &number(size));
    set("fill", &hex(ink));
    set("textLength", &length);
    set("lengthAdjust", "spacingAndGlyphs");
    element.append(Text::new(text));
    element
}

/// The text without the characters that XML does not allow, and on one line.
fn printable(text: &str) -> String {
    let allowed = |letter: char| {
        let is_refused = letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}');
        if is_refused { char::REPLACEMENT_CHARACTER } else { letter }
    };
    text.chars().map(allowed).collect()
}

fn stroked(path: Path, pen: Pen) -> Path {
    let path = path.set("stroke", hex(pen.ink)).set("stroke-width", number(pen.width));
    let path = path.set("stroke-linejoin", "round");
    match pen.dash {
        Some((dash, gap)) => path.set("stroke-dasharray", format!("{} {}", number(dash), number(gap))),
        None => path,
    }
}

/// An element between two corners.
fn framed<Shape: Node>(mut shape: Shape, from: Place, to: Place) -> Shape {
    let mut set = |name: &str, value: f64| shape.assign(name, number(value));
    set("x", from.0.min(to.0));
    set("y", from.1.min(to.1));
    set("width", (to.0 - from.0).abs());
    set("height", (to.1 - from.1).abs());
    shape
}

/// A path through these places.
fn outline(places: impl IntoIterator<Item = Place>) -> String {
    let mut path = String::new();
    for (x, y) in places {
        let command = if path.is_empty() { 'M' } else { 'L' };
        let _ = write!(path, "{command}{} {}", number(x), number(y));
    }
    path
}

/// A path around a circle.
fn circle(x: f64, y: f64, radius: f64) -> String {
    let (left, radius, across) = (number(x - radius), number(radius), number(2.0 * radius));
    format!("M{left} {}a{radius} {radius} 0 1 0 {across} 0a{radius} {radius} 0 1 0 -{across} 0Z", number(y))
}

fn hex([red, green, blue]: Ink) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// A length in points as written in the file: 0.01 point is 3.5 micrometres, finer than any printer.
fn number(points: f64) -> String {
    let text = format!("{points:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}
