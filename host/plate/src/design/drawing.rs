//! A drawing in millimetres: lines to cut, dimensions and notes to read. x points right from the driven end, z up.

/// The purpose of a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// A line to cut.
    Cut,
    /// A dimension line or text to read.
    Dimension,
}

impl Layer {
    /// Name of the layer in DXF files; lower case in SVG files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cut => "CUT",
            Self::Dimension => "DIMENSION",
        }
    }
}

/// A shape of a drawing; all numbers in millimetres.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A closed outline.
    Outline {
        /// Corners in order; the last is joined to the first.
        points: Vec<[f64; 2]>,
    },
    /// A round hole.
    Hole {
        /// Centre.
        centre: [f64; 2],
        /// Diameter.
        diameter: f64,
    },
    /// A dimension line with ticks at both ends and its text beside it.
    Dimension {
        /// One end.
        from: [f64; 2],
        /// The other end, to the right of `from` or above it.
        to: [f64; 2],
        /// The text.
        text: String,
    },
    /// A line of text.
    Note {
        /// Left end of the text's base line.
        at: [f64; 2],
        /// The text.
        text: String,
    },
}

impl Shape {
    /// The layer the shape belongs to.
    pub fn layer(&self) -> Layer {
        match self {
            Self::Outline { .. } | Self::Hole { .. } => Layer::Cut,
            Self::Dimension { .. } | Self::Note { .. } => Layer::Dimension,
        }
    }
}

/// A drawing of one part.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Name of the part.
    pub title: String,
    /// The shapes; the outer outline comes first.
    pub shapes: Vec<Shape>,
}

/// Height of the dimension text, mm.
pub(super) const TEXT_HEIGHT_MM: f64 = 4.0;
/// Width of a letter over its height: slightly above the average of common typefaces.
const LETTER_WIDTH: f64 = 0.6;
/// Largest number of letters in a line of a note.
const NOTE_LETTERS: usize = 70;
/// Half the length of the tick at a dimension line's end, mm.
pub(super) const TICK_MM: f64 = 1.5;

impl Drawing {
    /// Extents of the layer that is cut, mm: `[x_min, z_min, x_max, z_max]`.
    pub(crate) fn cut_extents_mm(&self) -> [f64; 4] {
        let mut extents = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for shape in &self.shapes {
            match shape {
                Shape::Outline { points } => points.iter().for_each(|&point| grow(&mut extents, point, 0.0)),
                Shape::Hole { centre, diameter } => grow(&mut extents, *centre, 0.5 * diameter),
                Shape::Dimension { .. } | Shape::Note { .. } => {}
            }
        }
        extents
    }

    /// Extents of all shapes, mm, with room for the texts.
    pub(super) fn extents_mm(&self) -> [f64; 4] {
        let mut extents = self.cut_extents_mm();
        for shape in &self.shapes {
            match shape {
                Shape::Dimension { from, to, .. } => {
                    grow(&mut extents, *from, 2.5 * TEXT_HEIGHT_MM);
                    grow(&mut extents, *to, 2.5 * TEXT_HEIGHT_MM);
                }
                Shape::Note { at: [x, z], text } => {
                    grow(&mut extents, [*x, *z], TEXT_HEIGHT_MM);
                    let end = x + LETTER_WIDTH * TEXT_HEIGHT_MM * text.chars().count() as f64;
                    grow(&mut extents, [end, *z], TEXT_HEIGHT_MM);
                }
                Shape::Outline { .. } | Shape::Hole { .. } => {}
            }
        }
        extents
    }
}

fn grow(extents: &mut [f64; 4], [x, z]: [f64; 2], radius: f64) {
    extents[0] = extents[0].min(x - radius);
    extents[1] = extents[1].min(z - radius);
    extents[2] = extents[2].max(x + radius);
    extents[3] = extents[3].max(z + radius);
}

/// A note broken into lines between words.
pub(super) fn wrapped(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.len() + 1 + word.len() <= NOTE_LETTERS => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The middle of a dimension's text, and whether the text runs upward.
pub(super) fn text_place(from: [f64; 2], to: [f64; 2]) -> ([f64; 2], bool) {
    let upward = (to[1] - from[1]).abs() > (to[0] - from[0]).abs();
    let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
    let gap = 0.4 * TEXT_HEIGHT_MM;
    if upward { ([middle[0] - gap, middle[1]], true) } else { ([middle[0], middle[1] + gap], false) }
}

/// The line and the two ticks of a dimension.
pub(super) fn strokes(from: [f64; 2], to: [f64; 2]) -> [[[f64; 2]; 2]; 3] {
    let tick = |[x, z]: [f64; 2]| [[x - TICK_MM, z - TICK_MM], [x + TICK_MM, z + TICK_MM]];
    [[from, to], tick(from), tick(to)]
}
