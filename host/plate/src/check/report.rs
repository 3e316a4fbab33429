//! What is told of a plate: lights, each with its number, its colour and a sentence.

use serde::{Serialize, Serializer};

/// Colour of a light, from the calmest to the worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Colour {
    /// What it takes to judge is not known; no reason to worry, and none not to.
    Unchecked,
    /// Nothing to mind.
    Green,
    /// It works, with the reservation the sentence names.
    Amber,
    /// Do not rely on it.
    Red,
}

impl Colour {
    /// Its word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unchecked => "unchecked",
            Self::Green => "green",
            Self::Amber => "amber",
            Self::Red => "red",
        }
    }
}

impl Serialize for Colour {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// One validity light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Light {
    /// What is looked at; the same words for every plate.
    pub name: &'static str,
    /// The number behind the light; `None` where there is none (no ghost boundary, no second tone).
    pub value: Option<f64>,
    /// Unit of `value`; empty for a plain number.
    pub unit: &'static str,
    /// The verdict.
    pub colour: Colour,
    /// One sentence that says what it means here.
    pub sentence: String,
    /// The boundary this was found at, metres: over the span, the one where it is worst.
    pub boundary_m: f64,
}

/// All lights of a plate at one boundary or over its span.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Name of the plate.
    pub plate: String,
    /// The boundary, metres; `None` over the span.
    pub boundary_m: Option<f64>,
    /// The frequencies that were looked at, Hz: the lowest and the highest.
    pub frequency_hz: (f64, f64),
    /// The lights, always in the same order.
    pub lights: Vec<Light>,
}

impl Report {
    /// The worst colour of all lights that could be judged.
    pub fn worst(&self) -> Colour {
        self.lights.iter().map(|light| light.colour).max().unwrap_or(Colour::Green)
    }

    /// The light of that name.
    pub fn light(&self, name: &str) -> Option<&Light> {
        self.lights.iter().find(|light| light.name == name)
    }
}
