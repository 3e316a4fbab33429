//! The numbers that a study can have of each plate and place, and by which equation.

use slipline_plate::PlateError;
use slipline_plate::quantity::nearest;

/// The equation by which each plate is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// The one-mode equation: some tens of microseconds a tone.
    #[default]
    OneMode,
    /// The plate in two dimensions, [`slipline_plate::plane`]: milliseconds a tone, with air up to a second.
    Plane,
}

impl Kind {
    const ALL: [Self; 2] = [Self::OneMode, Self::Plane];

    /// Its name in a specification.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::OneMode => "1d",
            Self::Plane => "2d",
        }
    }

    pub(super) fn of(name: &str) -> Result<Self, PlateError> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| unknown("kind", name, Self::ALL.map(Self::name)))
    }

    /// The results of a specification that names none.
    pub(super) const fn usual_results(self) -> [StudyResult; 2] {
        match self {
            Self::OneMode => [StudyResult::TurningPointShift, StudyResult::Level],
            Self::Plane => [StudyResult::Level, StudyResult::PeakShift],
        }
    }
}

/// A number of each plate and place. Each is of the place's tone at level 1: by the frequency and the gain of the nominal plate's
/// table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StudyResult {
    /// Turning point less that on the nominal plate, metres; positive is farther from the drive.
    TurningPointShift,
    /// Peak over that on the nominal plate, dB.
    Level,
    /// Place of the peak less that on the nominal plate, metres. NaN where one of the plates has no peak.
    PeakShift,
    /// Where the sensation of a usual finger ends, metres from the driven end. NaN where nothing is felt, or all up to the plate's
    /// end.
    FeltEdge,
    /// Of the nominal plate's solid area up to the place: mean square of the area over that behind its edge, dB, as of
    /// [`slipline_plate::merit::Merit`].
    Contrast,
    /// Of the same area: largest over smallest RMS amplitude in it, dB.
    Ripple,
    /// Peak over the RMS amplitude from the driven end to the turning point, dB. NaN without a peak.
    Crest,
}

impl StudyResult {
    /// All, in the order of their columns.
    pub const ALL: [Self; 7] = [
        Self::TurningPointShift,
        Self::Level,
        Self::PeakShift,
        Self::FeltEdge,
        Self::Contrast,
        Self::Ripple,
        Self::Crest,
    ];

    /// Its name in a specification, a column and a store; it ends in its unit.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::TurningPointShift => "turning_point_shift_m",
            Self::Level => "level_db",
            Self::PeakShift => "peak_shift_m",
            Self::FeltEdge => "felt_edge_m",
            Self::Contrast => "contrast_db",
            Self::Ripple => "ripple_db",
            Self::Crest => "crest_db",
        }
    }

    /// Its unit: metres or dB.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::TurningPointShift | Self::PeakShift | Self::FeltEdge => "m",
            Self::Level | Self::Contrast | Self::Ripple | Self::Crest => "dB",
        }
    }

    /// Its meaning, for a store's `long_name` and the head of a table.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::TurningPointShift => {
                "distance of the turning point from its place on the nominal plate, by the same tone"
            }
            Self::Level => "peak over the nominal plate's peak, by the same tone",
            Self::PeakShift => "distance of the peak from its place on the nominal plate, by the same tone",
            Self::FeltEdge => "end of the sensation of the tone at level 1",
            Self::Contrast => "contrast of the nominal plate's solid area up to the place",
            Self::Ripple => "ripple of the nominal plate's solid area up to the place",
            Self::Crest => "peak over the RMS amplitude from the driven end to the turning point",
        }
    }

    /// Whether this equation has it: the figures of a solid area are of the one-mode equation.
    const fn is_of(self, kind: Kind) -> bool {
        !matches!((kind, self), (Kind::Plane, Self::Contrast | Self::Ripple))
    }

    /// The results of these names, each once and in the order of their columns.
    pub(super) fn read(names: &[String], kind: Kind) -> Result<Vec<Self>, PlateError> {
        let known: Vec<Self> = Self::ALL.into_iter().filter(|it| it.is_of(kind)).collect();
        let of = |(number, name): (usize, &String)| {
            let found = known.iter().copied().find(|it| it.name() == name);
            found
                .ok_or_else(|| unknown(&format!("results[{number}]"), name, known.iter().map(|it| it.name())))
        };
        let mut read: Vec<Self> = names.iter().enumerate().map(of).collect::<Result<_, _>>()?;
        read.sort_unstable();
        read.dedup();
        Ok(read)
    }
}

/// The refusal of a name, with the one that may have been meant.
fn unknown<'a>(field: &str, name: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> PlateError {
    let meant =
        nearest(name, known.clone()).map_or_else(String::new, |near| format!("; did you mean {near}?"));
    PlateError::UnknownKind {
        field: field.to_owned(),
        value: format!("{:?}", name.chars().take(40).collect::<String>()),
        allowed: format!("one of {}{meant}", known.into_iter().collect::<Vec<_>>().join(", ")),
    }
}
