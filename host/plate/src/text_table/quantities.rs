//! The quantities that a column may hold.

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Frequency, hertz.
    Frequency,
    /// A level in decibels.
    Level,
    /// A magnitude.
    Magnitude,
    /// A magnitude of the deflection, metres.
    Displacement,
    /// A magnitude of the velocity, m/s.
    Velocity,
    /// A magnitude of the acceleration, m/s^2.
    Acceleration,
    /// A magnitude of the strain.
    Strain,
    /// A phase.
    Phase,
    /// The real part of a response.
    Real,
    /// The imaginary part of a response.
    Imaginary,
    /// A place, metres.
    Place,
    /// A time, seconds.
    Time,
    /// The number of a tone.
    Tone,
}

impl Quantity {
    /// Its name in a report and in an option.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::Level => "level",
            Self::Magnitude => "magnitude",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Strain => "strain",
            Self::Phase => "phase",
            Self::Real => "real",
            Self::Imaginary => "imaginary",
            Self::Place => "place",
            Self::Time => "time",
            Self::Tone => "tone",
        }
    }

    /// Whether it is the size of a response.
    pub(crate) const fn is_level(self) -> bool {
        matches!(
            self,
            Self::Level
                | Self::Magnitude
                | Self::Displacement
                | Self::Velocity
                | Self::Acceleration
                | Self::Strain
        )
    }
}
