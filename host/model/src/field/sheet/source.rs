//! Source of the drawn wave: the sheet if its cost allows, else the modal lines.

use super::grid;
use serde::{Deserialize, Serialize};
use slipline_plate::{Plate, SheetError};

/// Largest number of cell updates per second of plate time for which the sheet is chosen automatically: one
/// processor core settles it within moments and runs it faster than the slow motion needs.
const BUDGET: f64 = 5e8;
/// Largest number of cell updates per second of plate time for which the user can choose the sheet: it
/// settles within some tens of seconds on one core.
const BUDGET_ON_REQUEST: f64 = 5e10;

/// The user's choice of the source from which the wave is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SourceChoice {
    /// The 2-D sheet where it runs in real time, else the modal lines.
    #[default]
    Automatic,
    /// The modal lines.
    Lines,
    /// The 2-D sheet wherever it is possible at all.
    Sheet,
}

impl SourceChoice {
    /// Every choice, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Automatic, Self::Lines, Self::Sheet];

    /// Its name in the menu.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Automatic => "Wave: automatic",
            Self::Lines => "Wave: modal lines",
            Self::Sheet => "Wave: 2-D where possible",
        }
    }

    /// Its description in a sentence.
    #[must_use]
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::Automatic => "The 2-D sheet where it runs fast enough, else the modal lines",
            Self::Lines => "The first width mode along the plate: exact where one mode is enough, and quick",
            Self::Sheet => "The wave equation on the whole sheet, in time, even where that is slow",
        }
    }
}

/// The source from which the wave is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum FieldSource {
    /// The wave equation on the whole sheet, in time.
    Sheet,
    /// The first width mode along the plate, with the reason why it is not the sheet if the user chose the sheet.
    Lines(Option<String>),
}

/// The source for this plate at this sample rate in Hz. It depends only on the arguments, not on the machine.
/// A plate that has no sheet at this rate gets the lines for every choice.
#[must_use]
pub fn source(plate: &Plate, sample_rate_hz: f64, wish: SourceChoice) -> FieldSource {
    let (budget, is_wished) = match wish {
        SourceChoice::Lines => return FieldSource::Lines(None),
        SourceChoice::Automatic => (BUDGET, false),
        SourceChoice::Sheet => (BUDGET_ON_REQUEST, true),
    };
    let reason = match grid(plate).cost(plate, sample_rate_hz) {
        Ok(cost) if cost.updates_per_second() <= budget => return FieldSource::Sheet,
        Ok(cost) => {
            format!("the sheet would take {:.0e} cell updates a second", cost.updates_per_second())
        }
        Err(SheetError::Bends { .. }) => "a plate in bending is no stretched sheet".to_owned(),
        Err(error) => error.to_string(),
    };
    FieldSource::Lines(is_wished.then_some(reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_plates_get_the_sheet_and_stiff_ones_the_lines() {
        let of = |name: &str, wish| source(&slipline_plate::preset(name).unwrap(), 400e3, wish);
        for name in ["latex-membrane", "membrane", "paper-rubber"] {
            assert_eq!(of(name, SourceChoice::Automatic), FieldSource::Sheet, "{name}");
            assert_eq!(of(name, SourceChoice::Lines), FieldSource::Lines(None), "{name}");
        }
        for name in ["al-bending", "al-sh"] {
            assert_eq!(of(name, SourceChoice::Automatic), FieldSource::Lines(None), "{name}");
        }
        assert_eq!(of("al-sh", SourceChoice::Sheet), FieldSource::Sheet);
        let FieldSource::Lines(Some(reason)) = of("al-bending", SourceChoice::Sheet) else {
            panic!("it bends")
        };
        assert!(reason.contains("bending"), "{reason}");
    }
}
